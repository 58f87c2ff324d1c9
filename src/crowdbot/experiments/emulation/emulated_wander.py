"""EmulatedWander: small deviations of a person from the intended place."""

from __future__ import annotations

import math

from crowdbot.core import stream

WANDER_TIME = 2.0
"""Correlation time [s]."""


class EmulatedWander:
    """A stationary Ornstein-Uhlenbeck process with a correlation time of 2 s.

    Args:
        spread: standard deviation [m].
        step: time step [s].
        seed: seed.
        name: name of the trial; each has its own deviations.

    >>> EmulatedWander(0.0, 0.1, 1, "walk").step()
    0.0
    """

    def __init__(self, spread: float, step: float, seed: int, name: str) -> None:
        self._rng = stream(seed, "wander", name)
        self._keep = math.exp(-step / WANDER_TIME)
        self._fresh = spread * math.sqrt(1.0 - self._keep * self._keep)
        self._value = 0.0

    def step(self) -> float:
        """Advance one step and return the deviation [m]."""
        self._value = self._keep * self._value + self._fresh * float(self._rng.standard_normal())
        return self._value
