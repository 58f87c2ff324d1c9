"""Toy data of the report: people start at six places on a circle, and each continues in one of three directions."""

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
    """Toy data: people walk towards the center, then continue straight or turn to one side.

    The rows of a track lie on circles of decreasing radius. The observed rows are the same for all tracks of a group;
    later rows are rotated about the center by the angle of the mode and a uniform jitter.

    Fields:
        groups: number of start places, evenly spaced on the circle.
        modes: rotation of the later rows [rad], one for each mode.
        radii: radius of each row [m].
        observe: number of observed rows.
        jitter: half width of the uniform jitter of each later row [rad].
        tracks: number of tracks for each mode of each group.

    Report: CROWDBOT D4.2, figure 14; the values are those of its published code, 768 tracks rounded to even modes.

    Raises:
        InputError: a value is not allowed.

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
            raise InputError("toy data: groups, modes and tracks must be at least 1")
        if not 2 <= self.observe < len(self.radii) or len(self.jitter) != len(self.radii) - self.observe:
            raise InputError(
                f"toy data: {self.observe} of {len(self.radii)} rows are observed and {len(self.jitter)} later rows"
                " have a jitter; at least two rows must be observed, and each later row needs a jitter"
            )

    @property
    def predict(self) -> int:
        """Number of predicted rows."""
        return len(self.radii) - self.observe

    def paths(self, rng: np.random.Generator, tracks: int) -> Floats:
        """Draw tracks ``[groups, modes, tracks, rows, 2]`` [m]."""
        jitter = rng.uniform(-1.0, 1.0, (self.groups, len(self.modes), tracks, self.predict)) * np.array(self.jitter)
        return self._rotate(jitter + np.array(self.modes)[:, None, None])

    def middles(self) -> Floats:
        """Return the center of every mode ``[groups, modes, rows, 2]`` [m]."""
        zero = np.zeros((self.groups, len(self.modes), 1, self.predict))
        return self._rotate(zero + np.array(self.modes)[:, None, None])[:, :, 0]

    def samples(self, rng: np.random.Generator) -> Samples:
        """Return drawn tracks as training samples; every track is a scene with one person."""
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

    def _rotate(self, later: Floats) -> Floats:
        """Return the tracks with later rows rotated by angles ``[groups, modes, N, predict]`` [rad]."""
        begin = 2.0 * np.pi * np.arange(self.groups) / self.groups
        turn = np.concatenate([np.zeros((*later.shape[:3], self.observe)), later], axis=-1)
        angle = begin[:, None, None, None] + turn
        return np.asarray(np.array(self.radii)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1))
