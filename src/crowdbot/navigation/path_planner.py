"""PathPlanner: shortest paths of a robot around the walls of a stage."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, Walls, check_number
from crowdbot.typing import Floats
from crowdbot.world import Router

MARGIN = 0.1
"""Default distance [m] between a robot on its path and the walls."""
COLUMNS = 9
"""Numbers of the state of a path; NaN before it is planned."""
BENT, NARROW = 8, 2.0
"""Column of the state of a path that is at least this number for a path of half of the width."""
MOST_POINTS = 10_000
"""Largest number of points of a path."""


class Waypoints(NamedTuple):
    """The next points of the paths of N robots."""

    point: Floats
    """``[N, 2]`` [m], in sight of the robot; NaN where there is no path."""
    path: Floats
    """``[N, 9]`` state of the paths, an argument of the next call; plain numbers that can be copied."""
    failures: dict[int, InputError]
    """Robots without a path, by index 0 to N - 1."""


@dataclass(frozen=True)
class _EqualWalls:
    """Walls that are equal if their edges are."""

    edges: tuple[bytes, ...]
    walls: Walls = field(compare=False, repr=False)


@functools.lru_cache(maxsize=16)
def _shared(equal: _EqualWalls, radius: float, margin: float, half_width: float | None) -> PathPlanner:
    return PathPlanner.of(equal.walls, radius, margin, half_width)


@dataclass(frozen=True, eq=False)
class PathPlanner:
    """Shortest paths for a robot among walls, computed once for a stage; see :meth:`of`.

    Paths consist of straight lines between points near the corners of walls (visibility graph). People are no
    obstacles: avoiding them is the task of the navigator. Where the circumscribed disc of the robot has no path, the
    path keeps half of the width of the robot from the walls: the outline passes along a straight line, and the
    navigator checks its turns.

    Fields:
        radius: radius of the robot [m].
        margin: distance between a robot on its path and the walls [m].
        walls: the walls.
        half_width: half of the width of the robot across its forward axis [m]; ``radius`` for a disc.

    >>> planner = PathPlanner.of([[(2.0, -3.0), (2.0, 1.0)]], radius=0.3, margin=0.1)
    >>> planner.waypoints((0.0, 0.0), (4.0, 0.0)).round(2).tolist()
    [[1.83, 1.4], [2.17, 1.4], [4.0, 0.0]]
    """

    radius: float
    margin: float
    walls: Walls = field(repr=False)
    _router: Router = field(repr=False)
    half_width: float
    _narrow: Router | None = field(default=None, repr=False)

    @classmethod
    def of(
        cls, walls: Walls | ArrayLike, radius: float, margin: float = MARGIN, half_width: float | None = None
    ) -> PathPlanner:
        """Create the planner of a robot from walls (anything that :meth:`crowdbot.core.Walls.of` takes).

        Raises:
            InputError: a value is out of its range, or no space between the walls is wide enough.
        """
        check_number("PathPlanner", "radius", radius, "m", exclusive_min=0.0)
        check_number("PathPlanner", "margin", margin, "m", min=0.0)
        rings = Walls.of(walls)  # type: ignore[arg-type]
        half_width = radius if half_width is None else half_width
        check_number("PathPlanner", "half_width", half_width, "m", exclusive_min=0.0)
        if half_width >= radius:
            return cls(radius, margin, rings, Router.of(rings, radius + margin), radius)
        narrow = Router.of(rings, half_width + margin)
        try:
            return cls(radius, margin, rings, Router.of(rings, radius + margin), half_width, narrow)
        except InputError:  # the disc fits nowhere
            return cls(radius, margin, rings, narrow, half_width)

    @classmethod
    def for_stage(
        cls, walls: Walls, radius: float, margin: float = MARGIN, half_width: float | None = None
    ) -> PathPlanner:
        """Return the planner of :meth:`of`, computed once for equal walls, radius, margin and half of the width.

        Raises:
            InputError: as :meth:`of`.

        >>> walls = Walls.of([[(0.0, 0.0), (2.0, 0.0)]])
        >>> PathPlanner.for_stage(walls, 0.3) is PathPlanner.for_stage(Walls.of([[(0.0, 0.0), (2.0, 0.0)]]), 0.3)
        True
        """
        edges = (walls.start, walls.end, walls.previous, walls.next, walls.convex)
        return _shared(_EqualWalls(tuple(part.tobytes() for part in edges), walls), radius, margin, half_width)

    def waypoints(self, position: ArrayLike, goal: ArrayLike) -> Floats:
        """Return the points ``[K, 2]`` [m] of the shortest path after the position; the last point is the goal.

        Args:
            position, goal: x, y [m].

        Raises:
            InputError: there is no path, or a number is not finite.
        """
        here, end = np.array(position, dtype=np.float64), np.array(goal, dtype=np.float64)
        if here.shape != (2,) or end.shape != (2,):
            raise InputError(
                f"PathPlanner: position and goal have shapes {list(here.shape)} and {list(end.shape)}, they must be [2]"
            )
        points: list[Floats] = []
        path: Floats | None = None
        while not points or np.any(points[-1] != end):
            if len(points) == MOST_POINTS:
                raise InputError(f"PathPlanner: the path has more than {MOST_POINTS} points")
            next_waypoints = self.next_waypoints(here[None], end[None], path)
            for error in next_waypoints.failures.values():
                raise error
            here, path = next_waypoints.point[0], next_waypoints.path
            points.append(here)
        return np.array(points)

    def next_waypoints(self, position: Floats, goal: Floats, path: Floats | None = None) -> Waypoints:
        """Return the next points of the paths of N robots; following an existing path is fast.

        A path bends to the next point as soon as it is in sight. If the goal is in sight, it is the next point.

        Args:
            position, goal: ``[N, 2]`` [m].
            path: ``[N, 9]`` state from the previous call; None plans new paths. A robot that left its path, or whose
                goal moved, gets a new one.

        A robot without a path is a failure of its own; the others are not affected.
        """
        place, aim = np.asarray(position, dtype=np.float64), np.asarray(goal, dtype=np.float64)
        if place.ndim != 2 or place.shape[1] != 2 or aim.shape != place.shape:
            raise InputError(
                f"PathPlanner: position and goal have shapes {list(place.shape)} and {list(aim.shape)}, they must be"
                " equal and [N, 2]"
            )
        try:
            return self._follow(place, aim, path)
        except InputError:
            return self._follow_each(place, aim, path)

    def _follow(self, place: Floats, aim: Floats, path: Floats | None) -> Waypoints:
        if not (np.all(np.isfinite(place)) and np.all(np.isfinite(aim))):
            raise InputError(f"PathPlanner: a position or goal is not finite: {place.tolist()} to {aim.tolist()}")
        narrow = np.zeros(len(place), np.bool_) if path is None else path[:, BENT] >= NARROW
        if self._narrow is None or not narrow.any():
            ways = self._router.follow(place[:, None], aim[:, None], None if path is None else path[:, None])
            return Waypoints(ways.subgoal[:, 0], ways.way[:, 0], {})
        if not narrow.all():
            return self._follow_each(place, aim, path)
        return self._follow_narrow(place, aim, path)

    def _follow_narrow(self, place: Floats, aim: Floats, path: Floats | None) -> Waypoints:
        """Follow paths on which half of the width of the robot fits."""
        assert self._narrow is not None
        known = None
        if path is not None:
            known = path.copy()
            known[:, BENT] -= NARROW
        ways = self._narrow.follow(place[:, None], aim[:, None], None if known is None else known[:, None])
        rows = ways.way[:, 0].copy()
        rows[:, BENT] += NARROW
        return Waypoints(ways.subgoal[:, 0], rows, {})

    def _follow_each(self, place: Floats, aim: Floats, path: Floats | None) -> Waypoints:
        """Follow the paths one by one, since one of them fails, or some are narrow."""
        N = len(place)
        waypoints = Waypoints(
            np.full((N, 2), np.nan), np.full((N, COLUMNS), np.nan) if path is None else path.copy(), {}
        )
        for k in range(N):
            try:
                one = self._follow_one(place[k : k + 1], aim[k : k + 1], None if path is None else path[k : k + 1])
                waypoints.point[k], waypoints.path[k] = one.point[0], one.path[0]
            except InputError as error:
                waypoints.failures[k] = InputError(f"PathPlanner: no path: {error}")
        return waypoints

    def _follow_one(self, place: Floats, aim: Floats, path: Floats | None) -> Waypoints:
        """Follow a path ``[1, ...]``: of the disc, or where it has none, of half of the width."""
        try:
            return self._follow(place, aim, path)
        except InputError:
            if self._narrow is None or (path is not None and path[0, BENT] >= NARROW):
                raise
            return self._follow_narrow(place, aim, None)
