"""The toy set of the report: people come from six places on a circle, and each may go on in three ways."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.prediction import Samples

__all__ = ["ToyData"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ToyData:
    """The toy set: who is seen walking towards the middle goes on straight or turns off to one side.

    The rows of a track lie on circles of falling radius. Those that are seen are the same for all of a group; a later
    row is turned about the middle by the angle of the mode and by an even jitter.

    Fields:
        groups: places on the circle, evenly around.
        modes: angles [rad] by which the later rows of a mode are turned, one for each mode.
        radii: radius of each row [m].
        observe: how many of the rows are seen.
        jitter: half width [rad] of the even jitter of each later row.
        tracks: for each mode of each group.

    Report: CROWDBOT D4.2, figure 14; the values are those of its published code, 768 tracks rounded to even modes.

    Raises:
        InputError: the numbers do not fit together.

    >>> ToyData().paths(np.random.default_rng(0), 5).shape
    (6, 3, 5, 4, 2)
    """

    groups: int = 6
    modes: tuple[float, ...] = (-math.radians(16.0), 0.0, math.radians(16.0))
    radii: tuple[float, ...] = (1.0, 0.75, 0.5, 0.25)
    observe: int = 2
    jitter: tuple[float, ...] = (math.radians(2.0), math.radians(3.0))
    tracks: int = 43

    def __post_init__(self) -> None:
        if self.groups < 1 or not self.modes or self.tracks < 1:
            raise InputError("toy set: groups, modes and tracks must be at least 1")
        if not 2 <= self.observe < len(self.radii) or len(self.jitter) != len(self.radii) - self.observe:
            raise InputError(
                f"toy set: {self.observe} of {len(self.radii)} rows are seen and {len(self.jitter)} later ones have a"
                " jitter; at least two must be seen, and every later one needs its own"
            )

    @property
    def predict(self) -> int:
        """Number of rows that are predicted."""
        return len(self.radii) - self.observe

    def paths(self, rng: np.random.Generator, tracks: int) -> Floats:
        """Draw tracks ``[groups, modes, tracks, rows, 2]`` [m]."""
        jitter = rng.uniform(-1.0, 1.0, (self.groups, len(self.modes), tracks, self.predict)) * np.array(self.jitter)
        return self._turned(jitter + np.array(self.modes)[:, None, None])

    def middles(self) -> Floats:
        """Return the middle of every mode ``[groups, modes, rows, 2]`` [m]."""
        zero = np.zeros((self.groups, len(self.modes), 1, self.predict))
        return self._turned(zero + np.array(self.modes)[:, None, None])[:, :, 0]

    def samples(self, rng: np.random.Generator) -> Samples:
        """Return a drawn set as samples to learn from: every track is a scene with one person."""
        position = self.paths(rng, self.tracks).reshape(-1, len(self.radii), 2)
        count = len(position)
        return Samples(
            position=position,
            there=np.ones((count, len(self.radii)), dtype=bool),
            scored=np.ones(count, dtype=bool),
            first=np.arange(count + 1),
            source=np.zeros(count, dtype=np.int64),
            names=("toy",),
            observe=self.observe,
            dt=1.0,
        )

    def _turned(self, later: Floats) -> Floats:
        """Return the tracks whose later rows are turned by angles ``[groups, modes, N, predict]`` [rad]."""
        begin = 2.0 * np.pi * np.arange(self.groups) / self.groups
        turn = np.concatenate([np.zeros((*later.shape[:3], self.observe)), later], axis=-1)
        angle = begin[:, None, None, None] + turn
        return np.asarray(np.array(self.radii)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1))
