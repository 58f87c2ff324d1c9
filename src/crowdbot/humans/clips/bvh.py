"""Motion capture in BVH files: the hierarchy of joints and their rotations."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

MOST_JOINTS, MOST_FRAMES, MOST_CHARACTERS = 400, 20_000, 200_000_000
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
    if not 2 <= frames <= MOST_FRAMES or not 1e-3 <= period <= 1.0:
        raise InputError(f"{name}: {frames:g} frames of {period:g} s must be 2 to {MOST_FRAMES}, of 0.001 to 1 s")
    rows = [line for line in lines[first + 2 :] if line.strip()][: int(frames)]
    if len(rows) < frames:
        raise InputError(f"{name} has {len(rows)} frames, expected {frames:g}")
    found = [_numbers(row.split(), count, f"{name}: frame {k + 1}") for k, row in enumerate(rows)]
    return np.array(found), 1.0 / period


def _numbers(words: list[str], count: int, where: str) -> list[float]:
    try:
        found = [float(word) for word in words]
    except ValueError:
        raise InputError(f"{where}: a value is not a number") from None
    if len(found) != count or not all(math.isfinite(one) and abs(one) < 1e6 for one in found):
        raise InputError(f"{where}: there are {len(found)} numbers, expected {count} finite ones below 1e6")
    return found


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
    found = np.tile(np.eye(3), (len(angle), 1, 1))
    a, b = (axis + 1) % 3, (axis + 2) % 3
    found[:, a, a] = found[:, b, b] = np.cos(angle)
    found[:, b, a], found[:, a, b] = np.sin(angle), -np.sin(angle)
    return found
