"""MovingPeople: a tracker of people who walk through free space, for scans without a map."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import InputError, check_number, kernel, storable
from crowdbot.typing import Bools, Floats

from .detector import Coverage, Detections
from .tracker import Tracker, Tracks
from .trackers import GlobalNearestNeighbor

CELL = 0.1
"""Width of a cell [m]."""
SIDE = 240
"""Cells along a side of the grid, whose middle follows the scanner."""
REACH = 0.5 * CELL * SIDE - 1.0
"""Beams are followed up to this distance [m]; the scanner may leave the middle of the grid by less than 1 m."""
BODY = 0.35
"""Returns within this distance of a position [m] are those of the person."""


@storable
@dataclass(frozen=True)
class FreeSpace:
    """What the beams of the last seconds met, by cells of the ground.

    Fields:
        corner: ``[2]`` number of the first cell along x and y.
        passed, met: ``[SIDE, SIDE]`` weights of the scans in which beams passed a cell, and in which one ended in it.
    """

    corner: tuple[int, int]
    passed: Floats
    met: Floats


@storable
@dataclass(frozen=True)
class MovingPeopleState:
    """State of :class:`MovingPeople`.

    Fields:
        space: what the beams met, without those of the last ``lag`` seconds; None at the beginning.
        recent: times [s] and coverages of the last ``lag`` seconds.
        tracks: tracks of the last update, None before.
        start: ``[N, 2]`` where these tracks were first [m].
        away: ``[N]`` largest distance from there so far [m].
        inner: state of the inner tracker.
    """

    space: FreeSpace | None
    recent: tuple[tuple[float, Coverage], ...]
    tracks: Tracks | None
    start: Floats
    away: Floats
    inner: Any


@dataclass(frozen=True, kw_only=True)
class MovingPeople(Tracker):
    """Tracker of people who were seen to walk: a track begins only where a scan has shown free space before.

    Furniture of the width of legs stands where the scanner has never seen free space; people walk through it. A grid of
    the ground, which moves with the scanner, counts in how many scans beams passed a cell and ended in it. Beams count
    as far as their two neighbours reach: along a wall they pass cells that others end in. Detections count if most of
    their returns lie in cells that were free until ``lag`` before now and do not touch an occupied cell, or if they are
    near a person who has walked since the track began (Leigh, Pineau, Olmedo and Zhang (2015), Person tracking and
    following with 2D laser scanners, doi 10.1109/ICRA.2015.7139259, use free space in a similar way). People who stand
    from the beginning are not found until they walk. Detections without a coverage all count.

    Fields:
        tracker: tracker of the detections that count.
        lag: time between the grid and now, in which a person leaves a cell [s].
        memory: time in which the weight of a scan in the grid falls to 1 / e [s].
        scans: smallest weight of the scans in which beams passed a free cell.
        occupied: share of the scans in which a beam ended in a cell from which on the cell and those around it are not
            free.
        share: smallest share of the returns of a new person in free cells.
        hold: distance from a person who has walked within which all detections count [m].
        walk: distance from the start of a track at which the person has walked [m].
        confirm: distance from its start at which a track is shown [m]; 0: at once. 0.5 to 1 m leave out most false
            tracks, and show people later.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> from crowdbot.perception import LidarClusters
    >>> from crowdbot.sensors import Lidar2D
    >>> tracker = MovingPeople()
    >>> state = tracker.begin()
    >>> for k in range(40):  # a pillar, and a person who comes from behind the range
    ...     scene = Scene.of([[2.0, 0.0], [6.0 - 0.1 * k, 3.0]], radius=0.15).replace(time=0.1 * k)
    ...     found = LidarClusters().detect(Lidar2D(rays=720).read(scene, Pose.of((0.0, 0.0), 0.0)))
    ...     tracks, state = tracker.update(found, 0.1 * k, state)
    >>> tracks.position.round(1).tolist()
    [[2.1, 3.0]]
    """

    tracker: Tracker = dataclasses.field(default_factory=GlobalNearestNeighbor)
    lag: float = 1.0
    memory: float = 10.0
    scans: float = 3.0
    occupied: float = 0.1
    share: float = 0.5
    hold: float = 0.4
    walk: float = 0.5
    confirm: float = 0.0

    def __post_init__(self) -> None:
        name = type(self).__name__
        if not isinstance(self.tracker, Tracker) or isinstance(self.tracker, MovingPeople):
            raise InputError(f"{name}: tracker = {type(self.tracker).__name__} must be another tracker")
        for word, unit in (("lag", "s"), ("hold", "m"), ("walk", "m"), ("confirm", "m")):
            check_number(name, word, getattr(self, word), unit, min=0.0)
        check_number(name, "memory", self.memory, "s", exclusive_min=0.0)
        check_number(name, "scans", self.scans, exclusive_min=0.0)
        for word in ("occupied", "share"):
            check_number(name, word, getattr(self, word), exclusive_min=0.0, max=1.0)

    def begin(self) -> MovingPeopleState:
        return MovingPeopleState(None, (), None, np.zeros((0, 2)), np.zeros(0), self.tracker.begin())

    def update(self, detections: Detections, time: float, state: MovingPeopleState) -> tuple[Tracks, MovingPeopleState]:
        self.check_time(time, state.recent[-1][0] if state.recent else math.nan)
        coverage = detections.coverage
        space, recent = state.space, state.recent
        if coverage is not None:
            space, recent = self._learn(state, time, coverage)
            kept = self._counts(detections, coverage, space, state)
            place, spread, points = detections.position, detections.covariance, detections.points
            detections = Detections(detections.time, place[kept], spread[kept], points[kept], coverage)
        tracks, inner = self.tracker.update(detections, time, state.inner)
        start, away = tracks.position.copy(), np.zeros(len(tracks))
        if state.tracks is not None:
            _, here, there = np.intersect1d(tracks.ids, state.tracks.ids, return_indices=True)
            start[here], away[here] = state.start[there], state.away[there]
        away = np.maximum(away, np.hypot(*(tracks.position - start).T))
        return _rows(tracks, away >= self.confirm), MovingPeopleState(space, recent, tracks, start, away, inner)

    def _learn(
        self, state: MovingPeopleState, time: float, coverage: Coverage
    ) -> tuple[FreeSpace, tuple[tuple[float, Coverage], ...]]:
        """Return the grid with the scans older than ``lag``, and the other scans with the newest one."""
        middle = np.floor(coverage.origin / CELL).astype(np.int64) - SIDE // 2
        space = _moved(state.space, middle)
        elapsed = time - state.recent[-1][0] if state.recent else 0.0
        weight = math.exp(-elapsed / self.memory)
        passed, met = weight * space.passed, weight * space.met
        old = [scan for scan in state.recent if scan[0] <= time - self.lag]
        for _, scan in old:
            origin = scan.origin - CELL * np.array(space.corner)
            count_beams(passed, met, origin, float(scan.first), float(scan.step), scan.reach)
        recent = (*state.recent[len(old) :], (float(time), coverage))
        return FreeSpace(space.corner, passed, met), recent

    def _counts(self, detections: Detections, coverage: Coverage, space: FreeSpace, state: MovingPeopleState) -> Bools:
        """Return which detections ``[N]`` are in free space or near a person."""
        origin = coverage.origin - CELL * np.array(space.corner)
        position = np.ascontiguousarray(detections.position - CELL * np.array(space.corner))
        shares = np.zeros(len(position))
        share_free(
            space.passed, space.met, self.scans, self.occupied, origin, float(coverage.first), float(coverage.step),
            coverage.reach, position, shares,
        )  # fmt: skip
        kept = shares >= self.share
        walkers = state.away >= self.walk
        if state.tracks is not None and walkers.any():
            gap = detections.position[:, None] - state.tracks.position[None, walkers]
            kept |= np.hypot(gap[..., 0], gap[..., 1]).min(axis=1) <= self.hold
        return np.asarray(kept)


def _rows(tracks: Tracks, rows: Bools) -> Tracks:
    """Return some of the tracks."""
    values = [getattr(tracks, field.name)[rows] for field in dataclasses.fields(Tracks)[1:]]
    return Tracks(tracks.time, *values)


def _moved(space: FreeSpace | None, corner: Any) -> FreeSpace:
    """Return the grid with another first cell, if the scanner has left its middle."""
    wanted = (int(corner[0]), int(corner[1]))
    if space is None:
        return FreeSpace(wanted, np.zeros((SIDE, SIDE)), np.zeros((SIDE, SIDE)))
    i, j = wanted[0] - space.corner[0], wanted[1] - space.corner[1]
    if max(abs(i), abs(j)) * CELL < 1.0:
        return space
    grids = []
    for grid in (space.passed, space.met):
        moved = np.zeros_like(grid)
        if max(abs(i), abs(j)) < SIDE:
            here = (slice(max(0, -i), SIDE - max(0, i)), slice(max(0, -j), SIDE - max(0, j)))
            there = (slice(max(0, i), SIDE - max(0, -i)), slice(max(0, j), SIDE - max(0, -j)))
            moved[here] = grid[there]
        grids.append(moved)
    return FreeSpace(wanted, grids[0], grids[1])


@kernel
def count_beams(passed: Floats, met: Floats, origin: Floats, first: float, step: float, reach: Floats) -> None:
    """Add one scan to the grids: 1 where a beam ended, or else where one passed, no farther than its neighbours.

    The farthest beams have no return, or one that is farther away than people are seen. ``origin`` ``[2]`` is the
    scanner from the corner of the grid [m], ``reach`` ``[R]`` the length of the beams [m].
    """
    side, far = len(passed), min(REACH, reach.max())
    seen = np.zeros((side, side), dtype=np.uint8)
    for k in range(len(reach)):
        x, y = math.cos(first + k * step), math.sin(first + k * step)
        clear = min(reach[k], REACH)
        for other in (k - 1, k + 1):  # along a wall, a beam passes what its neighbour meets
            if 0 <= other < len(reach) and reach[other] > 0.0:
                clear = min(clear, reach[other])
        for s in range(int((clear - CELL) / (0.5 * CELL))):
            i, j = int((origin[0] + 0.5 * CELL * s * x) / CELL), int((origin[1] + 0.5 * CELL * s * y) / CELL)
            if 0 <= i < side and 0 <= j < side:
                seen[i, j] = max(seen[i, j], 1)
    for k in range(len(reach)):
        if 0.0 < reach[k] < far:
            x, y = math.cos(first + k * step), math.sin(first + k * step)
            i, j = int((origin[0] + reach[k] * x) / CELL), int((origin[1] + reach[k] * y) / CELL)
            if 0 <= i < side and 0 <= j < side:
                seen[i, j] = 2
    for i in range(side):
        for j in range(side):
            if seen[i, j] == 1:
                passed[i, j] += 1.0
            elif seen[i, j] == 2:
                met[i, j] += 1.0


@kernel
def share_free(
    passed: Floats, met: Floats, scans: float, occupied: float, origin: Floats, first: float, step: float,
    reach: Floats, position: Floats, shares: Floats,
) -> None:  # fmt: skip
    """Write the share ``[N]`` of the returns near each position ``[N, 2]`` that end in free cells."""
    total = np.zeros(len(position))
    side, far = len(passed), min(REACH, reach.max())
    for k in range(len(reach)):
        if not 0.0 < reach[k] < far:
            continue
        x = origin[0] + reach[k] * math.cos(first + k * step)
        y = origin[1] + reach[k] * math.sin(first + k * step)
        free = -1
        for n in range(len(position)):
            if math.hypot(position[n, 0] - x, position[n, 1] - y) > BODY:
                continue
            if free < 0:
                i, j = int(x / CELL), int(y / CELL)
                inside = 0 < i < side - 1 and 0 < j < side - 1
                free = 1 if inside and passed[i, j] >= scans else 0
                if free == 1:
                    for cell in range(9):
                        a, b = i - 1 + cell // 3, j - 1 + cell % 3
                        if met[a, b] > occupied * (met[a, b] + passed[a, b]):
                            free = 0
            total[n] += 1.0
            shares[n] += free
    for n in range(len(position)):
        if total[n] > 0.0:
            shares[n] /= total[n]
