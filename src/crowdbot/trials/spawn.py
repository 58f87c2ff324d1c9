"""Placing people: at random in a zone, clear of walls, robots and each other."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import stream

from .notation import Points
from .people import Spawner
from .stage import Stage, area
from .trial import Robot

__all__ = ["People", "place", "points_in"]

Floats = NDArray[np.float64]

GAP = 0.01
"""Two discs begin at least this far apart [m]."""
TRIES = 2000
"""A zone is full when a person finds no place in this many points of it."""
MOST_PROBLEMS = 100
BATCH = 64
EMPTY_BATCHES = 5000
"""A zone of which this many batches of points in its bounding box hit nothing is too thin to stand in."""


@dataclass(frozen=True)
class People:
    """Where N people begin and want to go.

    Fields:
        position, goal: ``[N, 2]`` [m]; who goes on a journey has no goal yet but the own place.
        radius: ``[N]`` [m].
        speed: ``[N]`` preferred speed [m/s].
        spawner: ``[N]`` index of the spawner.
    """

    position: Floats
    goal: Floats
    radius: Floats
    speed: Floats
    spawner: NDArray[np.int64]

    def __len__(self) -> int:
        """Return N."""
        return len(self.position)


def place(
    stage: Stage, spawners: Sequence[Spawner], robots: Sequence[Robot], seed: int
) -> tuple[People, list[tuple[Spawner, str]]]:
    """Return the people of all spawners, and for each spawner that could not place everyone a sentence.

    Spawner k draws from ``stream(seed, "spawner", k, ...)`` only: places, goals, speeds and radii have a stream each.
    Later spawners keep clear of the people of earlier ones.

    >>> zone = [(0, 0), (2, 0), (2, 2), (0, 2)]
    >>> people, problems = place(Stage(), [Spawner(count=50, zone=zone, goal=zone, radius=0.3)], [], seed=0)
    >>> len(people) < 50, problems[0][1][:20]
    (True, 'only 12 of 50 people')
    """
    taken = _Taken(2.0 * max([s.radius.extent[1] for s in spawners] + [r.radius for r in robots], default=1.0))
    for robot in robots:
        taken.add(robot.x, robot.y, robot.radius)
    groups, problems = [], []
    for index, spawner in enumerate(spawners):
        group = _group(stage, spawner, index, taken, seed)
        groups.append(group)
        if len(group) < spawner.count:
            problems.append((spawner, _too_many(spawner, len(group))))
        if len(problems) == MOST_PROBLEMS:
            break
    return _joined(groups), problems


def _too_many(spawner: Spawner, fit: int) -> str:
    if fit == 0:
        return (
            f"spawn zone of {area(spawner.zone).area:.2f} m2 leaves no room for a single body beside walls, robots and"
            " other people; move it, or make it larger"
        )
    return (
        f"only {fit} of {spawner.count} people fit into the spawn zone of {area(spawner.zone).area:.2f} m2 beside"
        " walls, robots and each other; make it larger, or take fewer or smaller people"
    )


def points_in(zone: Points, rng: np.random.Generator) -> Iterator[Floats]:
    """Yield uniformly distributed points of a zone, ``[N, 2]`` at a time, until the zone turns out too thin."""
    import shapely

    polygon = area(zone)
    shapely.prepare(polygon)
    low = np.array(polygon.bounds[:2])
    size = np.array(polygon.bounds[2:]) - low
    empty = 0
    while empty < EMPTY_BATCHES:
        points = low + rng.random((BATCH, 2)) * size
        inside = points[shapely.contains_xy(polygon, points[:, 0], points[:, 1])]
        empty = 0 if len(inside) else empty + 1
        if len(inside):
            yield inside


def _group(stage: Stage, spawner: Spawner, index: int, taken: _Taken, seed: int) -> People:
    radius = spawner.radius.draw(stream(seed, "spawner", index, "radius"), spawner.count)
    speed = spawner.speed.draw(stream(seed, "spawner", index, "speed"), spawner.count)
    places = _clear_points(stage, spawner.zone, stream(seed, "spawner", index, "place"))
    position: list[tuple[float, float]] = []
    for r in radius:
        found = next(((x, y) for x, y, room in _some(places) if room >= r and taken.free(x, y, r)), None)
        if found is None:
            break
        taken.add(*found, float(r))
        position.append(found)
    count = len(position)
    where = np.array(position, dtype=np.float64).reshape(-1, 2)
    aims = stream(seed, "spawner", index, "goal")
    return People(
        where,
        _goals(stage, spawner, radius[:count], aims) if spawner.goal else where,
        radius[:count],
        speed[:count],
        np.full(count, index, dtype=np.int64),
    )


def _clear_points(stage: Stage, zone: Points, rng: np.random.Generator) -> Iterator[tuple[float, float, float]]:
    """Yield points of the zone x, y [m] with the room around them up to the next wall [m]."""
    for points in points_in(zone, rng):
        for (x, y), room in zip(points.tolist(), stage.clearance(points).tolist(), strict=True):
            yield x, y, room


def _some(points: Iterator[tuple[float, float, float]]) -> Iterator[tuple[float, float, float]]:
    for _ in range(TRIES):
        point = next(points, None)
        if point is None:
            return
        yield point


def _goals(stage: Stage, spawner: Spawner, radius: Floats, rng: np.random.Generator) -> Floats:
    """Return a point ``[N, 2]`` of the goal zone for everyone, clear of walls where there is room for that."""
    places = _clear_points(stage, spawner.goal, rng)
    goals = []
    for r in radius:
        best = (-1.0, 0.0, 0.0)
        for x, y, room in _some(places):
            best = max(best, (min(room, float(r)), x, y), key=lambda one: one[0])
            if room >= r:
                break
        goals.append(best[1:])
    return np.array(goals, dtype=np.float64).reshape(-1, 2)


def _joined(groups: Sequence[People]) -> People:
    none = np.zeros(0)
    return People(
        np.concatenate([np.zeros((0, 2)), *(g.position for g in groups)]),
        np.concatenate([np.zeros((0, 2)), *(g.goal for g in groups)]),
        np.concatenate([none, *(g.radius for g in groups)]),
        np.concatenate([none, *(g.speed for g in groups)]),
        np.concatenate([np.zeros(0, dtype=np.int64), *(g.spawner for g in groups)]),
    )


@dataclass
class _Taken:
    """Discs that stand already, in a grid of cells that are as wide as the largest disc."""

    cell: float
    discs: dict[tuple[int, int], list[tuple[float, float, float]]] = field(default_factory=dict)

    def add(self, x: float, y: float, radius: float) -> None:
        self.discs.setdefault(self._at(x, y), []).append((x, y, radius))

    def free(self, x: float, y: float, radius: float) -> bool:
        i, j = self._at(x, y)
        near = (self.discs.get((i + di, j + dj), ()) for di in (-1, 0, 1) for dj in (-1, 0, 1))
        return all((x - a) ** 2 + (y - b) ** 2 >= (radius + r + GAP) ** 2 for cell in near for a, b, r in cell)

    def _at(self, x: float, y: float) -> tuple[int, int]:
        width = self.cell + GAP
        return math.floor(x / width), math.floor(y / width)
