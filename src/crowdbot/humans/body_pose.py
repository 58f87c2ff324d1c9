"""BodyPose: where a person is, and where head and hands are; poses from programs and files."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import InputError, storable
from crowdbot.typing import Floats

from .vectors import slerp

SKELETON = 3 + 28 * 4
PARTS = {"head": (3, 10), "left_hand": (10, 17), "right_hand": (17, 24), "skeleton": (24, 24 + SKELETON)}
"""Columns of each part in a row."""
ROW = 24 + SKELETON
"""Length of a row: x, y, heading, head, left hand, right hand, skeleton; NaN for a part that is not given."""
FARTHEST = 1e6
"""Largest coordinate [m]."""
REACH = 3.0
"""Largest horizontal distance [m] of head, hands and pelvis from x, y."""
LOWEST, HIGHEST = -1.0, 4.0
"""Heights [m] of head, hands and pelvis."""
_SEVEN = "x, y, z [m] and a quaternion w, x, y, z"


@storable
@dataclass(frozen=True)
class BodyPose:
    """The pose of a person at one instant, in the world frame (x forward, y left, z up).

    Fields:
        x, y: position on the floor [m].
        heading: direction of the trunk, counter-clockwise from +x [rad].
        head: pose of the middle between the eyes: x, y, z [m] and a quaternion w, x, y, z; x looks ahead. None: the
            head moves with the gait.
        left_hand, right_hand: pose of the wrist in the same form. x points along the hand to the fingers, z out of the
            back of the hand: a hand that reaches ahead with the palm down has the axes of the person.
        skeleton: position of the pelvis joint x, y, z [m], then a quaternion w, x, y, z of each of the 28 bones
            relative to its parent, in the order of the asset; the pelvis relative to ``heading``. No rotation is the
            rest shape. It replaces head and hands.

    Raises:
        InputError: a value is not finite or out of range, or a part has the wrong number of values.

    >>> BodyPose(1.0, 2.0, 0.0, right_hand=(1.1, 1.7, 1.9, 1, 0, 0, 0)).head is None
    True
    """

    x: float
    y: float
    heading: float = 0.0
    head: tuple[float, ...] | None = None
    left_hand: tuple[float, ...] | None = None
    right_hand: tuple[float, ...] | None = None
    skeleton: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        for name in ("x", "y", "heading"):
            value = getattr(self, name)
            if not _is_number(value) or not abs(value) <= FARTHEST:
                raise InputError(f"BodyPose: {name} = {value!r} must be a finite number, at most {FARTHEST:g}")
            object.__setattr__(self, name, float(value))
        for name, (first, last) in PARTS.items():
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, self._part(name, value, last - first))

    def _part(self, name: str, value: Any, count: int) -> tuple[float, ...]:
        what = _SEVEN if count == 7 else "3 numbers of the pelvis and a quaternion for each of 28 bones"
        if not isinstance(value, list | tuple | np.ndarray) or len(value) != count:
            raise InputError(f"BodyPose: {name} must be {count} numbers: {what}")
        if not all(_is_number(item) for item in value):
            raise InputError(f"BodyPose: {name} has a value that is not a finite number; it must be {what}")
        numbers = tuple(float(item) for item in value)
        x, y, z = numbers[:3]
        if math.hypot(x - self.x, y - self.y) > REACH or not LOWEST <= z <= HIGHEST:
            raise InputError(
                f"BodyPose: {name} at {x:g}, {y:g}, {z:g} m must be at most {REACH:g} m from x, y and {LOWEST:g} to"
                f" {HIGHEST:g} m high"
            )
        for k in range(3, count, 4):
            if not 1e-3 <= math.hypot(*numbers[k : k + 4]) <= 1e3:
                raise InputError(f"BodyPose: {name} has a quaternion {list(numbers[k : k + 4])} that is no rotation")
        return numbers

    def row(self) -> Floats:
        """Return the pose as ``[139]`` numbers, NaN for parts that are not given."""
        result = np.full(ROW, np.nan)
        result[:3] = self.x, self.y, self.heading
        for name, (first, last) in PARTS.items():
            value = getattr(self, name)
            if value is not None:
                result[first:last] = value
        return result

    @classmethod
    def of_row(cls, row: Floats) -> BodyPose:
        """Return the pose of a row."""
        parts = {
            name: None if np.isnan(row[first]) else tuple(row[first:last].tolist())
            for name, (first, last) in PARTS.items()
        }
        x, y, heading = row[:3].tolist()
        return cls(x, y, heading, **parts)


def _is_number(value: Any) -> bool:
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.floating | np.integer):
        return False
    return bool(-1e300 <= value <= 1e300)


def shift_row(row: Floats, dx: float, dy: float) -> Floats:
    """Return the row of the same pose moved by dx, dy [m]."""
    result = row.copy()
    for column in (0, 3, 10, 17, 24):
        result[column] += dx
        result[column + 1] += dy
    return result


def blend_rows(a: Floats, b: Floats, share: float) -> Floats:
    """Return the row between two rows: positions linearly, rotations by :func:`slerp`, headings on the shorter arc.

    A part that ``b`` lacks moves with the person; one that ``a`` lacks is not there.

    >>> blend_rows(BodyPose(0, 0, 3.0).row(), BodyPose(2, 4, -3.0).row(), 0.5)[:3].round(6).tolist()
    [1.0, 2.0, 3.141593]
    """
    result = shift_row(a, share * (b[0] - a[0]), share * (b[1] - a[1]))
    turn = b[2] - a[2]
    result[2] = a[2] + share * (turn - 2.0 * math.pi * math.floor((turn + math.pi) / (2.0 * math.pi)))
    for first, last in PARTS.values():
        if np.isnan(a[first]) or np.isnan(b[first]):
            continue
        place = slice(first, first + 3)
        result[place] = a[place] + share * (b[place] - a[place])
        turns = slice(first + 3, last)
        result[turns] = slerp(a[turns].reshape(-1, 4), b[turns].reshape(-1, 4), share).ravel()
    return result


MAX_SPEED = 8.0
"""Default speed [m/s] above which a change of position is a teleport."""
EARLY = 1e-6
"""Tolerance [s] of time stamps: the time of a tick is rounded to nanoseconds."""
SPAN = 0.02
"""Time [s] over which the velocity of a function is measured."""


class PoseMotion(NamedTuple):
    """Pose and velocity of a person: ``row [139]``, see :meth:`BodyPose.row`, and ``vx``, ``vy`` [m/s]."""

    row: Floats
    vx: float
    vy: float


class PoseSource(ABC):
    """Where a person is over time. Implementations are frozen dataclasses: the same time gives the same pose.

    >>> class Circle(PoseSource):
    ...     def at(self, time):
    ...         return BodyPose(math.cos(time), math.sin(time), time + 0.5 * math.pi)
    >>> motion = Circle().motion(0.0)
    >>> round(motion.vx, 2), round(motion.vy, 2)
    (-0.01, 1.0)
    """

    @abstractmethod
    def at(self, time: float) -> BodyPose:
        """Return the pose at a time of the trial [s]."""

    def motion(self, time: float) -> PoseMotion:
        """Return pose and velocity at a time [s].

        The velocity is that over the next 0.02 s; a faster change than 8 m/s is a teleport without velocity.

        Raises:
            InputError: :meth:`at` returns something else than a pose.
        """
        here, there = self.at(time), self.at(time + SPAN)
        for item in (here, there):
            if not isinstance(item, BodyPose):
                raise InputError(
                    f"{type(self).__name__}.at returned a {type(item).__name__}; it must return a BodyPose"
                )
        vx, vy = (there.x - here.x) / SPAN, (there.y - here.y) / SPAN
        return PoseMotion(here.row(), vx, vy) if math.hypot(vx, vy) <= MAX_SPEED else PoseMotion(here.row(), 0.0, 0.0)


@storable
@dataclass(frozen=True, eq=False)
class PoseTrack(PoseSource):
    """Samples of a pose with time stamps, interpolated.

    Between two samples, positions change linearly and rotations by spherical interpolation. Before the first sample the
    person stands at ``start``. After the last one the person continues with the last velocity for ``extrapolation``
    seconds, and then stands. A change faster than ``max_speed`` is a teleport: the person stands at the first place
    until the time of the second.

    Fields:
        time: ascending time stamps ``[T]`` [s].
        rows: poses ``[T, 139]``, see :meth:`BodyPose.row`.
        start: pose before the first sample; None: the first sample.
        extrapolation: longest time [s] after the last sample with the last velocity.
        max_speed: speed [m/s] above which a change of position is a teleport.
        part_timeout: longest time [s] for which head, hands and skeleton keep their latest sample while other samples
            lack them: each part comes at its own rate. 0: a sample without a part ends it.
        turning: whether ``heading`` continues with its last rate, too, during the extrapolation, as that of a robot.

    Raises:
        InputError: shapes do not fit, times do not increase, or there is neither a sample nor a start.

    >>> track = PoseTrack.of([0.0, 1.0], [BodyPose(0, 0), BodyPose(2, 0)], extrapolation=0.5)
    >>> [track.at(time).x for time in (-1.0, 0.25, 1.0, 1.2, 9.0)]
    [0.0, 0.5, 2.0, 2.4, 3.0]
    >>> [track.motion(time).vx for time in (-1.0, 0.25, 1.2, 9.0)]
    [0.0, 2.0, 2.0, 0.0]
    """

    time: Floats
    rows: Floats
    start: BodyPose | None = None
    extrapolation: float = 0.0
    max_speed: float = MAX_SPEED
    part_timeout: float = 0.0
    turning: bool = False

    def __post_init__(self) -> None:
        if self.time.ndim != 1 or self.rows.shape != (len(self.time), ROW):
            raise InputError(f"PoseTrack: rows must have shape [T, {ROW}] for times [T]")
        if not np.all(np.isfinite(self.time)) or not np.all(np.diff(self.time) > 0.0):
            raise InputError("PoseTrack: times must be finite and increase")
        if not len(self.time) and self.start is None:
            raise InputError("PoseTrack: there is neither a sample nor a start")

    @classmethod
    def of(
        cls,
        time: Sequence[float],
        poses: Sequence[BodyPose],
        *,
        start: BodyPose | None = None,
        extrapolation: float = 0.0,
        max_speed: float = MAX_SPEED,
        part_timeout: float = 0.0,
    ) -> PoseTrack:
        """Return the track of poses with time stamps [s]."""
        rows = np.array([pose.row() for pose in poses], dtype=np.float64).reshape(-1, ROW)
        return cls(np.array(time, dtype=np.float64), rows, start, extrapolation, max_speed, part_timeout)

    def at(self, time: float) -> BodyPose:
        return BodyPose.of_row(self.motion(time).row)

    def motion(self, time: float) -> PoseMotion:
        k = int(np.searchsorted(self.time, time + EARLY, side="right")) - 1
        pose_motion = self._whole(time, k)
        if self.part_timeout <= 0.0 or k < 0:
            return pose_motion
        return pose_motion._replace(row=self._with_parts(pose_motion.row, time, k))

    def _with_parts(self, row: Floats, time: float, k: int) -> Floats:
        """Return the row with the parts that have samples of their own before sample k + 1, at a time [s]."""
        row = row.copy()
        for first, last in PARTS.values():
            given = np.flatnonzero(~np.isnan(self.rows[:, first]))
            number = int(np.searchsorted(given, k, side="right")) - 1
            if number < 0 or time - self.time[given[number]] > self.part_timeout + EARLY:
                continue
            j = int(given[number])
            part = shift_row(self.rows[j], *(row[:2] - self.rows[j, :2]))
            if number + 1 < len(given):
                i = int(given[number + 1])
                span = float(self.time[i] - self.time[j])
                if span <= self.part_timeout + EARLY:
                    part = blend_rows(self.rows[j], self.rows[i], max(0.0, (time - float(self.time[j])) / span))
            row[first:last] = part[first:last]
        return row

    def _whole(self, time: float, k: int) -> PoseMotion:
        """Return pose and velocity at a time [s] after sample k, in which a sample without a part ends it."""
        if k < 0:
            return PoseMotion(self.rows[0] if self.start is None else self.start.row(), 0.0, 0.0)
        if k + 1 == len(self.time):
            late = max(0.0, time - float(self.time[k]))
            vx, vy = self._velocity(k - 1) if k > 0 else (0.0, 0.0)
            row = shift_row(self.rows[k], *(min(late, self.extrapolation) * item for item in (vx, vy)))
            if self.turning and k > 0:
                turn = float(self.rows[k, 2] - self.rows[k - 1, 2])
                turn -= 2.0 * math.pi * math.floor((turn + math.pi) / (2.0 * math.pi))
                row[2] += min(late, self.extrapolation) * turn / float(self.time[k] - self.time[k - 1])
            return PoseMotion(row, vx, vy) if late < self.extrapolation - EARLY else PoseMotion(row, 0.0, 0.0)
        velocity = self._velocity(k)
        if velocity == (0.0, 0.0) and np.any(self.rows[k, :2] != self.rows[k + 1, :2]):
            return PoseMotion(self.rows[k], 0.0, 0.0)
        share = (time - self.time[k]) / (self.time[k + 1] - self.time[k])
        return PoseMotion(blend_rows(self.rows[k], self.rows[k + 1], max(0.0, float(share))), *velocity)

    def with_sample(self, time: float, pose: BodyPose, since: float = -math.inf) -> PoseTrack:
        """Return the track with one more sample, without samples that no time from ``since`` [s] on needs.

        A sample replaces an earlier one with the same time stamp, within 1 us. One before all that are needed is left
        out.
        """
        first = max(0, int(np.searchsorted(self.time, since, side="right")) - 2)
        if first > 0 and time < self.time[first]:
            return self
        k = int(np.searchsorted(self.time, time - EARLY))
        same = int(k < len(self.time) and self.time[k] <= time + EARLY)
        times = np.concatenate([self.time[first:k], [time], self.time[k + same :]])
        rows = np.concatenate([self.rows[first:k], pose.row()[None], self.rows[k + same :]])
        return dataclasses.replace(self, time=times, rows=rows)

    def _velocity(self, k: int) -> tuple[float, float]:
        """Return the velocity [m/s] between samples k and k + 1; 0 for a teleport."""
        step = (self.rows[k + 1, :2] - self.rows[k, :2]) / (self.time[k + 1] - self.time[k])
        vx, vy = step.tolist()
        return (vx, vy) if math.hypot(vx, vy) <= self.max_speed else (0.0, 0.0)


SEVEN = ("x", "y", "z", "qw", "qx", "qy", "qz")
HANDS = ("head", "left_hand", "right_hand")
COLUMNS = ("time", "x", "y", "heading", *(f"{part}_{name}" for part in HANDS for name in SEVEN))
"""Columns of a CSV file; only the first three are required."""
KEYS = ("time", "x", "y", "heading", *HANDS, "skeleton")
MOST_SAMPLES = 200_000


def read_pose_file(data: bytes, name: str, *, begin: float = 0.0, max_speed: float = MAX_SPEED) -> PoseTrack:
    r"""Return the poses of a file; ``time`` in it is in seconds and increases.

    A CSV file has a header with ``time``, ``x``, ``y`` and possibly ``heading`` and ``head_x`` to ``head_qz``,
    ``left_hand_x`` to ``left_hand_qz`` and ``right_hand_x`` to ``right_hand_qz``; a part whose cells are empty is not
    given. A file of JSON lines has one object per line, with the keys of :class:`BodyPose` and ``time``. Without
    ``heading``, a person looks along x.

    Args:
        data: content of the file.
        name: name of the file for messages; JSON lines end in ``.jsonl``, any other name is CSV.
        begin: time in the file at which the trial begins [s].
        max_speed: see :class:`PoseTrack`.

    Raises:
        InputError: the file is not valid; the message names the line.

    >>> track = read_pose_file(b"time,x,y,heading\n0,0,0,0\n1,2,0,0\n", "walk.csv")
    >>> track.at(0.5).x
    1.0
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{name} is not UTF-8 text") from None
    rows = _json_rows(text, name) if name.lower().endswith(".jsonl") else _csv_rows(text, name)
    times, poses = list[float](), list[Any]()
    for line, time, values in rows:
        if len(times) >= MOST_SAMPLES:
            raise InputError(f"{name} has more than {MOST_SAMPLES} samples")
        if isinstance(time, bool) or not isinstance(time, int | float) or not math.isfinite(time):
            raise InputError(f"{name}:{line}: time = {time!r} must be a finite number")
        if times and time <= times[-1] + begin:
            raise InputError(f"{name}:{line}: time {time:g} s must be later than in the line before")
        try:
            pose = BodyPose(**values)
        except (InputError, TypeError) as error:
            raise InputError(f"{name}:{line}: {str(error).removeprefix('BodyPose: ')}") from None
        times.append(float(time) - begin)
        poses.append(pose.row())
    if not times:
        raise InputError(f"{name} has no samples")
    return PoseTrack(np.array(times), np.array(poses).reshape(-1, ROW), max_speed=max_speed)


