"""Comfort metrics: discomfort, asymmetric personal space, intended paths, and violations by who caused them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.metrics.contacts import MARGIN, contact_stretches
from crowdbot.metrics.outline_clearance import body_clearance
from crowdbot.metrics.proximity import ZONES
from crowdbot.typing import Floats

from .robot_log import RobotLog

DISCOMFORT = 0.2
"""Clearance [m] below which a step is uncomfortable (CrowdNav)."""
WEIGHT = 0.5
"""Weight of the discomfort in the reward of CrowdNav."""
INTENT_STEPS, INTENT_STEP, INTENT_SPACE = 5, 0.25, 0.25
"""Steps, time step [s] and additional distance [m] of the intended path (CrowdNav with predictions)."""


def comfort_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``comfort``."""
    near = log.nearest
    close = (near >= 0.0) & (near < DISCOMFORT)
    steps = np.diff(log.times, prepend=log.times[0])
    cost = personal_space_cost(log)
    worst = cost.max(axis=1, initial=0.0)
    inside, reach = _intended_path(log)
    found = {
        "discomfort_share": float(np.mean(close)),
        "discomfort_distance": float(np.mean(near[close])) if close.any() else math.nan,
        "discomfort_integral": float(np.sum(WEIGHT * (DISCOMFORT - near[close]) * steps[close])),
        "personal_space_cost": float(np.max(worst)),
        "personal_space_integral": float(np.sum(worst[1:] * steps[1:])),
        "intended_path_intrusion": float(np.mean(inside)),
        "intended_path_distance": float(np.mean(reach[inside])) if inside.any() else math.nan,
    }
    for zone in ("intimate", "personal"):
        robot, person = zone_violations(log, ZONES[zone])
        found |= {f"robot_on_person_{zone}": robot, f"person_on_robot_{zone}": person}
    return found


def personal_space_cost(log: RobotLog) -> Floats:
    """Return the cost ``[T, P]`` of the robot's centre in the personal space of each person, 0 to 1.

    An asymmetric Gaussian in the frame of the person: deviation ``max(2 |v|, 0.5)`` [m] ahead, 2/3 of it to the sides
    and half of it behind. Kirby 2010, Social Robot Navigation, PhD thesis, CMU-RI-TR-10-13.
    """
    away = log.position[:, None] - log.people_position
    cos, sin = np.cos(log.people_heading), np.sin(log.people_heading)
    ahead, left = cos * away[..., 0] + sin * away[..., 1], -sin * away[..., 0] + cos * away[..., 1]
    front = np.maximum(2.0 * np.hypot(log.people_velocity[..., 0], log.people_velocity[..., 1]), 0.5)
    along = np.where(ahead >= 0.0, front, front / 2.0)
    cost = np.exp(-0.5 * ((ahead / along) ** 2 + (left / (2.0 / 3.0 * front)) ** 2))
    return np.where(log.present, cost, 0.0)


def _intended_path(log: RobotLog) -> tuple[NDArray[np.bool_], Floats]:
    """Return at which samples the robot is on anyone's intended path, and its clearance to the nearest person [m]."""
    ahead = INTENT_STEP * np.arange(1, INTENT_STEPS + 1)
    place = log.people_position[:, :, None] + log.people_velocity[:, :, None] * ahead[:, None]
    points = place.reshape(len(log.times), -1, 2)
    size = np.repeat(log.people_radius, INTENT_STEPS)
    gap = body_clearance(log.position, log.heading, log.radius, log.outline, points, size)
    near = (gap < INTENT_SPACE) & np.repeat(log.present, INTENT_STEPS, axis=1)
    return np.asarray(near.any(axis=1)), log.nearest


def zone_violations(log: RobotLog, reach: float) -> tuple[float, float]:
    """Return how often the robot entered the zone of a person, and a person that of the robot.

    A violation is counted when the clearance falls below ``reach`` [m], and again after 0.5 s at 0.05 m above it. The
    one
    who approaches faster by more than 0.05 m/s has caused it; with equal speeds both counts rise. A robot slower than
    0.05 m/s causes none (as in SEAN 2.0).
    """
    robot = person = 0
    for k in np.flatnonzero((log.gap < reach).any(axis=0)).tolist():
        gap = np.where(np.isfinite(log.gap[:, k]), log.gap[:, k] - reach, 1e9)
        for first, _ in contact_stretches(log.times, gap, gap):
            away = log.people_position[first, k] - log.position[first]
            normal = away / max(1e-9, math.hypot(*away))
            own = max(0.0, float(log.velocity[first] @ normal)) if log.speed[first] >= MARGIN else 0.0
            other = max(0.0, float(-log.people_velocity[first, k] @ normal))
            robot += own > other - MARGIN and own > 0.0
            person += other > own - MARGIN or own == 0.0
    return float(robot), float(person)
