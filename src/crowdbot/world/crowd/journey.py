"""Journeys: sequences of waypoints and their assignment to people."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, did_you_mean
from crowdbot.typing import Bools, Floats

from .agent_arrays import BOOL, FLOAT, dense
from .waypoint import PersonRandom, Waypoint
from .waypoint_table import ASKS, LEAVES, TURNS, WaypointTable, advance_waypoints, routing_mask

Numbers = NDArray[np.int64]

JOURNEY, STOP = "journey", "stop"
"""Names in the memory of a scene ``[E, A]``: index of the journey (-1 for none) and number of the current waypoint,
which keeps counting on a repeated journey.
"""
THENS = ("leave", "stay", "again")
HOLD = "hold"
"""Name in the memory of a scene ``[E, A]``: 0 for people who go to the next waypoint on arrival, ``HOLDS`` for those
who stay at their waypoint, and ``GOES_ON`` for those who go to the next one at the end of the step, wherever they are.
"""
HOLDS, GOES_ON = 1.0, 2.0
UNTIL = "until"
"""Name in the memory of a scene ``[E, A]``: time at which the wait at the current waypoint ends [s], 0 before the
arrival. It is there if people wait at a waypoint.
"""


@dataclass(frozen=True)
class WaypointSequence:
    """A sequence of waypoints that a person visits in order.

    Fields:
        stops: waypoints, at least one.
        then: action at the last waypoint: ``leave``, ``stay`` or start ``again``.

    Raises:
        InputError: there is no waypoint, or a value is not a waypoint.

    >>> from crowdbot.world import Point, Zone
    >>> WaypointSequence((Point(5.0, 0.0), Zone(((9, 0), (11, 0), (10, 1)))), then="stay").then
    'stay'
    """

    stops: tuple[Waypoint, ...]
    then: str = "leave"

    def __post_init__(self) -> None:
        object.__setattr__(self, "stops", tuple(self.stops))
        if not self.stops or not all(isinstance(stop, Waypoint) for stop in self.stops):
            raise InputError(f"WaypointSequence: stops = {self.stops!r} must be one or more waypoints")
        if self.then not in THENS:
            raise InputError(
                f"WaypointSequence: then = {self.then!r}{did_you_mean(str(self.then), THENS)} must be leave, stay "
                f"or again"
            )

    def stop(self, number: int) -> Waypoint | None:
        """Return the waypoint with this number, or None if the journey is over."""
        if self.then == "again":
            return self.stops[number % len(self.stops)]
        return self.stops[number] if number < len(self.stops) else None


@dataclass(frozen=True)
class JourneyAssignment:
    """The journey of each person in a crowd.

    Fields:
        journeys: the available journeys.
        which: ``[A]`` or ``[E, A]`` int: index of the journey, -1 to keep the goal of the scene.

    Raises:
        InputError: an index is out of range.

    >>> from crowdbot.world import Point
    >>> paths = [WaypointSequence((Point(x, 5.0),)) for x in (0.0, 9.0)]
    >>> both = JourneyAssignment(tuple(paths), which=[0, 1, -1])
    >>> both.start(Scene.of([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), np.array([0]), np.array([[0, 1, 2]])).goal.tolist()
    [[[0.0, 5.0], [9.0, 5.0], [2.0, 0.0]]]
    """

    journeys: tuple[WaypointSequence, ...]
    which: int | Sequence[int] | Numbers = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "journeys", tuple(self.journeys))
        which = np.asarray(self.which)
        if which.dtype.kind not in "iu" or np.any((which < -1) | (which >= len(self.journeys))):
            raise InputError(
                f"JourneyAssignment: which = {which.tolist()} must be from 0 to {len(self.journeys) - 1},"
                " or -1 for no journey"
            )

    def start(
        self, scene: Scene, seeds: Numbers, ids: Numbers, holds: Callable[[Floats], Bools] | None = None
    ) -> Scene:
        """Return the scene with the first waypoint of each person as the goal.

        Args:
            scene: initial scene.
            seeds: ``[E]`` seeds of the environments.
            ids: ``[E, A]`` identities.
            holds: returns whether points ``[N, 2]`` have room for a body.
        """
        try:
            which = np.broadcast_to(np.asarray(self.which, dtype=np.float64), scene.shape).copy()
        except ValueError:
            raise InputError(
                f"JourneyAssignment: which has shape {list(np.shape(self.which))}, expected {list(scene.shape)}"
            ) from None
        memory = {**scene.memory, JOURNEY: which, STOP: np.zeros(scene.shape)}
        if any(stop.wait > 0.0 for journey in self.journeys for stop in journey.stops):
            memory[UNTIL] = np.zeros(scene.shape)
        return self.aim(scene.replace(memory=memory), which >= 0, seeds, ids, holds)

    def advance(
        self,
        scene: Scene,
        seeds: Numbers,
        ids: Numbers,
        holds: Callable[[Floats], Bools] | None = None,
        time: float | Floats = 0.0,
    ) -> Scene:
        """Return the scene after people who reached a waypoint have switched to the next one or left.

        The memory ``HOLD`` tells who does so regardless of their place, if it is there. Others stay at a waypoint for
        its ``wait``.

        Args:
            scene: scene after the motion of people.
            seeds: ``[E]`` seeds of the environments.
            ids: ``[E, A]`` identities.
            holds: returns whether points ``[N, 2]`` have room for a body.
            time: time since the start [s], one or ``[E]``.
        """
        if HOLD not in scene.memory and UNTIL not in scene.memory:
            return self._advance_free(scene, seeds, ids, holds)
        hold = scene.memory.get(HOLD, np.zeros(scene.shape))
        held, goes_on = hold > 0.0, hold == GOES_ON
        if UNTIL in scene.memory:
            scene, waits, over = self._wait(scene, ~held, time)
            held, goes_on = held | waits | over, goes_on | over
        free = self._advance_free(scene.replace(external=scene.external | held), seeds, ids, holds)
        scene = self._go_on(free.replace(external=scene.external), goes_on, seeds, ids, holds)
        moving = np.zeros(scene.shape, dtype=np.bool_)
        for _, _, at, rows in self._parties(scene, held):
            if at.moves:
                moving |= rows
        return self.aim(scene, moving, seeds, ids, holds)

    def _wait(self, scene: Scene, who: Bools, time: float | Floats) -> tuple[Scene, Bools, Bools]:
        """Return the scene with the ends of waits, and ``[E, A]`` which people ``who`` wait, and whose wait is over."""
        wait = np.zeros(scene.shape)
        for _, _, at, rows in self._parties(scene, who):
            wait[rows] = at.wait
        now = np.broadcast_to(np.reshape(time, (-1, 1)), scene.shape)
        until = np.where(wait > 0.0, scene.memory[UNTIL], 0.0)
        begins = self.reached(scene, (wait > 0.0) & (until == 0.0))
        until[begins] = (now + wait)[begins]
        over = (until > 0.0) & (now >= until - 1e-9)
        waits = (until > 0.0) & ~over
        until[over] = 0.0
        return scene.replace(memory={**scene.memory, UNTIL: until}), waits, over

    def _go_on(
        self, scene: Scene, who: Bools, seeds: Numbers, ids: Numbers, holds: Callable[[Floats], Bools] | None
    ) -> Scene:
        """Return the scene after the people ``who`` ``[E, A]`` have switched to the next waypoint or left."""
        who = who & self.under_way(scene)
        if not np.any(who):
            return scene
        stop = np.where(who, scene.memory[STOP] + 1.0, scene.memory[STOP])
        moved = scene.replace(memory={**scene.memory, STOP: stop})
        leaves = np.array([journey.then == "leave" for journey in self.journeys], dtype=np.bool_)
        over = who & ~self.under_way(moved)
        left = over & leaves[np.maximum(scene.memory[JOURNEY].astype(np.int64), 0)]
        return self.aim(moved.replace(active=scene.active & ~left), who & ~over, seeds, ids, holds)

    def under_way(self, scene: Scene) -> Bools:
        """Return ``[E, A]`` who has a waypoint ahead."""
        journey = scene.memory[JOURNEY].astype(np.int64)
        ends = [math.inf if one.then == "again" else len(one.stops) for one in self.journeys]
        last = np.array([*ends, 0.0])[journey]
        return np.greater(scene.active, scene.external) & (scene.memory[STOP] < last)

    def reached(self, scene: Scene, who: Bools) -> Bools:
        """Return ``[E, A]`` which of the people ``who`` are at their current waypoint."""
        there = np.zeros(scene.shape, dtype=np.bool_)
        for _, _, at, rows in self._parties(scene, who):
            there[rows] = at.is_reached(scene.position[rows], scene.goal[rows])
        return there

    def _advance_free(
        self, scene: Scene, seeds: Numbers, ids: Numbers, holds: Callable[[Floats], Bools] | None
    ) -> Scene:
        """Advance people who go to the next waypoint on arrival."""
        if not self._table.complete:
            return self._advance_each(scene, seeds, ids, holds)
        shape = scene.shape
        stop, active, goal = scene.memory[STOP].copy(), scene.active.copy(), scene.goal.copy()
        ask = np.empty(shape, dtype=np.bool_)
        journey = dense(scene.memory[JOURNEY], shape, FLOAT)
        position, external = dense(scene.position, (*shape, 2), FLOAT), dense(scene.external, shape, BOOL)
        found = advance_waypoints(self._rows, journey, position, external, stop, active, goal, ask)
        changes: dict[str, Any] = {"goal": goal} if found else {}
        if found & TURNS:
            changes["memory"] = {**scene.memory, STOP: stop}
        if found & LEAVES:
            changes["active"] = active
        on = scene.replace(**changes) if changes else scene
        return self.aim(on, ask, seeds, ids, holds) if found & ASKS else on

    def _advance_each(
        self, scene: Scene, seeds: Numbers, ids: Numbers, holds: Callable[[Floats], Bools] | None = None
    ) -> Scene:
        """Advance journeys with waypoints of other classes, one group of people after the other."""
        stop, active = scene.memory[STOP].copy(), scene.active.copy()
        renewed = np.zeros(scene.shape, dtype=np.bool_)
        for number, k, at, rows in self._parties(scene):
            journey = self.journeys[number]
            there = np.zeros(scene.shape, dtype=np.bool_)
            there[rows] = at.is_reached(scene.position[rows], scene.goal[rows])
            stop[there] = k + 1
            if journey.stop(k + 1) is not None:
                renewed |= there
            if at.moves:
                renewed |= rows & ~there
            if journey.stop(k + 1) is None and journey.then == "leave":
                active &= ~there
        on = scene.replace(active=active, memory={**scene.memory, STOP: stop})
        return self.aim(on, renewed & active, seeds, ids, holds)

    def aim(
        self,
        scene: Scene,
        who: Bools,
        seeds: Numbers,
        ids: Numbers,
        holds: Callable[[Floats], Bools] | None = None,
    ) -> Scene:
        """Return the scene in which the agents ``who`` ``[E, A]`` have their current waypoint as the goal."""
        if not np.any(who):
            return scene
        goal = scene.goal.copy()
        seed = np.broadcast_to(seeds[:, None], scene.shape)
        for number, k, at, mine in self._parties(scene, who):
            luck = PersonRandom(seed[mine], ids[mine], (STOP, number, k), holds)
            goal[mine] = at.goal(scene.position[mine], luck)
        return scene.replace(goal=goal)

    def uses_routing(self, scene: Scene) -> Bools:
        """Return ``[E, A]`` whether routing applies to the goal of an agent."""
        return self.walks_on_routes(scene) | ~np.greater(scene.active, scene.external)

    def walks_on_routes(self, scene: Scene) -> Bools:
        """Return ``[E, A]`` who walks to a goal to which routing applies."""
        shape = scene.shape
        out = np.empty(shape, dtype=np.bool_)
        memory = (dense(scene.memory[JOURNEY], shape, FLOAT), dense(scene.memory[STOP], shape, FLOAT))
        people = (dense(scene.active, shape, BOOL), dense(scene.external, shape, BOOL))
        routing_mask(self._rows, *memory, *people, out)
        return out

    @functools.cached_property
    def _rows(self) -> Any:
        """The table as a plain tuple: numba dispatches slowly on named tuples."""
        return tuple(self._table)

    @functools.cached_property
    def _table(self) -> WaypointTable:
        return WaypointTable.of([(journey.stops, journey.then) for journey in self.journeys])

    def _parties(self, scene: Scene, who: Bools | None = None) -> list[tuple[int, int, Waypoint, Bools]]:
        """Return the people on the way to each waypoint of each journey; empty groups are left out."""
        walking = np.greater(scene.active, scene.external)
        if who is not None:
            walking &= who
        parties = []
        for number, journey in enumerate(self.journeys):
            mine = walking & (scene.memory[JOURNEY] == number)
            for k in np.unique(scene.memory[STOP][mine]).astype(int).tolist():
                at = journey.stop(k)
                if at is not None:
                    parties.append((number, k, at, mine & (scene.memory[STOP] == k)))
        return parties