def _json_rows(text: str, name: str) -> Iterator[tuple[int, Any, dict[str, Any]]]:
    for line, part in enumerate(text.splitlines(), 1):
        if not part.strip():
            continue
        try:
            values = json.loads(part)
        except (ValueError, RecursionError) as error:
            raise InputError(f"{name}:{line}: this is not JSON: {error}") from None
        if not isinstance(values, dict):
            raise InputError(f"{name}:{line}: a line must be a JSON object with time, x and y")
        _check_names(values, KEYS, f"{name}:{line}")
        yield line, values.pop("time"), values


def _csv_rows(text: str, name: str) -> Iterator[tuple[int, Any, dict[str, Any]]]:
    try:
        rows = list(csv.reader(io.StringIO(text), strict=True))
    except csv.Error as error:
        raise InputError(f"{name} is not CSV: {error}") from None
    header = [cell.strip() for cell in rows[0]] if rows else []
    _check_names(header, COLUMNS, f"{name}:1")
    if len(set(header)) < len(header):
        raise InputError(f"{name}:1: a column has the same name as another")
    for part in HANDS:
        there = [f"{part}_{item}" in header for item in SEVEN]
        if any(there) and not all(there):
            raise InputError(f"{name}:1: {part} needs the columns {', '.join(f'{part}_{item}' for item in SEVEN)}")
    for line, cells in enumerate(rows[1:], 2):
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(header):
            raise InputError(f"{name}:{line}: there are {len(cells)} cells, expected {len(header)} as in the header")
        numbers = {key: _number(cell, f"{name}:{line}: {key}") for key, cell in zip(header, cells, strict=True)}
        values: dict[str, Any] = {key: numbers[key] for key in ("x", "y", "heading") if numbers.get(key) is not None}
        for part in HANDS:
            seven = [numbers.get(f"{part}_{item}") for item in SEVEN]
            if any(item is not None for item in seven):
                values[part] = tuple(seven)
        _check_names(values, ("x", "y", "heading", *HANDS), f"{name}:{line}", ("x", "y"))
        yield line, numbers["time"], values


def _check_names(found: Any, known: tuple[str, ...], where: str, need: tuple[str, ...] = ("time", "x", "y")) -> None:
    for key in found:
        if key not in known:
            raise InputError(f"{where}: {str(key)[:40]!r} is unknown; known are {', '.join(known)}")
    missing = [key for key in need if key not in found]
    if missing:
        raise InputError(f"{where}: {', '.join(missing)} is missing")


def _number(cell: str, where: str) -> float | None:
    if not cell.strip():
        return None
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{where} = {cell.strip()[:40]!r} must be a finite number")
    return value
