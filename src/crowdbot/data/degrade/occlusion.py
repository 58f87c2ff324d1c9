"""Occlusion: an eye among people sees only those whom nobody and no wall hides."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, Walls, parameter
from crowdbot.data.trajectories import Trajectories

from .degradation import GHOST, Degradation, Degraded

__all__ = ["Occlusion", "hidden"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


def hidden(eye: Floats, place: Floats, bodies: Floats, radius: float, reach: float, walls: Floats) -> Bools:
    """Return who cannot be seen from a point.

    The line of sight to a person's centre counts, so that about half a body must be free. A body hides who is farther
    away than itself; one that the eye stands in hides all on its side.

    Args:
        eye: ``[2]`` [m].
        place: ``[N, 2]`` [m], who is looked for.
        bodies: ``[B, 2]`` [m], centres of the discs that hide; people may be among them, they do not hide themselves.
        radius: of the discs [m].
        reach: farthest distance [m] that is seen.
        walls: ``[M, 4]`` segments x, y, x, y [m].

    >>> none = np.zeros((0, 4))
    >>> row = np.array([[1.0, 0.0], [2.0, 0.0], [2.0, 0.6], [9.0, 9.0]])
    >>> hidden(np.zeros(2), row, row, 0.25, 8.0, none).tolist()
    [False, True, False, True]
    """
    sight, body = place - eye, bodies - eye
    away = np.hypot(sight[:, 0], sight[:, 1])
    there = np.where(away > 0.0, away, 1.0)
    across = (body[:, 0] * sight[:, 1, None] - body[:, 1] * sight[:, 0, None]) / there[:, None]
    along = body[:, 0] * sight[:, 0, None] + body[:, 1] * sight[:, 1, None]
    nearer = np.hypot(body[:, 0], body[:, 1]) < away[:, None]
    covered = np.any((along > 0.0) & nearer & (np.abs(across) < radius), axis=1)
    return np.asarray((away > reach) | covered | _behind_walls(eye, sight, walls))


def _behind_walls(eye: Floats, sight: Floats, walls: Floats) -> Bools:
    """Return which lines ``sight`` ``[N, 2]`` from the eye cross a wall before their ends."""
    start, edge = walls[:, :2] - eye, walls[:, 2:] - walls[:, :2]
    turn = sight[:, 0, None] * edge[:, 1] - sight[:, 1, None] * edge[:, 0]
    on_sight = start[:, 0] * edge[:, 1] - start[:, 1] * edge[:, 0]
    on_edge = start[:, 0] * sight[:, 1, None] - start[:, 1] * sight[:, 0, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        s, q = on_sight / turn, on_edge / turn
    return np.asarray(np.any((turn != 0.0) & (s > 0.0) & (s < 1.0) & (q >= 0.0) & (q <= 1.0), axis=1))


@dataclass(frozen=True)
class Occlusion(Degradation):
    """People are lost while an eye does not see them: hidden by bodies and walls, or too far away.

    Where the eye is not there itself, nobody is seen. The eye's own track stays, and hides nobody; false tracks hide
    nobody and are not hidden. Put it first where several degradations are chained: bodies hide where they truly are.

    Fields:
        probability: that a row which is hidden is lost [1]; the level. Below 1 the tracker keeps some of them.
        radius: of the bodies [m].
        reach: how far the eye sees [m].
        eye: a point ``x, y`` [m], or the id of a robot or person who looks; None is the robot of the recording.

    >>> tracks = Trajectories([1, 2], [0, 0], [1.0, 2.0], [0.0, 0.0], row_rate=2.5)
    >>> Occlusion(eye=(0.0, 0.0)).apply(tracks).tracks.id.tolist()
    [1]
    """

    probability: float = parameter(1.0, unit="1", low=0.0, high=1.0, source="ours: what is hidden is lost")
    radius: float = parameter(0.25, unit="m", low=0.1, high=0.4, source="ours: as the crowd models")
    reach: float = parameter(10.0, unit="m", low=3.0, high=50.0, source="ours: legs in a sparse planar scan")
    eye: int | tuple[float, ...] | None = None

    level: ClassVar[str] = "probability"
    levels: ClassVar[tuple[float, ...]] = (0.0, 0.25, 0.5, 0.75, 1.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.eye, tuple) and not (len(self.eye) == 2 and all(map(math.isfinite, self.eye))):
            raise InputError(f"{self.name}: eye = {self.eye} must be a point x, y [m], or the id of who looks")

    def check(self, tracks: Trajectories) -> None:
        """Raise :class:`DataError` when the recording is in pixels or nobody knows who looks."""
        super().check(tracks)
        if isinstance(self.eye, tuple):
            return
        robots = sorted(tracks.robots)
        if self.eye is None and not robots:
            raise DataError(
                f"{self.name}: {tracks.name} has no robot to look from;"
                " set eye to a point x,y [m] or to the id of a person who looks"
            )
        if self.eye is None and len(robots) > 1:
            raise DataError(
                f"{self.name}: {tracks.name} has the robots {', '.join(map(str, robots))};"
                " set eye to the id of the one that looks"
            )
        if self.eye is not None and self.eye not in tracks.ids:
            raise DataError(
                f"{self.name}: eye = {self.eye}, but {tracks.name} has no track of this id;"
                f" ids go from {tracks.ids[0]} to {tracks.ids[-1]}"
            )

    def degrade(self, seen: Degraded, rng: np.random.Generator) -> Degraded:
        """Return the rows that the eye sees, see :meth:`Degradation.apply`."""
        tracks = seen.tracks
        keeps = rng.random(len(tracks)) >= self.probability
        looks = np.zeros(len(tracks), dtype=np.bool_)
        if not isinstance(self.eye, tuple):
            looks = tracks.id == (next(iter(tracks.robots)) if self.eye is None else self.eye)
        walls = Walls.of(tracks.walls).segments()
        body = (seen.truth != GHOST) & ~looks
        lost = np.zeros(len(tracks), dtype=np.bool_)
        first = np.unique(tracks.frame, return_index=True)[1].tolist()
        for begin, end in zip(first, [*first[1:], len(tracks)], strict=True):
            rows = slice(begin, end)
            place = tracks.position[rows]
            own = looks[rows]
            if not isinstance(self.eye, tuple) and not np.any(own):
                lost[rows] = True
                continue
            eye = np.asarray(self.eye) if isinstance(self.eye, tuple) else place[own][0]
            lost[rows] = hidden(eye, place, place[body[rows]], self.radius, self.reach, walls)
        return seen.kept(keeps | ~lost | looks | (seen.truth == GHOST))
