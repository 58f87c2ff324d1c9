"""Chain: several degradations in sequence."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from crowdbot.core import InputError, stream
from crowdbot.data.trajectories import Trajectories

from .degradation import Degradation, DegradedTracks


@dataclass(frozen=True)
class Chain:
    """Degradations applied in order, each with its own random stream; the level is that of the first.

    Fields:
        links: at least one degradation.

    >>> from crowdbot.data.degrade import GaussianNoise, LateStart
    >>> str(Chain((LateStart(2), GaussianNoise(0.1))))
    'late-start(rows=2 rows) + gaussian-noise(sd=0.1 m)'
    """

    links: tuple[Degradation, ...]

    def __post_init__(self) -> None:
        if not self.links:
            raise InputError("a chain of degradations needs at least one")

    @property
    def name(self) -> str:
        """Names of the links, joined by ``+``."""
        return "+".join(link.name for link in self.links)

    @property
    def level(self) -> str:
        """Name of the parameter that is the level."""
        return self.links[0].level

    @property
    def levels(self) -> Sequence[float]:
        """Levels of a sweep when none are given."""
        return self.links[0].levels

    @property
    def unit(self) -> str:
        """Unit of the level."""
        return self.links[0].unit

    @property
    def neutral(self) -> bool:
        """Whether the recording is unchanged."""
        return all(link.neutral for link in self.links)

    def __str__(self) -> str:
        """Return the links with every parameter."""
        return " + ".join(map(str, self.links))

    def describe(self, level: bool = True) -> dict[str, str]:
        """Return every parameter with its unit as text, see :meth:`Degradation.describe`."""
        words = [(link, link.describe(level or number > 0)) for number, link in enumerate(self.links)]
        return {f"{link.name}.{name}": word for link, values in words for name, word in values.items()}

    def at(self, level: float) -> Self:
        """Return the same chain with the first link at another level."""
        return dataclasses.replace(self, links=(self.links[0].at(level), *self.links[1:]))

    def check(self, tracks: Trajectories) -> None:
        """Raise :class:`DataError` unless the recording can be degraded."""
        for link in self.links:
            link.check(tracks)

    def apply(self, tracks: Trajectories | DegradedTracks, rng: np.random.Generator | None = None) -> DegradedTracks:
        """Return the degraded recording, see :meth:`Degradation.apply`."""
        source = stream(0, "degrade") if rng is None else rng
        seen = DegradedTracks.of(tracks)
        for link, seed in zip(self.links, source.integers(0, 2**63, size=len(self.links)), strict=True):
            seen = link.apply(seen, np.random.Generator(np.random.PCG64(int(seed))))
        return seen
