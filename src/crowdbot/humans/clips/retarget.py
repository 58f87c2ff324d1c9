"""Retargeting: motion capture on the bones of crowdbot, as a clip."""

from __future__ import annotations

import itertools
import math
import re

import numpy as np

from crowdbot.core import InputError
from crowdbot.humans.asset import shapes
from crowdbot.typing import Floats

from .bvh import Bvh
from .clip import MOST_FRAMES, Clip

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
    found = {}
    for bone, words in MIDDLE.items():
        joint = next((plain[word] for word in words if word in plain), None)
        if joint is not None:
            found[bone] = joint
    for s in "lr":
        elbows = f"{s}|elbow" in plain  # there, the shoulder is the joint of the upper arm
        for bone, words in SIDED.items():
            known = ("shoulder", *words) if elbows and bone == "upperarm" else words
            known = tuple(w for w in known if w != "shoulder") if elbows and bone == "clavicle" else known
            joint = next((plain[f"{s}|{word}"] for word in known if f"{s}|{word}" in plain), None)
            if joint is not None:
                found[f"{bone}_{s}"] = joint
    return found


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
