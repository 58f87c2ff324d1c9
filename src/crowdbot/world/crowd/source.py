"""Sources: people who enter while the simulation runs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, did_you_mean
from crowdbot.typing import Floats

from .journey import WaypointSequence
from .waypoint import Zone, polygon_ring

Numbers = NDArray[np.int64]

TIMINGS = ("poisson", "regular")
TOP = 1.3
"""Maximum speed, as a multiple of the preferred one (Helbing & Molnar 1995)."""
MOST_RATE = 1e4


class Sampler(Protocol):
    """A probability distribution.

    With a method ``values_at(share)``, which returns the values at shares in [0, 1) of any shape, ``draw`` must return
    the values at numbers of ``rng.random``. Then several people are drawn together.
    """

    def draw(self, rng: np.random.Generator, count: int) -> Floats:
        """Return ``count`` samples, ``[count]``."""


@dataclass(frozen=True)
class PeopleSource:
    """A source of people: they arrive at a rate and enter at random positions of a zone.

    People wait outside in a queue (first in, first out) if there is no room or no free slot among the agents of the
    scene. The number of agents A is constant: a person takes the slot of an absent agent, with a new identity.

    Fields:
        zone: zone of entry.
        journey: sequence of waypoints.
        rate: arrival rate [people/s].
        timing: ``poisson`` (random) or ``regular`` (equal intervals, first arrival at ``begin``).
        begin, end: time of the first and last possible arrival [s].
        max_count: maximum number of people (default: no limit).
        speed: preferred speed [m/s], a number or a distribution.
        radius: radius [m], a number or a distribution.
        model: index of the crowd model in a mixture.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.world import Point
    >>> door = Zone(((0, 0), (1, 0), (1, 2), (0, 2)))
    >>> PeopleSource(door, WaypointSequence((Point(9.0, 1.0),)), rate=0.5, max_count=20).timing
    'poisson'
    """

    zone: Zone
    journey: WaypointSequence
    rate: float
    timing: str = "poisson"
    begin: float = 0.0
    end: float = math.inf
    max_count: int | None = None
    speed: float | Sampler = 1.34
    radius: float | Sampler = 0.25
    model: int = 0

    def __post_init__(self) -> None:
        polygon_ring(self.zone.points)
        if not 0.0 < self.rate <= MOST_RATE:
            raise InputError(f"PeopleSource: rate = {self.rate} people/s must be above 0 and at most {MOST_RATE:g}")
        if self.timing not in TIMINGS:
            near = did_you_mean(str(self.timing), TIMINGS)
            raise InputError(f"PeopleSource: timing {self.timing!r} is unknown{near}; choose {' or '.join(TIMINGS)}")
        if not (math.isfinite(self.begin) and self.begin < self.end):
            raise InputError(f"PeopleSource: begin = {self.begin} s must be finite and before end = {self.end} s")
        if self.max_count is not None and self.max_count < 0:
            raise InputError(f"PeopleSource: max_count = {self.max_count} people must be at least 0, or None")
        for name in ("speed", "radius"):
            value = getattr(self, name)
            if isinstance(value, int | float) and not 0.0 < value < math.inf:
                raise InputError(f"PeopleSource: {name} = {value} must be finite and above 0")
