"""Character: skinned meshes of a glTF file, standing as in the file, on the joints of its skeleton."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import GltfFile, InputError
from crowdbot.humans.asset import shapes
from crowdbot.humans.clips.retarget import NEEDED, map_bones
from crowdbot.typing import Floats, Ints

MOST_TRIANGLES, MOST_JOINTS = 400_000, 1000


class Character(NamedTuple):
    """Triangles and bones in the frame of the file: metres, y up.

    Fields:
        name: name of the file.
        vertices: ``[V, 3]`` [m].
        weights: ``[V, 28]`` shares of the bones of crowdbot (sum 1).
        faces: ``[F, 3]``.
        uv: texture coordinates of the corners ``[F, 3, 2]``.
        material: number of the material of each triangle ``[F]``, -1 for none.
        joints: place ``[3]`` [m] of the bones that the skeleton has, by name.
        remarks: sentences about what is left out.
    """

    name: str
    vertices: Floats
    weights: Floats
    faces: Ints
    uv: Floats
    material: Ints
    joints: dict[str, Floats]
    remarks: tuple[str, ...]


def read_character(file: GltfFile) -> Character:
    """Return the character of a file, as its nodes stand without animation.

    The bones are found by the names of Rocketbox (``Bip01 L Calf``), Mixamo (``mixamorig:LeftLeg``) and similar
    skeletons; joints without such a name belong to the next bone above them.

    Raises:
        InputError: there is no skinned mesh, a bone is missing, or the file is damaged.
    """
    nodes = file.rows("nodes")
    joints = {k for skin in file.rows("skins") for k in _numbers(file, skin, "joints")}
    names = [str(node.get("name", "")) for node in nodes]
    if not joints or not any("skin" in node and "mesh" in node for node in nodes):
        raise InputError(f"{file.name} has no skinned mesh; export the character with its skeleton and skin")
    if len(joints) > MOST_JOINTS or not all(0 <= k < len(nodes) for k in joints):
        raise InputError(f"{file.name} has {len(joints)} joints; at most {MOST_JOINTS} that exist are allowed")
    order = sorted(joints)
    found = map_bones(tuple(names[k] for k in order))
    bone_node = {bone: order[k] for bone, k in found.items()}
    missing = [bone for bone in NEEDED if bone not in bone_node]
    if missing:
        known = ", ".join(names[k] for k in order)[:300]
        raise InputError(f"{file.name} has no joint for {', '.join(missing)}; its joints are {known}")
    frames = file.frames()
    owner = _owners(nodes, bone_node, names)
    return _joined(file, nodes, frames, owner, bone_node)


def _owners(nodes: list[Mapping[str, Any]], bone_node: dict[str, int], names: list[str]) -> Ints:
    """Return the bone ``[N]`` that each node moves with, -1 for none."""
    every = shapes()
    found = np.full(len(nodes), -1, dtype=np.int64)
    exact = {node: every.bone(bone) for bone, node in bone_node.items()}
    hands = {every.bone(f"hand_{side}"): side for side in "lr"}
    below = {child for node in nodes for child in node.get("children", ())}
    todo = [(k, -1, 0) for k in range(len(nodes)) if k not in below]
    while todo:
        k, bone, deep = todo.pop()
        bone = exact.get(k, bone)
        found[k] = bone
        if bone in hands and k not in exact:
            deep += 1
            thumb = re.search(r"(?i)thumb|finger0\d*$", names[k]) is not None
            first = f"thumb_{hands[bone]}" if thumb else f"fingers_0{min(deep, 2)}_{hands[bone]}"
            found[k] = every.bone(first)
        else:
            deep = 0
        todo += [(child, bone, deep) for child in nodes[k].get("children", ())]
    return found


def _joined(
    file: GltfFile, nodes: list[Mapping[str, Any]], frames: Floats, owner: Ints, bone_node: dict[str, int]
) -> Character:
    """Return the meshes of all nodes as one."""
    vertices, weights, faces, uv, material = [], [], [], [], []
    points, remarks = 0, list[str]()
    for k, node in enumerate(nodes):
        if "mesh" not in node:
            continue
        if "skin" not in node and owner[k] < 0:
            remarks.append(f"the mesh {str(node.get('name', k))[:40]!r} is not part of the skeleton and is left out")
            continue
        for primitive in _primitives(file, file.row("meshes", node["mesh"])):
            place, share = _placed(file, node, primitive, frames, owner, k)
            rows = _faces(file, primitive, len(place))
            vertices.append(place)
            weights.append(share)
            faces.append(rows + points)
            uv.append(_coordinates(file, primitive, len(place))[rows])
            kind = primitive.get("material")
            material.append(np.full(len(rows), kind if isinstance(kind, int) else -1, dtype=np.int64))
            points += len(place)
            if sum(map(len, faces)) > MOST_TRIANGLES:
                raise InputError(f"{file.name} has more than {MOST_TRIANGLES} triangles; simplify the mesh")
    if not sum(map(len, faces)):
        raise InputError(f"{file.name} has no triangles")
    whole, share = np.concatenate(vertices), np.concatenate(weights)
    if not np.all(np.isfinite(whole)) or np.abs(whole).max() > 1e5:
        raise InputError(f"{file.name} has points that are not finite or farther than 100 km from the origin")
    places = {bone: frames[node, :3, 3].copy() for bone, node in bone_node.items()}
    _add_fingers(places, frames, owner, nodes)
    return Character(
        file.name, whole, share, np.concatenate(faces), np.concatenate(uv), np.concatenate(material), places,
        tuple(remarks),
    )  # fmt: skip


def _add_fingers(places: dict[str, Floats], frames: Floats, owner: Ints, nodes: list[Mapping[str, Any]]) -> None:
    """Add the start of fingers and thumbs: the mean of the joints that move with them."""
    every = shapes()
    upper = {child: k for k, node in enumerate(nodes) for child in node.get("children", ())}
    for side in "lr":
        for name in ("fingers_01", "fingers_02", "thumb"):
            bone = every.bone(f"{name}_{side}")
            own = [k for k in np.flatnonzero(owner == bone).tolist() if owner[upper.get(k, k)] != bone]
            if own:
                places[f"{name}_{side}"] = frames[own, :3, 3].mean(axis=0)


def _primitives(file: GltfFile, mesh: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return the primitives of triangles of a mesh."""
    rows = mesh.get("primitives", [])
    if not isinstance(rows, list) or not all(isinstance(one, dict) for one in rows):
        raise InputError(f"{file.name}: primitives of a mesh must be a list of objects")
    for one in rows:
        if not isinstance(one.get("attributes"), dict) or "POSITION" not in one["attributes"]:
            raise InputError(f"{file.name}: a primitive has no POSITION")
        if one.get("mode", 4) not in (0, 1, 2, 3, 4):
            raise InputError(f"{file.name}: triangle strips and fans are not supported; save it with triangles")
    return [one for one in rows if one.get("mode", 4) == 4]


