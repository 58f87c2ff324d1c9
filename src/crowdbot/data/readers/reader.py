"""Reader: a file format, and user options that override the content of a file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

__all__ = ["ReadOptions", "Reader"]


@dataclass(frozen=True)
class ReadOptions:
    """Options of the user; they override the content of the file.

    Fields:
        fps: frames per second of the frame counter [1/s]; of files without one, rows per second.
        units: units of the coordinates in the file: ``m``, ``cm``, ``mm`` or ``px``.
        time_base: ``true`` or ``published``.
    """

    fps: float | None = None
    units: str | None = None
    time_base: str = "true"


class Reader(NamedTuple):
    """One format: its name, a line of description, a test of the content, and the function that reads it."""

    name: str
    about: str
    sniff: Callable[[Source], bool]
    read: Callable[[Source, ReadOptions], Trajectories]
