"""Comfort, conflict and social force: personal space, fear, who solves a conflict, and the work of the robot."""

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


SMALL = 0.01
"""Times [s] and speeds below this are 0 (SocNavData2026)."""
MOST_FEAR = 10.0
"""Fear at a time to collision of 0 [1/s]."""


def conflict_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``conflict``."""
    fear, panic = fear_and_panic(log)
    return {
        "max_fear": float(np.max(fear, initial=0.0)),
        "mean_fear": float(np.mean(fear.max(axis=1, initial=0.0))),
        "max_panic": float(np.max(panic, initial=0.0)),
        "mean_panic": float(np.mean(panic.max(axis=1, initial=0.0))),
        **conflict_shares(log),
    }


def fear_and_panic(log: RobotLog) -> tuple[Floats, Floats]:
    """Return the fear and the panic of each person ``[T, P]`` [1/s], 0 if absent.

    Fear is the inverse of the time to collision, at most 10 below 0.01 s. Panic is defined without a collision ahead,
    for
    people whom the robot approaches: ``sqrt(V2 / C2) g / (g - V rho)`` with relative velocity V, distance C, sum of the
    radii rho and ``g = sqrt(V2 C2 - (C.V)2)``.
    """
    ttc = log.ttc
    fear = np.where(np.isinf(ttc), 0.0, np.where(ttc > SMALL, 1.0 / np.maximum(ttc, SMALL), MOST_FEAR))
    away = log.people_position - log.position[:, None]
    speed = log.velocity[:, None] - log.people_velocity
    reach = log.radius + log.people_radius
    c2, v2, inner = np.sum(away**2, axis=-1), np.sum(speed**2, axis=-1), np.sum(away * speed, axis=-1)
    side = np.sqrt(np.maximum(0.0, v2 * c2 - inner**2))
    room = side - np.sqrt(v2) * reach
    ok = np.isinf(ttc) & (inner > 0.0) & (room > SMALL) & log.present
    panic = np.where(ok, np.sqrt(v2 / np.maximum(c2, 1e-12)) * side / np.where(ok, room, 1.0), 0.0)
    return np.where(log.present, fear, 0.0), panic


def conflict_shares(log: RobotLog) -> dict[str, float]:
    """Return how much the robot solves and raises conflicts with people, of all that is solved and raised.

    The conflict with a person is ``c = max(0, 1 - d / (r + r_i))`` with d the distance of closest approach at constant
    velocities. From one sample to the next, each of the two changes it by its change of velocity (mean of both orders);
    the rest is due to time. Decreases and increases are summed over samples and people.
    """
    lower, higher = np.zeros(3), np.zeros(3)
    both = log.present[1:] & log.present[:-1]
    reach = log.radius + log.people_radius
    away = log.people_position - log.position[:, None]
    v, w = log.velocity[:, None], log.people_velocity
    old = _conflict(away[:-1], w[:-1] - v[:-1], reach)
    robot_only = _conflict(away[:-1], w[:-1] - v[1:], reach)
    person_only = _conflict(away[:-1], w[1:] - v[:-1], reach)
    both_new = _conflict(away[:-1], w[1:] - v[1:], reach)  # velocities change first, then the step is walked with them
    new = _conflict(away[1:], w[1:] - v[1:], reach)
    robot = 0.5 * ((robot_only - old) + (both_new - person_only))
    person = 0.5 * ((person_only - old) + (both_new - robot_only))
    for k, change in enumerate((robot, person, new - both_new)):
        lower[k] = np.sum(np.where(both, np.maximum(0.0, -change), 0.0))
        higher[k] = np.sum(np.where(both, np.maximum(0.0, change), 0.0))
    raised, solved = higher[0] + higher[1], float(np.sum(lower))
    return {
        "conflict": float(np.sum(np.where(both, new, 0.0) * np.diff(log.times)[:, None])),
        "responsibility": float(lower[0] / solved) if solved > 0.0 else math.nan,
        "people_responsibility": float(lower[1] / solved) if solved > 0.0 else math.nan,
        "engagement": float(higher[0] / raised) if raised > 0.0 else math.nan,
    }


def _conflict(away: Floats, motion: Floats, reach: Floats) -> Floats:
    """Return ``max(0, 1 - d / reach)`` with d the distance of closest approach from now on."""
    speed2 = np.sum(motion**2, axis=-1)
    when = np.maximum(0.0, -np.sum(away * motion, axis=-1) / np.where(speed2 > 1e-12, speed2, 1.0))
    near = away + np.where(speed2 > 1e-12, when, 0.0)[..., None] * motion
    return np.maximum(0.0, 1.0 - np.hypot(near[..., 0], near[..., 1]) / reach)


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