def _placed(
    file: GltfFile, node: Mapping[str, Any], primitive: Mapping[str, Any], frames: Floats, owner: Ints, k: int
) -> tuple[Floats, Floats]:
    """Return the points ``[V, 3]`` of a primitive where the skeleton stands, and the shares ``[V, 28]`` of bones."""
    names = primitive["attributes"]
    rest = _columns(file, names["POSITION"], 3, None)
    count, bones = len(rest), len(shapes().bones)
    if "skin" not in node:
        share = np.zeros((count, bones))
        share[:, owner[k]] = 1.0
        return rest @ frames[k, :3, :3].T + frames[k, :3, 3], share
    skin = file.row("skins", node["skin"])
    joints = np.array(_numbers(file, skin, "joints"), dtype=np.int64)
    inverse = np.tile(np.eye(4), (len(joints), 1, 1))
    if "inverseBindMatrices" in skin:
        inverse = _columns(file, skin["inverseBindMatrices"], 16, len(joints)).reshape(-1, 4, 4).transpose(0, 2, 1)
    which, weight = _influences(file, names, count, len(joints))
    matrix = frames[joints] @ inverse
    found = np.zeros((count, 3))
    share = np.zeros((count, bones))
    root = shapes().bone("pelvis")
    bone = np.where(owner[joints] >= 0, owner[joints], root)
    for i in range(which.shape[1]):
        turned = np.einsum("vij,vj->vi", matrix[which[:, i], :3, :3], rest) + matrix[which[:, i], :3, 3]
        found += weight[:, i : i + 1] * turned
        np.add.at(share, (np.arange(count), bone[which[:, i]]), weight[:, i])
    return found, share


