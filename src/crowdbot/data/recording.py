"""Recording: a file and how windows are cut out of it, as one value that worker processes can be given."""

from __future__ import annotations

import functools
import hashlib
from dataclasses import dataclass
from pathlib import Path

from crowdbot.core import DataError, InputError

from .load import load
from .trajectories import Trajectories
from .windows import Windows

__all__ = ["Recording"]

EPISODE_STEP = 0.4
"""A recorded trial has no annotation rate of its own: it is scored at the field's 0.4 s."""


@dataclass(frozen=True)
class Recording:
    """Where people were recorded, and which windows of it are predicted.

    Fields:
        path, fps, format, units, time_base: as of :func:`crowdbot.load`.
        step: rows are so far apart [s] by interpolation; None keeps those of the file, recorded trials have 0.4.
        observe, predict, protocol, near, late: as of :meth:`Trajectories.windows`.
        learn: share of the recording, from its begin on, that goals may learn from and that is not predicted.
        every: only every so many-th window is predicted.

    Raises:
        InputError: the share is not from 0 to below 1, every is below 1, or nothing was kept to learn from.
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

    def __post_init__(self) -> None:
        if self.every < 1:
            raise InputError(f"every = {self.every} must be at least 1: each, every 2nd, every 3rd window")
        if not 0.0 <= self.learn < 1.0:
            raise InputError(f"the share of a recording to learn from is {self.learn}, it must be from 0 to below 1")

    @property
    def tracks(self) -> Trajectories:
        """The whole recording, in metres when its scale is known, at the wanted step."""
        return _tracks(self)

    @property
    def known(self) -> Trajectories:
        """The part that may be learned from."""
        if self.learn == 0.0:
            raise InputError(
                f"{self.path}: nothing was kept to learn from; keep the first part of the recording with --learn 0.5"
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
            with Path(self.path).open("rb") as file:
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
    tracks = load(recording.path, recording.fps, recording.format, recording.units, recording.time_base)
    if tracks.units == "px" and tracks.homography is not None:
        tracks = tracks.metres()
    step = recording.step or (EPISODE_STEP if tracks.robots and recording.fps is None else None)
    return tracks if step is None else tracks.resample(step)


@functools.lru_cache(maxsize=4)
def _windows(recording: Recording) -> tuple[Windows, Windows]:
    how = recording.observe, recording.predict, recording.protocol, recording.near, recording.late
    past, future = recording.rest.windows(*how)
    return (past, future) if recording.every == 1 else (past[:: recording.every], future[:: recording.every])
