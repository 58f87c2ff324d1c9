"""Voronoi density around a robot: people per area, with the area that each person has among the others."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.typing import Floats

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
