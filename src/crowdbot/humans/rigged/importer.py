"""Import of rigged characters of other programs as bodies."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import GltfFile, InputError, read_gltf
from crowdbot.humans.asset import person, shapes
from crowdbot.humans.clip import NEEDED, map_bones
from crowdbot.typing import Floats, Ints

from .rigged_body import PICTURE, RiggedBody
from .simplify import detail_levels

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
    owners = np.full(len(nodes), -1, dtype=np.int64)
    exact = {node: every.bone(bone) for bone, node in bone_node.items()}
    hands = {every.bone(f"hand_{side}"): side for side in "lr"}
    below = {child for node in nodes for child in node.get("children", ())}
    todo = [(k, -1, 0) for k in range(len(nodes)) if k not in below]
    while todo:
        k, bone, deep = todo.pop()
        bone = exact.get(k, bone)
        owners[k] = bone
        if bone in hands and k not in exact:
            deep += 1
            thumb = re.search(r"(?i)thumb|finger0\d*$", names[k]) is not None
            first = f"thumb_{hands[bone]}" if thumb else f"fingers_0{min(deep, 2)}_{hands[bone]}"
            owners[k] = every.bone(first)
        else:
            deep = 0
        todo += [(child, bone, deep) for child in nodes[k].get("children", ())]
    return owners


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
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise InputError(f"{file.name}: primitives of a mesh must be a list of objects")
    for row in rows:
        if not isinstance(row.get("attributes"), dict) or "POSITION" not in row["attributes"]:
            raise InputError(f"{file.name}: a primitive has no POSITION")
        if row.get("mode", 4) not in (0, 1, 2, 3, 4):
            raise InputError(f"{file.name}: triangle strips and fans are not supported; save it with triangles")
    return [row for row in rows if row.get("mode", 4) == 4]


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
    columns = _columns(file, primitive["attributes"][name], 2, count)
    return np.clip(np.nan_to_num(columns), -1e3, 1e3)


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
    if not isinstance(value, list) or not all(isinstance(item, int) and not isinstance(item, bool) for item in value):
        raise InputError(f"{file.name}: {key} of a skin must be a list of whole numbers")
    return value


MOST_PIXELS = 70_000_000
MOST_MATERIALS = 64
FORMATS = ("PNG", "JPEG", "WEBP")
GREY = (0.72, 0.70, 0.67, 1.0)
"""Colour of triangles without a material."""
CUT = 0.5
"""Smallest opacity of a triangle that is drawn, of materials with transparent parts."""


class CharacterPicture(NamedTuple):
    """The picture ``[1024, 1024, 3]``, coordinates ``uv [F, 3, 2]``, triangles with a back that shows, and drawn ones.

    Fields ``closed`` and ``drawn`` are ``[F]``.
    """

    picture: NDArray[np.uint8]
    uv: Floats
    closed: NDArray[np.bool_]
    drawn: NDArray[np.bool_]


def character_picture(file: GltfFile, character: Character) -> CharacterPicture:
    """Return the picture of a character; each material has a square of it.

    Textures repeat outside of 0 to 1 by whole triangles only. Triangles of transparent materials are drawn where more
    than half is opaque.

    Raises:
        InputError: an image cannot be read or is too large, or there are too many materials.
    """
    used = np.unique(character.material)
    if len(used) > MOST_MATERIALS:
        raise InputError(f"{file.name} has {len(used)} materials, at most {MOST_MATERIALS} are allowed; join them")
    grid = 1 << math.ceil(math.log2(max(1, math.ceil(math.sqrt(len(used))))))
    side = PICTURE // grid
    picture = np.zeros((PICTURE, PICTURE, 3), dtype=np.uint8)
    uv = character.uv - np.floor(character.uv.min(axis=1, keepdims=True) + 1e-6)
    uv = np.clip(uv, 0.5 / side, 1.0 - 0.5 / side)
    closed, drawn = np.ones(len(uv), dtype=np.bool_), np.ones(len(uv), dtype=np.bool_)
    for k, number in enumerate(used.tolist()):
        row, column = divmod(k, grid)
        material = file.row("materials", number) if number >= 0 else {}
        tile = material_picture(file, material, side)
        picture[row * side : (row + 1) * side, column * side : (column + 1) * side] = tile[..., :3]
        own = np.flatnonzero(character.material == number)
        closed[own] = material.get("doubleSided") is not True
        if material.get("alphaMode", "OPAQUE") != "OPAQUE":
            drawn[own] = _opacity(tile, uv[own]) >= CUT
            closed[own] = False
        uv[own] = (uv[own] + (column, row)) / grid
    if not drawn.any():
        raise InputError(f"{file.name}: all its triangles are transparent")
    return CharacterPicture(picture, uv, closed, drawn)


def _opacity(tile: NDArray[np.uint8], uv: Floats) -> Floats:
    """Return the mean opacity of triangles, from their middle and points between it and the corners."""
    side = len(tile)
    middle = uv.mean(axis=1, keepdims=True)
    points = np.concatenate([middle, 0.5 * (middle + uv)], axis=1)
    x, y = (np.minimum((points[..., k] * side).astype(np.int64), side - 1) for k in (0, 1))
    return np.asarray(tile[y, x, 3].mean(axis=1) / 255.0)


def material_picture(file: GltfFile, material: Mapping[str, Any], side: int) -> NDArray[np.uint8]:
    """Return the base colour of a material of a glTF file ``[side, side, 4]``: red, green, blue, opacity.

    Raises:
        InputError: its image cannot be read or is too large.
    """
    from PIL import Image

    detail = material.get("pbrMetallicRoughness", {})
    detail = detail if isinstance(detail, dict) else {}
    factor = _factor(file, detail) if material else np.array(GREY)
    texture = detail.get("baseColorTexture")
    if not isinstance(texture, dict):
        return np.tile(np.round(255.0 * factor).astype(np.uint8), (side, side, 1))
    row = file.row("textures", texture.get("index"))
    extensions = row.get("extensions")
    webp = extensions.get("EXT_texture_webp", {}) if isinstance(extensions, dict) else {}
    number = row.get("source", webp.get("source") if isinstance(webp, dict) else None)
    data = file.image(number)
    try:
        with Image.open(io.BytesIO(data), formats=FORMATS) as image:
            if image.size[0] * image.size[1] > MOST_PIXELS:
                raise InputError(f"image {number} has {image.size[0]} x {image.size[1]} pixels, at most 70 million")
            image.draft("RGB", (2 * side, 2 * side))
            whole = image.convert("RGBA").resize((side, side), Image.Resampling.BOX)
    except InputError as error:
        raise InputError(f"{file.name}: {error}") from None
    except Exception as error:  # a broken image causes many kinds of exceptions inside Pillow
        raise InputError(f"{file.name}: image {number} cannot be read: {type(error).__name__}") from None
    return np.round(np.asarray(whole, dtype=np.float64) * factor).astype(np.uint8)


def _factor(file: GltfFile, detail: Mapping[str, Any]) -> Floats:
    """Return the base colour factor ``[4]``, red, green and blue as in images."""
    try:
        found = np.array(detail.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0)), dtype=np.float64)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape != (4,) or not np.all((found >= 0.0) & (found <= 1.0)):
        raise InputError(f"{file.name}: baseColorFactor must be four numbers from 0 to 1")
    return np.append(found[:3] ** (1.0 / 2.2), found[3])


HEIGHTS = (0.5, 2.5)
LEANING = math.radians(25.0)
"""Largest angle of the trunk from upright in the file."""
SPLAYED = math.radians(60.0)
"""Largest angle of thighs and shanks from straight down in the file."""
CHILD = {
    "thigh": "calf", "calf": "foot", "upperarm": "lowerarm", "lowerarm": "hand", "hand": "fingers_01",
}  # fmt: skip
"""Bones that are turned to the direction of the rest pose, and where they end."""


class RestPose(NamedTuple):
    """Points ``vertices [V, 3]`` and ends of the bones ``head`` and ``tail [28, 3]`` [m]: x forward, y left, z up."""

    vertices: Floats
    head: Floats
    tail: Floats
    height: float


def rest_pose(character: Character, height: float | None = None) -> RestPose:
    """Return a character in the rest pose of the included bodies, standing on the floor.

    Args:
        character: the character as it stands in its file, in a T or A pose.
        height: stature [m] (default: that in the file).

    Raises:
        InputError: the character is not upright, its legs are not straight down, or its stature is not a person's.
    """
    axes = _axes(character)
    points = character.vertices @ axes.T
    own = {bone: axes @ place for bone, place in character.joints.items()}
    low = float(points[:, 2].min())
    tall = float(points[:, 2].max()) - low
    if height is None and not HEIGHTS[0] <= tall <= HEIGHTS[1]:
        raise InputError(
            f"{character.name}: the character is {tall:.4g} m tall, from {HEIGHTS[0]} to {HEIGHTS[1]} m are allowed;"
            " give its stature with --height"
        )
    factor = 1.0 if height is None else height / tall
    points, own = points * factor, {bone: place * factor for bone, place in own.items()}
    _check_posture(character.name, own)
    head, turned, turns = _turned(own, tall * factor)
    placed = np.zeros_like(points)
    for bone in np.flatnonzero(character.weights.any(axis=0)):
        away = points - head[bone]
        placed += character.weights[:, bone, None] * (away @ turns[bone].T + turned[bone])
    shift = np.array([turned[0, 0], turned[0, 1], float(placed[:, 2].min())])
    placed, turned = placed - shift, turned - shift
    size = 1.0 if height is None else height / float(placed[:, 2].max())
    placed, turned = placed * size, turned * size
    every = shapes()
    ratio = float(turned[0, 2]) / float(every.head[-1, 0, 2])
    tail = turned + ratio * (every.tail[-1] - every.head[-1])
    return RestPose(placed, turned, tail, float(placed[:, 2].max()))


def _axes(character: Character) -> Floats:
    """Return the rotation from the frame of the file to x forward, y left, z up."""
    up = np.array([0.0, 1.0, 0.0])
    left = character.joints["thigh_l"] - character.joints["thigh_r"]
    left = left - up * float(left @ up)
    size = float(np.linalg.norm(left))
    if size < 1e-6:
        raise InputError(f"{character.name}: the hips have no width; glTF has y up and metres")
    left = left / size
    return np.array([np.cross(left, up), left, up])


def _check_posture(name: str, own: dict[str, Floats]) -> None:
    trunk = own["head"] - own["pelvis"]
    if float(trunk[2]) < math.cos(LEANING) * float(np.linalg.norm(trunk)):
        raise InputError(f"{name}: the character does not stand upright; save it in its T pose without animation")
    for side in "lr":
        for first, last in (("thigh", "calf"), ("calf", "foot")):
            way = own[f"{last}_{side}"] - own[f"{first}_{side}"]
            if float(-way[2]) < math.cos(SPLAYED) * float(np.linalg.norm(way)) or not np.any(way):
                raise InputError(f"{name}: the legs are not straight; save it in its T pose without animation")


def _turned(own: dict[str, Floats], tall: float) -> tuple[Floats, Floats, Floats]:
    """Return start in the file ``[28, 3]``, start in the rest pose ``[28, 3]`` and rotation of each bone."""
    every = shapes()
    mean = every.head[-1]
    size = tall / float(every.levels[0].rest[-1][:, 2].max())
    head, turned = np.zeros_like(mean), np.zeros_like(mean)
    turns = np.tile(np.eye(3), (len(mean), 1, 1))
    for k, bone in enumerate(every.bones):
        parent = int(every.parents[k])
        above = turns[parent] if parent >= 0 else np.eye(3)
        if bone in own:
            head[k] = own[bone]
        else:
            head[k] = head[parent] + above.T @ (size * (mean[k] - mean[parent]))
        turned[k] = head[k] if parent < 0 else turned[parent] + above @ (head[k] - head[parent])
        turns[k] = _turn(bone, own, above)
    return head, turned, turns


def _turn(bone: str, own: dict[str, Floats], above: Floats) -> Floats:
    """Return the rotation of a bone from the file to the rest pose."""
    every = shapes()
    stem, _, side = bone.rpartition("_")
    mean = {name: every.head[-1, k] for k, name in enumerate(every.bones)}
    if side not in ("l", "r") or stem == "clavicle":
        return np.eye(3)
    if stem == "foot":
        toes = own.get(f"ball_{side}")
        if toes is None:
            return np.eye(3)
        flat = np.array([1.0, 1.0, 0.0])
        return _between((toes - own[bone]) * flat, (mean[f"ball_{side}"] - mean[bone]) * flat)
    end = f"{CHILD.get(stem, '')}_{side}"
    if stem not in CHILD or end not in own or bone not in own:
        return above
    way, goal = own[end] - own[bone], mean[end] - mean[bone]
    thumb = f"thumb_{side}"
    if stem == "hand" and thumb in own:
        return _frame(goal, mean[thumb] - mean[bone]) @ _frame(way, own[thumb] - own[bone]).T
    return _between(above @ way, goal) @ above


def _frame(first: Floats, second: Floats) -> Floats:
    """Return axes as columns: along a vector, and towards another one."""
    x = first / max(float(np.linalg.norm(first)), 1e-9)
    y = second - x * float(x @ second)
    size = float(np.linalg.norm(y))
    y = y / size if size > 1e-6 else np.cross((0.0, 0.0, 1.0), x)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def _between(first: Floats, second: Floats) -> Floats:
    """Return the smallest rotation from one direction to another."""
    a, b = (item / max(float(np.linalg.norm(item)), 1e-9) for item in (first, second))
    v, c = np.cross(a, b), float(a @ b)
    cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / max(1.0 + c, 1e-6))


class ImportedBody(NamedTuple):
    """A body, the bones that its skeleton lacks, and sentences about what is left out."""

    body: RiggedBody
    missing: tuple[str, ...]
    remarks: tuple[str, ...]


def import_body(path: str | Path, name: str, height: float | None = None, mass: float | None = None) -> ImportedBody:
    """Turn a rigged character in glTF into a body.

    The skeleton is that of Rocketbox (``Bip01``), Mixamo (``mixamorig``) or one with similar names; the character
    stands in a T or A pose. Bones that it lacks have the place of the mean adult.

    Args:
        path: a ``.glb`` or ``.gltf`` file.
        name: name of the body, such as ``ann.body``.
        height: stature [m] (default: that in the file).
        mass: mass [kg] (default: that of the mean adult times the square of the ratio of statures, the same body mass
            index).

    Raises:
        InputError: the file is missing, damaged, too large or without a known skeleton, or a value is not allowed.
    """
    file = read_gltf(Path(path))
    character = read_character(file)
    looks = character_picture(file, character)
    pose = rest_pose(character, height)
    faces = character.faces[looks.drawn]
    levels = detail_levels(pose.vertices, character.weights, faces, looks.uv[looks.drawn], looks.closed[looks.drawn])
    mean = person("mannequin")
    weight = mean.mass * (pose.height / mean.height) ** 2 if mass is None else mass
    if not np.all([len(level.faces) for level in levels]):
        raise InputError(f"{file.name} has no triangles of more than 0.1 mm")
    body = RiggedBody(name, pose.height, weight, pose.head, pose.tail, levels, looks.picture)
    missing = tuple(bone for bone in shapes().bones if bone not in character.joints)
    return ImportedBody(body, missing, character.remarks)
