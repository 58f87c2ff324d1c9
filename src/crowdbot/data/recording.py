"""Recording: a file with its loading and window options."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
from dataclasses import dataclass
from pathlib import Path

from crowdbot.core import DataError, InputError, did_you_mean

from .file_formats import load
from .file_options import AGENTS
from .place_layout import PlaceLayout
from .trajectories import Trajectories
from .windows import Windows

EPISODE_STEP = 0.4
"""Time step [s] of recorded trials, which have no annotation rate."""


@dataclass(frozen=True)
class Recording:
    """A file of tracks and the windows that are predicted.

    Fields:
        path, fps, format, units, time_base: see :func:`crowdbot.load`.
        step: time step after resampling [s]; None means the time step of the file, or 0.4 s for recorded trials.
        observe, predict, protocol, near, late: see :meth:`Trajectories.windows`.
        learn: initial share of the recording for learning goals; it is not predicted.
        every: only every n-th window is predicted.
        columns: pairs of a quantity and the name of its column, see :func:`crowdbot.load`.
        transform: metres per pixel, or the rows of a homography to metres, see :func:`crowdbot.load`.
        layout: walls and exits of the place, instead of the walls of the file.
        agents: ``pedestrians`` leaves out the cyclists, cars and others that the labels of a file name; ``all`` keeps
            them.
        topic, frame: topic of people and coordinate frame of a ROS bag, see :func:`crowdbot.load`.

    Raises:
        InputError: ``learn`` is not in [0, 1), ``every`` is below 1, or ``agents`` is unknown.
    """

    path: str
    fps: float | None = None
    format: str | None = None
    units: str | None = None
    time_base: str = "true"
    step: float | None = None
    observe: int = 8
    predict: int = 12
    protocol: str = "all"
    near: float | None = None
    late: str = "skip"
    learn: float = 0.0
    every: int = 1
    columns: tuple[tuple[str, str], ...] = ()
    transform: float | tuple[tuple[float, ...], ...] | None = None
    layout: PlaceLayout | None = None
    agents: str = "pedestrians"
    topic: str | None = None
    frame: str | None = None

    def __post_init__(self) -> None:
        if self.step is not None and not self.step > 0.0:
            raise InputError(f"step = {self.step} s must be above 0, such as 0.4 s")
        if self.agents not in AGENTS:
            near = did_you_mean(self.agents, AGENTS)
            raise InputError(f"unknown agents {self.agents!r}{near}; known are {', '.join(AGENTS)}")
        if self.every < 1:
            raise InputError(f"every = {self.every} must be at least 1")
        if not 0.0 <= self.learn < 1.0:
            raise InputError(f"learn = {self.learn} must be at least 0 and below 1")

    @property
    def original(self) -> Trajectories:
        """The whole recording at the time step of the file, in metres if its scale is known."""
        columns = dict(self.columns)
        tracks = load(
            self.path,
            self.fps,
            self.format,
            self.units,
            self.time_base,
            columns,
            self.transform,
            self.topic,
            self.frame,
        )
        if self.agents == "pedestrians":
            tracks = tracks.without_other_agents()
        return tracks.metres() if tracks.units == "px" and tracks.homography is not None else tracks

    @property
    def tracks(self) -> Trajectories:
        """The whole recording, in metres if its scale is known, at the time step ``step``."""
        return _tracks(self)

    @property
    def learning_part(self) -> Trajectories:
        """The part for learning."""
        if self.learn == 0.0:
            raise InputError(
                f"{self.path}: the recording has no learning part; reserve one with --learn, for example --learn 0.5"
            )
        return self.tracks.split(self.learn)[0]

    @property
    def rest(self) -> Trajectories:
        """The part that is predicted."""
        return self.tracks if self.learn == 0.0 else self.tracks.split(self.learn)[1]

    @property
    def name(self) -> str:
        """Name of the file."""
        return Path(self.path).name

    @property
    def digest(self) -> str:
        """Hash of the content of the file."""
        found = hashlib.blake2b(digest_size=8)
        try:
            path = Path(self.path)
            for part in sorted(path.iterdir()) if path.is_dir() else (path,):
                with part.open("rb") as file:
                    while block := file.read(1 << 20):
                        found.update(block)
        except OSError as error:
            raise DataError(f"{self.path} cannot be read: {error.strerror}") from None
        return found.hexdigest()

    @property
    def windows(self) -> tuple[Windows, Windows]:
        """Past and future of the windows that are predicted."""
        return _windows(self)


@functools.lru_cache(maxsize=4)
def _tracks(recording: Recording) -> Trajectories:
    one = recording
    tracks = recording.original
    if one.layout is not None:
        if tracks.units != "m":
            raise InputError(f"{one.path} is in pixels, and a layout in metres; give metres per pixel or a homography")
        remarks = filter(None, (tracks.note, one.layout.remark(tracks.position)))
        tracks = dataclasses.replace(tracks, walls=one.layout.rings, note="; ".join(remarks))
    step = recording.step or (EPISODE_STEP if tracks.robots and recording.fps is None else None)
    return tracks if step is None else tracks.resample(step)


@functools.lru_cache(maxsize=4)
def _windows(recording: Recording) -> tuple[Windows, Windows]:
    how = recording.observe, recording.predict, recording.protocol, recording.near, recording.late
    past, future = recording.rest.windows(*how)
    return (past, future) if recording.every == 1 else (past[:: recording.every], future[:: recording.every])