def _influences(file: GltfFile, names: Mapping[str, Any], count: int, joints: int) -> tuple[Ints, Floats]:
    """Return the joints and their weights (sum 1) of the points of a skinned primitive."""
    which, weight = [], []
    for n in range(4):
        if f"JOINTS_{n}" in names and f"WEIGHTS_{n}" in names:
            which.append(_columns(file, names[f"JOINTS_{n}"], 4, count).astype(np.int64))
            weight.append(_columns(file, names[f"WEIGHTS_{n}"], 4, count))
    if not which:
        raise InputError(f"{file.name}: a skinned mesh has no JOINTS_0 and WEIGHTS_0")
    rows, shares = np.concatenate(which, axis=1), np.concatenate(weight, axis=1)
    if not np.all(np.isfinite(shares)) or shares.min(initial=0.0) < -1e-3:
        raise InputError(f"{file.name}: weights of a skin must be finite and at least 0")
    shares = np.maximum(shares, 0.0)
    rows = np.where(shares > 0.0, rows, 0)
    if rows.size and not 0 <= rows.min() <= rows.max() < joints:
        raise InputError(f"{file.name}: a point names joint {rows.max()} of the {joints} joints of its skin")
    total = shares.sum(axis=1, keepdims=True)
    shares[total[:, 0] < 1e-6, 0] = 1.0
    return rows, shares / shares.sum(axis=1, keepdims=True)


def _faces(file: GltfFile, primitive: Mapping[str, Any], count: int) -> Ints:
    if "indices" not in primitive:
        found = np.arange(count - count % 3)
    else:
        values = file.array(primitive["indices"])
        found = values.ravel()[: values.size - values.size % 3].astype(np.int64)
    if found.size and not 0 <= found.min() <= found.max() < count:
        raise InputError(f"{file.name}: a triangle names point {found.max()} of {count}")
    return found.reshape(-1, 3)


def _coordinates(file: GltfFile, primitive: Mapping[str, Any], count: int) -> Floats:
    """Return the texture coordinates ``[V, 2]`` of the base colour of a primitive."""
    layer = 0
    if isinstance(primitive.get("material"), int):
        detail = file.row("materials", primitive["material"]).get("pbrMetallicRoughness", {})
        texture = detail.get("baseColorTexture", {}) if isinstance(detail, dict) else {}
        layer = texture.get("texCoord", 0) if isinstance(texture, dict) else 0
    name = f"TEXCOORD_{layer}"
    if name not in primitive["attributes"]:
        return np.zeros((count, 2))
    found = _columns(file, primitive["attributes"][name], 2, count)
    return np.clip(np.nan_to_num(found), -1e3, 1e3)


def _columns(file: GltfFile, number: Any, wide: int, count: int | None) -> Floats:
    """Return an array of a number of columns, and of rows if given."""
    found = file.array(number).astype(np.float64)
    if found.shape[1] != wide or (count is not None and len(found) < count):
        raise InputError(
            f"{file.name}: array {number} has the shape {list(found.shape)}; expected [{count or 'N'}, {wide}]"
        )
    return found if count is None else found[:count]


def _numbers(file: GltfFile, row: Mapping[str, Any], key: str) -> list[int]:
    value = row.get(key, [])
    if not isinstance(value, list) or not all(isinstance(one, int) and not isinstance(one, bool) for one in value):
        raise InputError(f"{file.name}: {key} of a skin must be a list of whole numbers")
    return value
