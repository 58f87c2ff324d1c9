"""Occlusion: people hidden from a viewpoint by bodies or walls are lost."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import DataError, InputError, Walls, parameter
from crowdbot.data.trajectories import Trajectories
from crowdbot.typing import Bools, Floats

from .degradation import GHOST, Degradation, DegradedTracks


def occlusion_mask(eye: Floats, place: Floats, bodies: Floats, radius: float, reach: float, walls: Floats) -> Bools:
    """Return the mask ``[N]`` of people who are not visible from a point.

    The line of sight to a person's centre decides, so about half a body must be visible. A body hides people who are
    farther away; a body around the viewpoint hides everyone on its side.

    Args:
        eye: ``[2]`` [m].
        place: ``[N, 2]`` [m], positions of people.
        bodies: ``[B, 2]`` [m], centres of the occluding discs; people do not hide themselves.
        radius: radius of the discs [m].
        reach: range of vision [m].
        walls: ``[M, 4]`` segments x, y, x, y [m].

    >>> none = np.zeros((0, 4))
    >>> row = np.array([[1.0, 0.0], [2.0, 0.0], [2.0, 0.6], [9.0, 9.0]])
    >>> occlusion_mask(np.zeros(2), row, row, 0.25, 8.0, none).tolist()
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
    """Return the mask of lines of sight ``[N, 2]`` from the eye that cross a wall."""
    start, edge = walls[:, :2] - eye, walls[:, 2:] - walls[:, :2]
    turn = sight[:, 0, None] * edge[:, 1] - sight[:, 1, None] * edge[:, 0]
    on_sight = start[:, 0] * edge[:, 1] - start[:, 1] * edge[:, 0]
    on_edge = start[:, 0] * sight[:, 1, None] - start[:, 1] * sight[:, 0, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        s, q = on_sight / turn, on_edge / turn
    return np.asarray(np.any((turn != 0.0) & (s > 0.0) & (s < 1.0) & (q >= 0.0) & (q <= 1.0), axis=1))


@dataclass(frozen=True)
class Occlusion(Degradation):
    """Removes people while they are hidden from a viewpoint by bodies or walls, or out of range.

    At frames without the observer, all people are removed. The track of the observer is unchanged and hides nobody.
    False tracks neither hide others nor are hidden. Place it first in a chain, so true positions occlude.

    Fields:
        probability: probability that a hidden row is lost [1]; the level.
        radius: radius of the bodies [m].
        reach: range of vision [m].
        eye: viewpoint: ``x, y`` [m], or the id of a robot or person; None is the robot of the recording.

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
            raise InputError(f"{self.name}: eye = {self.eye} must be a point x, y [m], or the id of a robot or person")

    def check(self, tracks: Trajectories) -> None:
        super().check(tracks)
        if isinstance(self.eye, tuple):
            return
        robots = sorted(tracks.robots)
        if self.eye is None and not robots:
            raise DataError(
                f"{self.name}: {tracks.name} has no robot as a viewpoint;"
                " set eye to a point x,y [m] or to the id of a person"
            )
        if self.eye is None and len(robots) > 1:
            raise DataError(
                f"{self.name}: {tracks.name} has the robots {', '.join(map(str, robots))};"
                " set eye to the id of one of them"
            )
        if self.eye is not None and self.eye not in tracks.ids:
            raise DataError(
                f"{self.name}: eye = {self.eye}, but {tracks.name} has no track of this id;"
                f" ids go from {tracks.ids[0]} to {tracks.ids[-1]}"
            )

    def degrade(self, seen: DegradedTracks, rng: np.random.Generator) -> DegradedTracks:
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
            lost[rows] = occlusion_mask(eye, place, place[body[rows]], self.radius, self.reach, walls)
        return seen.keep_rows(keeps | ~lost | looks | (seen.truth == GHOST))
