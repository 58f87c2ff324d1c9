"""PlacementPlan: the people of a trial at the beginning of many environments, placed by one kernel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import draw_uniform, kernel, next_uniform, stream, stream_states
from crowdbot.trials.agent import Agent
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.people import Spawner
from crowdbot.trials.recorded_people import RecordedPeople, Walk
from crowdbot.trials.robot import RobotSpec
from crowdbot.trials.stage import Stage, area
from crowdbot.typing import Bools, Floats, Ints, Words

from .population import place, place_fixed, recorded_people
from .spawn_layouts import draw_layout, goal_discs
from .spawn_placement import GAP, TRIES, InitialPeople, OccupiedDiscs, draw_heading

DOUBT = 1e-9
"""Distance [m] to a limit, relative to coordinates above 1 m, below which the kernel does not decide."""
MOST_MISSES = 64_000
"""Points outside a zone after which the kernel does not decide."""
NO, YES, UNSURE = 0, 1, 2


class Polygons(NamedTuple):
    """K polygons with holes as arrays: edges ``[M, 4]``, and ``[K + 1]`` the first edge of each."""

    edges: Floats
    first: Ints

    @classmethod
    def of(cls, shapes: Sequence[Any]) -> Polygons:
        """Return shapely polygons as arrays."""
        edges, first = [np.zeros((0, 4))], [0]
        for shape in shapes:
            rings = [] if shape.is_empty else [np.asarray(item.coords) for item in (shape.exterior, *shape.interiors)]
            edges += [np.concatenate([ring[:-1, :2], ring[1:, :2]], axis=1) for ring in rings]
            first.append(first[-1] + sum(len(ring) - 1 for ring in rings))
        return cls(np.concatenate(edges), np.array(first, dtype=np.int64))


class PlacementGeometry(NamedTuple):
    """Stage, zones and occupied discs of K spawners as arrays.

    Fields:
        solids: ``[M, 4]`` edges of walls and solids [m].
        blocks, grounds, bounded: solid polygons, parts of the walkable area, and whether there is one.
        zones: K spawn zones, then K goal zones, empty without a goal.
        low, size: ``[2 K, 2]`` lower corners and sizes of their boxes [m].
        discs: ``[D, 3]`` x, y and radius of robots and other people [m].
        cell: width of the cells of the grid of discs [m]; discs in cells that do not touch are not compared.
    """

    solids: Floats
    blocks: Polygons
    grounds: Polygons
    bounded: bool
    zones: Polygons
    low: Floats
    size: Floats
    discs: Floats
    cell: float


def place_people(
    states: Words,
    counts: Ints,
    geometry: PlacementGeometry,
    tries: int,
    radius: Floats,
    position: Floats,
    goal: Floats,
    decided: Bools,
) -> None:
    """Write positions and goals of N people of K spawners in E environments.

    Args:
        states: ``[E, 2 K, 4]`` states of the generators of positions, then of goals; advanced.
        counts: ``[K]`` number of people.
        geometry: stage, zones and discs.
        tries: number of points per person.
        radius: ``[E, N]`` [m].
        position, goal: ``[E, N, 2]`` [m], filled.
        decided: ``[E]`` filled with whether every decision is beyond doubt and everybody has found a place.
    """
    solids, blocks, grounds, bounded, zones, low, size, discs, cell = geometry
    stage = (solids, *blocks, *grounds, bounded)
    _place_all(
        states, counts, stage, tuple(zones), low, size, discs, cell, tries, radius, position, goal, decided
    )  # fmt: skip


@kernel
def _place_all(
    states: Words,
    counts: Ints,
    stage: Any,
    zones: Any,
    low: Floats,
    size: Floats,
    fixed: Floats,
    cell: float,
    tries: int,
    radius: Floats,
    position: Floats,
    goal: Floats,
    decided: Bools,
) -> None:
    spawners, others = len(counts), len(fixed)
    discs = np.empty((others + radius.shape[1], 3))
    discs[:others] = fixed
    point = np.empty(2)
    for e in range(len(states)):
        begin, fits = 0, True
        for k in range(spawners):
            for n in range(begin, begin + counts[k]):
                r = radius[e, n]
                fits = fits and _find(
                    states[e, k], stage, zones, k, low, size, tries, r, discs[: others + n], cell, point
                )
                position[e, n, 0], position[e, n, 1] = point[0], point[1]
                discs[others + n, 0], discs[others + n, 1], discs[others + n, 2] = point[0], point[1], r
            has_goal = zones[1][spawners + k + 1] > zones[1][spawners + k]
            for n in range(begin, begin + counts[k]):
                goal[e, n, 0], goal[e, n, 1] = position[e, n, 0], position[e, n, 1]
                if has_goal and fits:
                    i, r = spawners + k, radius[e, n]
                    fits = _find(states[e, i], stage, zones, i, low, size, tries, r, discs[:0], cell, point)
                    goal[e, n, 0], goal[e, n, 1] = point[0], point[1]
            begin += counts[k]
            if not fits:
                break
        decided[e] = fits


@kernel
def _find(
    state: Words,
    stage: Any,
    zones: Any,
    zone: int,
    low: Floats,
    size: Floats,
    tries: int,
    radius: float,
    discs: Floats,
    cell: float,
    point: Floats,
) -> bool:
    """Write the next random point of a zone with room for a disc, and return whether it is found beyond doubt."""
    misses = 0
    while tries > 0 and misses < MOST_MISSES:
        x = low[zone, 0] + next_uniform(state) * size[zone, 0]
        y = low[zone, 1] + next_uniform(state) * size[zone, 1]
        inside = _is_within(x, y, zones[0], zones[1][zone], zones[1][zone + 1])
        if inside == NO:
            misses += 1
            continue
        misses, tries = 0, tries - 1
        clear = _is_clear(x, y, radius, stage) if inside == YES else UNSURE
        if clear == YES:
            clear = _is_free(x, y, radius, discs, cell)
        if clear == YES:
            point[0], point[1] = x, y
            return True
        if clear == UNSURE:
            return False
    return False


@kernel
def _is_within(x: float, y: float, edges: Floats, first: int, last: int) -> int:
    """Return whether a point is inside of a polygon; unsure near its edges."""
    inside = False
    for m in range(first, last):
        x1, y1, x2, y2 = edges[m, 0], edges[m, 1], edges[m, 2], edges[m, 3]
        if _distance(x, y, x1, y1, x2, y2) <= _doubt(x, y):
            return UNSURE
        if (y1 > y) != (y2 > y) and x < (x2 - x1) * (y - y1) / (y2 - y1) + x1:
            inside = not inside
    return YES if inside else NO


@kernel
def _is_clear(x: float, y: float, radius: float, stage: Any) -> int:
    """Return whether a point is at least ``radius`` [m] away from all solids, and in the walkable area."""
    solids, blocks, block_first, grounds, ground_first, bounded = stage
    doubt = _doubt(x, y)
    for m in range(len(solids)):
        away = _distance(x, y, solids[m, 0], solids[m, 1], solids[m, 2], solids[m, 3])
        if away < radius + doubt:
            return NO if away < radius - doubt else UNSURE
    for k in range(len(block_first) - 1):
        inside = _is_within(x, y, blocks, block_first[k], block_first[k + 1])
        if inside != NO:
            return NO if inside == YES else UNSURE
    if not bounded:
        return YES
    for k in range(len(ground_first) - 1):
        inside = _is_within(x, y, grounds, ground_first[k], ground_first[k + 1])
        if inside != NO:
            return inside
    return NO


@kernel
def _is_free(x: float, y: float, radius: float, discs: Floats, cell: float) -> int:
    """Return whether a disc keeps the gap to all discs in its cell of the grid and the cells around."""
    i, j = math.floor(x / cell), math.floor(y / cell)
    for n in range(len(discs)):
        a, b = discs[n, 0], discs[n, 1]
        least = (radius + discs[n, 2] + GAP) * (radius + discs[n, 2] + GAP)
        away = (x - a) * (x - a) + (y - b) * (y - b)
        if away < least * (1.0 + DOUBT) and abs(math.floor(a / cell) - i) <= 1 and abs(math.floor(b / cell) - j) <= 1:
            return NO if away < least * (1.0 - DOUBT) else UNSURE
    return YES


@kernel
def _doubt(x: float, y: float) -> float:
    return DOUBT * max(1.0, abs(x), abs(y))


@kernel
def _distance(x: float, y: float, x1: float, y1: float, x2: float, y2: float) -> float:
    """Return the distance [m] of a point to a segment."""
    dx, dy, px, py = x2 - x1, y2 - y1, x - x1, y - y1
    square = dx * dx + dy * dy
    share = min(1.0, max(0.0, (px * dx + py * dy) / square)) if square > 0.0 else 0.0
    away, aside = px - share * dx, py - share * dy
    return math.sqrt(away * away + aside * aside)


MOST_PEOPLE = 1000
"""Number of people above which they are placed one environment after the other, with a grid of occupied discs."""
SMALLEST = 1e-5
"""Smallest radius [m] for the kernel, which leaves decisions closer than 1e-9 m to :func:`place`."""


class PeopleBatch(NamedTuple):
    """The people at the beginning of E environments.

    Fields:
        position, goal: ``[E, N, 2]`` [m].
        radius, speed, heading: ``[E, N]``, as in :class:`InitialPeople`.
        group: ``[E, N]`` number of the group, -1 without a group.
        first: the people of the first environment.
    """

    position: Floats
    goal: Floats
    radius: Floats
    speed: Floats
    heading: Floats
    group: Ints
    first: InitialPeople

    @classmethod
    def of(cls, people: Sequence[InitialPeople]) -> PeopleBatch:
        """Return the people of several environments, as many in each."""
        columns: dict[str, Any] = {
            name: np.stack([getattr(person, name) for person in people]) for name in cls._fields[:-1]
        }
        return cls(**columns, first=people[0])

    def environment(self, number: int) -> InitialPeople:
        """Return the people of one environment."""
        first = self.first
        columns: dict[str, Any] = {name: getattr(self, name)[number] for name in self._fields[:-1]}
        return InitialPeople(**columns, owner=first.owner, owners=first.owners, walks=first.walks)


@dataclass(frozen=True, eq=False)
class PlacementPlan:
    """Places the people of a trial for many seeds at once, exactly as :func:`place` for each seed.

    A kernel draws the numbers of the same random streams. Whatever it cannot decide beyond doubt is left to
    :func:`place`: points within 1e-9 m of a limit, groups, people who do not fit, and more than 1000 people.

    Fields:
        stage, spawners, robots, agents, recorded: the arguments of :func:`place`.

    >>> zone = [(0, 0), (9, 0), (9, 9), (0, 9)]
    >>> plan = PlacementPlan.of(Stage(), [Spawner(count=9, zone=zone, goal=zone)], [])
    >>> people = plan.place([3, 4])
    >>> people.position.shape, bool(np.all(people.goal[1] == place(Stage(), plan.spawners, [], 4)[0].goal))
    ((2, 9, 2), True)
    """

    stage: Stage
    spawners: tuple[Spawner, ...]
    robots: tuple[RobotSpec, ...]
    agents: tuple[Agent, ...]
    recorded: tuple[tuple[RecordedPeople, tuple[Walk, ...]], ...]
    _fixed: tuple[OccupiedDiscs, list[tuple[Any, str]], InitialPeople] = field(repr=False)
    _geometry: PlacementGeometry | None = field(repr=False)

    @classmethod
    def of(
        cls,
        stage: Stage,
        spawners: Sequence[Spawner],
        robots: Sequence[RobotSpec],
        agents: Sequence[Agent] = (),
        recorded: Sequence[tuple[RecordedPeople, Sequence[Walk]]] = (),
    ) -> PlacementPlan:
        """Return the plan with the geometry of the stage and the zones as arrays."""
        walks = tuple((item, tuple(rows)) for item, rows in recorded)
        whole = (stage, tuple(spawners), tuple(robots), tuple(agents), walks)
        fixed = place_fixed(*whole)
        simple = not fixed[1] and _is_simple(whole[1])
        return cls(*whole, fixed, _geometry_of(stage, whole[1], fixed[0]) if simple else None)

    def place(self, seeds: Sequence[int]) -> PeopleBatch | tuple[int, list[tuple[Any, str]]]:
        """Return the people of all seeds, or the index of the first seed with problems and these, as :func:`place`."""
        batch, decided = self._place_at_once(seeds)
        missing = np.flatnonzero(~decided).tolist()
        exact: dict[int, InitialPeople] = {}
        for e in missing:
            exact[e], problems = place(
                self.stage, self.spawners, self.robots, seeds[e], self.agents, list(self.recorded)
            )
            if problems:
                return e, problems
        if batch is None:
            return PeopleBatch.of([exact[e] for e in missing])
        for e, people in exact.items():
            for name in PeopleBatch._fields[:-1]:
                getattr(batch, name)[e] = getattr(people, name)
        return batch

    def _place_at_once(self, seeds: Sequence[int]) -> tuple[PeopleBatch | None, NDArray[np.bool_]]:
        """Return the people placed by the kernel, and ``[E]`` where it could decide."""
        small = all(-(2**63) <= seed < 2**63 for seed in seeds)
        if small and self._has_layouts:
            return self._place_layouts(seeds)
        if self._geometry is None or not small:
            return None, np.zeros(len(seeds), dtype=np.bool_)
        keys = np.array(seeds, dtype=np.int64)
        counts = [spawner.count for spawner in self.spawners]
        people = sum(counts)
        radius, speed, heading = (np.empty((len(keys), people)) for _ in range(3))
        begin = 0
        for k, spawner in enumerate(self.spawners):
            own = slice(begin, begin + spawner.count)
            radius[:, own] = _draw(spawner.radius, keys, ("spawner", k, "radius"), spawner.count)
            speed[:, own] = _draw(spawner.speed, keys, ("spawner", k, "speed"), spawner.count)
            heading[:, own] = _headings(spawner, seeds, k)
            begin += spawner.count
        position, goal = (np.empty((len(keys), people, 2)) for _ in range(2))
        decided = np.full(len(keys), not people)
        if people:
            states = stream_states(
                keys, [("spawner", k, word) for word in ("place", "goal") for k in range(len(counts))]
            )
            counted = np.array(counts, dtype=np.int64)
            drawn = (radius, position, goal, decided)
            place_people(states, counted, self._geometry, TRIES, *drawn)
        return self._whole(keys, (position, goal, radius, speed, heading)), decided

    @property
    def _has_layouts(self) -> bool:
        """Whether one spawner with a layout, on a stage without walls, has all people of spawners."""
        solids, ground = self.stage.shapes
        alone = len(self.spawners) == 1 and not self._fixed[1]
        return alone and self.spawners[0].layout != "zone" and not len(solids) and ground is None

    def _place_layouts(self, seeds: Sequence[int]) -> tuple[PeopleBatch, NDArray[np.bool_]]:
        """Return the people of the spawner with a layout, and ``[E]`` where they fit."""
        one, E = self.spawners[0], len(seeds)
        keys = np.array(seeds, dtype=np.int64)
        radius = _draw(one.radius, keys, ("spawner", 0, "radius"), one.count)
        speed = _draw(one.speed, keys, ("spawner", 0, "speed"), one.count)
        heading = np.broadcast_to(_headings(one, seeds, 0), (E, one.count)).astype(np.float64)
        discs = np.array(self._fixed[0].rows, dtype=np.float64).reshape(-1, 3)
        tiled = (np.tile(rows, (E, 1, 1)) for rows in (discs, goal_discs(self.robots)))
        drawn = draw_layout(one, 0, seeds, radius, *tiled)
        return self._whole(keys, (drawn.position, drawn.goal, radius, speed, heading)), drawn.placed == one.count

    def _whole(self, seeds: Ints, drawn: Sequence[Floats]) -> PeopleBatch:
        """Return the people of spawners, with agents before and recorded people after them."""
        agents = self._fixed[2]
        last = [
            recorded_people(walks, _draw(item.radius, seeds[:1], ("recorded", k, "radius"), len(walks))[0])
            for k, (item, walks) in enumerate(self.recorded)
        ]
        columns: dict[str, Any] = {}
        for name, value in zip(PeopleBatch._fields, drawn, strict=False):
            parts = [getattr(agents, name), *(getattr(item, name) for item in last)]
            wide = [np.broadcast_to(part, (len(seeds), *part.shape)) for part in parts]
            columns[name] = np.concatenate([wide[0], value, *wide[1:]], axis=1)
        begin = len(self.agents) + drawn[0].shape[1]
        for k, (item, walks) in enumerate(self.recorded):
            rows = columns["radius"][:, begin : begin + len(walks)]
            rows[:] = _draw(item.radius, seeds, ("recorded", k, "radius"), len(walks))
            begin += len(walks)
        count = columns["radius"].shape[1] - len(agents)
        group = np.concatenate([agents.group, np.full(count, -1, dtype=np.int64)])
        columns["group"] = np.tile(group, (len(seeds), 1))
        return PeopleBatch(**columns, first=self._first(columns))

    def _first(self, columns: dict[str, Any]) -> InitialPeople:
        """Return the people of the first environment, with their owners."""
        sizes = (
            [1] * len(self.agents) + [spawner.count for spawner in self.spawners] + [len(w) for _, w in self.recorded]
        )
        owner = np.repeat(np.arange(len(sizes)), sizes)
        owners: tuple[Any, ...] = (*self.agents, *self.spawners, *(item for item, _ in self.recorded))
        walks = tuple(walk for _, rows in self.recorded for walk in rows)
        rows = {name: column[0] for name, column in columns.items()}
        return InitialPeople(**rows, owner=owner, owners=owners, walks=walks)


def _is_simple(spawners: Sequence[Spawner]) -> bool:
    """Return whether the kernel can place the people of these spawners."""
    if any(spawner.layout != "zone" for spawner in spawners):
        return False
    small = any(spawner.radius.extent[0] < SMALLEST for spawner in spawners)
    return (
        not small
        and not any(spawner.groups for spawner in spawners)
        and sum(spawner.count for spawner in spawners) <= MOST_PEOPLE
    )


def _geometry_of(stage: Stage, spawners: Sequence[Spawner], taken: OccupiedDiscs) -> PlacementGeometry:
    """Return the stage, the zones and the discs as arrays."""
    import shapely

    solids, ground = stage.shapes
    rings = [line.coords for shape in solids for line in _lines(shape)]
    pairs = [np.concatenate([ring[:-1], ring[1:]], axis=1) for ring in map(np.asarray, rings)]
    edges = np.concatenate([np.zeros((0, 4)), *pairs])
    blocks = Polygons.of([shape for shape in solids if shape.geom_type == "Polygon"])
    grounds = Polygons.of([] if ground is None else list(shapely.get_parts(ground)))
    zones = [area(spawner.zone) for spawner in spawners]
    goals = [area(spawner.goal) if spawner.goal else shapely.Polygon() for spawner in spawners]
    boxes = np.array([shape.bounds if not shape.is_empty else (0.0,) * 4 for shape in (*zones, *goals)])
    low = boxes.reshape(-1, 4)[:, :2].copy()
    size = boxes.reshape(-1, 4)[:, 2:] - low
    discs = np.array(taken.rows, dtype=np.float64).reshape(-1, 3)
    areas = Polygons.of([*zones, *goals])
    return PlacementGeometry(edges, blocks, grounds, ground is not None, areas, low, size, discs, taken.cell + GAP)


def _lines(shape: Any) -> list[Any]:
    return [shape.exterior, *shape.interiors] if shape.geom_type == "Polygon" else [shape]


def _draw(what: Distribution, seeds: Ints, path: tuple[str | int, ...], count: int) -> Floats:
    """Return ``[E, count]`` values of a distribution, each seed from its own stream."""
    if what.kind == "number":
        return np.full((len(seeds), count), what.extent[0])
    return what.values_at(draw_uniform(stream_states(seeds, [path])[:, 0], count))


def _headings(spawner: Spawner, seeds: Sequence[int], number: int) -> Any:
    """Return the headings of people of a spawner: one number, or ``[E, count]``."""
    if spawner.heading is None and spawner.stands:
        return np.stack([draw_heading(stream(seed, "spawner", number, "heading"), spawner.count) for seed in seeds])
    return np.nan if spawner.heading is None else spawner.heading
