"""BVH files: a hierarchy of joints and one row of channels for each frame."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .motion_recording import MOST_FRAMES, MotionRecording, RecordedSubject
from .pose_stream import MotionSample
from .source_skeleton import MOST_JOINTS, SourceSkeleton, body_axes

LEG = 0.85
UNITS = (1.0, 0.01, 0.001, 0.056444)
"""Metres in one unit of length: m, cm, mm, and that of the CMU library (1/0.45 inch). A BVH file does not name it."""
CHANNELS = {f"{axis}{kind}": (kind, "XYZ".index(axis)) for axis in "XYZ" for kind in ("position", "rotation")}


@dataclass
class _Joint:
    name: str
    parent: int
    offset: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    channels: list[tuple[str, int]] = field(default_factory=list)


class _Words:
    """The words of a file with their lines."""

    def __init__(self, text: str, name: str) -> None:
        self.name = name
        lines = text.replace("{", " { ").replace("}", " } ").splitlines()
        self.words = [(word, k) for k, line in enumerate(lines, 1) for word in line.split()]
        self.place = 0

    def next(self, expected: str = "") -> str:
        if self.place >= len(self.words):
            raise InputError(f"{self.name} ends where {expected or 'a word'} is expected")
        word = self.words[self.place][0]
        if expected and word.upper() != expected.upper():
            raise self.error(f"{word[:40]!r} stands where {expected} is expected")
        self.place += 1
        return word

    def number(self) -> float:
        word = self.next("")
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or abs(value) > 1e6:
            self.place -= 1
            raise self.error(f"{word[:40]!r} must be a finite number")
        return value

    def error(self, sentence: str) -> InputError:
        line = self.words[min(self.place, len(self.words) - 1)][1] if self.words else 1
        return InputError(f"{self.name}:{line}: {sentence}")


def read_bvh(data: bytes, name: str, begin: float = 0.0) -> MotionRecording:
    """Return the person in a BVH file.

    The axes are found from the rest pose (all rotations 0), which must stand upright: hips beside each other, the head
    above. The unit of length is m, cm, mm or that of the CMU library, whichever gives legs closest to 0.85 m.

    Args:
        data: content of the file.
        name: name of the file for messages.
        begin: time in the file at which the trial begins [s].

    Raises:
        InputError: the file is not valid; the message names the line.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{name} is not UTF-8 text") from None
    head, mark, motion = text.partition("MOTION")
    if not mark:
        raise InputError(f"{name} has no MOTION section")
    joints = _read_hierarchy(_Words(head, name))
    rows, period = _read_motion(motion, head.count("\n") + 1, sum(len(one.channels) for one in joints), name)
    return _recording(joints, rows, period, name, begin)


def _read_hierarchy(words: _Words) -> list[_Joint]:
    words.next("HIERARCHY")
    words.next("ROOT")
    joints: list[_Joint] = []
    open_joints = [_begin_joint(words, joints, words.next(), -1)]
    while open_joints:
        word = words.next().upper()
        joint = joints[open_joints[-1]]
        if word == "}":
            open_joints.pop()
        elif word == "OFFSET":
            joint.offset = [words.number() for _ in range(3)]
        elif word == "CHANNELS":
            joint.channels = [_channel(words) for _ in range(_channel_count(words))]
        elif word == "JOINT":
            open_joints.append(_begin_joint(words, joints, words.next(), open_joints[-1]))
        elif word == "END":
            words.next("Site")
            open_joints.append(_begin_joint(words, joints, f"{joint.name}End", open_joints[-1]))
        else:
            words.place -= 1
            raise words.error(f"{word[:40]!r} is unknown; known are OFFSET, CHANNELS, JOINT, End Site and }}")
    if words.place < len(words.words):
        raise words.error("only one ROOT is supported")
    return joints


def _begin_joint(words: _Words, joints: list[_Joint], name: str, parent: int) -> int:
    if len(joints) >= MOST_JOINTS:
        raise words.error(f"there are more than {MOST_JOINTS} joints")
    words.next("{")
    joints.append(_Joint(name, parent))
    return len(joints) - 1


def _channel_count(words: _Words) -> int:
    count = words.number()
    if count not in (0, 1, 2, 3, 4, 5, 6):
        raise words.error(f"a joint has {count:g} channels; at most 6 are possible")
    return int(count)


