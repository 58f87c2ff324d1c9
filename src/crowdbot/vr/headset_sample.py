"""HeadsetSample: poses of head and hands at one instant, as a WebXR browser sends them."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats
from crowdbot.web import StateFrame

from .rotation_matrices import matrices, quaternion_blend, unit_quaternions

CHANNEL = "headset"
AXES = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Rotation from the axes of WebXR (x right, y up, z backward) to those of the room (x forward, y left, z up)."""
PALM = 0.08
"""Distance [m] from the wrist to the middle of the palm, where WebXR has the pose of a controller."""
FARTHEST = 1e3
"""Largest coordinate [m]."""
PARTS = ("head", "left", "right")
VISIBLE, EMULATED, LEFT_HAND, RIGHT_HAND = 1, 2, 4, 8
"""Bits of ``flags``: the scene is shown; the position is guessed; the part is a tracked hand, not a controller."""


@dataclass(frozen=True, eq=False)
class HeadsetSample:
    """What a headset measured at one instant, in its room (x forward, y left, z up, floor at 0).

    Fields:
        time: time stamp in the clock of the headset [s].
        head: middle between the eyes: x, y, z [m] and a quaternion w, x, y, z; x looks ahead. None: tracking is lost.
        left, right: wrists in the form of :class:`crowdbot.humans.BodyPose`; None: not tracked.
        gaze: direction of the eyes in the frame of the head (x ahead, y left, z up), a unit vector; None: the headset
            does not measure it, or the eyes are closed.
        pressed: names of the hands whose trigger is pressed or whose fingers pinch.
        number: counts the messages of the headset.
        clock: ``t0, t1, t2, t3`` of the latest exchange of clocks, or None.
        pictures: ``[K, 2]`` pairs of the server's stamp of a state and the headset's time at which it was drawn.
        dropped: frames that were not drawn in time so far.
        visible: whether the scene is shown to the participant.

    >>> frame = StateFrame("headset", 2.0, {"head": np.array([0, 1.7, -1, 0, 0, 0, 1], dtype="f4")})
    >>> sample = HeadsetSample.of_frame(frame)
    >>> sample.head.round(3).tolist(), sample.left is None
    ([1.0, 0.0, 1.7, 1.0, 0.0, 0.0, 0.0], True)
    """

    time: float
    head: Floats | None
    left: Floats | None = None
    right: Floats | None = None
    gaze: Floats | None = None
    pressed: tuple[str, ...] = ()
    number: int = 0
    clock: tuple[float, float, float, float] | None = None
    pictures: Floats = dataclasses.field(default_factory=lambda: np.zeros((0, 2)))
    dropped: int = 0
    visible: bool = True

    @classmethod
    def of_frame(cls, frame: StateFrame) -> HeadsetSample:
        """Return the sample in a frame of the channel ``headset``.

        Raises:
            InputError: the frame has another channel, or an array has a wrong size or values.
        """
        if frame.channel != CHANNEL or not np.isfinite(frame.time):
            raise InputError(f"a message of a headset has the channel {frame.channel!r} and the time {frame.time}")
        flags = int(_numbers(frame, "flags", 1, np.array([VISIBLE]))[0])
        poses = {name: _numbers(frame, name, 7) for name in PARTS if name in frame.arrays}
        head = poses.get("head")
        parts: dict[str, Floats | None] = {"head": None, "left": None, "right": None}
        if head is not None and not flags & EMULATED:
            parts["head"] = _pose(head[:3], _turn(head) @ AXES.T)
        for name, bit in (("left", LEFT_HAND), ("right", RIGHT_HAND)):
            if name in poses:
                parts[name] = _wrist(poses[name], name, bool(flags & bit))
        press = int(_numbers(frame, "press", 1, np.zeros(1))[0])
        clock = _numbers(frame, "clock", 4) if "clock" in frame.arrays else None
        return cls(
            float(frame.time),
            **parts,
            gaze=None if parts["head"] is None or head is None else _gaze(frame, head),
            pressed=tuple(name for k, name in enumerate(("left", "right")) if press >> k & 1),
            number=frame.sequence,
            clock=None if clock is None else (float(clock[0]), float(clock[1]), float(clock[2]), float(clock[3])),
            pictures=_pairs(frame),
            dropped=int(_numbers(frame, "dropped", 1, np.zeros(1))[0]),
            visible=bool(flags & VISIBLE),
        )

    def blend(self, later: HeadsetSample, share: float) -> HeadsetSample:
        """Return the sample at a share between two; a part that one of them lacks is that of ``later``.

        The gaze is not blended, since eyes jump: it is the latest one.
        """
        parts: dict[str, Any] = {"gaze": later.gaze if share >= 1.0 else self.gaze}
        for name in PARTS:
            a, b = getattr(self, name), getattr(later, name)
            if a is not None and b is not None:
                turn = quaternion_blend(a[3:], b[3:], share)
                parts[name] = np.concatenate([a[:3] + share * (b[:3] - a[:3]), turn])
        time = self.time + share * (later.time - self.time)
        return dataclasses.replace(later, time=time, **parts)


def _numbers(frame: StateFrame, name: str, count: int, default: Any = None) -> Floats:
    found = frame.arrays.get(name, default)
    if found is None or found.shape != (count,) or not np.all(np.isfinite(found)):
        raise InputError(f"a message of a headset must have {count} finite numbers {name!r}")
    numbers = np.asarray(found, dtype=np.float64)
    if count == 7 and (np.abs(numbers[:3]).max() > FARTHEST or not 0.5 < np.linalg.norm(numbers[3:]) < 2.0):
        raise InputError(f"a message of a headset has {name!r} = {numbers.round(3).tolist()}, which is no pose")
    return numbers


def _gaze(frame: StateFrame, head: Floats) -> Floats | None:
    """Return the direction of the ray of the eyes, which is along -z of its pose, in the frame of the head."""
    if "gaze" not in frame.arrays:
        return None
    ahead = _turn(_numbers(frame, "gaze", 7)) @ AXES.T
    return np.asarray((_turn(head) @ AXES.T).T @ ahead[:, 0])


def _pairs(frame: StateFrame) -> Floats:
    found = frame.arrays.get("pictures")
    if found is None:
        return np.zeros((0, 2))
    if found.ndim != 2 or found.shape[1] != 2 or len(found) > 1000:
        raise InputError("a message of a headset must have pairs of numbers in 'pictures'")
    return np.asarray(found, dtype=np.float64)


def _turn(pose: Floats) -> Floats:
    """Return the rotation matrix, in the axes of the room, of a pose with a quaternion x, y, z, w."""
    x, y, z, w = pose[3:]
    return np.asarray(AXES @ matrices(np.array([w, x, y, z])))


def _pose(position: Floats, rotation: Floats) -> Floats:
    return np.concatenate([AXES @ position, unit_quaternions(rotation)])


def _wrist(pose: Floats, side: str, hand: bool) -> Floats:
    """Return the wrist: columns to the fingers, left, out of the back of the hand.

    The joint ``wrist`` of a tracked hand has -z to the fingers and y out of the back of the hand. The grip of a
    controller has -z to the thumb; x goes into the palm of the right hand and out of that of the left hand.
    """
    turn = _turn(pose)
    x, y, z = turn.T
    if hand:
        return _pose(pose[:3], np.stack([-z, -x, y], axis=1))
    own = np.stack([-y, -z, x] if side == "right" else [-y, z, -x], axis=1)
    found = _pose(pose[:3], own)
    found[:3] -= PALM * own[:, 0]
    return found
