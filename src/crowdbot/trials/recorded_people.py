"""Recorded people as a crowd: any recording that can be read, as it was or reacting to a robot."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .distribution import Distribution
from .fields import FieldProblem, attribute, check, quote_value
from .files.trial_files import resolve_file
from .people import BODY_RADIUS

if TYPE_CHECKING:
    from crowdbot.data import Trajectories

__all__ = ["RecordedPeople", "Walk"]

Floats = NDArray[np.float64]
LONGEST_GAP = 2.0
"""Over a gap of more than this [s] nobody is moved: the person is away, and comes back as another."""


class Walk(NamedTuple):
    """A recorded person from one appearance to the next absence: ``[T]`` times [s] of the trial, ``[T, 2]`` places."""

    person: int
    time: Floats
    position: Floats


@dataclass(frozen=True, kw_only=True)
class RecordedPeople:
    """People of a recording: they are where they were, or walk by the model of their crowd once a robot is near.

    Scripted people react to nothing. Reactive people are scripted until a robot that people see is nearer than
    ``near``; from then on they walk to where their recording will be a little later, and to its end. People whose
    track has a gap of more than 2 s are away meanwhile.

    Raises:
        InputError: a value is not allowed.

    >>> RecordedPeople(data="zara01.txt", fps=25.0, mode="reactive").reaction_distance
    5.0
    """

    name: str = attribute("", about="name for messages")
    data: str = attribute(about="file of the recording, in the folder of the trial", pattern=r"[^\x00]{1,500}")
    fps: float | None = attribute(
        None, about="frames per second, when the file does not say", unit="1/s", exclusive_min=0.0
    )
    format: str = attribute("", about="format of the file, by default found by its content")
    units: str = attribute("", about="of its numbers, when it does not say", choices=("", "m", "cm", "mm", "px"))
    time_base: str = attribute(
        "true", about="of the one ETH text that is published with a wrong one", choices=("true", "published")
    )
    mode: str = attribute("scripted", about="whether people react to robots", choices=("scripted", "reactive"))
    reaction_distance: float = attribute(
        5.0, about="who reacts does so from here on", unit="m", exclusive_min=0.0, max=1000.0
    )
    begin: float = attribute(0.0, about="time of the recording at which the trial begins", unit="s", min=0.0)
    exclude: str = attribute("", about="ids of people who are left out, such as those whom a robot replaces")
    radius: Distribution = attribute(BODY_RADIUS, about="radius of the body", unit="m", exclusive_min=0.0, max=5.0)
    crowd: str = attribute("", about="name of the crowd by which they react, by default the first")
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    trust: bool = dataclasses.field(default=True, compare=False, repr=False)
    """Where the file lies, and whether it may lie outside; not part of the tree."""

    def __post_init__(self) -> None:
        check(self)
        self.excluded_ids()

    @staticmethod
    def mistakes(values: Mapping[str, Any]) -> list[FieldProblem]:
        """Return what is wrong with the name of the file and with ids, whatever else is wrong in its element."""
        found: list[FieldProblem] = []
        try:
            _ids(values.get("exclude", ""))
        except InputError as error:
            found.append((("exclude",), str(error)))
        try:
            if "data" in values:
                resolve_file(values["data"], values["folder"], values["trust"])
        except InputError as error:
            found.append((("data",), f"data={quote_value(values['data'])} {error}"))
        return found

    def excluded_ids(self) -> frozenset[int]:
        """Return the ids that are left out."""
        return _ids(self.exclude)

    def tracks(self) -> Trajectories:
        """Return the recording in metres, read once.

        Raises:
            InputError: there is no such file in the folder of the trial.
            DataError: it cannot be read, or somebody who is left out is not in it.
        """
        path = resolve_file(self.data, self.folder, self.trust)
        stamp = path.stat()
        options = (self.fps, self.format or None, self.units or None, self.time_base)
        return _loaded(path, stamp.st_mtime_ns, stamp.st_size, *options)

    def walks(self, duration: float) -> tuple[Walk, ...]:
        """Return everybody who is there during a trial of this duration [s], by id.

        Raises:
            InputError, DataError: as :meth:`tracks`; or somebody who is left out is not in the recording.
        """
        tracks = self.tracks()
        known = set(tracks.ids.tolist())
        for person in sorted(self.excluded_ids() - known):
            raise InputError(f"exclude names person {person}, who is not in {self.data}")
        away = self.excluded_ids() | tracks.robots
        order = np.lexsort((tracks.frame, tracks.id))
        ids, time = tracks.id[order], np.round(tracks.time[order] - self.begin, 9)
        position = tracks.position[order]
        new = (np.diff(ids) != 0) | (np.diff(time) > max(LONGEST_GAP, 1.5 * tracks.dt))
        borders = np.concatenate([[0], np.flatnonzero(new) + 1, [len(ids)]]).tolist()
        walks = [
            Walk(int(ids[a]), time[a:b], position[a:b])
            for a, b in itertools.pairwise(borders)
            if int(ids[a]) not in away
        ]
        return tuple(walk for walk in walks if walk.time[-1] >= 0.0 and walk.time[0] <= duration)


def _ids(without: str) -> frozenset[int]:
    words = without.replace(",", " ").split()
    if any(not word.lstrip("-").isdecimal() or len(word) > 18 for word in words):
        raise InputError(f'exclude="{without[:60]}" must be whole numbers, such as 3 17')
    return frozenset(int(word) for word in words)


@functools.lru_cache(maxsize=4)
def _loaded(
    path: Path, changed: int, size: int, fps: float | None, format: str | None, units: str | None, time_base: str
) -> Trajectories:
    """Read a recording once for as long as its file stays the same."""
    from crowdbot.data import RowRateError, load

    try:
        tracks = load(path, fps=fps, format=format, units=units, time_base=time_base)
    except RowRateError as error:  # in older trial files fps was rows per second
        warnings.warn(f'{path.name}: fps="{fps:g}" is read as rows per second; write fps="{error.fps:g}"', stacklevel=1)
        tracks = load(path, fps=error.fps, format=format, units=units, time_base=time_base)
    return tracks if tracks.units == "m" and tracks.homography is None else tracks.metres()
