"""Exit detection: ends of tracks, and openings in the border of the walkable area."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Walls
from crowdbot.data import Trajectories
from crowdbot.typing import Floats, Ints

from .headings import length

MOST_ENDS = 3000
"""Maximum number of end points to cluster; above it, every k-th point is used."""
STEP = 0.1
"""Sampling distance along the border [m]."""
NEAR_WALL = 0.3
"""A wall closer than this [m] closes the border."""
NARROWEST = 0.5
"""Minimum width of an opening [m], wide enough for a person."""


def track_ends(tracks: Trajectories) -> tuple[Ints, Floats, NDArray[np.bool_]]:
    """Return the ids of people ``[P]``, the ends of their tracks ``[P, 2]`` [m], and whether a track is complete.

    Tracks that reach the end of the recording are truncated: their end is not a destination.
    """
    order = np.lexsort((tracks.frame, tracks.id))
    last = np.append(tracks.id[order][1:] != tracks.id[order][:-1], True)
    rows = order[last]
    rows = rows[~np.isin(tracks.id[rows], list(tracks.robots))]
    gone = tracks.frame[rows] < tracks.frame[-1] - tracks.frame_step
    return tracks.id[rows], tracks.position[rows], gone


def clusters(points: Floats, width: float, fewest: int) -> Floats:
    """Return the centres ``[G, 2]`` [m] of clusters of at least ``fewest`` points within ``width`` [m].

    Complete linkage is invariant to rotation.
    """
    from scipy.cluster.hierarchy import fcluster, linkage

    if len(points) > MOST_ENDS:
        points = points[:: -(-len(points) // MOST_ENDS)]
    if len(points) == 1:
        return points.copy() if fewest <= 1 else np.zeros((0, 2))
    group = fcluster(linkage(points, "complete"), width, "distance")
    centres = [points[group == g].mean(axis=0) for g in np.unique(group) if np.sum(group == g) >= fewest]
    return np.array(centres).reshape(-1, 2)


def hull(points: Floats) -> Floats:
    """Return the convex hull ``[N, 2]`` of points, counter-clockwise, starting at the corner farthest from the mean."""
    from scipy.spatial import ConvexHull

    corner = points[ConvexHull(points).vertices]
    first = int(np.argmax(length(corner - points.mean(axis=0))))
    return np.asarray(np.roll(corner, -first, axis=0))


def openings(border: Floats, walls: Walls, width: float) -> Floats:
    """Return the parts of the ring ``border [N, 2]`` without walls as segments ``[G, 2, 2]`` of about ``width`` [m]."""
    place = _sample_ring(border)
    open_ = ~_is_near_wall(place, walls)
    if not np.any(open_):
        return np.zeros((0, 2, 2))
    if not np.all(open_):  # start at a wall so that no opening is divided
        first = int(np.argmin(open_))
        place, open_ = np.roll(place, -first, axis=0), np.roll(open_, -first)
    else:
        place, open_ = np.concatenate([place, place[:1]]), np.append(open_, True)
    edge = np.diff(np.concatenate([[0], open_.astype(np.int64), [0]]))
    pieces = []
    for start, end in zip(np.flatnonzero(edge == 1), np.flatnonzero(edge == -1), strict=True):
        run = place[start:end]
        far = np.concatenate([[0.0], np.cumsum(length(np.diff(run, axis=0)))])
        if far[-1] < NARROWEST:
            continue
        count = max(1, round(far[-1] / width))
        cut = np.searchsorted(far, np.linspace(0.0, far[-1], count + 1) - 1e-9)
        pieces += [(run[a], run[b]) for a, b in itertools.pairwise(cut)]
    return np.array(pieces, dtype=np.float64).reshape(-1, 2, 2)


def _sample_ring(border: Floats) -> Floats:
    """Return points on a ring at equal distances."""
    parts = []
    for start, end in zip(border, np.roll(border, -1, axis=0), strict=True):
        count = max(1, round(float(length(end - start)) / STEP))
        parts.append(start + (end - start) * (np.arange(count) / count)[:, None])
    return np.concatenate(parts)


def _is_near_wall(place: Floats, walls: Walls) -> NDArray[np.bool_]:
    """Return which points are near a wall or inside a solid."""
    if len(walls) == 0:
        return np.zeros(len(place), np.bool_)
    along = walls.end - walls.start
    share = np.sum((place[:, None] - walls.start) * along, axis=-1) / np.sum(along * along, axis=-1)
    off = place[:, None] - walls.start - np.clip(share, 0.0, 1.0)[..., None] * along
    return np.asarray((length(off).min(axis=1) < NEAR_WALL) | _is_in_solid(place, walls))


def _is_in_solid(place: Floats, walls: Walls) -> NDArray[np.bool_]:
    """Return which points lie inside a solid ring (winding number 1)."""
    start, end = walls.start - place[:, None], walls.end - place[:, None]
    cross = start[..., 0] * end[..., 1] - start[..., 1] * end[..., 0]
    up = (start[..., 1] <= 0.0) & (end[..., 1] > 0.0) & (cross > 0.0)
    down = (start[..., 1] > 0.0) & (end[..., 1] <= 0.0) & (cross < 0.0)
    return np.asarray(np.sum(up, axis=1) - np.sum(down, axis=1) > 0)
