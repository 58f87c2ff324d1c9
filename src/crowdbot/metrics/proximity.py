"""Proximity metrics of a logged robot: clearance, proxemic zones, time to collision, local density.

All distances are surface to surface unless stated otherwise: between centres, less both radii. Arrays of a log are
``times [T]``, ``position [T, A, 2]``, ``radius [A]``, ``active [T, A]``; ``robot`` is the index of the robot in A. The
metrics and their usual thresholds are collected in Francis et al. 2025 (ACM THRI), arXiv 2306.16740.
"""

from __future__ import annotations

import math

import numpy as np

from crowdbot.typing import Bools, Floats

JUMP = 15.0
"""A larger speed [m/s] between two samples means that the person left and entered again; nothing is swept."""
ZONES = {"intimate": 0.45, "personal": 1.2, "social": 3.6}
"""Outer edges of the proxemic zones [m], doi 10.1086/200975 (Hall 1968), surface to surface."""


def swept_distance(start: Floats, end: Floats) -> Floats:
    """Return the smallest distance to the origin on the straight line from ``start`` to ``end``, both ``[..., 2]`` [m].

    >>> float(swept_distance(np.array([-3.0, 0.5]), np.array([3.0, 0.5])))
    0.5
    """
    way = end - start
    length2 = way[..., 0] ** 2 + way[..., 1] ** 2
    along = -(start[..., 0] * way[..., 0] + start[..., 1] * way[..., 1])
    share = np.clip(along / np.where(length2 > 0.0, length2, 1.0), 0.0, 1.0)
    near = start + share[..., None] * way
    return np.sqrt(near[..., 0] ** 2 + near[..., 1] ** 2)


def clearance(position: Floats, radius: Floats, active: Bools, robot: int) -> Floats:
    """Return the clearance of all agents to the robot at each sample, ``[T, A]`` [m].

    ``d = |p_i - p| - r_i - r``, negative for overlap, ``inf`` for the robot itself and for absent agents.

    >>> p = np.array([[[0.0, 0.0], [2.0, 0.0]]])
    >>> clearance(p, np.array([0.3, 0.2]), np.ones((1, 2), bool), robot=0).tolist()
    [[inf, 1.5]]
    """
    away = position - position[:, robot : robot + 1]
    gap = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2) - radius - radius[robot]
    return np.where(_others(active, robot), gap, np.inf)


def swept_clearance(times: Floats, position: Floats, radius: Floats, active: Bools, robot: int) -> Floats:
    """Return the smallest clearance of all agents to the robot since the previous sample, ``[T, A]`` [m].

    Motion between samples is assumed straight and uniform, which detects contacts between samples. The first sample of
    an agent, also after a jump at more than 15 m/s, is not swept.

    >>> p = np.array([[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, 0.0]]])
    >>> swept_clearance(np.array([0.0, 0.5]), p, np.array([0.3, 0.2]), np.ones((2, 2), bool), robot=0)[:, 1].tolist()
    [0.5, -0.5]
    """
    result = clearance(position, radius, active, robot)
    if len(position) < 2:
        return result
    step = np.diff(position, axis=0)
    steady = active[1:] & active[:-1] & (np.hypot(step[..., 0], step[..., 1]) <= JUMP * np.diff(times)[:, None])
    away = position - position[:, robot : robot + 1]
    swept = swept_distance(away[:-1], away[1:]) - radius - radius[robot]
    both = steady & steady[:, robot : robot + 1] & _others(active, robot)[1:]
    result[1:] = np.where(both, swept, result[1:])
    return result


def wall_clearance(position: Floats, radius: float, walls: Floats) -> Floats:
    """Return the smallest clearance of a disc to walls since the previous sample, ``[T]`` [m].

    Args:
        position: ``[T, 2]`` [m], moving straight between samples.
        radius: radius of the disc [m].
        walls: segments ``[N, 4]`` x, y, x, y [m].

    >>> wall_clearance(np.array([[0.0, 1.0], [2.0, 1.0]]), 0.3, np.array([[1.0, 0.0, 1.0, 0.5]])).round(3).tolist()
    [0.818, 0.2]
    """
    if len(walls) == 0:
        return np.full(len(position), np.inf)
    before = np.concatenate([position[:1], position[:-1]])[:, None]
    now = position[:, None]
    a, b = walls[None, :, :2], walls[None, :, 2:]
    gap = np.minimum(swept_distance(a - before, a - now), swept_distance(b - before, b - now))
    gap = np.minimum(gap, np.minimum(swept_distance(a - before, b - before), swept_distance(a - now, b - now)))
    crossing = (_side(before, now, a) * _side(before, now, b) < 0.0) & (_side(a, b, before) * _side(a, b, now) < 0.0)
    return np.asarray(np.min(np.where(crossing, 0.0, gap), axis=1) - radius)


