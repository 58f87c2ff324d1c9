"""Statistics of scans: how many beams return from a person, by distance, and in how many pieces."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.sensors import PointCloud, Reading, Scan, planar_pose
from crowdbot.typing import Floats

BAND_LIMITS = (0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 15.0, 27.0)
"""Limits of the bands of distance [m]."""
REACH = 0.45
"""Returns at most this far from the centre of a person [m] are those of the person."""
BODY = 0.2
"""Radius [m] of the disc towards which beams must be free for a person who is not hidden."""
BEFORE = 0.6
"""Returns more than this before the centre of a person [m] hide the person."""
GAP = 0.1
"""Neighbouring returns of a person farther apart than this [m], plus two beam spacings, are in two clusters."""
LOW, HIGH = 0.1, 2.1
"""Heights above the floor between which points of a cloud are those of people [m]."""


class ReturnsOfPeople(NamedTuple):
    """Returns of the people in a band of distance; NaN without people.

    Fields:
        near, far: limits of the distance to the centre [m].
        people: number of people who are not hidden, over all scans.
        returns, low, high: mean of the returns of a person, and the quantiles of 10 and 90 %.
        unseen: share of people without a return.
        apart: share of the people with returns whose returns are two or more clusters; NaN for point clouds.
        width: median width of a cluster of at least 2 returns [m]; NaN for point clouds.
    """

    near: float
    far: float
    people: int
    returns: float
    low: float
    high: float
    unseen: float
    apart: float
    width: float


@dataclass
class _Band:
    counts: list[int] = field(default_factory=list)
    clusters: list[int] = field(default_factory=list)
    widths: list[float] = field(default_factory=list)

    def summary(self, near: float, far: float) -> ReturnsOfPeople:
        counts = np.array(self.counts, dtype=np.float64)
        if not len(counts):
            return ReturnsOfPeople(near, far, 0, *[math.nan] * 6)
        low, high = np.quantile(counts, (0.1, 0.9)).tolist()
        seen = np.array(self.clusters)
        apart = float((seen >= 2).mean()) if len(seen) else math.nan
        width = float(np.median(self.widths)) if self.widths else math.nan
        unseen = float((counts == 0).mean())
        return ReturnsOfPeople(near, far, len(counts), float(counts.mean()), low, high, unseen, apart, width)


def scan_statistics(rows: Iterable[tuple[Reading, Floats]]) -> tuple[list[ReturnsOfPeople], float]:
    """Return the returns of people by distance, and the share of all beams without a return.

    The same definitions hold for simulated and recorded scans, without ground truth of single beams: the returns of a
    person are those at most 0.45 m from the centre. People are left out if at least half of the beams towards a disc of
    0.2 m around them end more than 0.6 m before them, or outside the field of view; in point clouds nobody is left out.

    Args:
        rows: scans or point clouds of one environment, each with the people ``[N, 2]`` in the world [m].

    Raises:
        InputError: a reading is neither a planar scan nor a point cloud, or there is none.

    >>> from crowdbot.core import Pose, Scene
    >>> from crowdbot.sensors import Lidar2D
    >>> scan = Lidar2D(rays=360).read(Scene.of([[3.0, 0.0]], radius=0.25), Pose.of((0.0, 0.0), 0.0))
    >>> bands, missing = scan_statistics([(scan, np.array([[3.0, 0.0]]))])
    >>> bands[1].returns, bands[1].apart, round(missing, 3)
    (9.0, 0.0, 0.975)
    """
    bands = {limits: _Band() for limits in itertools.pairwise(BAND_LIMITS)}
    beams = missing = 0
    for reading, people in rows:
        if not isinstance(reading, Scan | PointCloud):
            raise InputError(f"statistics are of laser scanners, not of {type(reading).__name__}")
        known = np.isfinite(reading.ranges[0])
        beams, missing = beams + known.size, missing + int((~known).sum())
        place = planar_pose(reading.pose).position[0]
        for person in people:
            away = float(np.hypot(*(person - place)))
            band = next((band for (near, far), band in bands.items() if near <= away < far), None)
            if band is not None:
                _add(reading, person, place, away, band)
    if not beams:
        raise InputError("there are no scans")
    return [band.summary(*limits) for limits, band in bands.items()], missing / beams


def _add(reading: Scan | PointCloud, person: Floats, place: Floats, away: float, band: _Band) -> None:
    """Add the returns of a person to a band."""
    if isinstance(reading, PointCloud):
        points = reading.points(in_world=True)[0].reshape(-1, 3)
        near = np.hypot(points[:, 0] - person[0], points[:, 1] - person[1]) <= REACH
        band.counts.append(int((near & (points[:, 2] >= LOW) & (points[:, 2] <= HIGH)).sum()))
        return
    heading = float(planar_pose(reading.pose).heading[0])
    bearing = math.atan2(person[1] - place[1], person[0] - place[0]) - heading
    aside = (reading.angles - bearing + math.pi) % (2.0 * math.pi) - math.pi
    ranges = reading.ranges[0]
    at = np.abs(aside) <= math.asin(min(1.0, BODY / max(away, BODY)))
    if not at.any() and np.abs(aside).min() > np.abs(np.diff(reading.angles)).max(initial=0.0):
        return
    if at.any() and (ranges[at] < away - BEFORE).mean() >= 0.5:
        return
    order = np.argsort(aside, kind="stable")
    points = reading.points()[0][order, :2]
    own = points[np.hypot(*(points - person).T) <= REACH]
    band.counts.append(len(own))
    if len(own):
        spacing = away * float(np.abs(np.diff(reading.angles)).max(initial=0.0))
        breaks = np.flatnonzero(np.hypot(*np.diff(own, axis=0).T) > GAP + 2.0 * spacing) + 1
        parts = np.split(own, breaks)
        band.clusters.append(len(parts))
        band.widths += [float(np.hypot(*(part[-1] - part[0]))) for part in parts if len(part) > 1]