def _channel(words: _Words) -> tuple[str, int]:
    word = words.next()
    if word not in CHANNELS:
        words.place -= 1
        raise words.error(f"channel {word[:40]!r} is unknown; known are {', '.join(CHANNELS)}")
    return CHANNELS[word]


def _read_motion(text: str, first: int, width: int, name: str) -> tuple[Floats, float]:
    """Return the channels of all frames ``[T, C]`` and the time between two [s]."""
    lines = [(k, line.split()) for k, line in enumerate(text.splitlines(), first) if line.strip()]
    if len(lines) < 2 or lines[0][1][0] != "Frames:" or lines[1][1][:2] != ["Frame", "Time:"]:
        raise InputError(f"{name}:{first}: MOTION must begin with Frames: and Frame Time:")
    try:
        count, period = int(lines[0][1][1]), float(lines[1][1][2])
    except (ValueError, IndexError):
        raise InputError(f"{name}:{lines[0][0]}: Frames: and Frame Time: must be numbers") from None
    if not 1 <= count <= MOST_FRAMES or not 1e-5 <= period <= 10.0:
        raise InputError(f"{name}:{lines[0][0]}: {count} frames every {period:g} s are out of range")
    if len(lines) - 2 != count:
        raise InputError(f"{name} has {len(lines) - 2} frames instead of {count}")
    rows = np.empty((count, width))
    for k, (line, words) in enumerate(lines[2:]):
        if len(words) != width:
            raise InputError(f"{name}:{line}: a frame has {len(words)} numbers instead of {width}")
        try:
            rows[k] = [float(word) for word in words]
        except ValueError:
            rows[k] = math.nan
        if not np.all(np.abs(rows[k]) <= 1e6):
            raise InputError(f"{name}:{line}: a value of a frame must be a finite number")
    return rows, period


def _recording(joints: list[_Joint], rows: Floats, period: float, name: str, begin: float) -> MotionRecording:
    rest = np.zeros((len(joints), 3))
    for k, joint in enumerate(joints):
        rest[k] = joint.offset if joint.parent < 0 else rest[joint.parent] + joint.offset
    rest -= rest[0]
    names, parents = tuple(one.name for one in joints), tuple(one.parent for one in joints)
    try:
        axes = body_axes(names, parents, rest)
        upright = rest @ axes.T
        legs = SourceSkeleton(names, parents, upright * (1.9 / float(np.linalg.norm(np.ptp(rest, axis=0)))))
        length = legs.leg_length("l") / 1.9 * float(np.linalg.norm(np.ptp(rest, axis=0)))
        unit = min(UNITS, key=lambda one: abs(math.log(one * length / LEG)))
        feet = upright[[legs.roles["foot_l"], legs.roles["foot_r"]], 2].mean()
        upright = upright * unit
        upright[:, 2] -= min(float(upright[:, 2].min()), feet * unit - 0.03)
        skeleton = SourceSkeleton(names, parents, upright)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None

    def sample(k: int) -> MotionSample:
        position, rotation = _pose(joints, rows[k])
        turned = axes @ rotation @ axes.T
        return MotionSample(k, k * period, position @ axes.T * unit, turned, skeleton)

    subject = RecordedSubject(np.arange(len(rows), dtype=np.float64) * np.float64(period), sample)
    return MotionRecording({joints[0].name: subject}, begin)


def _pose(joints: list[_Joint], row: Floats) -> tuple[Floats, Floats]:
    """Return positions and rotations of all joints in the axes and unit of the file, by forward kinematics."""
    position, rotation = np.empty((len(joints), 3)), np.empty((len(joints), 3, 3))
    column = 0
    for k, joint in enumerate(joints):
        own, shift = np.eye(3), np.array(joint.offset)
        for kind, axis in joint.channels:
            value = float(row[column])
            column += 1
            if kind == "position":
                shift[axis] = value
            else:
                own = own @ _turn(axis, math.radians(value))
        if joint.parent < 0:
            position[k], rotation[k] = shift, own
        else:
            above = rotation[joint.parent]
            position[k], rotation[k] = position[joint.parent] + above @ shift, above @ own
    return position, rotation


def _turn(axis: int, angle: float) -> Floats:
    i, j = (axis + 1) % 3, (axis + 2) % 3
    found = np.eye(3)
    found[i, i] = found[j, j] = math.cos(angle)
    found[i, j], found[j, i] = -math.sin(angle), math.sin(angle)
    return found
