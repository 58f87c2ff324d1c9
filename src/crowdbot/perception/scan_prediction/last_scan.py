"""LastScan and MovedScan: the future looks like the last scan."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crowdbot.core import Pose, kernel
from crowdbot.sensors import Scan, cast_plane, planar_pose
from crowdbot.typing import Bools, Floats

from .scan_predictor import ScanForecast, ScanPredictor, continue_motion

GAP = 0.15
"""Neighbouring points closer than this [m], plus three beam widths, are on one surface."""


def scan_segments(scan: Scan) -> Floats:
    """Return the surfaces of a scan as segments ``[S, 4]`` in the world [m]."""
    return static_segments([scan], [np.zeros((0, 2))], 0.0)


def static_segments(scans: Sequence[Scan], people: Sequence[Floats], reach: float) -> Floats:
    """Return the surfaces of the last scan without people, and of earlier scans where people hide them now.

    Args:
        scans: scans of one environment, in the order of time.
        people: positions ``[N, 2]`` of people at the time of each scan [m].
        reach: points at most this far from a person [m] belong to the person.
    """
    now = planar_pose(scans[-1].pose)
    here, heading = np.ascontiguousarray(now.position[0]), float(now.heading[0])
    angles = scans[-1].angles
    step = float(angles[1] - angles[0]) if len(angles) > 1 else 2.0 * math.pi
    hidden = np.zeros(len(angles), dtype=np.bool_)
    segments, count = np.empty((4 * len(angles), 4)), 0
    for scan, persons in zip(reversed(scans), reversed(people), strict=True):
        pose, last = planar_pose(scan.pose), scan is scans[-1]
        ranges = np.ascontiguousarray(scan.ranges[0])
        points, moving = _end_points(ranges, scan.angles, pose.position[0], float(pose.heading[0]), persons, reach)
        if last:
            hidden[:] = moving
        count = _add_segments(
            ranges, points, moving, step, last, here, heading + angles[0], hidden, segments, count
        )  # fmt: skip
        if not hidden.any():
            break
    return segments[:count].copy()


@kernel
def _end_points(
    ranges: Floats, angles: Floats, origin: Floats, heading: float, people: Floats, reach: float
) -> tuple[Floats, Bools]:
    """Return the end points of the beams, and which of them belong to people."""
    points, moving = np.full((len(ranges), 2), np.nan), np.zeros(len(ranges), dtype=np.bool_)
    for k in range(len(ranges)):
        if 0.0 < ranges[k] < math.inf:
            points[k, 0] = origin[0] + ranges[k] * math.cos(heading + angles[k])
            points[k, 1] = origin[1] + ranges[k] * math.sin(heading + angles[k])
            for n in range(len(people)):
                if (people[n, 0] - points[k, 0]) ** 2 + (people[n, 1] - points[k, 1]) ** 2 <= reach * reach:
                    moving[k] = True
    return points, moving


@kernel
def _add_segments(
    ranges: Floats, points: Floats, moving: Bools, step: float, last: bool, here: Floats, first: float, hidden: Bools,
    segments: Floats, count: int,
) -> int:  # fmt: skip
    """Append the segments of a scan; of earlier scans those in beams that people hide now, each beam once."""
    beams, turn = len(ranges), 2.0 * math.pi
    circle = beams * step > turn - 0.5 * step
    filled = np.zeros(beams, dtype=np.bool_)
    for k in range(beams):
        if math.isnan(points[k, 0]) or moving[k]:
            continue
        beam = k
        if not last:
            beam = int(np.rint(((math.atan2(points[k, 1] - here[1], points[k, 0] - here[0]) - first) % turn) / step))
            beam = beam % round(turn / step)
            if beam >= len(hidden) or not hidden[beam]:
                continue
            filled[beam] = True
        if count >= len(segments):
            break
        after = (k + 1) % beams if circle else k + 1
        joined = after < beams and not moving[after] and ranges[after] < math.inf and ranges[after] > 0.0
        if joined:
            limit = GAP + 3.0 * step * min(ranges[k], ranges[after])
            x, y = points[after, 0] - points[k, 0], points[after, 1] - points[k, 1]
            joined = x * x + y * y <= limit * limit
        segments[count, 0], segments[count, 1] = points[k, 0], points[k, 1]
        if joined:
            segments[count, 2], segments[count, 3] = points[after, 0], points[after, 1]
        else:  # a lone point is as wide as its beam
            x, y = points[k, 0] - here[0], points[k, 1] - here[1]
            segments[count, 0], segments[count, 1] = points[k, 0] + 0.5 * step * y, points[k, 1] - 0.5 * step * x
            segments[count, 2], segments[count, 3] = points[k, 0] - 0.5 * step * y, points[k, 1] + 0.5 * step * x
        count += 1
    for beam in range(len(hidden)):
        hidden[beam] = hidden[beam] and not filled[beam]
    return count


MEMORY = 5
"""Number of scans that give the velocity of the sensor."""


@dataclass(frozen=True, kw_only=True)
class LastScan(ScanPredictor):
    """Every future scan has the ranges of the last one.

    The state is a tuple of the last scans.

    >>> LastScan().begin()
    ()
    """

    def begin(self) -> tuple[Scan, ...]:
        return ()

    def update(self, scan: Scan, state: tuple[Scan, ...]) -> tuple[Scan, ...]:
        return (*state, scan)[-MEMORY:]

    def forecast(
        self,
        state: tuple[Scan, ...],
        ahead: Floats,
        pose: Pose | None = None,
        samples: int = 1,
        rng: np.random.Generator | None = None,
    ) -> ScanForecast:
        there = continue_motion(state, ahead) if pose is None else pose
        ranges = np.where(state[-1].ranges[0] > 0.0, state[-1].ranges[0], np.inf)
        repeated = np.broadcast_to(ranges, (1, len(ahead), len(ranges))).copy()
        return ScanForecast(ahead, there, state[-1].angles, repeated, np.ones(1))


@dataclass(frozen=True, kw_only=True)
class MovedScan(LastScan):
    """The surfaces of the last scan, seen from the future poses of the sensor; nothing moves but the sensor.

    Fields:
        range_max: largest range [m]; farther surfaces give no return.
    """

    range_max: float = 30.0

    def forecast(
        self,
        state: tuple[Scan, ...],
        ahead: Floats,
        pose: Pose | None = None,
        samples: int = 1,
        rng: np.random.Generator | None = None,
    ) -> ScanForecast:
        there = continue_motion(state, ahead) if pose is None else pose
        nobody = np.zeros((len(ahead), 0, 2))
        angles = state[-1].angles
        ranges, _ = cast_plane(there, angles, nobody, nobody[..., 0], scan_segments(state[-1]), self.range_max)
        return ScanForecast(ahead, there, angles, ranges[None], np.ones(1))
