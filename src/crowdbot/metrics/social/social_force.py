"""Social forces between a robot and people, and the social work of the robot (HuNavSim, parameters of light-SFM)."""

from __future__ import annotations

import numpy as np

from crowdbot.typing import Floats

from .robot_log import RobotLog

FACTOR, LAMBDA, GAMMA, N, N_PRIME = 2.1, 2.0, 0.35, 2.0, 3.0
"""Parameters of the social force (Moussaid et al. 2009, https://doi.org/10.1098/rspb.2009.0405), as in light-SFM."""
OBSTACLE_FACTOR, OBSTACLE_SIGMA = 10.0, 0.2
"""Factor and range [m] of the force of the nearest wall."""


def force_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``force``."""
    here = log.present[..., None]
    away = log.people_position - log.position[:, None]
    drift = log.velocity[:, None] - log.people_velocity
    on_people = np.where(here, social_force(-away, -drift), 0.0)
    on_robot = np.where(here, social_force(away, drift), 0.0).sum(axis=1)
    people = np.hypot(on_people[..., 0], on_people[..., 1])
    robot, wall = np.hypot(*on_robot.T), OBSTACLE_FACTOR * np.exp(-log.wall_clearance / OBSTACLE_SIGMA)
    return {
        "social_force_on_people": float(people.sum()),
        "max_social_force_on_person": float(people.max(initial=0.0)),
        "social_force_on_robot": float(robot.sum()),
        "obstacle_force_on_robot": float(wall.sum()),
        "social_work": float(robot.sum() + wall.sum() + people.sum()),
        "social_work_rate": float((robot.sum() + wall.sum() + people.sum()) / len(log.times)),
    }


def social_force(away: Floats, drift: Floats) -> Floats:
    """Return the social force ``[..., 2]`` of others on an agent [m/s2].

    Args:
        away: position of the other minus own position ``[..., 2]`` [m].
        drift: own velocity minus that of the other ``[..., 2]`` [m/s].

    >>> force = social_force(np.array([1.0, 0.0]), np.array([0.5, 0.0]))
    >>> round(float(force[0]), 4)
    -0.5033
    """
    distance = np.maximum(1e-9, np.hypot(away[..., 0], away[..., 1]))
    toward = away / distance[..., None]
    mix = LAMBDA * drift + toward
    length = np.maximum(1e-9, np.hypot(mix[..., 0], mix[..., 1]))
    along = mix / length[..., None]
    left = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    angle = np.arctan2(np.sum(left * toward, axis=-1), np.sum(along * toward, axis=-1))
    reach = GAMMA * length
    slow = -np.exp(-distance / reach - (N_PRIME * reach * angle) ** 2)
    turn = -np.sign(angle) * np.exp(-distance / reach - (N * reach * angle) ** 2)
    return np.asarray(FACTOR * (slow[..., None] * along + turn[..., None] * left))
