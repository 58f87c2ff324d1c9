"""Recorded people: the people of a recording, replayed or reacting to a robot."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.core.fields import attribute, check
from crowdbot.data import AGENTS, FILE_OPTIONS, UNITS, parse_columns, split_columns
from crowdbot.typing import Floats

from .distribution import Distribution
from .files.trial_files import recording_files, resolve_file, resolve_recording
from .people import BODY_RADIUS

if TYPE_CHECKING:
    from crowdbot.data import Recording, Trajectories


LONGEST_GAP = 2.0
"""Longest gap [s] that is interpolated; after a longer one the person returns as another."""


class Walk(NamedTuple):
    """A recorded person without longer gaps: times ``[T]`` [s] of the trial, positions ``[T, 2]`` [m]."""

    person: int
    time: Floats
    position: Floats


@dataclass(frozen=True, kw_only=True)
class RecordedPeople:
    """People of a recording. They follow it, or the model of their crowd if a robot is near.

    Scripted people react to nothing. Reactive people follow the recording until a visible robot is nearer than
    ``reaction_distance``; from then on the crowd model moves them towards their recorded position a little later, up to
    the end of the recording. People are absent during gaps of more than 2 s in their track.

    Raises:
        InputError: a value is not allowed.

    >>> RecordedPeople(data="zara01.txt", fps=25.0, mode="reactive").reaction_distance
    5.0
    """

    name: str = attribute("", about="name for messages")
    data: str = attribute(
        about="recording in the folder of the trial: a file, or a folder that is one recording",
        pattern=r"[^\x00]{1,500}",
    )
    fps: float | None = attribute(None, about=FILE_OPTIONS["fps"].about, unit="1/s", exclusive_min=0.0)
    format: str = attribute("", about=FILE_OPTIONS["format"].about)
    units: str = attribute("", about=FILE_OPTIONS["units"].about, choices=("", *UNITS))
    columns: str = attribute("", about=f"{FILE_OPTIONS['columns'].about}, such as id=who x=east")
    scale: float | None = attribute(None, about=FILE_OPTIONS["scale"].about, unit="m", exclusive_min=0.0)
    homography: str = attribute("", about=f"{FILE_OPTIONS['homography'].about}, in the folder of the trial")
    topic: str = attribute("", about=FILE_OPTIONS["topic"].about)
    frame: str = attribute("", about=FILE_OPTIONS["frame"].about)
    time_base: str = attribute("true", about=FILE_OPTIONS["time_base"].about, choices=("true", "published"))
    agents: str = attribute("all", about=FILE_OPTIONS["agents"].about, choices=AGENTS[::-1])
    mode: str = attribute("scripted", about="whether people react to robots", choices=("scripted", "reactive"))
    reaction_distance: float = attribute(
        5.0, about="distance to a robot below which people react", unit="m", exclusive_min=0.0, max=1000.0
    )
    begin: float = attribute(0.0, about="time in the recording at which the trial begins", unit="s", min=0.0)
    exclude: str = attribute("", about="ids of people to exclude, such as those that robots replace")
    radius: Distribution = attribute(BODY_RADIUS, about="radius of the body", unit="m", exclusive_min=0.0, max=5.0)
    crowd: str = attribute("", about="name of the crowd whose model reacting people follow (default: the first)")
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    trust: bool = dataclasses.field(default=True, compare=False, repr=False)
    """Folder of the file, and whether the file may lie outside; not part of the XML."""

    def __post_init__(self) -> None:
        check(self)
        self.excluded_ids()
        parse_columns(split_columns(self.columns))
        if self.scale is not None and self.homography:
            raise InputError("scale and homography are given; coordinates have one scale")

    def excluded_ids(self) -> frozenset[int]:
        """Return the excluded ids."""
        return _ids(self.exclude)

    def tracks(self) -> Trajectories:
        """Return the recording in metres; its files are read once.

        Raises:
            InputError: there is no such file in the folder of the trial.
            DataError: it cannot be read.
        """
        path = resolve_recording(self.data, self.folder, self.trust)
        stamps = [file.stat() for file in recording_files(self.data, self.folder, self.trust).values()]
        return _load(self.recording(path), tuple((stamp.st_mtime_ns, stamp.st_size) for stamp in stamps))

    def recording(self, path: Path) -> Recording:
        """Return a file with the options of the element.

        Raises:
            InputError: there is no homography file in the folder of the trial.
            DataError: it has no homography.
        """
        from crowdbot.data import Recording, read_homography

        transform: Any = self.scale
        if self.homography:
            matrix = read_homography(resolve_file(self.homography, self.folder, self.trust))
            transform = tuple(map(tuple, matrix.tolist()))
        return Recording(
            str(path),
            fps=self.fps,
            format=self.format or None,
            units=self.units or None,
            time_base=self.time_base,
            columns=parse_columns(split_columns(self.columns)),
            transform=transform,
            agents=self.agents,
            topic=self.topic or None,
            frame=self.frame or None,
        )

    def remarks(self) -> list[str]:
        """Return why the file can hardly have the units or the columns that it is read with.

        Raises:
            InputError, DataError: as :meth:`tracks`.
        """
        return [f"{self.data}: warning: {sentence}" for sentence in self.tracks().warnings]

    def walks(self, duration: float) -> tuple[Walk, ...]:
        """Return the people of a trial of this duration [s], by id.

        Raises:
            InputError, DataError: as :meth:`tracks`, or an excluded person is not in the recording.
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
def _load(recording: Recording, stamps: tuple[tuple[int, int], ...]) -> Trajectories:
    """Return a recording, which is read again only if a file of it has changed."""
    from crowdbot.data import RowRateError

    try:
        tracks = recording.original
    except RowRateError as error:  # in older trial files fps was rows per second
        warnings.warn(
            f'{recording.name}: fps="{recording.fps:g}" is read as rows per second; write fps="{error.fps:g}"',
            stacklevel=1,
        )
        tracks = dataclasses.replace(recording, fps=error.fps).original
    return tracks if tracks.units == "m" else tracks.metres()
