"""Trajectories: the rows of a recording, with methods to select, resample and cut windows."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import (
    PERSON_COLOR,
    ROBOT_COLOR,
    WALL_COLOR,
    DataError,
    Disc,
    InputError,
    Path2D,
    did_you_mean,
    draw_svg,
)
from crowdbot.typing import Floats

from .protocols import NoWindowError, cut_past, cut_windows
from .rows import runs
from .source import MAX_ROWS
from .track_table import PrimaryScene, TrackTable
from .windows import Windows

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["OTHER_AGENTS", "PrimaryScene", "Trajectories"]

OTHER_AGENTS = frozenset(
    ("animal", "bicycle", "bicyclist", "bike", "biker", "bus", "car", "cart", "cyclist", "misc", "motorcycle",
     "motorcyclist", "person on vehicle", "scooter", "skateboarder", "skater", "trailer", "tram", "truck", "truck_bus",
     "van", "veh", "vehicle")
)  # fmt: skip
"""Labels of tracks that are not of pedestrians, in lower case, as in SDD, inD, CITR, KITTI and MOT Challenge."""
WHOLE = 1e-6
"""Tolerance for a new step that is a whole number of frames [frames]."""


@dataclass(frozen=True, eq=False, repr=False)
class Trajectories(TrackTable):
    """The rows of a recording, one per person and frame, sorted by frame, then id; the arrays are read-only.

    Frames, rows and seconds are different things. ``fps`` is frames per second of the frame counter of the file. The
    rows of one track are ``frame_step`` frames apart, so ``dt = frame_step / fps = 1 / row_rate``. In files without a
    frame column, frames number the rows: then ``frame_step`` is 1 and ``fps`` equals ``row_rate``.

    Fields (arrays over rows N):
        id: ``[N]`` int64 identity of the person or robot.
        frame: ``[N]`` int64 frame of the file's own counter.
        x, y: ``[N]`` float64 position, in ``units``.
        row_rate: rows per second of one track [1/s]; its inverse is ``dt``.
        frame_step: frames between two rows of a track; 0 (default) takes the most frequent difference.
        units: ``m`` or ``px``.
        homography: ``[3, 3]`` from (x, y, 1) of the file to metres, or None.
        name: name of the recording, for messages and results.
        note: remarks on the data, for example an assumed time base.
        robots: ids of robots.
        walls: rings ``[N, 2]`` around areas that are not walkable, as in :class:`crowdbot.core.Walls`.
        labels: class of a track (``Pedestrian``, ``Biker``) by id, where the file has one.
        scenes: the scenes of a TrajNet++ file.
        clock_origin: time of frame 0 on the clock of the file [s]; 0 without a column of times.

    Raises:
        DataError: there are no rows, a coordinate is not finite, a (frame, id) pair is duplicated, columns differ in
            length, or ``row_rate`` is not above 0.

    >>> tracks = Trajectories([7, 7, 7], [0, 10, 20], [0.0, 0.5, 1.0], [2.0, 2.0, 2.0], row_rate=2.5)
    >>> tracks.dt, tracks.frame_step, tracks.fps, tracks.time.tolist()
    (0.4, 10, 25.0, [0.0, 0.4, 0.8])
    """

    def _repr_svg_(self) -> str:
        """Return a drawing for notebooks: walls, the tracks of people and of robots."""
        return self.drawing()

    def drawing(self, beneath: Iterable[Path2D] = ()) -> str:
        """Return an SVG drawing: walls, the tracks of people and of robots, above other lines.

        >>> Trajectories([7, 7], [0, 10], [0.0, 0.5], [2.0, 2.0], row_rate=2.5).drawing().startswith("<svg")
        True
        """
        closed = [np.concatenate([ring, ring[:1]]) for ring in self.walls]
        walls = [Path2D(np.asarray(ring, dtype=np.float64), WALL_COLOR, 1.5) for ring in closed]
        tracks = [(int(who), self.position[self.id == who]) for who in self.ids]
        paths = [Path2D(way, ROBOT_COLOR if who in self.robots else PERSON_COLOR, 1.2, 0.7) for who, way in tracks]
        size = 0.004 * float(np.ptp(self.position, axis=0).max(initial=0.0))
        ends = [
            Disc(float(way[-1, 0]), float(way[-1, 1]), size, p.color) for (_, way), p in zip(tracks, paths, strict=True)
        ]
        return draw_svg([*beneath, *walls, *paths], ends, repr(self)[1:-1])

    def track(self, id: int) -> Trajectories:
        """Return the track of one person or robot.

        Raises:
            DataError: the id does not exist.
        """
        return self.only(ids=[id])

    def only(self, *labels: str, ids: Iterable[int] | None = None) -> Trajectories:
        """Return the tracks with one of the labels or ids.

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

    @property
    def other_agents(self) -> dict[int, str]:
        """Labels of the tracks that are neither of pedestrians nor of robots, by id, see :data:`OTHER_AGENTS`.

        >>> kinds = {1: "Pedestrian", 2: "Biker"}
        >>> Trajectories([1, 2], [0, 0], [0, 1], [0, 0], row_rate=2.5, labels=kinds).other_agents
        {2: 'Biker'}
        """
        return {
            id: label for id, label in self.labels.items() if label.lower() in OTHER_AGENTS and id not in self.robots
        }

    def without_other_agents(self) -> Trajectories:
        """Return the tracks without those of :attr:`other_agents`; the note counts them.

        Raises:
            NoWindowError: no track is left. It is a :class:`DataError`.
        """
        other = self.other_agents
        if not other:
            return self
        kept = ~np.isin(self.id, np.asarray(sorted(other), dtype=np.int64))
        counts = ", ".join(f"{count} {label}" for label, count in sorted(Counter(other.values()).items()))
        if not np.any(kept):
            raise NoWindowError(f"{self.name} has no pedestrians; the labels of its tracks are {counts}")
        note = "; ".join(filter(None, (self.note, f"left out by their labels: {counts}")))
        return dataclasses.replace(self._where(kept), note=note)

    def split(self, fraction: float, by: str = "time") -> tuple[Trajectories, Trajectories]:
        """Return a first part and the rest.

        Args:
            fraction: share of the first part, in (0, 1).
            by: ``time`` cuts at a frame, so a track across the border is in both parts; ``person`` puts the people who
                appear first into the first part, so no person is in both (robots are).

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
            transform: metres per pixel, or a homography ``[3, 3]`` from (x, y, 1) to metres; default: that of the
                recording.

        Raises:
            DataError: there is no transform, the tracks are in metres already, a point goes to infinity, or positions
                are on both sides of the horizon of the homography.
        """
        if self.units == "m":
            raise DataError(f"{self.name} is already in metres; load it with units='px' if its coordinates are pixels")
        known = self.homography if transform is None else np.asarray(transform, dtype=np.float64)
        if known is None:
            raise DataError(f"{self.name} is in pixels and has no homography; give metres per pixel or a 3 x 3 matrix")
        matrix = np.diag([float(known), float(known), 1.0]) if known.ndim == 0 else known
        if matrix.shape != (3, 3) or not np.all(np.isfinite(matrix)) or abs(np.linalg.det(matrix)) < 1e-300:
            raise DataError(f"{self.name}: the transform must be a scale above 0 or an invertible 3 x 3 matrix")
        depth = self.position @ matrix[2, :2] + matrix[2, 2]
        if np.min(depth) < 0.0 < np.max(depth):
            beyond = int(np.argmin(depth) if np.mean(depth > 0.0) > 0.5 else np.argmax(depth))
            raise DataError(
                f"{self.name}: the horizon of the homography lies between the positions, such as person"
                f" {self.id[beyond]} at ({self.x[beyond]:g}, {self.y[beyond]:g}) px; the matrix is from (x, y, 1) of"
                " the file to metres, perhaps it is of another picture or x and y are exchanged"
            )
        walls = tuple(_transform(ring, matrix) for ring in self.walls)
        place = _transform(self.position, matrix)
        return dataclasses.replace(self, x=place[:, 0], y=place[:, 1], units="m", homography=matrix, walls=walls)

    def resample(self, dt: float, gap: float | None = None) -> Trajectories:
        """Return the tracks at a time step ``dt`` [s] from the first frame on, by linear interpolation.

        Interpolation uses the next row, which leaks the future into shorter steps; for prediction use longer steps.

        Args:
            dt: new time step [s].
            gap: longest gap inside a track that is interpolated [s] (default: the longer of ``dt`` and the old step).
                Tracks are never extrapolated.

        Raises:
            InputError: dt or gap is not above 0.
            DataError: there would be more than 20 million rows.
        """
        for name, value in (("dt", dt), ("gap", gap)):
            if value is not None and not (value > 0.0 and math.isfinite(value)):
                raise InputError(f"resample: {name} {value} s must be above 0 and finite")
        fps = self.fps
        step = dt * fps
        whole = abs(step - round(step)) < WHOLE and round(step) >= 1
        step = float(round(step)) if whole else step
        bridge = max(dt, self.dt) * 1.001 if gap is None else gap
        order = np.lexsort((self.frame, self.id))
        id, x, y = self.id[order], self.x[order], self.y[order]
        since = (self.frame[order] - self.frame[0]).astype(np.float64)
        begins = np.flatnonzero(np.concatenate([[True], np.diff(id) != 0]))
        ends = np.concatenate([begins[1:], [len(id)]])
        if np.sum(since[ends - 1] - since[begins]) / step > MAX_ROWS:
            raise DataError(f"{self.name}: steps of {dt} s give more than {MAX_ROWS} rows; use a longer step")
        parts: list[tuple[NDArray[Any], ...]] = []
        for begin, end in zip(begins, ends, strict=True):
            own = since[begin:end]
            count = _steps_inside(own, step, bridge * fps)
            place = [np.interp(count * step, own, axis[begin:end]) for axis in (x, y)]
            parts.append((np.full(len(count), id[begin]), count, *place))
        ids, counts, xs, ys = (np.concatenate(column) for column in zip(*parts, strict=True))
        left = set(ids.tolist())
        return dataclasses.replace(
            self,
            id=ids,
            frame=self.frame[0] + counts * int(step) if whole else counts,
            x=xs,
            y=ys,
            row_rate=1.0 / dt,
            frame_step=int(step) if whole else 1,
            robots=self.robots & left,
            labels={key: label for key, label in self.labels.items() if key in left},
            scenes=(),
            clock_origin=self.clock_origin if whole else float(self.clock[0]),
        )

    def windows(
        self, observe: int = 8, predict: int = 12, protocol: str = "all", near: float | None = None, late: str = "skip"
    ) -> tuple[Windows, Windows]:
        """Return the observed and the future part of every window of a protocol.

        ``past`` contains everyone present at the last observed row, by id, also people without a known future; only
        ``future.scored`` has the people who are scored.

        Args:
            observe, predict: rows of the two parts.
            protocol: ``all``, ``sgan``, ``partial``, ``timesplit``, ``timesplit-train`` or ``trajnet++``: see
                ``PROTOCOLS``.
            near: score only people within this distance of a robot at the last observed row [m].
            late: people who appear during the observed part are excluded (``skip``) or, with at least two rows,
                extrapolated backwards with their first velocity (``extrapolate``); they are never scored.

        Raises:
            InputError: an argument is not allowed.
            NoWindowError: there is no window; the message states the reason. It is a :class:`DataError`.
        """
        return cut_windows(self, observe, predict, protocol, near, late)

    def past(self, observe: int = 8, frame: int | None = None, late: str = "extrapolate") -> Windows:
        """Return one window with everyone at ``frame`` (default: the last), for predicting an unknown future.

        Raises:
            InputError: an argument is not allowed.
            DataError: the frame does not exist, or no track there is long enough.
        """
        return cut_past(self, observe, frame, late)

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


def _steps_inside(own: NDArray[np.float64], step: float, bridge: float) -> NDArray[np.int64]:
    """Return the multiples of ``step`` [frames] inside one track, but not inside a gap longer than ``bridge``."""
    tiny = 1e-9 * max(step, 1.0)
    count = np.arange(math.ceil((own[0] - tiny) / step), math.floor((own[-1] + tiny) / step) + 1, dtype=np.int64)
    holes = np.flatnonzero(np.diff(own) > bridge)
    if len(holes) == 0 or len(count) == 0:
        return count
    at = count * step
    before = np.clip(np.searchsorted(own, at + tiny, side="right") - 1, 0, len(own) - 1)
    lost = np.isin(before, holes) & (at - own[before] > tiny)
    return np.asarray(count[~lost])


def _transform(points: Floats, matrix: Floats) -> Floats:
    flat = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(flat[:, :2] / flat[:, 2:])
