"""Rigged characters in glTF made of an included body: T pose, names and units of Mixamo or of Rocketbox."""

import io
import json
import struct

import numpy as np
from PIL import Image
from scipy.spatial.transform import Rotation

from crowdbot.humans import body_uv, person, shapes

MIXAMO = {
    "pelvis": "Hips", "spine_01": "Spine", "spine_02": "Spine1", "spine_03": "Spine2", "neck_01": "Neck",
    "head": "Head", "clavicle": "Shoulder", "upperarm": "Arm", "lowerarm": "ForeArm", "hand": "Hand",
    "fingers_01": "HandIndex1", "fingers_02": "HandIndex2", "thumb": "HandThumb1", "thigh": "UpLeg", "calf": "Leg",
    "foot": "Foot", "ball": "ToeBase",
}  # fmt: skip
BIPED = {
    "pelvis": "Pelvis", "spine_01": "Spine", "spine_02": "Spine1", "spine_03": "Spine2", "neck_01": "Neck",
    "head": "Head", "clavicle": "Clavicle", "upperarm": "UpperArm", "lowerarm": "Forearm", "hand": "Hand",
    "fingers_01": "Finger1", "fingers_02": "Finger11", "thumb": "Finger0", "thigh": "Thigh", "calf": "Calf",
    "foot": "Foot", "ball": "Toe0",
}  # fmt: skip
TO_FILE = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""From x forward, y left, z up to the axes of glTF: x left, y up, z forward."""
FLOAT, SHORT, INT = 5126, 5123, 5125


def joint_name(bone, scheme):
    """Return the name of the joint of a bone."""
    stem, _, side = bone.rpartition("_")
    if scheme == "mixamo":
        return f"mixamorig:{'Left' if side == 'l' else 'Right'}{MIXAMO[stem]}" if side in ("l", "r") else (
            f"mixamorig:{MIXAMO[bone]}")  # fmt: skip
    return f"Bip01 {side.upper()} {BIPED[stem]}" if side in ("l", "r") else f"Bip01 {BIPED[bone]}"


def t_pose(name, level=1):
    """Return vertices ``[V, 3]`` and starts of bones ``[28, 3]`` [m] of a body whose arms point to the sides."""
    every, row = shapes(), person(name).index
    head, mesh = every.head[row], every.levels[level]
    turns, placed = np.tile(np.eye(3), (len(head), 1, 1)), head.copy()
    for k, bone in enumerate(every.bones):
        parent = int(every.parents[k])
        stem, _, side = bone.rpartition("_")
        if stem in ("upperarm", "lowerarm", "hand"):
            end = every.bone({"upperarm": "lowerarm_", "lowerarm": "hand_", "hand": "fingers_01_"}[stem] + side)
            way = head[end] - head[k]
            turns[k] = Rotation.align_vectors([[0.0, 1.0 if side == "l" else -1.0, 0.0]], [way])[0].as_matrix()
        elif stem in ("fingers_01", "fingers_02", "thumb"):
            turns[k] = turns[parent]
        if parent >= 0:
            placed[k] = placed[parent] + turns[parent] @ (head[k] - head[parent])
    rest, out = mesh.rest[row], np.zeros_like(mesh.rest[row])
    for i in range(4):
        b = mesh.bones[:, i]
        out += mesh.weights[:, i : i + 1] * (np.einsum("vij,vj->vi", turns[b], rest - head[b]) + placed[b])
    return out, placed


class Chunks:
    """Collects arrays as accessors of a GLB file."""

    def __init__(self):
        self.data, self.views, self.accessors = b"", [], []

    def view(self, data):
        """Add bytes, and return the number of their part."""
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        self.data += data + b"\0" * (-len(data) % 4)
        return len(self.views) - 1

    def array(self, values, kind, words):
        """Add an array, and return the number of its accessor."""
        types = {FLOAT: "<f4", SHORT: "<u2", INT: "<u4"}
        view = self.view(np.ascontiguousarray(values).astype(types[kind]).tobytes())
        self.accessors.append({"bufferView": view, "componentType": kind, "count": len(values), "type": words})
        return len(self.accessors) - 1


def checked_picture(side=64):
    """Return a PNG file: the top half red, the lower half blue."""
    image = np.zeros((side, side, 3), dtype=np.uint8)
    image[: side // 2, :, 0], image[side // 2 :, :, 2] = 200, 200
    out = io.BytesIO()
    Image.fromarray(image).save(out, "PNG")
    return out.getvalue()


def character_table(body="woman-36", scheme="mixamo", level=1, without=(), picture=None):
    """Return the table and the data of a character; ``without`` names bones that its skeleton lacks."""
    every = shapes()
    vertices, heads = t_pose(body, level)
    mesh = every.levels[level]
    faces = mesh.faces[np.isin(mesh.face_part, [0, 1, 2])]
    scale = 100.0  # centimetres in the frame of the skeleton
    tilt = np.eye(3) if scheme == "mixamo" else Rotation.from_euler("x", 90, degrees=True).as_matrix()
    inner = scale * (tilt @ TO_FILE)
    bones = [k for k, bone in enumerate(every.bones) if bone not in without]
    number = {k: n for n, k in enumerate(bones)}
    roll = [Rotation.from_euler("y", 17.0 * k, degrees=True).as_matrix() for k in bones]
    world = [np.block([[roll[n], (inner @ heads[k])[:, None]], [np.zeros((1, 3)), 1.0]]) for n, k in enumerate(bones)]
    nodes = []
    for n, k in enumerate(bones):
        parent = int(every.parents[k])
        while parent >= 0 and parent not in number:
            parent = int(every.parents[parent])
        local = world[n] if parent < 0 else np.linalg.inv(world[number[parent]]) @ world[n]
        nodes.append({"name": joint_name(every.bones[k], scheme), "matrix": local.T.ravel().tolist(), "children": []})
        if parent >= 0:
            nodes[number[parent]]["children"].append(n)
    kept = np.array([number.get(k, number.get(int(every.parents[k]), 0)) for k in range(len(every.bones))])
    chunks = Chunks()
    uv = body_uv(level)[np.isin(mesh.face_part, [0, 1, 2])].reshape(-1, 2)
    corner = faces.ravel()  # each corner has its own point, as exporters write it where textures have seams
    attributes = {
        "POSITION": chunks.array(vertices[corner] @ inner.T, FLOAT, "VEC3"),
        "TEXCOORD_0": chunks.array(uv, FLOAT, "VEC2"),
        "JOINTS_0": chunks.array(kept[mesh.bones[corner]], SHORT, "VEC4"),
        "WEIGHTS_0": chunks.array(mesh.weights[corner], FLOAT, "VEC4"),
    }
    inverse = chunks.array(
        np.array([np.linalg.inv(item).T.ravel() for item in world]).reshape(len(bones), 16), FLOAT, "MAT4"
    )
    indices = chunks.array(np.arange(len(corner)), INT, "SCALAR")
    image = chunks.view(checked_picture() if picture is None else picture)
    armature = {
        "name": "Armature", "scale": [0.01] * 3, "children": [0, len(nodes)],
        "rotation": Rotation.from_matrix(tilt.T).as_quat().tolist(),
    }  # fmt: skip
    nodes += [{"name": "Body", "mesh": 0, "skin": 0}, armature]
    table = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [len(nodes) - 1]}], "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}],
        "skins": [{"joints": list(range(len(bones))), "inverseBindMatrices": inverse}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"bufferView": image, "mimeType": "image/png"}],
        "accessors": chunks.accessors, "bufferViews": chunks.views, "buffers": [{"byteLength": len(chunks.data)}],
    }  # fmt: skip
    for node in table["nodes"]:
        if not node.get("children", True):
            del node["children"]
    return table, chunks.data


def glb(table, data):
    """Return the bytes of a GLB file."""
    text = json.dumps(table).encode()
    text += b" " * (-len(text) % 4)
    rest = struct.pack("<I", len(data)) + b"BIN\0" + data
    whole = struct.pack("<I", len(text)) + b"JSON" + text + rest
    return b"glTF" + struct.pack("<II", 2, 12 + len(whole)) + whole


def character(folder, name="ann.glb", **options):
    """Write a character, and return its path."""
    path = folder / name
    path.write_bytes(glb(*character_table(**options)))
    return path
