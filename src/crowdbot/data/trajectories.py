"""Trajectories: the rows of a recording of people, with all that turns them into metres and seconds."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import DataError, InputError, did_you_mean

from .cut import past_at, windows_of
from .resample import resampled
from .rows import check_rows, floats, frame_step, integers, runs

if TYPE_CHECKING:
    import pandas as pd

    from .windows import Windows

__all__ = ["PrimaryScene", "Trajectories"]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class PrimaryScene(NamedTuple):
    """A scene of a TrajNet++ file: the person it is about, its frames, and its categories."""

    id: int
    person: int
    first: int
    last: int
    tag: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Trajectories:
    """The rows of a recording, one per person and frame, sorted by frame, then id; the arrays cannot be written to.

    Fields (arrays over rows N):
        id: ``[N]`` int64 identity of the person or robot.
        frame: ``[N]`` int64 frame of the file's own counter.
        x, y: ``[N]`` float64 position, in ``units``.
        frame_rate: rows a second of one track [1/s]; its inverse is ``dt``.
        frame_step: frames of the counter from one row of a track to the next; 0 finds it.
        units: ``m`` or ``px``.
        homography: ``[3, 3]`` from (x, y, 1) of the file to metres, or None.
        name: name of the recording, for messages and results.
        note: what a reader of results should know, e.g. the time base.
        robots: ids that are robots.
        walls: rings ``[N, 2]`` of what cannot be walked on, as :class:`crowdbot.core.Walls` takes them.
        labels: what a track is (``Pedestrian``, ``Biker``), by id, where the file says so.
        scenes: the scenes of a TrajNet++ file.

    Raises:
        DataError: there is no row, a coordinate is not finite, a (frame, id) pair stands twice, columns differ in
            length, or the frame rate is not above 0.

    >>> tracks = Trajectories([7, 7, 7], [0, 10, 20], [0.0, 0.5, 1.0], [2.0, 2.0, 2.0], frame_rate=2.5)
    >>> tracks.dt, tracks.frame_step, tracks.time.tolist()
    (0.4, 10, [0.0, 0.4, 0.8])
    """

    id: Integers
    frame: Integers
    x: Floats
    y: Floats
    frame_rate: float
    frame_step: int = 0
    units: str = "m"
    homography: Floats | None = None
    name: str = "tracks"
    note: str = ""
    robots: frozenset[int] = frozenset()
    walls: tuple[Floats, ...] = ()
    labels: Mapping[int, str] = field(default_factory=dict)
    scenes: tuple[PrimaryScene, ...] = ()

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
        if not (self.frame_rate > 0.0 and math.isfinite(self.frame_rate)):
            raise DataError(f"{self.name}: frame rate {self.frame_rate} is not above 0, it is the rows a second")
        if self.units not in ("m", "px"):
            raise DataError(f"{self.name}: units {self.units!r} are not known, tracks are in 'm' or 'px'")
        for name, column in columns.items():
            ordered = column[order]
            ordered.setflags(write=False)
            object.__setattr__(self, name, ordered)
        object.__setattr__(self, "frame_step", int(self.frame_step or frame_step(self.id, self.frame)))
        object.__setattr__(self, "frame_rate", float(self.frame_rate))
        object.__setattr__(self, "robots", frozenset(int(robot) for robot in self.robots))

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.id)

    def __repr__(self) -> str:
        people = len(self.ids) - len(self.robots)
        robots = f" and {len(self.robots)} robots" if self.robots else ""
        return f"<Trajectories {self.name}: {len(self)} rows of {people} people{robots}, dt {self.dt:.4g} s>"

    @property
    def dt(self) -> float:
        """Time from one row of a track to the next [s]."""
        return 1.0 / self.frame_rate

    @property
    def ids(self) -> Integers:
        """Every id once, ascending."""
        return np.unique(self.id)

    @property
    def time(self) -> Floats:
        """``[N]`` [s] since the first frame."""
        return np.asarray((self.frame - self.frame[0]) / self.frame_step / self.frame_rate)

    @property
    def position(self) -> Floats:
        """``[N, 2]`` in ``units``."""
        return np.stack([self.x, self.y], axis=1)

    def velocities(self) -> Floats:
        """Return ``[N, 2]`` [units/s]: the way from the row before, over the time it took.

        It looks backwards only, so nothing of the future is in it; NaN where a track begins.
        """
        order = np.lexsort((self.frame, self.id))
        before, after = order[:-1], order[1:]
        same = self.id[before] == self.id[after]
        before, after = before[same], after[same]
        velocity = np.full((len(self), 2), np.nan)
        passed = self.time[after] - self.time[before]
        velocity[after] = (self.position[after] - self.position[before]) / passed[:, None]
        return velocity

    def track(self, id: int) -> Trajectories:
        """Return the rows of one person or robot.

        Raises:
            DataError: nobody has this id.
        """
        return self.only(ids=[id])

    def only(self, *labels: str, ids: Iterable[int] | None = None) -> Trajectories:
        """Return the tracks with one of the labels, or with one of the ids.

        Raises:
            DataError: no track has such a label or id.
        """
        if ids is None:
            known = sorted(set(self.labels.values()))
            wrong = next((label for label in labels if label not in known), None)
            if wrong is not None or not labels:
                near = did_you_mean(wrong or "", known)
                raise DataError(f"{self.name} has no track labelled {wrong!r}{near}; labels are {', '.join(known)}")
            ids = [id for id, label in self.labels.items() if label in labels]
        wanted = sorted(set(ids))
        missing = next((id for id in wanted if id not in self.ids), None)
        if missing is not None:
            raise DataError(f"{self.name} has no track of id {missing}; ids go from {self.ids[0]} to {self.ids[-1]}")
        return self._where(np.isin(self.id, np.asarray(wanted, dtype=np.int64)))

    def split(self, fraction: float, by: str = "time") -> tuple[Trajectories, Trajectories]:
        """Return a first part and the rest.

        Args:
            fraction: share of the first part, above 0 and below 1.
            by: ``time`` cuts at a frame, so that one walking over the border is in both parts; ``person`` gives the
                first part the people who appeared first, so that nobody is in both (robots are in both).

        Raises:
            InputError: fraction or by is not allowed.
            DataError: one part would be empty.
        """
        if not 0.0 < fraction < 1.0:
            raise InputError(f"split: fraction {fraction} must be above 0 and below 1")
        if by == "time":
            border = self.frame[0] + fraction * (self.frame[-1] + self.frame_step - self.frame[0])
            early = late = self.frame < border
        elif by == "person":
            order = self.id[np.sort(np.unique(self.id, return_index=True)[1])]
            people = order[~np.isin(order, list(self.robots))]
            chosen = np.isin(self.id, people[: round(fraction * len(people))])
            robot = np.isin(self.id, list(self.robots))
            early, late = chosen | robot, chosen & ~robot
        else:
            raise InputError(f"split: by {by!r}{did_you_mean(by, ('time', 'person'))}; known are time, person")
        if not np.any(early) or np.all(late):
            raise DataError(f"{self.name}: a split at {fraction} by {by} leaves one part empty")
        return self._where(early), self._where(~late)

    def metres(self, transform: ArrayLike | None = None) -> Trajectories:
        """Return the tracks in metres.

        Args:
            transform: metres per pixel, or a homography ``[3, 3]`` from (x, y, 1) to metres; default: the one that
                came with the recording.

        Raises:
            DataError: there is no transform, the tracks are in metres already, or a point goes to infinity.
        """
        if self.units == "m":
            raise DataError(f"{self.name} is in metres already; load it with units='px' when its numbers are pixels")
        known = self.homography if transform is None else np.asarray(transform, dtype=np.float64)
        if known is None:
            raise DataError(f"{self.name} is in pixels and has no homography; give metres per pixel or a 3 x 3 matrix")
        matrix = np.diag([float(known), float(known), 1.0]) if known.ndim == 0 else known
        if matrix.shape != (3, 3) or not np.all(np.isfinite(matrix)) or abs(np.linalg.det(matrix)) < 1e-300:
            raise DataError(f"{self.name}: the transform must be a scale above 0 or an invertible 3 x 3 matrix")
        walls = tuple(_mapped(ring, matrix) for ring in self.walls)
        place = _mapped(self.position, matrix)
        return dataclasses.replace(self, x=place[:, 0], y=place[:, 1], units="m", homography=matrix, walls=walls)

    def resample(self, dt: float, gap: float | None = None) -> Trajectories:
        """Return the tracks at steps of ``dt`` [s] from the first frame on, interpolated linearly.

        A position between two rows knows the later one: make steps longer with it, not shorter, where the future must
        stay hidden.

        Args:
            dt: new time step [s].
            gap: longest hole inside a track [s] that is bridged; default the longer of ``dt`` and one old step. Nothing
                is ever added before the first or after the last row of a track.

        Raises:
            InputError: dt or gap is not above 0.
            DataError: the steps are so short that there would be more than 20 million rows.
        """
        return resampled(self, dt, gap)

    def windows(
        self, observe: int = 8, predict: int = 12, protocol: str = "all", near: float | None = None, late: str = "skip"
    ) -> tuple[Windows, Windows]:
        """Return the observed and the future part of every window that a protocol counts.

        ``past`` holds everyone who can be used at the last observed step, by id, whether or not their future is known;
        who is scored stands in ``future.scored`` only.

        Args:
            observe, predict: rows of the two parts.
            protocol: ``all``, ``sgan``, ``partial``, ``timesplit`` or ``timesplit-train``: see ``PROTOCOLS``.
            near: score only people within so many metres of a robot at the last observed step.
            late: people who came during the observed part are left out (``skip``) or, from two rows on, walked
                backwards with their first velocity (``extrapolate``); they are company, never scored.

        Raises:
            InputError: an argument is not allowed.
            DataError: no window was found, and why.
        """
        return windows_of(self, observe, predict, protocol, near, late)

    def past(self, observe: int = 8, frame: int | None = None, late: str = "extrapolate") -> Windows:
        """Return one window with everyone at ``frame`` (default: the last), for predicting what nobody has seen yet.

        Raises:
            InputError: an argument is not allowed.
            DataError: the frame does not exist, or nobody there was seen for long enough.
        """
        return past_at(self, observe, frame, late)

    def summary(self) -> dict[str, float]:
        """Return counts, duration [s], speeds [units/s] and people per frame."""
        speed = np.hypot(*self.velocities().T)
        moving = speed[~np.isnan(speed)]
        crowd = np.unique(self.frame, return_counts=True)[1]
        return {
            "rows": len(self),
            "tracks": len(self.ids),
            "frames": len(crowd),
            "seconds": float(self.time[-1]),
            "dt": self.dt,
            "mean_speed": float(moving.mean()) if len(moving) else math.nan,
            "max_speed": float(moving.max()) if len(moving) else math.nan,
            "mean_per_frame": float(crowd.mean()),
            "max_per_frame": int(crowd.max()),
            "longest_run": int(runs(self.id, self.frame).behind.max()),
        }

    def to_frame(self) -> pd.DataFrame:
        """Return a pandas table with the columns id, frame, time [s], x, y."""
        import pandas as pd

        columns = {"id": self.id, "frame": self.frame, "time": self.time, "x": self.x, "y": self.y}
        return pd.DataFrame({name: column.copy() for name, column in columns.items()})

    def _where(self, rows: NDArray[np.bool_]) -> Trajectories:
        here = {int(id) for id in np.unique(self.id[rows])}
        arrays: dict[str, Any] = {name: getattr(self, name)[rows] for name in ("id", "frame", "x", "y")}
        frames = self.frame[rows]
        inside = [s for s in self.scenes if s.person in here and frames.min() <= s.first and s.last <= frames.max()]
        return dataclasses.replace(
            self,
            **arrays,
            robots=self.robots & here,
            labels={id: label for id, label in self.labels.items() if id in here},
            scenes=tuple(inside),
        )


def _mapped(points: Floats, matrix: Floats) -> Floats:
    flat = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(flat[:, :2] / flat[:, 2:])
