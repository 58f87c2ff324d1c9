"""PoseSource: the pose of a person over time, from a function, a recording or a stream."""

from __future__ import annotations

import dataclasses
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError, storable
from crowdbot.typing import Floats

from .body_pose import PARTS, ROW, BodyPose, blend_rows, shift_row

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
        for one in (here, there):
            if not isinstance(one, BodyPose):
                raise InputError(f"{type(self).__name__}.at returned a {type(one).__name__}; it must return a BodyPose")
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
        """Return the pose at a time [s]."""
        return BodyPose.of_row(self.motion(time).row)

    def motion(self, time: float) -> PoseMotion:
        """Return pose and velocity at a time [s]."""
        k = int(np.searchsorted(self.time, time + EARLY, side="right")) - 1
        found = self._whole(time, k)
        if self.part_timeout <= 0.0 or k < 0:
            return found
        return found._replace(row=self._with_parts(found.row, time, k))

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
            row = shift_row(self.rows[k], *(min(late, self.extrapolation) * one for one in (vx, vy)))
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
