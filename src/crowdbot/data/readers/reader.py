"""Reader: a file format, and user options that override the content of a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories


@dataclass(frozen=True)
class ReadOptions:
    """Options of the user; they override the content of the file.

    Fields:
        fps: frames per second of the frame counter [1/s]; of files without one, rows per second.
        units: units of the coordinates in the file, one of :data:`crowdbot.data.UNITS`.
        time_base: ``true`` or ``published``.
        columns: columns of a table by quantity, ``id``, ``frame``, ``time``, ``x``, ``y`` or ``label``.
        topic: topic of people of a bag.
        frame: coordinate frame of the tracks of a bag.
    """

    fps: float | None = None
    units: str | None = None
    time_base: str = "true"
    columns: Mapping[str, str] = field(default_factory=dict)
    topic: str | None = None
    frame: str | None = None


class Reader(NamedTuple):
    """One format: its name, a line of description, a test of the content, and the function that reads it."""

    name: str
    about: str
    sniff: Callable[[Source], bool]
    read: Callable[[Source, ReadOptions], Trajectories]
