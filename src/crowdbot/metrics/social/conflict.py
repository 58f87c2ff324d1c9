"""Conflict metrics: fear, panic, and who solves or raises a conflict (responsibility and engagement)."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.typing import Floats

from .robot_log import RobotLog

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
