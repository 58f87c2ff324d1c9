"""Clearance of points of a robot to people and walls, as arrays."""

from __future__ import annotations

import numpy as np

from crowdbot.core import Twist, kernel
from crowdbot.core.outlines import wall_gap
from crowdbot.navigation.batch_rows import drive_numbers
from crowdbot.navigation.dynamic_window import dynamic_window_twist
from crowdbot.navigation.goal_motion import holonomic_twists
from crowdbot.navigation.observation import Observation
from crowdbot.typing import Floats

TINY = 1e-9
"""Smallest length [m] by which a vector is divided."""


def vectors_from_walls(points: Floats, segments: Floats) -> Floats:
    """Return the vectors ``[P, M, 2]`` [m] from the nearest points of walls to points.

    Args:
        points: ``[P, 2]`` [m].
        segments: ``[M, 4]`` x, y, x, y [m].

    >>> vectors_from_walls(np.array([[1.0, 2.0]]), np.array([[0.0, 0.0, 4.0, 0.0]])).tolist()
    [[[0.0, 2.0]]]
    """
    a, along = segments[:, :2], segments[:, 2:] - segments[:, :2]
    away = points[:, None] - a
    length2 = np.maximum((along**2).sum(axis=1), TINY**2)
    share = np.clip((away * along).sum(axis=2) / length2, 0.0, 1.0)
    return np.asarray(away - share[..., None] * along)


def wall_gaps(points: Floats, segments: Floats, radius: float) -> Floats:
    """Return the clearance ``[P]`` [m] of a robot at points ``[P, 2]`` to the nearest wall; inf without walls."""
    if len(segments) == 0:
        return np.full(len(points), np.inf)
    away = vectors_from_walls(points, segments)
    return np.asarray(np.hypot(away[..., 0], away[..., 1]).min(axis=1) - radius)


def robot_wall_gaps(observation: Observation, points: Floats, heading: Floats, segments: Floats) -> Floats:
    """Return the clearance ``[P]`` [m] of the robot, a disc or an outline, to the nearest wall; inf without walls.

    Args:
        observation: what the robot knows.
        points, heading: poses ``[P, 2]`` [m], ``[P]`` [rad].
        segments: ``[M, 4]`` x, y, x, y [m].
    """
    if not len(observation.outline) or not len(segments):
        return wall_gaps(points, segments, observation.radius)
    out = np.empty(len(points))
    arrays = map(np.ascontiguousarray, (points, heading, segments, observation.outline))
    place, turn, walls, outline = arrays
    _outline_gaps(place, turn, walls, outline, out)
    return out


@kernel
def _outline_gaps(place: Floats, turn: Floats, walls: Floats, outline: Floats, out: Floats) -> None:
    for p in range(len(place)):
        out[p] = np.inf
        for m in range(len(walls)):
            gap = wall_gap(
                place[p, 0], place[p, 1], turn[p], outline, 0, len(outline),
                walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3],
            )  # fmt: skip
            out[p] = min(out[p], gap)


def move_with(observation: Observation, wish: Floats, speed: float) -> Twist:
    """Return the twist of a drive that moves with a velocity ``[2]`` of the world [m/s] as well as it can.

    A drive that cannot move sideways takes :func:`dynamic_window_twist`; a holonomic drive moves with the velocity and
    turns towards it.
    """
    top = min(speed, observation.limits.max_speed)
    size = float(np.hypot(wish[0], wish[1]))
    vx, vy = (wish * min(1.0, top / max(size, TINY))).tolist()
    if not observation.limits.holonomic:
        return dynamic_window_twist(observation, (vx, vy), speed)
    out = np.zeros((1, 3))
    pose, numbers = np.array([observation.pose], np.float64), drive_numbers(observation.limits, speed)
    holonomic_twists(np.ones(1, np.bool_), pose, np.array([[vx, vy]]), numbers, float(observation.dt), out)
    return Twist(*out[0].tolist())
