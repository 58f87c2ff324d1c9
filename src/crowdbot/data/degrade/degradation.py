"""Degradation: contract of tracking errors that are added to a recording."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import DataError, InputError, check_parameters, kebab_case, parameters, stream
from crowdbot.data.trajectories import Trajectories
from crowdbot.typing import Bools, Floats, Ints

GHOST = -1
"""True id of rows of false tracks."""


class EmptyRecordingError(DataError):
    """A degraded recording has no rows."""


@dataclass(frozen=True, eq=False)
class DegradedTracks:
    """A degraded recording and the true id of each row.

    Fields:
        tracks: the degraded recording.
        truth: ``[N]`` int64, true id of each row of ``tracks``; ``GHOST`` for false tracks.

    Raises:
        DataError: ``truth`` is not ``[N]``.

    >>> tracks = Trajectories([7, 7], [0, 10], [0.0, 0.5], [2.0, 2.0], row_rate=2.5)
    >>> seen = DegradedTracks.of(tracks).relabel([7, 9])
    >>> seen.tracks.id.tolist(), seen.truth.tolist()
    ([7, 9], [7, 7])
    """

    tracks: Trajectories
    truth: Ints

    def __post_init__(self) -> None:
        if np.shape(self.truth) != (len(self.tracks),):
            raise DataError(f"{self.tracks.name} has {len(self.tracks)} rows, truth has shape {np.shape(self.truth)}")

    @classmethod
    def of(cls, tracks: Trajectories | DegradedTracks) -> DegradedTracks:
        """Return a recording with its ids as truth; a degraded recording is returned unchanged.

        Raises:
            DataError: a track has the id -1, which is reserved for false tracks.
        """
        if isinstance(tracks, DegradedTracks):
            return tracks
        if np.any(tracks.id == GHOST):
            raise DataError(f"{tracks.name} has a track of id {GHOST}, which is reserved for false tracks; change it")
        return cls(tracks, tracks.id)

    @property
    def robot(self) -> Bools:
        """``[N]`` bool, rows of robots; degradations do not change them."""
        return np.isin(self.tracks.id, np.asarray(sorted(self.tracks.robots), dtype=np.int64))

    def displace(self, away: Floats) -> DegradedTracks:
        """Return the recording with rows displaced by ``away`` ``[N, 2]`` [units], except robots."""
        away = np.where(self.robot[:, None], 0.0, away)
        return self._with(x=self.tracks.x + away[:, 0], y=self.tracks.y + away[:, 1])

    def keep_rows(self, rows: Bools) -> DegradedTracks:
        """Return the recording with the rows of the mask ``[N]`` and all rows of robots.

        Raises:
            EmptyRecordingError: no rows are left.
        """
        rows = rows | self.robot
        if not np.any(rows):
            raise EmptyRecordingError(f"{self.tracks.name}: no rows are left after degradation; lower its level")
        columns = {name: getattr(self.tracks, name)[rows] for name in ("id", "frame", "x", "y")}
        return self._with(**columns, truth=self.truth[rows])

    def relabel(self, id: ArrayLike) -> DegradedTracks:
        """Return the recording with other ids ``[N]``."""
        return self._with(id=np.asarray(id, dtype=np.int64))

    def add_false_rows(self, id: Ints, frame: Ints, position: Floats) -> DegradedTracks:
        """Return the recording with rows of false tracks: ids ``[M]``, frames ``[M]`` and positions ``[M, 2]``."""
        own = self.tracks
        return self._with(
            id=np.concatenate([own.id, id]),
            frame=np.concatenate([own.frame, frame]),
            x=np.concatenate([own.x, position[:, 0]]),
            y=np.concatenate([own.y, position[:, 1]]),
            truth=np.concatenate([self.truth, np.full(len(id), GHOST, dtype=np.int64)]),
        )

    def _with(self, truth: Ints | None = None, **columns: Any) -> DegradedTracks:
        own = self.tracks
        id, frame = columns.get("id", own.id), columns.get("frame", own.frame)
        order = np.lexsort((id, frame))  # the order in which Trajectories will put the rows
        here = {int(item) for item in np.unique(id)}
        tracks = dataclasses.replace(
            own,
            **columns,
            robots=own.robots & here,
            labels={item: label for item, label in own.labels.items() if item in here},
            scenes=tuple(scene for scene in own.scenes if scene.person in here),
        )
        return DegradedTracks(tracks, (self.truth if truth is None else truth)[order])


@dataclass(frozen=True)
class Degradation(ABC):
    """A kind of tracking error; one of its parameters is the level that a sweep varies.

    Requirements:
        It is a function of the recording, its parameters and the generator. At level 0 the recording is unchanged
        (ensured by :meth:`apply`). All levels use the same draws, so a higher level adds errors of the same kind.
        Robots are unchanged. Rows keep the frames of the recording.

    Class attributes:
        level: name of the parameter that is the level.
        levels: levels of a sweep when none are given.
        metric: whether it requires a recording in metres.
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
        """Name on the command line."""
        return kebab_case(type(self).__name__)

    @property
    def unit(self) -> str:
        """Unit of the level."""
        return next(row.unit for row in parameters(self) if row.name == self.level)

    @property
    def neutral(self) -> bool:
        """Whether the recording is unchanged."""
        return bool(getattr(self, self.level) == 0)

    def __str__(self) -> str:
        """Return the name with every parameter."""
        return f"{self.name}({', '.join(f'{name}={value}' for name, value in self.describe().items())})"

    def describe(self, level: bool = True) -> dict[str, str]:
        """Return every parameter with its unit as text; ``level=False`` omits the level."""
        units = {row.name: row.unit for row in parameters(self)}
        found = {}
        for field in dataclasses.fields(self):
            value, unit = getattr(self, field.name), units.get(field.name, "1")
            values = value if isinstance(value, tuple) else (value,)
            word = ",".join(f"{value:g}" if isinstance(value, float) else str(value) for value in values)
            found[field.name] = word if unit == "1" else f"{word} {unit}"
        return found if level else {name: word for name, word in found.items() if name != self.level}

    def at(self, level: float) -> Self:
        """Return the same degradation at another level.

        Raises:
            InputError: the level is not allowed.
        """
        return dataclasses.replace(self, **{self.level: level})

    def check(self, tracks: Trajectories) -> None:
        """Raise :class:`DataError` unless the recording can be degraded."""
        if self.metric and tracks.units != "m":
            raise DataError(f"{tracks.name} is in pixels, {self.name} is in metres; convert it to metres first")

    def apply(self, tracks: Trajectories | DegradedTracks, rng: np.random.Generator | None = None) -> DegradedTracks:
        """Return the degraded recording.

        Args:
            tracks: a recording, or a degraded recording.
            rng: source of randomness; None means ``stream(0, "degrade")``.

        Raises:
            DataError: the recording cannot be degraded, or no rows are left.
        """
        seen = DegradedTracks.of(tracks)
        if self.neutral:
            return seen
        self.check(seen.tracks)
        return self.degrade(seen, stream(0, "degrade") if rng is None else rng)

    @abstractmethod
    def degrade(self, seen: DegradedTracks, rng: np.random.Generator) -> DegradedTracks:
        """Return the degraded recording at a level above 0; see :meth:`apply`."""
