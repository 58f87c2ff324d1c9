"""Navigation from scans only: an occupancy map of the last scans around the robot, for any navigator."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from crowdbot.core import InputError, Walls, check_number, did_you_mean, kernel
from crowdbot.navigation.action import Action
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation, VisiblePeople
from crowdbot.navigation.orca import ORCANavigator
from crowdbot.navigation.planners.elastic_band import TimeElasticBandNavigator
from crowdbot.navigation.planners.potential_field import PotentialFieldNavigator
from crowdbot.navigation.planners.window_navigator import DynamicWindowNavigator
from crowdbot.typing import Floats

PLANNERS: dict[str, Any] = {
    "dynamic-window": DynamicWindowNavigator,
    "orca": ORCANavigator,
    "potential-field": PotentialFieldNavigator,
    "time-elastic-band": TimeElasticBandNavigator,
}
"""Navigators that can drive among the cells of the map."""
HIT, MISS = 0.85, -0.4
"""Change of the log-odds of a cell in which a beam ends, and of one that it passes."""
LARGEST = 3.5
"""Largest size of the log-odds."""
OCCUPIED = 0.6
"""Log-odds from which a cell is occupied."""
MOST = 80
"""Largest number of occupied cells for the planner, the nearest ones."""


@dataclass(frozen=True)
class ScanMapNavigator(Navigator):
    """Drives with a navigator that knows no people and no walls, only a map of the last scans.

    The map is a square grid of log-odds around the robot that moves with it by whole cells. A beam adds to the cell in
    which it ends and takes from the cells that it passes; with time all cells return to unknown (``memory``). The
    occupied cells are discs at rest for the planner, whose people and walls are removed. So a method without a tracker
    can be compared with those that have one. The grid moves with the pose of the robot, as from a localisation.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        planner: ``dynamic-window``, ``orca``, ``potential-field`` or ``time-elastic-band``.
        cell: width of a cell [m].
        size: width of the map [m].
        memory: time after which the log-odds of a cell that no beam meets are 1/e [s].

    Raises:
        InputError: a number is out of its range, or there is no such planner.

    >>> ScanMapNavigator(planner="orca").inner
    ORCANavigator(speed=1.0, safety=0.05, share=1.0, time_horizon=1.5, time_horizon_walls=1.0, neighbor_distance=6.0, \
max_neighbors=15, reaction=0.3)
    """

    needs_scan: ClassVar[bool] = True
    always_returns = True

    speed: float = 1.0
    planner: str = "dynamic-window"
    cell: float = 0.1
    size: float = 8.0
    memory: float = 0.8

    def __post_init__(self) -> None:
        for name, unit in {"speed": "m/s", "cell": "m", "size": "m", "memory": "s"}.items():
            check_number("ScanMapNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        if not 4.0 <= self.size / self.cell <= 400.0:
            raise InputError(f"ScanMapNavigator: size = {self.size:g} m must be 4 to 400 cells of {self.cell:g} m")
        if self.planner not in PLANNERS:
            raise InputError(
                f"ScanMapNavigator: planner = {self.planner!r} must be one of {', '.join(PLANNERS)}"
                f"{did_you_mean(self.planner, PLANNERS)}"
            )

    @property
    def inner(self) -> Navigator:
        """The navigator that plans among the occupied cells."""
        made: Navigator = PLANNERS[self.planner](speed=self.speed)
        return made

    @property
    def cells(self) -> int:
        """Number of cells of a side."""
        return max(4, round(self.size / self.cell))

    def begin(self, observation: Observation) -> tuple[Any, ...]:
        # empty map: grid of log-odds, cell of its lower corner, time of the last scan, time
        corner = self._corner(observation)
        return np.zeros((self.cells, self.cells)), *corner, -math.inf, observation.time

    def act(self, observation: Observation, memory: tuple[Any, ...]) -> tuple[Action, tuple[Any, ...]]:
        grid, i, j, scanned, time = memory
        corner = self._corner(observation)
        grid = _shifted(grid, corner[0] - i, corner[1] - j)
        grid *= math.exp(-max(observation.time - time, 0.0) / self.memory)
        scan: Any = observation.scan
        taken = float(np.max(scan.time)) if scan is not None else scanned
        if scan is not None and taken > scanned:
            self._add_scan(grid, corner, scan)
        action, _ = self.inner.decide(self._seen(observation, grid, corner), None)
        return action, (grid, *corner, taken, observation.time)

    def _corner(self, observation: Observation) -> tuple[int, int]:
        half = self.cells // 2
        x, y = observation.pose[:2]
        return math.floor(x / self.cell) - half, math.floor(y / self.cell) - half

    def _add_scan(self, grid: Floats, corner: tuple[int, int], scan: Any) -> None:
        """Add the beams of a scan to the grid, in place."""
        angles = np.ascontiguousarray(scan.pose.heading[0] + scan.angles)
        ranges = np.ascontiguousarray(scan.ranges[0], dtype=np.float64)
        x, y = (float(value) for value in scan.pose.position[0, :2])
        _add_beams(grid, x / self.cell - corner[0], y / self.cell - corner[1], angles, ranges / self.cell)

    def _seen(self, observation: Observation, grid: Floats, corner: tuple[int, int]) -> Observation:
        """Return the observation of a planner that knows only the occupied cells."""
        at = np.argwhere(grid >= OCCUPIED)
        centre = ((at + corner + 0.5) * self.cell).astype(np.float64)
        away = np.hypot(*(centre - observation.position).T)
        near = np.argsort(away, kind="stable")[:MOST]
        count = len(near)
        cells = VisiblePeople(centre[near], np.zeros((count, 2)), np.full(count, 0.5 * self.cell))
        return dataclasses.replace(observation, people=cells, walls=_NO_WALLS, tracks=None, predictor=None)


_NO_WALLS = Walls.of()


def _shifted(grid: Floats, di: int, dj: int) -> Floats:
    """Return a copy of a grid whose corner has moved by whole cells; new cells are unknown."""
    count, new = len(grid), np.zeros_like(grid)
    if abs(di) < count and abs(dj) < count:
        to_i, from_i = (slice(max(0, -di), count - max(0, di)), slice(max(0, di), count - max(0, -di)))
        to_j, from_j = (slice(max(0, -dj), count - max(0, dj)), slice(max(0, dj), count - max(0, -dj)))
        new[to_i, to_j] = grid[from_i, from_j]
    return new


@kernel
def _add_beams(grid: Floats, x: float, y: float, angles: Floats, ranges: Floats) -> None:
    """Add beams from ``x, y`` to a grid; all lengths are in cells.

    A beam passes cells until half a cell before its end. A beam without an end passes all cells in its direction; one
    with an invalid range adds nothing.
    """
    count = len(grid)
    passed = np.zeros((count, count), np.bool_)
    hit = np.zeros((count, count), np.bool_)
    for b in range(len(angles)):
        r = ranges[b]
        if math.isnan(r) or r < 0.0:
            continue
        cos, sin = math.cos(angles[b]), math.sin(angles[b])
        length = min(r, 1.5 * count)
        for n in range(int(2.0 * max(length - 0.5, 0.0))):
            i, j = math.floor(x + 0.5 * n * cos), math.floor(y + 0.5 * n * sin)
            if not (0 <= i < count and 0 <= j < count):
                break
            passed[i, j] = True
        if math.isfinite(r):
            i, j = math.floor(x + r * cos), math.floor(y + r * sin)
            if 0 <= i < count and 0 <= j < count:
                hit[i, j] = True
    for i in range(count):
        for j in range(count):
            if hit[i, j]:
                grid[i, j] = min(grid[i, j] + HIT, LARGEST)
            elif passed[i, j]:
                grid[i, j] = max(grid[i, j] + MISS, -LARGEST)
