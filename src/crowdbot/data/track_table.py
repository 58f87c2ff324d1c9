"""TrackTable: the rows of a recording with their units and time base."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import DataError
from crowdbot.typing import Floats, Ints

from .rows import check_rows, floats, frame_step, integers


class PrimaryScene(NamedTuple):
    """A scene of a TrajNet++ file: the person it is about, its frames, and its categories."""

    id: int
    person: int
    first: int
    last: int
    tag: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class TrackTable:
    """Rows of tracks with their units and time base: the fields of :class:`crowdbot.data.Trajectories`.

    Functions that cut windows or resample depend on this table only.
    """

    id: Ints
    frame: Ints
    x: Floats
    y: Floats
    row_rate: float
    frame_step: int = 0
    units: str = "m"
    homography: Floats | None = None
    name: str = "tracks"
    note: str = ""
    robots: frozenset[int] = frozenset()
    walls: tuple[Floats, ...] = ()
    labels: Mapping[int, str] = field(default_factory=dict)
    scenes: tuple[PrimaryScene, ...] = ()
    clock_origin: float = 0.0

    def __post_init__(self) -> None:
        columns: dict[str, Any] = {
            "id": integers(self.id, "id", self.name),
            "frame": integers(self.frame, "frame", self.name),
            "x": floats(self.x, "x", self.name),
            "y": floats(self.y, "y", self.name),
        }
        shapes = {name: column.shape for name, column in columns.items()}
        if any(shape != (len(columns["id"]),) for shape in shapes.values()):
            raise DataError(f"{self.name}: columns differ in shape, {shapes}; each must be [N]")
        order = check_rows(**columns, name=self.name)
        if not (self.row_rate > 0.0 and math.isfinite(self.row_rate)):
            raise DataError(f"{self.name}: row_rate is {self.row_rate}, it must be above 0 and finite [rows/s]")
        if self.units not in ("m", "px"):
            raise DataError(f"{self.name}: unknown units {self.units!r}, tracks are in 'm' or 'px'")
        for name, column in columns.items():
            ordered = column[order]
            ordered.setflags(write=False)
            object.__setattr__(self, name, ordered)
        object.__setattr__(self, "frame_step", int(self.frame_step or frame_step(self.id, self.frame)))
        object.__setattr__(self, "row_rate", float(self.row_rate))
        object.__setattr__(self, "robots", frozenset(int(robot) for robot in self.robots))

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.id)

    def __repr__(self) -> str:
        people = len(self.ids) - len(self.robots)
        robots = f" and {len(self.robots)} robots" if self.robots else ""
        return f"<Trajectories {self.name}: {len(self)} rows of {people} people{robots}, dt {self.dt:.4g} s>"

    @property
    def warnings(self) -> list[str]:
        """The warnings in the note: units, times or columns that can hardly be those of people.

        >>> TrackTable([7], [0], [0.0], [0.0], row_rate=2.5, note="2.5 Hz; warning: slow; warning: flat").warnings
        ['slow', 'flat']
        """
        parts = self.note.split("; ")
        return [part.removeprefix("warning: ") for part in parts if part.startswith("warning: ")]

    @property
    def dt(self) -> float:
        """Time between rows of a track [s]: ``frame_step / fps``, the inverse of ``row_rate``."""
        return 1.0 / self.row_rate

    @property
    def fps(self) -> float:
        """Frames per second of the frame counter [1/s]: ``frame_step * row_rate``."""
        return self.frame_step * self.row_rate

    @property
    def ids(self) -> Ints:
        """The distinct ids in ascending order."""
        return np.unique(self.id)

    @property
    def time(self) -> Floats:
        """``[N]`` time since the first frame [s]."""
        return np.asarray((self.frame - self.frame[0]) / self.frame_step / self.row_rate)

    @property
    def clock(self) -> Floats:
        """``[N]`` time on the clock of the file [s]: ``clock_origin + frame / fps``.

        Files of one run that are recorded with one clock are aligned by it.
        """
        return np.asarray(self.clock_origin + self.frame / self.frame_step / self.row_rate)

    @property
    def position(self) -> Floats:
        """``[N, 2]`` positions in ``units``."""
        return np.stack([self.x, self.y], axis=1)

    def velocities(self) -> Floats:
        """Return the velocity of every row ``[N, 2]`` [units/s] by backward differences.

        Backward differences use no future positions; the first row of a track is NaN.
        """
        order = np.lexsort((self.frame, self.id))
        before, after = order[:-1], order[1:]
        same = self.id[before] == self.id[after]
        before, after = before[same], after[same]
        velocity = np.full((len(self), 2), np.nan)
        passed = self.time[after] - self.time[before]
        velocity[after] = (self.position[after] - self.position[before]) / passed[:, None]
        return velocity
