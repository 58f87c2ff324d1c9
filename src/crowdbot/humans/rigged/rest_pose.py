"""A character in the rest pose and the axes of the included bodies, so that gait, clips and falls fit it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.humans.asset import shapes
from crowdbot.typing import Floats

from .character import Character

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
    a, b = (one / max(float(np.linalg.norm(one)), 1e-9) for one in (first, second))
    v, c = np.cross(a, b), float(a @ b)
    cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / max(1.0 + c, 1e-6))
