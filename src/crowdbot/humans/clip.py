"""Clips: recorded motions that all bodies can play, and their import from BVH files."""

from __future__ import annotations

import itertools
import json
import math
import re
from dataclasses import dataclass, field

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .asset import shapes

SUFFIX = ".clip"
FORMAT = "crowdbot-clip-1"
MOST_FRAMES, MOST_BYTES = 3000, 40_000_000
KEYS = {"format", "rate", "cyclic", "bones", "rotations", "lift"}


@dataclass(frozen=True, eq=False)
class Clip:
    """A motion of the bones, without the way and the heading.

    Fields:
        name: name of the activity, the name of its file.
        rate: frames per second.
        cyclic: whether it is one cycle of a gait from the landing of the left foot on, played in step with the way;
            otherwise it is played in time, again and again.
        bones: names of the bones that move.
        rotations: ``[T, K, 4]`` quaternions w, x, y, z of the bones relative to their rest, in the frame of the body.
        lift: height ``[T]`` of the lower foot above the floor, in leg lengths.

    Raises:
        InputError: a shape or a value is not allowed.
    """

    name: str
    rate: float
    cyclic: bool
    bones: tuple[str, ...]
    rotations: Floats
    lift: Floats
    matrices: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not 1.0 <= self.rate <= 1000.0:
            raise InputError(f"{self.name}: rate = {self.rate} Hz must be from 1 to 1000")
        unknown = [bone for bone in self.bones if bone not in shapes().bones]
        if unknown or not self.bones or len(set(self.bones)) < len(self.bones):
            what = f"unknown bone {unknown[0]!r}" if unknown else "no bones, or one twice"
            raise InputError(f"{self.name} has {what}; bones are {', '.join(shapes().bones)}")
        count = len(self.lift)
        if not 2 <= count <= MOST_FRAMES or self.rotations.shape != (count, len(self.bones), 4):
            raise InputError(
                f"{self.name}: rotations have shape {list(self.rotations.shape)}; they must be"
                f" [T, {len(self.bones)}, 4] for {count} frames, from 2 to {MOST_FRAMES}"
            )
        if not np.all(np.isfinite(self.rotations)) or not np.all((self.lift >= 0.0) & (self.lift <= 2.0)):
            raise InputError(f"{self.name}: a rotation is not finite, or a lift is not from 0 to 2 leg lengths")
        size = np.sqrt(np.sum(self.rotations**2, axis=-1, keepdims=True))
        if not np.all((size > 0.5) & (size < 2.0)):
            raise InputError(f"{self.name}: a quaternion has a length of {float(size.min()):g}; it must be 1")
        object.__setattr__(self, "matrices", _matrices(self.rotations / size))

    def at(self, phase: float, clock: float) -> tuple[Floats, float]:
        """Return the rotations ``[K, 3, 3]`` and the lift at a phase of the gait (0 to 1), or at a time [s]."""
        count = len(self.lift)
        place = (phase % 1.0) * count if self.cyclic else (clock * self.rate) % count
        first = int(place) % count
        share, second = place - math.floor(place), (first + 1) % count
        mixed = (1.0 - share) * self.matrices[first] + share * self.matrices[second]
        u, _, v = np.linalg.svd(mixed)
        return np.asarray(u @ v), float((1.0 - share) * self.lift[first] + share * self.lift[second])


def _matrices(q: Floats) -> Floats:
    w, x, y, z = np.moveaxis(q, -1, 0)
    rows = (
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z),
        2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    )  # fmt: skip
    return np.stack(rows, axis=-1).reshape(*q.shape[:-1], 3, 3)


def write_clip(clip: Clip) -> str:
    """Return the text of the file of a clip.

    >>> still = Clip("nod", 30.0, False, ("head",), np.tile((1.0, 0, 0, 0), (2, 1, 1)), np.zeros(2))
    >>> read_clip(write_clip(still), "nod.clip").bones
    ('head',)
    """
    values = {
        "format": FORMAT, "rate": clip.rate, "cyclic": clip.cyclic, "bones": list(clip.bones),
        "rotations": np.round(clip.rotations, 6).tolist(), "lift": np.round(clip.lift, 5).tolist(),
    }  # fmt: skip
    return json.dumps(values)


