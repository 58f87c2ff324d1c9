"""Waypoints: goals of people and the conditions of arrival."""

from __future__ import annotations

import functools
import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, kernel
from crowdbot.core.fields import Points, attribute, check
from crowdbot.typing import Bools, Floats

from .agent_arrays import FLOAT, dense
from .person_random import uniform

Numbers = NDArray[np.int64]

AHEAD = 1000.0
"""Distance [m] of the goal of a direction."""
TOLERANCE = 0.3
"""Distance [m] from a goal at which a person has arrived."""
TRIES = 5000
"""Points of the bounding box to try; a zone that none of them hits is too thin."""


@dataclass(frozen=True)
class PersonRandom:
    """Random numbers of each person, reproducible by seed, identity and purpose.

    Fields:
        seed, person: seed of the environment and identity of the person, ``[N]``.
        path: purpose of the number.
        holds: returns whether points ``[N, 2]`` have room for a body (default: all have).
    """

    seed: Numbers
    person: Numbers
    path: tuple[str | int, ...] = ()
    holds: Callable[[Floats], Bools] | None = None

    def draw(self, *more: str | int) -> Floats:
        """Return a number in [0, 1) for each person."""
        return uniform(self.seed, self.person, *self.path, *more)


@dataclass(frozen=True)
class Waypoint(ABC):
    """A goal of people with a condition of arrival."""

    uses_routing: ClassVar[bool] = True
    """Whether routing applies to it."""

    @property
    def moves(self) -> bool:
        """Whether the goal depends on the position of the person."""
        return False

    @property
    def wait(self) -> float:
        """Time for which a person stays after the arrival [s]."""
        return 0.0

    @abstractmethod
    def goal(self, place: Floats, luck: PersonRandom) -> Floats:
        """Return the goals ``[N, 2]`` [m] of people at ``place`` ``[N, 2]`` [m]."""

    @abstractmethod
    def is_reached(self, place: Floats, goal: Floats) -> Bools:
        """Return ``[N]``, whether each person is there."""


@dataclass(frozen=True)
class Point(Waypoint):
    """A stop at a point.

    >>> goal = np.array([[1.0, 2.0], [1.0, 2.0]])
    >>> Point(1.0, 2.0).is_reached(np.array([[1.0, 1.8], [1.0, 1.0]]), goal).tolist()
    [True, False]
    """

    x: float = attribute(about="x coordinate", unit="m")
    y: float = attribute(about="y coordinate", unit="m")
    tolerance: float = attribute(TOLERANCE, about="arrival tolerance", unit="m", exclusive_min=0.0)
    wait: float = attribute(
        0.0, about="time for which people stay after their arrival", unit="s", min=0.0, max=86_400.0
    )

    def __post_init__(self) -> None:
        check(self)

    def goal(self, place: Floats, luck: PersonRandom) -> Floats:
        return np.tile([float(self.x), float(self.y)], (len(place), 1))

    def is_reached(self, place: Floats, goal: Floats) -> Bools:
        return _within(place, goal, self.tolerance)


@dataclass(frozen=True)
class Direction(Waypoint):
    """A direction to walk in without end: the last stop of a journey. Routing does not apply to it.

    >>> Direction(0.0).is_reached(np.zeros((1, 2)), np.ones((1, 2))).tolist()
    [False]
    """

    uses_routing: ClassVar[bool] = False
    heading: float = attribute(about="counter-clockwise from +x", unit="rad", min=-2.0 * math.pi, max=2.0 * math.pi)

    def __post_init__(self) -> None:
        check(self)

    @property
    def moves(self) -> bool:
        return True

    def goal(self, place: Floats, luck: PersonRandom) -> Floats:
        return np.asarray(place + np.array(self.ahead))

    @property
    def ahead(self) -> tuple[float, float]:
        """Vector from a person to the goal [m]."""
        return AHEAD * math.cos(self.heading), AHEAD * math.sin(self.heading)

    def is_reached(self, place: Floats, goal: Floats) -> Bools:
        return np.zeros(len(place), dtype=np.bool_)


def polygon_ring(points: Points) -> Floats:
    """Return the corners ``[N, 2]`` [m] of a zone.

    Raises:
        InputError: the area is 0.
    """
    ring = np.array(points, dtype=np.float64)
    area = 0.5 * abs(float(np.sum(ring[:, 0] * np.roll(ring[:, 1], -1) - np.roll(ring[:, 0], -1) * ring[:, 1])))
    if area < 1e-6:
        raise InputError(f"the corners {ring.tolist()} of a zone enclose {area:g} m2, the area must be above 0")
    return ring


