"""Features of tracked people, from which a network predicts how they leave a straight path."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.perception.tracks import Tracks
from crowdbot.sensors import Scan, planar_pose
from crowdbot.typing import Floats

LAGS = (0.5, 1.0)
"""Times before now [s] whose velocities are features."""
NEIGHBOURS, SIGHT = 5, 6.0
"""Number of neighbours, and their largest distance [m]."""
SECTORS, FREE = 8, 4.0
"""Sectors around a person, and the largest distance of a surface [m]."""
OWN = 0.5
"""Returns at most this far from a tracked person [m] are no surface."""
SOFT = 0.3
"""Distance [m] that is added before the inverse of a distance is taken."""
FASTEST = 3.0
"""Limit of velocities in features [m/s]."""
SAME_TIME = 0.06
"""Largest difference of two times that are the same [s]."""
FEATURES = 4 + 3 * len(LAGS) + 6 * NEIGHBOURS + SECTORS
"""Number of features of a person."""


class EarlierTracks(NamedTuple):
    """Identities ``[N]`` and velocities ``[N, 2]`` [m/s] of tracked people at an earlier time [s]."""

    time: float
    ids: NDArray[np.int64]
    velocity: Floats


def person_frames(velocity: Floats) -> Floats:
    """Return the rotations ``[N, 2, 2]`` from the world to frames whose x axis is along velocities ``[N, 2]``."""
    size = np.hypot(velocity[:, 0], velocity[:, 1])
    ahead = np.where(size[:, None] > 1e-6, velocity / np.maximum(size, 1e-6)[:, None], [1.0, 0.0])
    return np.stack([ahead, np.stack([-ahead[:, 1], ahead[:, 0]], axis=-1)], axis=1)


def track_features(tracks: Tracks, earlier: Sequence[EarlierTracks], scans: Sequence[Scan]) -> Floats:
    """Return the features ``[N, FEATURES]`` of tracked people, each in the frame of its velocity.

    They are the speed, the logarithms of two variances, whether the person is detected, changes of the velocity in the
    last 0.5 and 1 s, place and velocity of the five nearest people (the scanner is one of them), and the inverse
    distances of surfaces in eight sectors.

    Args:
        tracks: N people at the last scan.
        earlier: the tracks before, in the order of time.
        scans: the last scans.
    """
    turn, N = person_frames(tracks.velocity), len(tracks)
    speed = np.minimum(np.hypot(*tracks.velocity.T), FASTEST)
    spread = np.log(np.clip(tracks.covariance[:, (0, 2), (0, 2)], 1e-6, 10.0))
    parts = [speed[:, None], spread, tracks.detected[:, None].astype(np.float64)]
    for lag in LAGS:
        parts.append(_change(tracks, earlier, lag, turn))
    parts.append(_neighbours(tracks, scans, turn).reshape(N, -1))
    points = scans[-1].points()[0][:, :2]
    nearest = np.full((N, SECTORS), FREE)
    _measure_sectors(np.ascontiguousarray(points), tracks.position, turn, nearest)
    parts.append(1.0 / (SOFT + nearest))
    return np.concatenate(parts, axis=1)


def _change(tracks: Tracks, earlier: Sequence[EarlierTracks], lag: float, turn: Floats) -> Floats:
    """Return the velocity some time ago minus that of now, and whether it is known, ``[N, 3]``."""
    found = np.zeros((len(tracks), 3))
    row = min(earlier, key=lambda one: abs(one.time - tracks.time + lag), default=None)
    if row is None or abs(row.time - tracks.time + lag) > SAME_TIME:
        return found
    _, now, then = np.intersect1d(tracks.ids, row.ids, assume_unique=True, return_indices=True)
    away = row.velocity[then] - tracks.velocity[now]
    found[now, :2] = np.clip(np.einsum("nij,nj->ni", turn[now], away), -FASTEST, FASTEST)
    found[now, 2] = 1.0
    return found


def _neighbours(tracks: Tracks, scans: Sequence[Scan], turn: Floats) -> Floats:
    """Return place, velocity, inverse distance and presence ``[N, NEIGHBOURS, 6]`` of the nearest people."""
    here, before = (planar_pose(scan.pose).position[0] for scan in (scans[-1], scans[max(0, len(scans) - 2)]))
    passed = float(np.max(scans[-1].time) - np.max(scans[max(0, len(scans) - 2)].time))
    own = (here - before) / passed if passed > 0.0 else np.zeros(2)
    place, velocity = np.vstack([tracks.position, here]), np.vstack([tracks.velocity, own])
    away = place[None] - tracks.position[:, None]
    distance = np.hypot(away[..., 0], away[..., 1])
    N = len(tracks)
    distance[np.arange(N), np.arange(N)] = math.inf
    order = np.argsort(distance, axis=1, kind="stable")[:, :NEIGHBOURS]
    found, row = np.zeros((N, NEIGHBOURS, 6)), np.arange(N)[:, None]
    near = distance[row, order]
    there, width = near < SIGHT, order.shape[1]
    found[:, :width, :2] = np.einsum("nij,nkj->nki", turn, away[row, order])
    motion = np.einsum("nij,nkj->nki", turn, velocity[order] - tracks.velocity[:, None])
    found[:, :width, 2:4] = np.clip(motion, -2.0 * FASTEST, 2.0 * FASTEST)
    found[:, :width, 4], found[:, :width, 5] = 1.0 / (SOFT + near), 1.0
    found[:, :width][~there] = 0.0
    return found


@kernel
def _measure_sectors(points: Floats, people: Floats, turn: Floats, nearest: Floats) -> None:
    """Shorten the distances ``[N, S]`` to the surfaces in the sectors around people."""
    N, S = nearest.shape
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        if math.isnan(x):
            continue
        owned = False
        for n in range(N):
            owned = owned or (people[n, 0] - x) ** 2 + (people[n, 1] - y) ** 2 <= OWN * OWN
        if owned:
            continue
        for n in range(N):
            dx, dy = x - people[n, 0], y - people[n, 1]
            away = math.sqrt(dx * dx + dy * dy)
            if away < FREE:
                ahead, left = turn[n, 0, 0] * dx + turn[n, 0, 1] * dy, turn[n, 1, 0] * dx + turn[n, 1, 1] * dy
                s = int((math.atan2(left, ahead) + math.pi) / (2.0 * math.pi) * S) % S
                nearest[n, s] = min(nearest[n, s], away)
