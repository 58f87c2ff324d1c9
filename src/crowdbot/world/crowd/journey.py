"""Journeys: sequences of waypoints and their assignment to people."""

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
"""Names in the memory of a scene ``[E, A]``: index of the journey (-1 for none) and number of the current waypoint,
which keeps counting on a repeated journey.
"""
THENS = ("leave", "stay", "again")


@dataclass(frozen=True)
class WaypointSequence:
    """A sequence of waypoints that a person visits in order.

    Fields:
        stops: waypoints, at least one.
        then: action at the last waypoint: ``leave``, ``stay`` or start ``again``.

    Raises:
        InputError: there is no waypoint, or a value is not a waypoint.

    >>> from crowdbot.world import PointWaypoint, PolygonZone
    >>> WaypointSequence((PointWaypoint(5.0, 0.0), PolygonZone(((9, 0), (11, 0), (10, 1)))), then="stay").then
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
        return self.aim(scene.replace(memory=memory), which >= 0, seeds, ids, holds)

    def advance(
        self, scene: Scene, seeds: Numbers, ids: Numbers, holds: Callable[[Floats], Bools] | None = None
    ) -> Scene:
        """Return the scene after people who reached a waypoint have switched to the next one or left."""
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
        for number, k, at, rows in self._parties(scene):
            mine = rows & who
            if np.any(mine):
                luck = PersonRandom(seed[mine], ids[mine], (STOP, number, k), holds)
                goal[mine] = at.goal(scene.position[mine], luck)
        return scene.replace(goal=goal)

    def uses_routing(self, scene: Scene) -> Bools:
        """Return ``[E, A]`` whether routing applies to the goal of an agent."""
        out = np.ones(scene.shape, dtype=np.bool_)
        for _, _, at, rows in self._parties(scene):
            if not at.uses_routing:
                out[rows] = False
        return out

    def _parties(self, scene: Scene) -> list[tuple[int, int, Waypoint, Bools]]:
        """Return the people on the way to each waypoint of each journey; empty groups are left out."""
        walking = scene.active & ~scene.external
        found = []
        for number, journey in enumerate(self.journeys):
            mine = walking & (scene.memory[JOURNEY] == number)
            for k in np.unique(scene.memory[STOP][mine]).astype(int).tolist():
                at = journey.stop(k)
                if at is not None:
                    found.append((number, k, at, mine & (scene.memory[STOP] == k)))
        return found