@dataclass(frozen=True)
class Zone(Waypoint):
    """A stop in a polygon.

    It is reached inside, or within the tolerance of the person's own goal in it.

    Raises:
        InputError: a value is not allowed, or the area is 0 (when it is used).

    >>> hall = Zone(((4.0, 0.0), (6.0, 0.0), (6.0, 3.0), (4.0, 3.0)))
    >>> hall.goal(np.array([[0.0, 1.0], [5.0, 2.0]]), PersonRandom(np.zeros(2, int), np.arange(2))).tolist()
    [[4.0, 1.0], [5.0, 2.0]]
    """

    points: Points = attribute(about="corners x,y of the zone", unit="m", points=3)
    aim: str = attribute(
        "nearest",
        about="target in the zone: its nearest point, or a random point per person",
        choices=("nearest", "random"),
    )
    tolerance: float = attribute(TOLERANCE, about="arrival tolerance of the random point", unit="m", exclusive_min=0.0)
    wait: float = attribute(
        0.0, about="time for which people stay after their arrival", unit="s", min=0.0, max=86_400.0
    )

    def __post_init__(self) -> None:
        check(self)

    @functools.cached_property
    def ring(self) -> Floats:
        """Corners ``[N, 2]`` [m]."""
        return polygon_ring(self.points)

    @property
    def moves(self) -> bool:
        return self.aim == "nearest"

    def goal(self, place: Floats, luck: PersonRandom) -> Floats:
        if self.aim == "random":
            return self.sample(luck)
        out = np.empty((len(place), 2))
        _nearest_points(self.ring, dense(place, (len(place), 2), FLOAT), out)
        return out

    def is_reached(self, place: Floats, goal: Floats) -> Bools:
        return self.contains(place) | _within(place, goal, self.tolerance)

    def contains(self, place: Floats) -> Bools:
        """Return ``[N]`` whether points ``[N, 2]`` [m] lie in the zone."""
        inside = np.empty(len(place), dtype=np.bool_)
        _contain(self.ring, dense(place, (len(place), 2), FLOAT), inside)
        return inside

    def sample(self, luck: PersonRandom) -> Floats:
        """Return a random free point of the zone for each person, ``[N, 2]`` [m].

        Raises:
            InputError: no free point was found.
        """
        low = self.ring.min(axis=0)
        size = self.ring.max(axis=0) - low
        points = np.zeros((len(luck.person), 2))
        missing = np.arange(len(points))
        for k in range(TRIES):
            if len(missing) == 0:
                return points
            some = PersonRandom(luck.seed[missing], luck.person[missing], luck.path)
            found = low + size * np.stack([some.draw(k, "x"), some.draw(k, "y")], axis=-1)
            good = self.contains(found)
            if luck.holds is not None and np.any(good):
                good[good] = luck.holds(found[good])
            points[missing[good]] = found[good]
            missing = missing[~good]
        raise InputError(f"Zone: no free position for a body was found in the zone with corners {list(self.points)}")


@kernel
def is_inside(ring: Floats, x: float, y: float) -> bool:
    """Return whether a point is in the polygon with corners ``[N, 2]`` (even-odd rule)."""
    inside = False
    for k in range(len(ring)):
        after = k + 1 if k + 1 < len(ring) else 0
        ax, ay, bx, by = ring[k, 0], ring[k, 1], ring[after, 0], ring[after, 1]
        if ay != by and (ay > y) != (by > y) and x < ax + (bx - ax) * ((y - ay) / (by - ay)):
            inside = not inside
    return inside


@kernel
def nearest_point(ring: Floats, x: float, y: float) -> tuple[float, float]:
    """Return the point of a polygon, border or interior, nearest to x, y."""
    found_x, found_y, best = x, y, math.inf
    if is_inside(ring, x, y):
        return found_x, found_y
    for k in range(len(ring)):
        after = k + 1 if k + 1 < len(ring) else 0
        ax, ay = ring[k, 0], ring[k, 1]
        ex, ey = ring[after, 0] - ax, ring[after, 1] - ay
        along = ((x - ax) * ex + (y - ay) * ey) / max(ex * ex + ey * ey, 1e-300)
        along = min(max(along, 0.0), 1.0)
        px, py = ax + along * ex, ay + along * ey
        away = (x - px) * (x - px) + (y - py) * (y - py)
        if away < best:
            found_x, found_y, best = px, py, away
    return found_x, found_y


@kernel
def _contain(ring: Floats, place: Floats, out: Bools) -> None:
    for row in range(len(place)):
        out[row] = is_inside(ring, place[row, 0], place[row, 1])


@kernel
def _nearest_points(ring: Floats, place: Floats, out: Floats) -> None:
    for row in range(len(place)):
        out[row, 0], out[row, 1] = nearest_point(ring, place[row, 0], place[row, 1])


def _within(place: Floats, goal: Floats, distance: float) -> Bools:
    return np.asarray((place[:, 0] - goal[:, 0]) ** 2 + (place[:, 1] - goal[:, 1]) ** 2 < distance * distance)
