"""Arrivals: the queues of the sources of all environments, and the people who enter."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, RandomStreams, Scene, Storage, draw_uniform, kernel, next_uniform, stream_states
from crowdbot.models.mixture import MODEL
from crowdbot.typing import Bools, Floats, Words

from .agent_arrays import BOOL, dense
from .journey import JOURNEY
from .source import TOP, PeopleSource
from .waypoint import is_inside

Numbers = NDArray[np.int64]

GAP = 0.01
"""Smallest distance [m] between bodies at entry."""


@kernel
def find_busy(arrival: Floats, waiting: Numbers, now: Floats, active: Bools, external: Bools, busy: Bools) -> bool:
    """Write the sources ``[E, K]`` at which somebody arrives or may enter; return whether there is one."""
    some = False
    for e in range(len(now)):
        slot = int(np.int64(-2))
        for k in range(waiting.shape[1]):
            busy[e, k] = arrival[e, k] <= now[e] + 1e-9
            if not busy[e, k] and waiting[e, k] > 0:
                slot = free_slot(active[e], external[e]) if slot == -2 else slot
                busy[e, k] = slot >= 0
            some = some or busy[e, k]
    return some


@kernel
def free_slot(active: Bools, external: Bools) -> int:
    """Return the first slot of an absent person, -1 for none."""
    for a in range(len(active)):
        if not active[a] and not external[a]:
            return a
    return -1


@kernel
def first_free(
    points: Floats, ring: Floats, position: Floats, size: Floats, active: Bools, walls: Floats, radius: float
) -> int:
    """Return the first point in the zone with room for a body, -1 for none."""
    for row in range(len(points)):
        x, y = points[row, 0], points[row, 1]
        free = is_inside(ring, x, y)
        for k in range(len(active)):
            if not free:
                break
            if active[k]:
                dx, dy, reach = position[k, 0] - x, position[k, 1] - y, size[k] + radius + GAP
                free = not dx * dx + dy * dy < reach * reach
        for m in range(len(walls)):
            if not free:
                break
            free = not _distance2(x, y, walls[m]) < radius * radius
        if free:
            return row
    return -1


@kernel
def _distance2(x: float, y: float, wall: Floats) -> float:
    """Return the squared distance [m2] from a point to a wall ``[4]``."""
    ex, ey = wall[2] - wall[0], wall[3] - wall[1]
    dx, dy = x - wall[0], y - wall[1]
    along = min(max((dx * ex + dy * ey) / max(ex * ex + ey * ey, 1e-300), 0.0), 1.0)
    return float((dx - along * ex) * (dx - along * ex) + (dy - along * ey) * (dy - along * ey))


BLOCK = 16
"""Random numbers that are drawn together for a queue."""
TRIES = 20
"""Positions tried per person and step."""
DONE, NO_BODY, WRONG_BODY = 0, 1, 2
"""Results of :func:`enter`: finished; a queue needs new speeds and radii; a speed or radius is not allowed."""


@kernel
def fill(
    queue: Any, rate: Floats, end: Floats, most: Floats, regular: Bools, now: Floats, chosen: Bools, short: Bools
) -> bool:
    """Add arrivals up to the time ``now`` ``[E]`` [s] to queues; write which lack random numbers, and return if any."""
    begin, due, come, waiting, arrival, gaps, gap = queue
    some = False
    for e in range(len(now)):
        for k in range(len(rate)):
            short[e, k] = False
            if not chosen[e, k]:
                continue
            while due[e, k] <= now[e] + 1e-9 and due[e, k] < end[k] and come[e, k] < most[k]:
                if not regular[k] and gap[e, k] >= gaps.shape[2]:
                    short[e, k] = some = True
                    break
                come[e, k] += 1
                waiting[e, k] += 1
                if regular[k]:
                    due[e, k] = begin[e, k] + come[e, k] / rate[k]
                else:
                    due[e, k] += 1.0 / rate[k] * gaps[e, k, gap[e, k]]
                    gap[e, k] += 1
            arrival[e, k] = due[e, k] if due[e, k] < end[k] and come[e, k] < most[k] else math.inf
    return some


@kernel
def enter(
    busy: Bools,
    queue: Any,
    people: Any,
    walls: Floats,
    rings: Floats,
    first: Numbers,
    ids: Numbers,
    following: Numbers,
    where: Numbers,
    values: Floats,
    mark: Numbers,
) -> int:
    """Let people of the ``busy`` ``[E, K]`` queues enter while there are free slots and room.

    Args:
        busy: the queues.
        queue: waiting, body, bodies, next, last and places of the queues.
        people: position, radius, presence and externality of all agents; modified.
        walls: ``[M, 4]``.
        rings, first: corners of the zones, and the first of each of the K zones.
        ids, following: ``[E, A]`` identities and ``[E]`` the next ones; modified.
        where: ``[N, 3]`` environment, agent and source of those who enter; filled.
        values: ``[N, 4]`` position [m], speed [m/s] and radius [m]; filled.
        mark: number of the queue at which to continue, and of people who have entered; modified.
    """
    waiting, body, bodies, next_, last, places = queue
    position, radius, active, external = people
    points = np.empty((TRIES, 2))
    sources = busy.shape[1]
    for number in range(mark[0], busy.size):
        e, k = number // sources, number % sources
        mark[0] = number
        ring = rings[first[k] : first[k + 1]]
        while busy[e, k] and waiting[e, k] > 0:
            slot = free_slot(active[e], external[e])
            if slot < 0:
                break
            if math.isnan(body[e, k, 0]):
                if next_[e, k] >= last[e, k]:
                    return NO_BODY
                speed, size = bodies[e, k, next_[e, k], 0], bodies[e, k, next_[e, k], 1]
                next_[e, k] += 1
                if not (0.0 < speed < math.inf and 0.0 < size < math.inf):
                    return WRONG_BODY
                body[e, k, 0], body[e, k, 1] = speed, size
            _draw_points(ring, places[e, k], points)
            row = first_free(points, ring, position[e], radius[e], active[e], walls, body[e, k, 1])
            if row < 0:
                break
            x, y, n = points[row, 0], points[row, 1], mark[1]
            position[e, slot, 0], position[e, slot, 1] = x, y
            radius[e, slot], active[e, slot] = body[e, k, 1], True
            where[n, 0], where[n, 1], where[n, 2] = e, slot, k
            values[n, 0], values[n, 1], values[n, 2], values[n, 3] = x, y, body[e, k, 0], body[e, k, 1]
            body[e, k, 0] = body[e, k, 1] = math.nan
            waiting[e, k] -= 1
            ids[e, slot] = following[e]
            following[e] += 1
            mark[1] += 1
    return DONE


@kernel
def _draw_points(ring: Floats, state: Any, points: Floats) -> None:
    """Write random positions in the bounding box of a zone [m]."""
    left, right, bottom, top = ring[0, 0], ring[0, 0], ring[0, 1], ring[0, 1]
    for row in range(1, len(ring)):
        left, right = min(left, ring[row, 0]), max(right, ring[row, 0])
        bottom, top = min(bottom, ring[row, 1]), max(top, ring[row, 1])
    width, height = right - left, top - bottom
    for row in range(len(points)):
        points[row, 0] = left + width * next_uniform(state)
        points[row, 1] = bottom + height * next_uniform(state)


@dataclass
class _Queues:
    """Queues of K sources in E environments.

    Fields:
        sources: the sources.
        begin: ``[E, K]`` time of the first arrival with regular timing [s].
        due: ``[E, K]`` time of the next arrival [s] if there is one.
        come, waiting: ``[E, K]`` number of people who have arrived, and who wait.
        arrival: ``[E, K]`` time of the next arrival [s], infinite if nobody comes any more.
        body: ``[E, K, 2]`` preferred speed [m/s] and radius [m] of the first person in the queue, NaN before they are
            drawn.
        gaps, gap: ``[E, K, B]`` next times between arrivals as multiples of the mean, and ``[E, K]`` the first unused.
        times: ``[E, K, 4]`` states of the generators of these times.
        bodies, next, last: ``[E, K, B, 2]`` next speeds and radii; first unused and end of those that are drawn.
        before, after: ``[E, K, 4]`` states of the generators of bodies, before and after these were drawn.
        places: ``[E, K, 4]`` states of the generators of positions.
        streams: generators of bodies of each source, for samplers of other classes.
    """

    sources: tuple[PeopleSource, ...]
    begin: Floats
    due: Floats
    come: Numbers
    waiting: Numbers
    arrival: Floats
    body: Floats
    gaps: Floats
    gap: Numbers
    times: Words
    bodies: Floats
    next: Numbers
    last: Numbers
    before: Words
    after: Words
    places: Words
    streams: list[RandomStreams]
    storage = Storage(constants=("sources",))

    @classmethod
    def of(cls, sources: Sequence[PeopleSource], seeds: Sequence[int], first: int = 0) -> _Queues:
        """Return the queues at time 0; the sources have the numbers from ``first`` on."""
        shape, keys = (len(seeds), len(sources)), np.array(seeds, dtype=np.int64)
        names = ("times", "bodies", "places")
        states = stream_states(keys, [("source", first + k, name) for k in range(len(sources)) for name in names])
        times, bodies, places = (states[:, n::3].copy() for n in range(3))
        zero = np.zeros(shape, dtype=np.int64)
        due = np.tile(np.array([source.begin for source in sources], dtype=np.float64), (len(seeds), 1))
        queues = cls(
            tuple(sources), due.copy(), due, zero, zero.copy(), np.full(shape, np.inf), np.full((*shape, 2), np.nan),
            np.zeros((*shape, BLOCK)), np.full(shape, BLOCK), times, np.zeros((*shape, BLOCK, 2)), zero.copy(),
            zero.copy(), bodies, bodies.copy(), places,
            [RandomStreams(seeds, "source", first + k, "bodies") for k in range(len(sources))],
        )  # fmt: skip
        poisson = np.array([source.timing == "poisson" for source in sources], dtype=np.bool_)
        queues._draw_gaps(np.broadcast_to(poisson, shape))
        scale = np.array([1.0 / source.rate for source in sources], dtype=np.float64)
        queues.due = np.where(poisson, queues.due + scale * queues.gaps[..., 0], queues.due)
        queues.gap[:, poisson] = 1
        queues.fill(np.full(len(seeds), -np.inf), np.ones(shape, dtype=np.bool_))
        return queues

    def fill(self, now: Floats, chosen: Bools) -> None:
        """Add all arrivals up to a time ``[E]`` [s] to the ``chosen`` ``[E, K]`` queues."""
        sources = self.sources
        rate = np.array([source.rate for source in sources], dtype=np.float64)
        end = np.array([source.end for source in sources], dtype=np.float64)
        most = np.array(
            [np.inf if source.max_count is None else source.max_count for source in sources], dtype=np.float64
        )
        regular = np.array([source.timing == "regular" for source in sources], dtype=np.bool_)
        short = np.zeros(chosen.shape, dtype=np.bool_)
        queue = (self.begin, self.due, self.come, self.waiting, self.arrival, self.gaps, self.gap)
        while fill(queue, rate, end, most, regular, now, chosen, short):
            self._draw_gaps(short)

    def _draw_gaps(self, chosen: Bools) -> None:
        """Draw new times between arrivals for the ``chosen`` ``[E, K]`` queues."""
        rng = np.random.Generator(np.random.PCG64(0))
        for e, k in np.argwhere(chosen).tolist():
            _set_state(rng, self.times[e, k])
            self.gaps[e, k], self.gap[e, k] = rng.standard_exponential(BLOCK), 0
            self.times[e, k] = _state_of(rng)

    def draw_bodies(self, busy: Bools, environment: int, k: int) -> None:
        """Draw speeds and radii of the next people of source ``k``.

        If they can be drawn in advance, in all ``busy`` ``[E, K]`` queues without any, otherwise only in the
        environment that needs them now.
        """
        some = np.flatnonzero(busy[:, k] & (self.next[:, k] >= self.last[:, k]) & np.isnan(self.body[:, k, 0]))
        both = (self.sources[k].speed, self.sources[k].radius)
        drawn = [n for n, value in enumerate(both) if not isinstance(value, int | float)]
        many = _is_buffered(self.sources[k])
        some = some if many else np.array([environment])
        self.next[some, k], self.before[some, k] = 0, self.after[some, k]
        self.last[some, k] = count = BLOCK if many else 1
        states = self.after[some, k]
        shares = draw_uniform(states, count * len(drawn) if many else 0)
        for n, value in enumerate(both):
            if isinstance(value, int | float):
                self.bodies[some, k, :, n] = value
            elif many:
                own: Any = value
                self.bodies[some, k, :, n] = own.values_at(shares[:, drawn.index(n) :: len(drawn)])
            else:
                sampler: Any = value
                for e in some.tolist():
                    self.bodies[e, k, 0, n] = np.asarray(sampler.draw(self.streams[k][e], 1))[0]
        self.after[some, k] = states
        for e in some.tolist() if not many else ():
            self.after[e, k] = _state_of(self.streams[k][e])

    def refuse_body(self, e: int, k: int) -> None:
        """Raise :class:`InputError` for the speed or radius that a queue has drawn last."""
        for name, number in zip(("speed", "radius"), self.bodies[e, k, self.next[e, k] - 1].tolist(), strict=True):
            if not 0.0 < number < np.inf:
                raise InputError(f"PeopleSource: the sampled {name} {number} must be finite and above 0")

    @property
    def rings(self) -> tuple[Floats, Numbers]:
        """Corners of the zones [m], and the first of each."""
        rings = [source.zone.ring for source in self.sources]
        return np.concatenate(rings), np.cumsum([0, *map(len, rings)])

    def change_sources(self, sources: Sequence[PeopleSource]) -> None:
        """Change the sources. With regular timing, the next arrival stays as planned."""
        for k, (old, new) in enumerate(zip(self.sources, sources, strict=True)):
            for e in range(len(self.due)):
                self._forget_bodies(e, k)
                if _is_buffered(old) and not _is_buffered(new):
                    _set_state(self.streams[k][e], self.after[e, k])
                begin, come = self.due[e, k] - self.come[e, k] / new.rate, self.come[e, k]
                same = new == dataclasses.replace(old, begin=float(self.begin[e, k]))
                planned = new.timing == "regular" and not same and come and begin < new.end
                self.begin[e, k] = begin if planned else new.begin
        self.sources = tuple(sources)

    def _forget_bodies(self, e: int, k: int) -> None:
        """Return to the random numbers before the bodies that have been drawn for later people."""
        if self.next[e, k] < self.last[e, k]:
            both = (self.sources[k].speed, self.sources[k].radius)
            drawn = sum(not isinstance(value, int | float) for value in both)
            self.after[e, k] = self.before[e, k]
            draw_uniform(self.after[e : e + 1, k], int(self.next[e, k]) * drawn)
            self.last[e, k] = self.next[e, k]


class Arrivals:
    """Queues and entries of a set of sources.

    Args:
        sources: the sources.
        seeds: seed of each environment.
        first_journey: index of the journey of the first source; the others follow.
        fresh: initial values in the memory of the scene for a new person, by name (default: 0).

    >>> from crowdbot.world import Point, Zone, WaypointSequence
    >>> door = Zone(((0, 0), (1, 0), (1, 2), (0, 2)))
    >>> path = WaypointSequence((Point(9, 1),))
    >>> coming = Arrivals([PeopleSource(door, path, rate=2.0, timing="regular")], [0], 0, {})
    >>> empty = Scene.of(np.zeros((3, 2)), active=False)
    >>> scene, new = coming.let_in(empty, 0.6, np.arange(3)[None], np.array([3]))
    >>> new.tolist(), scene.active.tolist()
    ([[True, True, False]], [[True, True, False]])
    """

    storage = Storage(constants=("_first_journey", "_fresh"))

    def __init__(
        self,
        sources: Sequence[PeopleSource],
        seeds: Sequence[int],
        first_journey: int,
        fresh: Mapping[str, float | Floats],
    ) -> None:
        self._queues = _Queues.of(sources, seeds)
        self._first_journey = first_journey
        self._fresh = fresh

    @property
    def waiting_count(self) -> Numbers:
        """Number of people waiting to enter, ``[E]``."""
        return np.asarray(self._queues.waiting.sum(axis=1))

    def reconfigure(self, sources: Sequence[PeopleSource], seeds: Sequence[int] | None = None) -> None:
        """Replace the sources; queues and planned arrivals are kept.

        Args:
            sources: as many as before, with the same journeys.
            seeds: new seed of each environment; None: the random numbers continue.

        Raises:
            InputError: the number or the journeys of the sources differ.
        """
        queues = self._queues
        if [source.journey for source in sources] != [source.journey for source in queues.sources]:
            raise InputError("the number and the journeys of sources cannot change in a running world")
        queues.change_sources(sources)
        if seeds is not None:
            new = _Queues.of(sources, seeds)
            for name in ("gaps", "gap", "times", "next", "last", "before", "after", "places"):
                setattr(queues, name, getattr(new, name))
            queues.streams = new.streams
        queues.fill(np.full(len(queues.due), -np.inf), np.ones(queues.due.shape, dtype=np.bool_))

    def let_in(
        self, scene: Scene, time: float | Floats, ids: Numbers, following: Numbers
    ) -> tuple[Scene, NDArray[np.bool_]]:
        """Return the scene with the people who have arrived up to a time, and who they are ``[E, A]``.

        New people are at rest and have no goal yet.

        Args:
            scene: current scene.
            time: time since the start [s], one or ``[E]``.
            ids: ``[E, A]`` identities; modified in place.
            following: ``[E]`` next identities; modified in place.
        """
        shape, queues = scene.shape, self._queues
        external = dense(scene.external, shape, BOOL)
        now = np.full(shape[0], time, dtype=np.float64)
        busy: Bools = np.empty(queues.waiting.shape, dtype=np.bool_)
        new = np.zeros(shape, dtype=np.bool_)
        if not find_busy(queues.arrival, queues.waiting, now, dense(scene.active, shape, BOOL), external, busy):
            return scene, new
        queues.fill(now, busy)
        position, radius, active = scene.position.copy(), scene.radius.copy(), scene.active.copy()
        walls = np.ascontiguousarray(scene.walls.segments())
        rings, first = queues.rings
        most = int(np.sum(queues.waiting, where=busy))
        where, values = np.empty((most, 3), dtype=np.int64), np.empty((most, 4))
        queue = (queues.waiting, queues.body, queues.bodies, queues.next, queues.last, queues.places)
        people, mark = (position, radius, active, external), np.zeros(2, dtype=np.int64)
        while (state := enter(busy, queue, people, walls, rings, first, ids, following, where, values, mark)) != DONE:
            e, k = divmod(int(mark[0]), len(queues.sources))
            if state == NO_BODY:
                queues.draw_bodies(busy, e, k)
            else:
                queues.refuse_body(e, k)
        count = int(mark[1])
        if not count:
            return scene, new
        new[where[:count, 0], where[:count, 1]] = True
        return self._with(scene, where[:count], values[:count]), new

    def _with(self, scene: Scene, where: Numbers, values: Floats) -> Scene:
        (e, a, source), (x, y, speed, radius) = where.T, values.T

        def put(value: NDArray[Any], new: Any) -> NDArray[Any]:
            changed = value.copy()
            changed[e, a] = new
            return changed

        place = np.stack([x, y], axis=-1)
        memory = {name: put(value, self._fresh.get(name, 0.0)) for name, value in scene.memory.items()}
        if JOURNEY in memory:
            memory[JOURNEY] = put(memory[JOURNEY], self._first_journey + source)
        if MODEL in memory:
            memory[MODEL] = put(memory[MODEL], [self._queues.sources[k].model for k in source])
        return scene.replace(
            position=put(scene.position, place),
            velocity=put(scene.velocity, 0.0),
            goal=put(scene.goal, place),
            radius=put(scene.radius, radius),
            preferred_speed=put(scene.preferred_speed, speed),
            max_speed=put(scene.max_speed, TOP * speed),
            active=put(scene.active, True),
            visible=put(scene.visible, True),
            group=put(scene.group, -1),
            memory=memory,
        )


def arrival_counts(sources: Sequence[PeopleSource], seeds: Sequence[int], time: float, first: int = 0) -> Numbers:
    """Return ``[E, K]`` the number of arrivals until a time [s] for the sources of worlds with these seeds.

    Args:
        sources: K sources.
        seeds: E seeds.
        time: time [s].
        first: number of the first source in the world.

    >>> from crowdbot.world import Point, Zone, WaypointSequence
    >>> door = Zone(((0, 0), (1, 0), (1, 2), (0, 2)))
    >>> source = PeopleSource(door, WaypointSequence((Point(9, 1),)), rate=0.5, timing="regular")
    >>> arrival_counts([source], seeds=[0, 1], time=9.0).tolist()
    [[5], [5]]
    """
    queues = _Queues.of(sources, [int(seed) % 2**63 for seed in seeds], first)
    queues.fill(np.full(len(seeds), float(time)), np.ones(queues.due.shape, dtype=np.bool_))
    return queues.come


def _is_buffered(source: PeopleSource) -> bool:
    """Return whether several speeds and radii can be drawn in advance: one random number for each."""
    return all(isinstance(item, int | float) or hasattr(item, "values_at") for item in (source.speed, source.radius))


def _state_of(rng: np.random.Generator) -> Words:
    """Return the state ``[4]`` of a PCG64, as kernels take it."""
    known: Any = rng.bit_generator.state["state"]
    words = [known[name] >> shift & (2**64 - 1) for name in ("state", "inc") for shift in (64, 0)]
    return np.array(words, dtype=np.uint64)


def _set_state(rng: np.random.Generator, state: Words) -> None:
    """Continue a PCG64 at a state ``[4]``; half a number that it has kept for whole numbers stays."""
    a, b, c, d = map(int, state)
    known: Any = dict(rng.bit_generator.state)
    known["state"] = {"state": a << 64 | b, "inc": c << 64 | d}
    rng.bit_generator.state = known
