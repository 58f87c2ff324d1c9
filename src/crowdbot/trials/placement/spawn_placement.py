"""Spawn placement: the people of a spawner at random places of its zone, clear of walls and of each other."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import stream
from crowdbot.core.fields import Points
from crowdbot.trials.agent import Agent, Avatar
from crowdbot.trials.people import Spawner
from crowdbot.trials.recorded_people import RecordedPeople, Walk
from crowdbot.trials.stage import Stage, area
from crowdbot.typing import Floats

from .spawn_layouts import draw_layout

GAP = 0.01
"""Smallest gap [m] between two people at the beginning."""
TRIES = 2000
"""Number of random points per person after which a zone is full."""
BATCH = 64
EMPTY_BATCHES = 5000
"""Number of batches of points in the bounding box without a hit after which a zone is too thin."""
MEMBERS = 200
"""Number of tries per member of a group near one place."""
PLACES = 50
"""Number of places tried per group after which a zone is full."""


@dataclass(frozen=True)
class InitialPeople:
    """Start, goal and body of N people: agents, people of spawners, avatars, recorded people.

    Fields:
        position, goal: ``[N, 2]`` [m]; with a journey, the goal is the position.
        radius: ``[N]`` [m].
        speed: ``[N]`` preferred speed [m/s].
        heading: ``[N]`` [rad], NaN for the walking direction.
        group: ``[N]`` number of the group, -1 without a group.
        owner: ``[N]`` index in ``owners``.
        owners: agents, spawners, avatars, recorded people.
        walks: walks of the recorded people, which are the last rows.
    """

    position: Floats
    goal: Floats
    radius: Floats
    speed: Floats
    heading: Floats
    group: NDArray[np.int64]
    owner: NDArray[np.int64]
    owners: tuple[Agent | Spawner | Avatar | RecordedPeople, ...] = ()
    walks: tuple[Walk, ...] = ()

    def __len__(self) -> int:
        """Return N."""
        return len(self.position)

    @property
    def spawner(self) -> NDArray[np.int64]:
        """``[N]`` index of the spawner, below 0 without a spawner."""
        first = sum(isinstance(owner, Agent) for owner in self.owners)
        last = first + sum(isinstance(owner, Spawner) for owner in self.owners)
        return np.where(self.owner < last, self.owner - first, -1)

    @classmethod
    def concatenate(
        cls, groups: Sequence[InitialPeople], owners_of: Sequence[int], owners: tuple[Any, ...], walks: tuple[Walk, ...]
    ) -> InitialPeople:
        """Return the people of all groups; ``owners_of`` is the number of owners of each group."""
        first = np.cumsum([0, *owners_of]).tolist()

        def whole(name: str, empty: Any) -> Any:
            return np.concatenate([empty, *(getattr(group, name) for group in groups)])

        none, no = np.zeros(0), np.zeros(0, dtype=np.int64)
        return cls(
            whole("position", np.zeros((0, 2))),
            whole("goal", np.zeros((0, 2))),
            whole("radius", none),
            whole("speed", none),
            whole("heading", none),
            whole("group", no),
            np.concatenate([no, *(k + group.owner for k, group in zip(first, groups, strict=False))]),
            owners,
            walks,
        )


def points_in(zone: Points, rng: np.random.Generator) -> Iterator[Floats]:
    """Yield batches ``[N, 2]`` of uniformly distributed points of a zone; end if the zone is too thin."""
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


def draw_heading(rng: np.random.Generator, count: int) -> Floats:
    """Return random headings ``[count]`` of standing people [rad]."""
    return rng.uniform(-math.pi, math.pi, count)


class SpawnPlacement(NamedTuple):
    """Places the people of spawner ``number`` of a trial, clear of the discs in ``taken``."""

    stage: Stage
    spawner: Spawner
    number: int
    taken: OccupiedDiscs
    seed: int
    robot_goals: Floats = np.zeros((0, 3))

    def stream(self, word: str) -> np.random.Generator:
        """Return the random stream of one quantity."""
        return stream(self.seed, "spawner", self.number, word)

    def people(self, first_group: int) -> InitialPeople:
        """Return the people who fit; their groups are numbered from ``first_group``."""
        spawner = self.spawner
        radius = spawner.radius.draw(self.stream("radius"), spawner.count)
        speed = spawner.speed.draw(self.stream("speed"), spawner.count)
        if spawner.layout != "zone":
            return self._layout(radius, speed)
        sizes = self._sizes()
        position = self._place_groups(radius, sizes) if sizes else self._place_singles(radius)
        count = len(position)
        where = np.array(position, dtype=np.float64).reshape(-1, 2)
        goal = _goals(self.stage, spawner, radius[:count], self.stream("goal")) if spawner.goal else where.copy()
        group = np.full(count, -1, dtype=np.int64)
        at = 0
        for number, size in enumerate(sizes):
            mates = slice(at, min(at + size, count))
            if size > 1 and at < count:
                group[mates] = first_group + number
                speed[mates] = speed[at]
                goal[mates] = goal[at] if spawner.goal else goal[mates]
            at += size
        return InitialPeople(
            where, goal, radius[:count], speed[:count], self._heading(count), group, np.zeros(count, dtype=np.int64)
        )

    def _layout(self, radius: Floats, speed: Floats) -> InitialPeople:
        """Return the people of a layout who fit, up to the first who is in a wall."""
        starts = np.array(self.taken.rows, dtype=np.float64).reshape(1, -1, 3)
        drawn = draw_layout(self.spawner, self.number, [self.seed], radius[None], starts, self.robot_goals[None])
        count = int(drawn.placed[0])
        if count:
            blocked = self.stage.clearance(drawn.position[0, :count]) < radius[:count]
            count = int(np.argmax(blocked)) if blocked.any() else count
        for (x, y), r in zip(drawn.position[0, :count].tolist(), radius[:count].tolist(), strict=True):
            self.taken.add(x, y, r)
        alone, owner = np.full(count, -1, dtype=np.int64), np.zeros(count, dtype=np.int64)
        where, goal = drawn.position[0, :count], drawn.goal[0, :count]
        return InitialPeople(where, goal, radius[:count], speed[:count], self._heading(count), alone, owner)

    def _heading(self, count: int) -> Floats:
        if self.spawner.heading is not None:
            return np.full(count, self.spawner.heading)
        if self.spawner.stands:
            return draw_heading(self.stream("heading"), count)
        return np.full(count, np.nan)

    def _sizes(self) -> list[int]:
        """Return group sizes drawn from the shares, largest first; empty without groups."""
        spawner, sizes, left = self.spawner, [], self.spawner.count
        shares = np.array([group.share for group in spawner.groups])
        rng = self.stream("groups")
        while len(shares) and left > 0:
            size = spawner.groups[int(rng.choice(len(shares), p=shares / shares.sum()))].size
            sizes.append(min(size, left))
            left -= sizes[-1]
        return sorted(sizes, reverse=True)

    def _place_singles(self, radius: Floats) -> list[tuple[float, float]]:
        places = _clear_points(self.stage, self.spawner.zone, self.stream("place"))
        position: list[tuple[float, float]] = []
        for r in radius:
            found = next(((x, y) for x, y, room in _some(places) if room >= r and self.taken.free(x, y, r)), None)
            if found is None:
                break
            self.taken.add(*found, float(r))
            position.append(found)
        return position

    def _place_groups(self, radius: Floats, sizes: Sequence[int]) -> list[tuple[float, float]]:
        places = _clear_points(self.stage, self.spawner.zone, self.stream("place"))
        rng, position = self.stream("member"), list[tuple[float, float]]()
        for size in sizes:
            bodies = radius[len(position) : len(position) + size].tolist()
            found = self._group(bodies, places, rng)
            if not found:
                break
            for (x, y), r in zip(found, bodies, strict=True):
                self.taken.add(x, y, r)
            position += found
        return position

    def _group(self, bodies: Sequence[float], places: Any, rng: np.random.Generator) -> list[tuple[float, float]]:
        """Return positions of a group near each other, empty if there is no room."""
        free = self.taken.free
        for _ in range(PLACES):
            begin = next(((x, y) for x, y, room in _some(places) if room >= bodies[0] and free(x, y, bodies[0])), None)
            if begin is None:
                return []
            members = [begin]
            for r in bodies[1:]:
                found = self._member(begin, members, bodies, r, rng)
                if found is None:
                    break
                members.append(found)
            if len(members) == len(bodies):
                return members
        return []

    def _member(
        self,
        begin: tuple[float, float],
        members: Sequence[tuple[float, float]],
        bodies: Sequence[float],
        radius: float,
        rng: np.random.Generator,
    ) -> tuple[float, float] | None:
        """Return a position near the first member of a group, in a disc that grows with every try."""
        import shapely

        zone = area(self.spawner.zone)
        for k in range(MEMBERS):
            far = (bodies[0] + radius) * (1.0 + k / 20.0)
            angle, away = rng.uniform(-math.pi, math.pi), far * math.sqrt(rng.random())
            x, y = begin[0] + away * math.cos(angle), begin[1] + away * math.sin(angle)
            alone = all(
                (x - a) ** 2 + (y - b) ** 2 >= (radius + r + GAP) ** 2
                for (a, b), r in zip(members, bodies, strict=False)
            )
            clear = alone and self.taken.free(x, y, radius) and shapely.contains_xy(zone, x, y)
            if clear and float(self.stage.clearance([(x, y)])[0]) >= radius:
                return x, y
        return None


def _clear_points(stage: Stage, zone: Points, rng: np.random.Generator) -> Iterator[tuple[float, float, float]]:
    """Yield batches of points x, y [m] of the zone with their distance to the nearest wall [m]."""
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
    """Return ``[N, 2]`` random points of the goal zone, clear of walls if possible."""
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


@dataclass
class OccupiedDiscs:
    """Occupied discs in a grid with cells as wide as the largest disc."""

    cell: float
    discs: dict[tuple[int, int], list[tuple[float, float, float]]] = field(default_factory=dict)

    def add(self, x: float, y: float, radius: float) -> None:
        """Add a disc."""
        self.discs.setdefault(self._at(x, y), []).append((x, y, radius))

    def free(self, x: float, y: float, radius: float, gap: float = GAP) -> bool:
        """Return whether a disc with a gap [m] around it is free."""
        i, j = self._at(x, y)
        near = (self.discs.get((i + di, j + dj), ()) for di in (-1, 0, 1) for dj in (-1, 0, 1))
        return all((x - a) ** 2 + (y - b) ** 2 >= (radius + r + gap) ** 2 for cell in near for a, b, r in cell)

    @property
    def rows(self) -> list[tuple[float, float, float]]:
        """x, y and radius [m] of all discs."""
        return [disc for cell in self.discs.values() for disc in cell]

    def _at(self, x: float, y: float) -> tuple[int, int]:
        width = self.cell + GAP
        return math.floor(x / width), math.floor(y / width)