def personal_space_compliance(nearest: Floats, space: float = 0.5) -> float:
    """Return the share of samples in which the nearest clearance ``[T]`` [m] is at least ``space`` [m].

    >>> personal_space_compliance(np.array([0.2, 0.5, 3.0, np.inf]))
    0.75
    """
    return float(np.mean(nearest >= space))


def proxemic_shares(nearest: Floats) -> dict[str, float]:
    """Return the share of samples whose nearest clearance ``[T]`` [m] falls in each zone, surface to surface.

    Intimate below 0.45 m (contact included), personal 0.45 to 1.2 m, social 1.2 to 3.6 m; the rest is public.
    Hall measured between bodies; between centres, the zones are wider by both radii.

    >>> proxemic_shares(np.array([-0.1, 0.5, 2.0, 9.0]))
    {'intimate': 0.25, 'personal': 0.25, 'social': 0.25}
    """
    shares: dict[str, float] = {}
    inner = -math.inf
    for zone, outer in ZONES.items():
        shares[zone] = float(np.mean((nearest >= inner) & (nearest < outer)))
        inner = outer
    return shares


def time_to_collision(position: Floats, velocity: Floats, radius: Floats, active: Bools, robot: int) -> Floats:
    """Return the time to collision of all agents with the robot at constant velocities, ``[T, A]`` [s].

    The smallest t >= 0 with ``|s + w t| = r + r_i`` for relative position s and velocity w; 0 for overlap, ``inf``
    without a collision, for the robot itself and for absent agents.

    >>> p, v = np.array([[[0.0, 0.0], [3.0, 0.0]]]), np.array([[[1.0, 0.0], [-1.0, 0.0]]])
    >>> time_to_collision(p, v, np.array([0.5, 0.5]), np.ones((1, 2), bool), robot=0).tolist()
    [[inf, 1.0]]
    """
    s = position - position[:, robot : robot + 1]
    w = velocity - velocity[:, robot : robot + 1]
    gap = s[..., 0] ** 2 + s[..., 1] ** 2 - (radius + radius[robot]) ** 2
    closing = s[..., 0] * w[..., 0] + s[..., 1] * w[..., 1]
    inside = closing**2 - (w[..., 0] ** 2 + w[..., 1] ** 2) * gap
    meets = (closing < 0.0) & (inside > 0.0)
    root = np.sqrt(np.where(meets, inside, 0.0))
    when = np.where(meets, gap / np.where(meets, root - closing, 1.0), np.inf)
    return np.where(_others(active, robot), np.where(gap <= 0.0, 0.0, when), np.inf)


def local_density(position: Floats, active: Bools, robot: int, reach: float = 2.5) -> Floats:
    """Return the density of people around the robot at each sample, ``[T]`` [1/m2].

    ``N / (pi reach^2)`` with N the number of people whose centre is within ``reach`` [m] of the centre of the robot;
    walls do not clip the circle.

    >>> p = np.array([[[0.0, 0.0], [1.0, 0.0], [4.0, 0.0]]])
    >>> local_density(p, np.ones((1, 3), bool), robot=0, reach=2.0).round(4).tolist()
    [0.0796]
    """
    away = position - position[:, robot : robot + 1]
    near = (np.hypot(away[..., 0], away[..., 1]) < reach) & _others(active, robot)
    return np.asarray(near.sum(axis=1) / (math.pi * reach**2))


def _others(active: Bools, robot: int) -> Bools:
    others = active & active[:, robot : robot + 1]
    others[:, robot] = False
    return others


def _side(a: Floats, b: Floats, p: Floats) -> Floats:
    return np.asarray(
        (b[..., 0] - a[..., 0]) * (p[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (p[..., 0] - a[..., 0])
    )
