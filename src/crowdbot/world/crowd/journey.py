"""JourneyAssignment: where people go, one stop after the other, and what they do at the end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, did_you_mean

from .waypoint import PersonRandom, Waypoint

__all__ = ["JOURNEY", "STOP", "JourneyAssignment", "WaypointSequence"]

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]
Bools = NDArray[np.bool_]

JOURNEY, STOP = "journey", "stop"
"""Names in the memory of a scene ``[E, A]``: the index of the journey, -1 for none, and the number of the stop one
goes to; on a journey that begins again it counts on."""
THENS = ("leave", "stay", "again")


@dataclass(frozen=True)
class WaypointSequence:
    """Stops that one person after the other goes to, in order.

    Fields:
        stops: at least one.
        then: at the last one people ``leave`` or ``stay``, or begin ``again``.

    Raises:
        InputError: there is no stop, or something is none.

    >>> from crowdbot.world import PointWaypoint, PolygonZone
    >>> WaypointSequence((PointWaypoint(5.0, 0.0), PolygonZone(((9, 0), (11, 0), (10, 1)))), then="stay").then
    'stay'
    """

    stops: tuple[Waypoint, ...]
    then: str = "leave"

    def __post_init__(self) -> None:
        object.__setattr__(self, "stops", tuple(self.stops))
        if not self.stops or not all(isinstance(stop, Waypoint) for stop in self.stops):
            raise InputError(f"WaypointSequence: stops = {self.stops!r}, it must be one or more waypoints")
        if self.then not in THENS:
            raise InputError(
                f"WaypointSequence: then = {self.then!r}{did_you_mean(str(self.then), THENS)};"
                " choose leave, stay or again"
            )

    def stop(self, number: int) -> Waypoint | None:
        """Return the stop that is this many stops after the first; None when there is none."""
        if self.then == "again":
            return self.stops[number % len(self.stops)]
        return self.stops[number] if number < len(self.stops) else None


@dataclass(frozen=True)
class JourneyAssignment:
    """The journeys of a crowd.

    Fields:
        journeys: on one of which people are.
        which: ``[A]`` or ``[E, A]`` int: its index, -1 for whoever keeps the goal of the scene.

    Raises:
        InputError: an index is not that of a journey.

    >>> from crowdbot.world import PointWaypoint
    >>> paths = [WaypointSequence((PointWaypoint(x, 5.0),)) for x in (0.0, 9.0)]
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
                " or -1 for none"
            )

    def start(
        self, scene: Scene, seeds: Numbers, ids: Numbers, holds: Callable[[Floats], Bools] | None = None
    ) -> Scene:
        """Return the scene in which everybody is on the way to the first stop.

        Args:
            scene: at the beginning.
            seeds: ``[E]``.
            ids: ``[E, A]`` who people are.
            holds: whether a body has room at points ``[N, 2]``.
        """
        try:
            which = np.broadcast_to(np.asarray(self.which, dtype=np.float64), scene.shape).copy()
        except ValueError:
            raise InputError(
                f"JourneyAssignment: which has shape {list(np.shape(self.which))}, it must fit {list(scene.shape)}"
            ) from None
        memory = {**scene.memory, JOURNEY: which, STOP: np.zeros(scene.shape)}
        return self.aim(scene.replace(memory=memory), which >= 0, seeds, ids, holds)

    def advance(
        self, scene: Scene, seeds: Numbers, ids: Numbers, holds: Callable[[Floats], Bools] | None = None
    ) -> Scene:
        """Return the scene in which whoever has reached a stop is on the way to the next, or has left."""
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
        """Return the scene in which those ``who`` ``[E, A]`` have the goal of their stop."""
        if not np.any(who):
            return scene
        goal = scene.goal.copy()
        seed = np.broadcast_to(seeds[:, None], scene.shape)
        for number, k, at, rows in self._parties(scene):
            mine = rows & who
            if np.any(mine):
                luck = PersonRandom(seed[mine], ids[mine], (STOP, number, k), holds)
                goal[mine] = at.goal(scene.position[mine], luck)
        return scene.replace(goal=goal)

    def uses_routing(self, scene: Scene) -> Bools:
        """Return ``[E, A]`` whom a router may lead."""
        out = np.ones(scene.shape, dtype=np.bool_)
        for _, _, at, rows in self._parties(scene):
            if not at.uses_routing:
                out[rows] = False
        return out

    def _parties(self, scene: Scene) -> list[tuple[int, int, Waypoint, Bools]]:
        """Return for every journey and stop who is on the way there, where somebody is."""
        walking = scene.active & ~scene.external
        found = []
        for number, journey in enumerate(self.journeys):
            mine = walking & (scene.memory[JOURNEY] == number)
            for k in np.unique(scene.memory[STOP][mine]).astype(int).tolist():
                at = journey.stop(k)
                if at is not None:
                    found.append((number, k, at, mine & (scene.memory[STOP] == k)))
        return found
