"""Routes around walls: lines of sight and shortest paths to exits past corners."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from crowdbot.core import Walls, kernel
from crowdbot.typing import Bools, Floats

from .headings import length, unit

CLEARANCE = 0.4
"""Distance at which people pass corners [m]."""


@kernel
def mark_visible(place: Floats, target: Floats, segments: Floats, seen: Bools) -> None:
    """Fill ``seen [P, N]``: whether no wall ``[S, 4]`` crosses the line from ``[P, 2]`` to ``[P, N, 2]``."""
    for i in range(place.shape[0]):
        px, py = place[i, 0], place[i, 1]
        for j in range(target.shape[1]):
            dx, dy = target[i, j, 0] - px, target[i, j, 1] - py
            free = True
            for s in range(segments.shape[0]):
                ax, ay = segments[s, 0] - px, segments[s, 1] - py
                bx, by = segments[s, 2] - px, segments[s, 3] - py
                side_a, side_b = dx * ay - dy * ax, dx * by - dy * bx
                if side_a * side_b > 0.0:
                    continue
                ex, ey = bx - ax, by - ay
                cross = dx * ey - dy * ex
                if cross == 0.0:
                    continue
                along = (ax * ey - ay * ex) / cross
                if 0.0 < along < 1.0:
                    free = False
                    break
            seen[i, j] = free


@dataclass(frozen=True, eq=False)
class Routes:
    """Shortest paths to exits along lines of sight.

    Fields:
        exits: ``[G, 2, 2]`` [m] start and end of each exit.
        segments: ``[S, 4]`` [m] walls.
        corners: ``[N, 2]`` [m] waypoints at convex corners and ends of walls, offset from the wall.
        rest: ``[N, G]`` [m] path length from each corner to each exit; inf without a path.
    """

    exits: Floats
    segments: Floats
    corners: Floats
    rest: Floats

    @classmethod
    def of(cls, exits: Floats, walls: Walls) -> Self:
        """Return the routes of a layout."""
        segments = np.ascontiguousarray(walls.segments())
        corners = _corners(walls, segments)
        count = len(corners)
        if count == 0:
            return cls(exits, segments, corners, np.zeros((0, len(exits))))
        to_exit = _nearest_on_exits(corners, exits)
        rest = np.where(_visibility(corners, to_exit, segments), length(to_exit - corners[:, None]), np.inf)
        every = np.broadcast_to(corners, (count, count, 2))
        between = np.where(_visibility(corners, every, segments), length(every - corners[:, None]), np.inf)
        for middle in range(count):  # Floyd-Warshall
            between = np.minimum(between, between[:, middle, None] + between[None, middle])
        return cls(exits, segments, corners, np.min(between[:, :, None] + rest[None], axis=1))

    def next(self, place: Floats) -> tuple[Floats, Floats]:
        """Return the next waypoint for each exit ``[P, G, 2]`` [m] and the path length ``[P, G]`` [m].

        The waypoint is the exit if it is visible, otherwise the next corner; the length is inf without a path.
        """
        aim = _nearest_on_exits(place, self.exits)
        way = np.where(_visibility(place, aim, self.segments), length(aim - place[:, None]), np.inf)
        if len(self.corners) == 0 or np.all(np.isfinite(way)):
            return aim, way
        corner = np.broadcast_to(self.corners, (len(place), *self.corners.shape))
        near = np.where(_visibility(place, corner, self.segments), length(corner - place[:, None]), np.inf)
        around = near[:, :, None] + self.rest
        best = np.argmin(around, axis=1)
        hidden = ~np.isfinite(way)
        aim = np.where(hidden[..., None], self.corners[best], aim)
        return aim, np.where(hidden, np.min(around, axis=1), way)


def _visibility(place: Floats, target: Floats, segments: Floats) -> Bools:
    seen = np.ones(target.shape[:2], np.bool_)
    if len(segments):
        mark_visible(np.ascontiguousarray(place), np.ascontiguousarray(target), segments, seen)
    return seen


def _nearest_on_exits(place: Floats, exits: Floats) -> Floats:
    """Return the nearest point ``[P, G, 2]`` [m] on the inner half of each exit."""
    start = 0.75 * exits[:, 0] + 0.25 * exits[:, 1]
    along = 0.5 * (exits[:, 1] - exits[:, 0])
    size = np.sum(along * along, axis=-1)
    share = np.sum((place[:, None] - start) * along, axis=-1) / np.where(size > 0.0, size, 1.0)
    return np.asarray(start + np.clip(share, 0.0, 1.0)[..., None] * along)


def _corners(walls: Walls, segments: Floats) -> Floats:
    """Return points ``[N, 2]`` [m] near convex corners, without those that touch another wall."""
    here = walls.start[walls.convex]
    arriving = unit(here - walls.start[walls.previous[walls.convex]])
    leaving = unit(walls.end[walls.convex] - here)
    away = unit(arriving - leaving)
    found = here + CLEARANCE * np.sqrt(2.0) * away
    free = _distance(found, segments) > 0.5 * CLEARANCE
    return np.ascontiguousarray(found[free])


def _distance(place: Floats, segments: Floats) -> Floats:
    """Return the distance ``[P]`` [m] to the nearest wall; inf without walls."""
    if len(segments) == 0 or len(place) == 0:
        return np.full(len(place), np.inf)
    start, along = segments[:, :2], segments[:, 2:] - segments[:, :2]
    share = np.sum((place[:, None] - start) * along, axis=-1) / np.sum(along * along, axis=-1)
    return np.asarray(length(place[:, None] - start - np.clip(share, 0.0, 1.0)[..., None] * along).min(axis=1))
