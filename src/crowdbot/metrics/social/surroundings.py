"""Crowd around a robot: density within several radii, nearness, speeds of people near it, and its worst-off people."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.metrics.proximity import ZONES
from crowdbot.typing import Floats

from .metric import undefined_metrics
from .robot_log import RobotLog

RADIUS = 2.5
"""Radius [m] of the disc around the robot, and of the disc around a person that holds the cell."""
RAYS = 120
"""Directions in which the border of a cell is computed."""
ANGLES = 2.0 * math.pi * (np.arange(RAYS) + 0.5) / RAYS
DIRECTIONS = np.stack([np.cos(ANGLES), np.sin(ANGLES)])


def voronoi_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of Voronoi density of the family ``density``."""
    found = [
        voronoi_density(place, people[seen])
        for place, people, seen in zip(log.position, log.people_position, log.present, strict=True)
    ]
    return {"voronoi_density": float(np.mean(found)), "max_voronoi_density": float(np.max(found))}


def voronoi_density(place: Floats, people: Floats) -> float:
    """Return the Voronoi density [1/m2] of the disc M of 2.5 m around a place.

    ``sum_i A(V_i and M) / (A(V_i) A(M))``. ``V_i`` are the points nearer to person i than to all others, at most 2.5 m
    from the person; the robot has no cell. Areas are sums over 120 directions. A single person at the place, or
    nobody, has the classic density. Steffen, Seyfried 2010, https://doi.org/10.1016/j.physa.2009.12.015.

    Args:
        place: ``[2]`` [m].
        people: ``[N, 2]`` [m].

    >>> density = voronoi_density(np.zeros(2), np.array([[0.5, 0.0], [-0.5, 0.0]]))
    >>> round(density * math.pi * 2.5**2, 2)
    1.59
    """
    away = people - place
    near = away[np.hypot(away[:, 0], away[:, 1]) < 2.0 * RADIUS]
    if not len(near):
        return 0.0
    border = _borders(near, away)
    along = near @ DIRECTIONS
    square = along**2 - (np.sum(near**2, axis=1) - RADIUS**2)[:, None]
    half = np.sqrt(np.maximum(square, 0.0))
    enters, leaves = (np.clip(root, 0.0, border) for root in (-along - half, -along + half))
    whole, part = np.sum(border**2, axis=1), np.sum(leaves**2 - enters**2, axis=1)
    return float(np.sum(part / whole)) / (math.pi * RADIUS**2)


def _borders(near: Floats, people: Floats) -> Floats:
    """Return the distance [m] of the border of each cell ``[N, RAYS]`` from its person; people are ``[M, 2]``."""
    to = people - near[:, None]
    square = np.sum(to**2, axis=2)
    i, j = np.nonzero((square > 0.0) & (square < 4.0 * RADIUS**2))
    border = np.full((len(near), RAYS), RADIUS)
    if len(i):
        # |to| / 2 over the cosine of the angle; behind the person there is no border
        ahead = to[i, j] / square[i, j, None] @ DIRECTIONS
        first = np.flatnonzero(np.diff(i, prepend=-1))
        most = np.maximum.reduceat(ahead, first, axis=0)
        border[i[first]] = 0.5 / np.maximum(most, 0.5 / RADIUS)
    return border


RADII = {"2_5m": 2.5, "3m": 3.0, "5m": 5.0, "10m": 10.0}
"""Radii [m] of densities (CrowdBot)."""
LONG = 0.5
"""Time [s] in the intimate or personal zone after which a person counts as disturbed."""


def density_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``density``."""
    away = np.hypot(*np.moveaxis(log.people_position - log.position[:, None], -1, 0))
    away = np.where(log.present, away, np.inf)
    found: dict[str, float] = {}
    for name, radius in RADII.items():
        density = (away < radius).sum(axis=1) / (math.pi * radius**2)
        found |= {f"density_{name}": float(np.mean(density)), f"max_density_{name}": float(np.max(density))}
    near = log.nearest[np.isfinite(log.nearest)]
    spread = float(np.std(near) / np.mean(near)) if len(near) and np.mean(near) != 0.0 else math.nan
    speed = np.hypot(log.people_velocity[..., 0], log.people_velocity[..., 1])
    everyone = speed[log.present]
    found |= {
        "proximity_variation": spread,
        "people_speed": float(np.mean(everyone)) if len(everyone) else math.nan,
        "nearest_person_speed": _nearest_speed(log, away, speed),
    }
    for name, radius in (("2_5m", 2.5), ("5m", 5.0)):
        inner, outer = speed[away < radius], speed[log.present & (away >= radius)]
        known = len(inner) and len(outer) and np.mean(outer) > 0.0
        found[f"velocity_loss_{name}"] = 1.0 - float(np.mean(inner) / np.mean(outer)) if known else math.nan
    return found | voronoi_metrics(log)


def _nearest_speed(log: RobotLog, away: Floats, speed: Floats) -> float:
    rows = np.flatnonzero(np.isfinite(away).any(axis=1))
    return float(np.mean(speed[rows, np.argmin(away[rows], axis=1)])) if len(rows) else math.nan


def person_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``people``: values of the worst-off people, not means over time."""
    if not log.present.shape[1]:
        return undefined_metrics("people")
    least = np.sort(log.least_gap.min(axis=0))
    steps = np.diff(log.times, prepend=log.times[0])
    times = {zone: steps @ (log.gap < ZONES[zone]) for zone in ("intimate", "personal")}
    return {
        "worst_decile_clearance": float(np.mean(least[: max(1, math.ceil(len(least) / 10))])),
        "worst_person_intrusion_time": float(np.max(times["personal"])),
        **{f"{zone}_people_share": float(np.mean(time > LONG)) for zone, time in times.items()},
    }
