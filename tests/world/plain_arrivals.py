"""Plain twin of the arrivals of a world: one queue after the other, with generators of its own."""

from __future__ import annotations

import copy
import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, dense, stream
from crowdbot.models.mixture import MODEL
from crowdbot.world import PeopleSource
from crowdbot.world.crowd.arrivals import find_busy, first_free, free_slot
from crowdbot.world.crowd.journey import JOURNEY

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]
BOOL = np.dtype(np.bool_)
TRIES = 20
TOP = 1.3


@dataclass
class _Queue:
    """Queue of one source in one environment."""

    source: PeopleSource
    times: np.random.Generator
    bodies: np.random.Generator
    places: np.random.Generator
    due: float
    come: int = 0
    waiting: int = 0
    body: tuple[float, float] | None = None
    """Preferred speed [m/s] and radius [m] of the first person in the queue."""

    def __post_init__(self) -> None:
        ring = self.source.zone.ring
        self.low = ring.min(axis=0)
        self.size = ring.max(axis=0) - self.low

    @classmethod
    def of(cls, source: PeopleSource, seed: int, number: int) -> _Queue:
        times, bodies, places = (stream(seed, "source", number, name) for name in ("times", "bodies", "places"))
        queue = cls(source, times, bodies, places, source.begin)
        if source.timing == "poisson":
            queue.due += queue.pause()
        return queue

    def reconfigure(self, source: PeopleSource) -> None:
        """Change the source. With regular timing, the next arrival stays as planned."""
        begin = self.due - self.come / source.rate
        if source.timing == "regular" and source != self.source and self.come and begin < source.end:
            source = dataclasses.replace(source, begin=begin)
        self.source = source
        self.__post_init__()

    def pause(self) -> float:
        """Return the time until the next arrival [s]."""
        regular = self.source.timing == "regular"
        return 1.0 / self.source.rate if regular else float(self.times.exponential(1.0 / self.source.rate))

    def fill(self, time: float) -> None:
        """Add all arrivals up to a time [s] to the queue."""
        most = math.inf if self.source.max_count is None else self.source.max_count
        while self.due <= time + 1e-9 and self.due < self.source.end and self.come < most:
            self.come += 1
            self.waiting += 1
            self.due = (
                self.source.begin + self.come / self.source.rate
                if self.source.timing == "regular"
                else self.due + self.pause()
            )

    @property
    def next_arrival(self) -> float:
        """Time [s] of the next arrival, infinite if nobody comes any more."""
        most = math.inf if self.source.max_count is None else self.source.max_count
        return self.due if self.due < self.source.end and self.come < most else math.inf

    def first(self) -> tuple[float, float]:
        """Return preferred speed [m/s] and radius [m] of the first person in the queue."""
        if self.body is None:
            self.body = (self._drawn("speed"), self._drawn("radius"))
        return self.body

    def _drawn(self, name: str) -> float:
        value = getattr(self.source, name)
        number = float(value if isinstance(value, int | float) else np.asarray(value.draw(self.bodies, 1))[0])
        if not 0.0 < number < math.inf:
            raise InputError(f"PeopleSource: the sampled {name} {number} must be finite and above 0")
        return number

    def points(self) -> Floats:
        """Return random positions ``[N, 2]`` [m] in the bounding box of the zone."""
        return np.asarray(self.low + self.size * self.places.random((TRIES, 2)))


class _Entry(NamedTuple):
    """A person who enters: environment, index in the arrays, source, speed and radius."""

    e: int
    a: int
    source: int
    x: float
    y: float
    speed: float
    radius: float