def read_clip(text: str, name: str) -> Clip:
    """Return the clip of a file.

    Args:
        text: content of the file.
        name: name of the file; it is the name of the activity.

    Raises:
        InputError: the file is no clip, or a value in it is not allowed.
    """
    if len(text) > MOST_BYTES:
        raise InputError(f"{name} has {len(text)} characters, at most {MOST_BYTES} are allowed")
    try:
        values = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{name} is not JSON: {error}") from None
    if not isinstance(values, dict) or values.get("format") != FORMAT:
        raise InputError(f"{name} is no clip: its format must be {FORMAT!r}; crowdbot new clip FILE.bvh writes one")
    if set(values) != KEYS:
        raise InputError(
            f"{name} has the keys {', '.join(sorted(map(str, values)))}; expected {', '.join(sorted(KEYS))}"
        )
    try:
        rotations, lift = (np.array(values[key], dtype=np.float64) for key in ("rotations", "lift"))
        rate, bones = float(values["rate"]), tuple(str(bone) for bone in values["bones"])
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: rate, rotations and lift must be numbers in lists of equal lengths") from None
    if not isinstance(values["cyclic"], bool) or lift.ndim != 1:
        raise InputError(f"{name}: cyclic must be true or false, and lift a list of numbers")
    return Clip(name, rate, values["cyclic"], bones, rotations, lift)


MOST_JOINTS, MOST_BVH_FRAMES, MOST_CHARACTERS = 400, 20_000, 200_000_000
CHANNELS = {f"{axis}{kind}": (k, kind) for kind in ("position", "rotation") for k, axis in enumerate("XYZ")}


