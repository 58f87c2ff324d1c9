"""Samples of a headset, and their recording."""

from __future__ import annotations

import dataclasses
import json
import struct
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError
from crowdbot.typing import Floats
from crowdbot.web import StateFrame

from .rigid_transform import matrices, quaternion_blend, unit_quaternions

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
    wrist = _pose(pose[:3], own)
    wrist[:3] -= PALM * own[:, 0]
    return wrist


MAGIC = b"CBHR1\n"
ENTRY = struct.Struct("<BdI")
"""Kind, time of the server [s] and number of bytes of an entry."""
MESSAGE, NOTE = 0, 1
LARGEST = 1 << 20


class HeadsetRecord(NamedTuple):
    """An entry of a recording.

    Fields:
        time: time of the server [s].
        sample: message of the headset, or None.
        note: what else was recorded, such as ``{"pose": {...}}`` of a step, or None.
    """

    time: float
    sample: HeadsetSample | None
    note: dict[str, Any] | None


class HeadsetClock(NamedTuple):
    """Estimated relations of the clocks of a recording, about once a second.

    Fields:
        server: ``[T]`` monotonic clock of the server [s], as in :class:`crowdbot.experiments.TrialClock`.
        offset: ``[T]`` server minus headset [s].
        round_trip: ``[T]`` round trip of the exchange that counts [s]; the offset is wrong by at most half of it.
        utc: ``[T]`` seconds since 1970.
    """

    server: Floats
    offset: Floats
    round_trip: Floats
    utc: Floats

    def to_server(self, time: ArrayLike) -> Floats:
        """Return times of the headset in the clock of the server [s], with the offset interpolated between estimates.

        >>> clock = HeadsetClock(np.array([50.0, 60.0]), np.array([40.0, 40.1]), np.full(2, 0.004), np.zeros(2))
        >>> clock.to_server([10.0, 19.9]).round(3).tolist()
        [50.0, 60.0]
        """
        instants = np.asarray(time, dtype=np.float64)
        return np.asarray(instants + np.interp(instants, self.server - self.offset, self.offset))


class HeadsetRecorder:
    """Writes the messages of a headset as they come, so that a run that is killed loses at most the last one.

    Args:
        path: file to write; an existing one is replaced.

    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "one.headset"
    >>> with HeadsetRecorder(path) as recorder:
    ...     recorder.note(5.0, {"participant": "P01"})
    >>> [one.note for one in read_headset_recording(path)]
    [{'participant': 'P01'}]
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = path.open("wb", buffering=0)
        self._lock = threading.Lock()
        self._file.write(MAGIC)

    def __enter__(self) -> HeadsetRecorder:
        """Return the recorder."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the file."""
        self.close()

    def message(self, time: float, data: bytes) -> None:
        """Write a message of the headset that arrived at a time of the server [s]."""
        self._write(MESSAGE, time, data)

    def note(self, time: float, values: dict[str, Any]) -> None:
        """Write what happened at a time of the server [s], JSON."""
        self._write(NOTE, time, json.dumps(values, allow_nan=False).encode())

    def close(self) -> None:
        """Close the file; more entries are left out."""
        with self._lock:
            self._file.close()

    def _write(self, kind: int, time: float, data: bytes) -> None:
        with self._lock:
            if not self._file.closed:
                self._file.write(ENTRY.pack(kind, time, len(data)) + data)


def read_headset_recording(path: Path | str) -> Iterator[HeadsetRecord]:
    """Yield the entries of a recording in their order; a last one that is not whole is left out.

    Raises:
        InputError: the file is no recording of a headset, or an entry is damaged.
    """
    with Path(path).open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise InputError(f"{path}: not a recording of a headset")
        while len(head := file.read(ENTRY.size)) == ENTRY.size:
            kind, time, size = ENTRY.unpack(head)
            if kind not in (MESSAGE, NOTE) or size > LARGEST:
                raise InputError(f"{path}: an entry is damaged before byte {file.tell()}")
            data = file.read(size)
            if len(data) < size:
                return
            if kind == MESSAGE:
                yield HeadsetRecord(time, HeadsetSample.of_frame(StateFrame.decode(data)), None)
            else:
                yield HeadsetRecord(time, None, json.loads(data))


def read_headset_clock(path: Path | str) -> HeadsetClock:
    """Return the clocks of a recording.

    Raises:
        InputError: the file is no recording of a headset, an entry is damaged, or no clock was estimated.
    """
    notes = [
        (item.time, item.note["clock"]) for item in read_headset_recording(path) if item.note and "clock" in item.note
    ]
    if not notes:
        raise InputError(f"{path}: the clocks were not compared; a recording needs two messages of the headset")
    rows = [(time, note["offset"], note["round_trip"], note["utc"]) for time, note in notes]
    return HeadsetClock(*np.array(rows, dtype=np.float64).T)
