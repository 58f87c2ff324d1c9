"""The contract of the folder: a degradation makes of a recording what a tracker could have made of it."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import DataError, InputError, check_parameters, kebab_case, parameters, stream
from crowdbot.data.trajectories import Trajectories

__all__ = ["GHOST", "Degradation", "Degraded", "NobodySeen"]

GHOST = -1
"""Truth of a row that is nobody."""

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Bools = NDArray[np.bool_]


class NobodySeen(DataError):
    """Nothing is left of a recording."""


@dataclass(frozen=True, eq=False)
class Degraded:
    """A recording as it is seen, and who each of its rows truly is.

    Fields:
        tracks: what is seen.
        truth: ``[N]`` int64, the true id behind each row of ``tracks``; ``GHOST`` where there is nobody.

    Raises:
        DataError: there is not one truth a row.

    >>> tracks = Trajectories([7, 7], [0, 10], [0.0, 0.5], [2.0, 2.0], frame_rate=2.5)
    >>> seen = Degraded.of(tracks).renamed([7, 9])
    >>> seen.tracks.id.tolist(), seen.truth.tolist()
    ([7, 9], [7, 7])
    """

    tracks: Trajectories
    truth: Integers

    def __post_init__(self) -> None:
        if np.shape(self.truth) != (len(self.tracks),):
            raise DataError(f"{self.tracks.name} has {len(self.tracks)} rows, truth has shape {np.shape(self.truth)}")

    @classmethod
    def of(cls, tracks: Trajectories | Degraded) -> Degraded:
        """Return a recording in which everyone is who the ids say; one that is degraded already comes back as it is.

        Raises:
            DataError: somebody has the id -1, which here means nobody.
        """
        if isinstance(tracks, Degraded):
            return tracks
        if np.any(tracks.id == GHOST):
            raise DataError(f"{tracks.name} has a track of id {GHOST}, which stands for false tracks; give it another")
        return cls(tracks, tracks.id)

    @property
    def robot(self) -> Bools:
        """``[N]``, rows of robots: they know where they are, so nothing here touches them."""
        return np.isin(self.tracks.id, np.asarray(sorted(self.tracks.robots), dtype=np.int64))

    def moved(self, away: Floats) -> Degraded:
        """Return every row displaced by ``away`` ``[N, 2]`` [units]; robots stay."""
        away = np.where(self.robot[:, None], 0.0, away)
        return self._with(x=self.tracks.x + away[:, 0], y=self.tracks.y + away[:, 1])

    def kept(self, rows: Bools) -> Degraded:
        """Return the rows ``[N]`` that are still seen; those of robots always are.

        Raises:
            NobodySeen: no row is left.
        """
        rows = rows | self.robot
        if not np.any(rows):
            raise NobodySeen(f"{self.tracks.name}: nobody is seen any more, not one row is left; degrade it less")
        columns = {name: getattr(self.tracks, name)[rows] for name in ("id", "frame", "x", "y")}
        return self._with(**columns, truth=self.truth[rows])

    def renamed(self, id: ArrayLike) -> Degraded:
        """Return the rows under other ids ``[N]``."""
        return self._with(id=np.asarray(id, dtype=np.int64))

    def added(self, id: Integers, frame: Integers, position: Floats) -> Degraded:
        """Return the recording with more rows: ids ``[M]``, frames ``[M]`` and positions ``[M, 2]`` of ghosts."""
        own = self.tracks
        return self._with(
            id=np.concatenate([own.id, id]),
            frame=np.concatenate([own.frame, frame]),
            x=np.concatenate([own.x, position[:, 0]]),
            y=np.concatenate([own.y, position[:, 1]]),
            truth=np.concatenate([self.truth, np.full(len(id), GHOST, dtype=np.int64)]),
        )

    def _with(self, truth: Integers | None = None, **columns: Any) -> Degraded:
        own = self.tracks
        id, frame = columns.get("id", own.id), columns.get("frame", own.frame)
        order = np.lexsort((id, frame))  # the order in which Trajectories will put the rows
        here = {int(one) for one in np.unique(id)}
        tracks = dataclasses.replace(
            own,
            **columns,
            robots=own.robots & here,
            labels={one: label for one, label in own.labels.items() if one in here},
            scenes=tuple(scene for scene in own.scenes if scene.person in here),
        )
        return Degraded(tracks, (self.truth if truth is None else truth)[order])


@dataclass(frozen=True)
class Degradation(ABC):
    """What a tracker does to a recording; one of its parameters is the level that a sweep varies.

    What a degradation must hold to:
        It is a function of the recording, its parameters and the generator. At level 0 the recording comes back
        unchanged to the last bit (the contract sees to it). The same draws serve every level, so that a higher level
        is more of the same. Robots are not touched. Rows keep the frames of the recording.

    Class attributes:
        level: name of the parameter that is the level.
        levels: levels of a sweep when none are given.
        metric: whether its lengths need a recording in metres.
    """

    level: ClassVar[str]
    levels: ClassVar[tuple[float, ...]]
    metric: ClassVar[bool] = True

    def __post_init__(self) -> None:
        for row in parameters(self):
            if np.ndim(getattr(self, row.name)) != 0:
                raise InputError(f"{self.name}: {row.name} must be one number for the whole recording")
        check_parameters(self)
        if getattr(self, "probability", 0.0) > 1.0:
            raise InputError(f"{self.name}: probability = {getattr(self, 'probability')} must be at most 1")  # noqa: B009

    @property
    def name(self) -> str:
        """Name as on the command line."""
        return kebab_case(type(self).__name__)

    @property
    def unit(self) -> str:
        """Unit of the level."""
        return next(row.unit for row in parameters(self) if row.name == self.level)

    @property
    def neutral(self) -> bool:
        """Whether the recording comes back unchanged."""
        return bool(getattr(self, self.level) == 0)

    def __str__(self) -> str:
        """Return the name with every parameter."""
        return f"{self.name}({', '.join(f'{name}={value}' for name, value in self.told().items())})"

    def told(self, level: bool = True) -> dict[str, str]:
        """Return every parameter with its unit, in words; ``level=False`` leaves out the level."""
        units = {row.name: row.unit for row in parameters(self)}
        found = {}
        for field in dataclasses.fields(self):
            value, unit = getattr(self, field.name), units.get(field.name, "1")
            values = value if isinstance(value, tuple) else (value,)
            word = ",".join(f"{one:g}" if isinstance(one, float) else str(one) for one in values)
            found[field.name] = word if unit == "1" else f"{word} {unit}"
        return found if level else {name: word for name, word in found.items() if name != self.level}

    def at(self, level: float) -> Self:
        """Return the same degradation at another level.

        Raises:
            InputError: the level is not allowed.
        """
        return dataclasses.replace(self, **{self.level: level})

    def check(self, tracks: Trajectories) -> None:
        """Raise :class:`DataError` unless such a recording can be degraded."""
        if self.metric and tracks.units != "m":
            raise DataError(f"{tracks.name} is in pixels, {self.name} is in metres; turn it into metres first")

    def apply(self, tracks: Trajectories | Degraded, rng: np.random.Generator | None = None) -> Degraded:
        """Return the recording as it is seen.

        Args:
            tracks: a recording, or one that is degraded already.
            rng: source of randomness; None means ``stream(0, "degrade")``.

        Raises:
            DataError: this recording cannot be degraded so, or nothing is left of it.
        """
        seen = Degraded.of(tracks)
        if self.neutral:
            return seen
        self.check(seen.tracks)
        return self.degrade(seen, stream(0, "degrade") if rng is None else rng)

    @abstractmethod
    def degrade(self, seen: Degraded, rng: np.random.Generator) -> Degraded:
        """Return the recording as it is seen at a level above 0; see :meth:`apply`."""