@dataclass(frozen=True, eq=False)
class Bvh:
    """A motion: names and parents of J joints, offsets ``[J, 3]``, rotations and positions in the world of the file.

    Fields: ``names``, ``parents`` (-1 is the root), ``offset [J, 3]``, ``rotation [T, J, 3, 3]``,
    ``position [T, J, 3]``, ``rate`` [Hz]. Lengths have the unit of the file.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offset: Floats
    rotation: Floats
    position: Floats
    rate: float


def read_bvh(text: str, name: str) -> Bvh:
    """Return the motion of a BVH file.

    Args:
        text: content of the file.
        name: name of the file for messages.

    Raises:
        InputError: the file is no BVH file or too large; the message names the line.
    """
    if len(text) > MOST_CHARACTERS:
        raise InputError(f"{name} has {len(text)} characters, at most {MOST_CHARACTERS} are allowed")
    lines = text.splitlines()
    at = next((k for k, line in enumerate(lines) if line.strip().upper() == "MOTION"), -1)
    if not lines or lines[0].strip().upper() != "HIERARCHY" or at < 0:
        raise InputError(f"{name} is no BVH file: it must have HIERARCHY in its first line, and a line MOTION")
    joints = _hierarchy(lines[1:at], name)
    values, rate = _motion(lines, at + 1, sum(len(joint.channels) for joint in joints), name)
    return _world(joints, values, rate)


@dataclass
class _Joint:
    name: str
    parent: int
    offset: tuple[float, ...] = (0.0, 0.0, 0.0)
    channels: tuple[str, ...] = ()
    end: bool = False


def _hierarchy(lines: list[str], name: str) -> list[_Joint]:
    joints: list[_Joint] = []
    open_joints: list[int] = []
    for number, line in enumerate(lines, 2):
        words = line.split()
        where = f"{name}:{number}"
        if not words or words[0] == "{":
            continue
        if words[0] in ("ROOT", "JOINT", "End"):
            if len(joints) >= MOST_JOINTS:
                raise InputError(f"{where}: there are more than {MOST_JOINTS} joints")
            if not open_joints and joints:
                raise InputError(f"{where}: there is a second root; a BVH file has one person")
            joints.append(_Joint(" ".join(words[1:]), open_joints[-1] if open_joints else -1, end=words[0] == "End"))
            open_joints.append(len(joints) - 1)
        elif words[0] == "}":
            if not open_joints:
                raise InputError(f"{where}: there is a }} too many")
            open_joints.pop()
        elif words[0] == "OFFSET" and open_joints:
            joints[open_joints[-1]].offset = tuple(_numbers(words[1:], 3, where))
        elif words[0] == "CHANNELS" and open_joints:
            channels = tuple(words[2:])
            if any(channel not in CHANNELS for channel in channels) or words[1:2] != [str(len(channels))]:
                raise InputError(f"{where}: channels must be a number and as many of {', '.join(CHANNELS)}")
            joints[open_joints[-1]].channels = channels
        else:
            raise InputError(f"{where}: {words[0][:40]!r} is not expected here")
    if not joints or open_joints:
        raise InputError(f"{name}: a {{ is not closed" if joints else f"{name} has no joints")
    return joints


def _motion(lines: list[str], first: int, count: int, name: str) -> tuple[Floats, float]:
    head = [line.split(":") for line in lines[first : first + 2]]
    if len(head) < 2 or head[0][0].strip() != "Frames" or head[1][0].strip() != "Frame Time":
        raise InputError(f"{name}:{first + 1}: after MOTION come the lines Frames: N and Frame Time: S")
    (frames,), (period,) = (_numbers(words[1:], 1, f"{name}:{first + k + 1}") for k, words in enumerate(head))
    if not 2 <= frames <= MOST_BVH_FRAMES or not 1e-3 <= period <= 1.0:
        raise InputError(f"{name}: {frames:g} frames of {period:g} s must be 2 to {MOST_BVH_FRAMES}, of 0.001 to 1 s")
    rows = [line for line in lines[first + 2 :] if line.strip()][: int(frames)]
    if len(rows) < frames:
        raise InputError(f"{name} has {len(rows)} frames, expected {frames:g}")
    found = [_numbers(row.split(), count, f"{name}: frame {k + 1}") for k, row in enumerate(rows)]
    return np.array(found), 1.0 / period


def _numbers(words: list[str], count: int, where: str) -> list[float]:
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        raise InputError(f"{where}: a value is not a number") from None
    if len(numbers) != count or not all(math.isfinite(one) and abs(one) < 1e6 for one in numbers):
        raise InputError(f"{where}: there are {len(numbers)} numbers, expected {count} finite ones below 1e6")
    return numbers


def _world(joints: list[_Joint], values: Floats, rate: float) -> Bvh:
    """Return rotations and positions of all joints in the world of the file."""
    frames = len(values)
    rotation, position = np.empty((frames, len(joints), 3, 3)), np.empty((frames, len(joints), 3))
    column = 0
    for k, joint in enumerate(joints):
        turn, shift = np.tile(np.eye(3), (frames, 1, 1)), np.tile(joint.offset, (frames, 1))
        for channel in joint.channels:
            axis, kind = CHANNELS[channel]
            if kind == "position":
                shift[:, axis] = values[:, column]
            else:
                turn = turn @ _turns(axis, np.radians(values[:, column]))
            column += 1
        if joint.parent < 0:
            rotation[:, k], position[:, k] = turn, shift
        else:
            rotation[:, k] = rotation[:, joint.parent] @ turn
            position[:, k] = position[:, joint.parent] + np.einsum("tij,tj->ti", rotation[:, joint.parent], shift)
    names = tuple(joint.name if not joint.end else f"{joints[joint.parent].name} end" for joint in joints)
    offset = np.array([joint.offset for joint in joints])
    return Bvh(names, tuple(joint.parent for joint in joints), offset, rotation, position, rate)


def _turns(axis: int, angle: Floats) -> Floats:
    """Return rotations ``[T, 3, 3]`` about an axis of the file by angles [rad]."""
    turns = np.tile(np.eye(3), (len(angle), 1, 1))
    a, b = (axis + 1) % 3, (axis + 2) % 3
    turns[:, a, a] = turns[:, b, b] = np.cos(angle)
    turns[:, b, a], turns[:, a, b] = np.sin(angle), -np.sin(angle)
    return turns


WALKING = 0.3
"""Speed [leg lengths per s] from which on a motion is a gait."""
RATE = 60.0
SIDED = {
    "clavicle": ("shoulder", "collar", "clavicle"),
    "upperarm": ("arm", "upperarm", "uparm"),
    "lowerarm": ("forearm", "lowarm", "lowerarm", "elbow"),
    "hand": ("hand", "wrist"),
    "thigh": ("upleg", "thigh", "hip", "upperleg"),
    "calf": ("leg", "calf", "knee", "lowleg", "lowerleg", "shin"),
    "foot": ("foot", "ankle"),
    "ball": ("toebase", "toe", "toe0", "ball"),
}
MIDDLE = {
    "pelvis": ("hips", "pelvis", "root", "hip"),
    "spine_01": ("spine", "lowerback", "chest", "spine01", "abdomen"),
    "spine_02": ("spine1", "chest2", "spine02"),
    "spine_03": ("spine2", "chest3", "spine03", "chest4", "upperchest"),
    "neck_01": ("neck", "neck1", "neck01"),
    "head": ("head",),
}
NEEDED = (
    "pelvis",
    "head",
    *(f"{bone}_{s}" for bone in ("upperarm", "lowerarm", "thigh", "calf", "foot") for s in "lr"),
)
CHILD = {"thigh": "calf", "calf": "foot", "upperarm": "lowerarm", "lowerarm": "hand"}
"""Bones whose direction at rest differs between skeletons, and where they end."""


def map_bones(names: tuple[str, ...]) -> dict[str, int]:
    """Return the joint of each bone of crowdbot, for the names of Mixamo, CMU, Rocketbox and others.

    >>> found = map_bones(("mixamorig:Hips", "mixamorig:LeftArm", "mixamorig:LeftShoulder", "Bip01 R Calf"))
    >>> found["pelvis"], found["upperarm_l"], found["clavicle_l"], found["calf_r"]
    (0, 1, 2, 3)
    """
    plain: dict[str, int] = {}
    for k, name in enumerate(names):
        word = re.sub(r"^(mixamorig\d*|bip\d{2,3})", "", name.lower().split(":")[-1])
        word = word.replace("_", " ").strip()
        for side, marks in (("l", ("left", "l ")), ("r", ("right", "r "))):
            mark = next((mark for mark in marks if word.startswith(mark)), "")
            if mark:
                word = f"{side}|{word.removeprefix(mark)}"
                break
        plain.setdefault(word.replace(" ", ""), k)
    result = {}
    for bone, words in MIDDLE.items():
        joint = next((plain[word] for word in words if word in plain), None)
        if joint is not None:
            result[bone] = joint
    for s in "lr":
        elbows = f"{s}|elbow" in plain  # there, the shoulder is the joint of the upper arm
        for bone, words in SIDED.items():
            known = ("shoulder", *words) if elbows and bone == "upperarm" else words
            known = tuple(w for w in known if w != "shoulder") if elbows and bone == "clavicle" else known
            joint = next((plain[f"{s}|{word}"] for word in known if f"{s}|{word}" in plain), None)
            if joint is not None:
                result[f"{bone}_{s}"] = joint
    return result


def clip_of(motion: Bvh, name: str) -> Clip:
    """Return a motion as a clip; of a gait, one cycle from the landing of the left foot on.

    Args:
        motion: the motion.
        name: name of the clip.

    Raises:
        InputError: a bone is missing, the skeleton has no height, or a gait has no whole cycle.
    """
    joint = map_bones(motion.names)
    missing = [bone for bone in NEEDED if bone not in joint]
    if missing:
        raise InputError(
            f"{name} has no joint for {', '.join(missing)}; its joints are {', '.join(motion.names)[:300]}"
        )
    axes = _axes(motion, joint)
    rotation = axes @ motion.rotation @ axes.T
    position = motion.position @ axes.T
    leg = _leg(motion, joint)
    feet = position[:, [joint["foot_l"], joint["foot_r"]]]
    root = position[:, joint["pelvis"]]
    way = root[-1, :2] - root[0, :2]
    cyclic = float(np.hypot(*way)) * motion.rate / len(root) > WALKING * leg
    ahead = way / np.hypot(*way) if cyclic else _facing(rotation[:, joint["pelvis"]])
    cos, sin = float(ahead[0]), float(ahead[1])
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    rows = _cycle((feet[:, 0, :2] - root[:, :2]) @ ahead, motion.rate, name) if cyclic else slice(0, len(root))
    step = max(1, round(motion.rate / RATE), math.ceil(len(root[rows]) / MOST_FRAMES))
    turns = np.stack(
        [turn @ rotation[rows, k] @ _aligned(bone, motion, joint, axes) for bone, k in joint.items()], axis=1
    )
    low = np.min(feet[rows, :, 2], axis=1) - np.min(feet[..., 2])
    lift = np.where(low > 0.04 * leg, low - 0.04 * leg, 0.0) / leg
    return Clip(
        name, motion.rate / step, cyclic, tuple(joint), _quaternions(turns[::step]), np.clip(lift[::step], 0.0, 2.0)
    )


def _axes(motion: Bvh, joint: dict[str, int]) -> Floats:
    """Return the rotation from the axes of the file to x forward, y left, z up, from the hips and the head at rest."""
    rest = np.zeros_like(motion.offset)
    for k, parent in enumerate(motion.parents):
        rest[k] = motion.offset[k] + (rest[parent] if parent >= 0 else 0.0)
    left = rest[joint["thigh_l"]] - rest[joint["thigh_r"]]
    up = rest[joint["head"]] - 0.5 * (rest[joint["foot_l"]] + rest[joint["foot_r"]])
    axis = np.zeros(3)
    axis[int(np.argmax(np.abs(up)))] = np.sign(up[int(np.argmax(np.abs(up)))])
    left = left - axis * float(left @ axis)
    size = float(np.linalg.norm(left))
    if size < 1e-6 or float(np.linalg.norm(up)) < 1e-6:
        raise InputError("the skeleton at rest has no width between the hips or no height")
    left = left / size
    return np.array([np.cross(left, axis), left, axis])


def _leg(motion: Bvh, joint: dict[str, int]) -> float:
    """Return the length of a leg in the unit of the file."""
    middle = motion.position[0]
    thigh = middle[joint["calf_l"]] - middle[joint["thigh_l"]]
    shank = middle[joint["foot_l"]] - middle[joint["calf_l"]]
    return max(1e-9, float(np.linalg.norm(thigh) + np.linalg.norm(shank)))


def _facing(pelvis: Floats) -> Floats:
    """Return the mean direction ``[2]`` of the x axis of the pelvis ``[T, 3, 3]``."""
    mean = pelvis[:, :2, 0].mean(axis=0)
    size = float(np.hypot(*mean))
    return np.asarray(mean / size if size > 1e-6 else np.array([1.0, 0.0]))


def _cycle(foot: Floats, rate: float, name: str) -> slice:
    """Return the frames of the middle cycle between two landings of a foot, where it is farthest ahead."""
    wide = max(2, int(0.25 * rate))
    tops = [
        k for k in range(1, len(foot) - 1)
        if foot[k] == foot[max(0, k - wide) : k + wide + 1].max() and foot[k] > 0.5 * foot.max()
    ]  # fmt: skip
    pairs = [(a, b) for a, b in itertools.pairwise(tops) if 0.4 * rate < b - a < 2.5 * rate]
    if not pairs:
        raise InputError(f"{name} has no whole cycle of a gait: the left foot must land at least twice")
    first, last = pairs[len(pairs) // 2]
    return slice(first, last)


def _aligned(bone: str, motion: Bvh, joint: dict[str, int], axes: Floats) -> Floats:
    """Return the rotation from the direction of a bone at rest to that of its joint at rest."""
    stem, _, side = bone.rpartition("_")
    end = CHILD.get(stem)
    if side not in ("l", "r") or end is None or f"{end}_{side}" not in joint:
        return np.eye(3)
    k, away, child = joint[bone], np.zeros(3), joint[f"{end}_{side}"]
    while child != k and child >= 0:
        away, child = away + motion.offset[child], motion.parents[child]
    every = shapes()
    own = every.head[-1, every.bone(f"{end}_{side}")] - every.head[-1, every.bone(bone)]
    a, b = own / np.linalg.norm(own), axes @ away
    b = b / max(float(np.linalg.norm(b)), 1e-9)
    v, c = np.cross(a, b), float(a @ b)
    cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / max(1.0 + c, 1e-6))


def _quaternions(turns: Floats) -> Floats:
    """Return quaternions ``[..., 4]`` w, x, y, z of rotation matrices."""
    from scipy.spatial.transform import Rotation

    found = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_quat()[:, [3, 0, 1, 2]]
    found = np.where(found[:, :1] < 0.0, -found, found)
    return np.asarray(found.reshape(*turns.shape[:-2], 4))