class PlainArrivals:
    """Queues and entries of a set of sources.

    Args:
        sources: the sources.
        seeds: seed of each environment.
        first_journey: index of the journey of the first source; the others follow.
        fresh: initial values in the memory of the scene for a new person, by name (default: 0).
    """

    def __init__(
        self,
        sources: Sequence[PeopleSource],
        seeds: Sequence[int],
        first_journey: int,
        fresh: Mapping[str, float | Floats],
    ) -> None:
        self._sources = sources
        self._queues = [[_Queue.of(source, int(seed), k) for k, source in enumerate(sources)] for seed in seeds]
        self._first_journey = first_journey
        self._fresh = fresh
        self._arrival = np.zeros((len(seeds), len(sources)))
        """Time [s] of the next arrival of each source, ``[E, K]``."""
        self._waiting = np.zeros((len(seeds), len(sources)), dtype=np.int64)
        """Number of people waiting at each source, ``[E, K]``."""
        self._note()

    @property
    def waiting_count(self) -> Numbers:
        """Number of people waiting to enter, ``[E]``."""
        return np.asarray(self._waiting.sum(axis=1))

    def _note(self) -> None:
        """Note the state of all queues in arrays."""
        for e, queues in enumerate(self._queues):
            for k, queue in enumerate(queues):
                self._arrival[e, k], self._waiting[e, k] = queue.next_arrival, queue.waiting

    def select(self, environments: Sequence[int]) -> PlainArrivals:
        """Return independent queues of some environments."""
        chosen = copy.copy(self)
        chosen._queues = [[copy.deepcopy(queue) for queue in self._queues[e]] for e in environments]
        chosen._arrival, chosen._waiting = self._arrival[list(environments)], self._waiting[list(environments)]
        return chosen

    def join(self, others: Sequence[PlainArrivals]) -> PlainArrivals:
        """Return the queues of this and other worlds with the same sources."""
        whole = copy.copy(self)
        whole._queues = [queues for item in (self, *others) for queues in item._queues]
        whole._arrival = np.concatenate([item._arrival for item in (self, *others)])
        whole._waiting = np.concatenate([item._waiting for item in (self, *others)])
        return whole

    def put(self, environments: Sequence[int], other: PlainArrivals) -> None:
        """Replace the queues of some environments by those of another world with the same sources."""
        for k, e in enumerate(environments):
            self._queues[e] = other._queues[k]
            self._arrival[e], self._waiting[e] = other._arrival[k], other._waiting[k]

    def reconfigure(self, sources: Sequence[PeopleSource], seeds: Sequence[int] | None = None) -> None:
        """Replace the sources; queues and planned arrivals are kept.

        Args:
            sources: as many as before, with the same journeys.
            seeds: new seed of each environment; None: the random numbers continue.

        Raises:
            InputError: the number or the journeys of the sources differ.
        """
        if [source.journey for source in sources] != [source.journey for source in self._sources]:
            raise InputError("the number and the journeys of sources cannot change in a running world")
        self._sources = tuple(sources)
        for e, queues in enumerate(self._queues):
            for number, queue in enumerate(queues):
                queue.reconfigure(sources[number])
                if seeds is not None:
                    new = _Queue.of(sources[number], int(seeds[e]), number)
                    queue.times, queue.bodies, queue.places = new.times, new.bodies, new.places
        self._note()

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
        shape = scene.shape
        external = dense(scene.external, shape, BOOL)
        now = np.full(shape[0], time, dtype=np.float64)
        busy = np.empty(self._waiting.shape, dtype=np.bool_)
        new = np.zeros(shape, dtype=np.bool_)
        if not find_busy(self._arrival, self._waiting, now, dense(scene.active, shape, BOOL), external, busy):
            return scene, new
        position, radius, active = scene.position.copy(), scene.radius.copy(), scene.active.copy()
        walls = np.ascontiguousarray(scene.walls.segments())
        entries: list[_Entry] = []
        for e, k in np.argwhere(busy).tolist():
            queue, here = self._queues[e][k], (position[e], radius[e], active[e], external[e])
            queue.fill(now[e])
            while queue.waiting and (entry := self._entry(e, k, queue, here, walls)) is not None:
                entries.append(entry)
            self._arrival[e, k], self._waiting[e, k] = queue.next_arrival, queue.waiting
        if not entries:
            return scene, new
        for entry in entries:
            ids[entry.e, entry.a] = following[entry.e]
            following[entry.e] += 1
            new[entry.e, entry.a] = True
        return self._with(scene, entries), new

    def _entry(self, e: int, k: int, queue: _Queue, here: tuple[Any, ...], walls: Floats) -> _Entry | None:
        """Let the first person of a queue enter; None without a free slot or room.

        Args:
            e, k: environment and source.
            queue: the queue.
            here: position, radius, presence and externality of the agents; modified in place.
            walls: ``[M, 4]``.
        """
        slot = free_slot(here[2], here[3])
        if slot < 0:
            return None
        speed, radius = queue.first()
        points = queue.points()
        row = first_free(points, queue.source.zone.ring, here[0], here[1], here[2], walls, radius)
        if row < 0:
            return None
        x, y = points[row].tolist()
        here[0][slot], here[1][slot], here[2][slot] = points[row], radius, True
        queue.body, queue.waiting = None, queue.waiting - 1
        return _Entry(e, slot, k, x, y, speed, radius)

    def _with(self, scene: Scene, entries: Sequence[_Entry]) -> Scene:
        e, a, source, x, y, speed, radius = (np.array(column) for column in zip(*entries, strict=True))

        def put(value: NDArray[Any], new: Any) -> NDArray[Any]:
            changed = value.copy()
            changed[e, a] = new
            return changed

        place = np.stack([x, y], axis=-1)
        memory = {name: put(value, self._fresh.get(name, 0.0)) for name, value in scene.memory.items()}
        if JOURNEY in memory:
            memory[JOURNEY] = put(memory[JOURNEY], self._first_journey + source)
        if MODEL in memory:
            memory[MODEL] = put(memory[MODEL], [self._sources[k].model for k in source])
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
