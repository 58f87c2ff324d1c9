"""Occlusion of people in a plan view: the hidden share of each person, seen from a sensor."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Bools, Floats

SIGHT_LINES = 16
"""Number of sight lines over the width of a person."""


def occluded_shares(
    origin: Floats, position: Floats, radius: Floats, active: Bools, own: int, walls: tuple[Floats, Floats]
) -> Floats:
    """Return which share of the width of each agent other agents and walls hide from a sensor, ``[N, A]``.

    Agents are discs and walls are lines without height. Sixteen sight lines lead from the sensor to points of
    the diameter across the view; one that another disc or a wall cuts is hidden. NaN for absent agents, for the robot
    itself and for agents that contain the sensor.

    Args:
        origin: ``[N, 2]`` position of the sensor [m].
        position: ``[N, A, 2]`` [m].
        radius: ``[N, A]`` [m].
        active: ``[N, A]`` present agents.
        own: column of the robot that has the sensor, which hides nothing; -1 for none.
        walls: start and end of the edges of walls, ``[M, 2]`` each [m].

    >>> place, size = np.array([[[2.0, 0.0], [4.0, 0.0], [0.0, 3.0]]]), np.full((1, 3), 0.25)
    >>> occluded_shares(np.zeros((1, 2)), place, size, np.ones((1, 3), bool), -1, (np.zeros((0, 2)),) * 2).tolist()
    [[0.0, 1.0, 0.0]]
    """
    shares = np.empty(active.shape)
    arrays = (origin, position, radius, walls[0], walls[1])
    origin, position, radius, start, end = (np.ascontiguousarray(one, dtype=np.float64) for one in arrays)
    _fill_shares(origin, position, radius, np.ascontiguousarray(active), own, start, end, shares)
    return shares


@kernel
def _fill_shares(
    origin: Floats, position: Floats, radius: Floats, active: Bools, own: int, start: Floats, end: Floats,
    shares: Floats,
) -> None:  # fmt: skip
    for n in range(len(active)):
        for a in range(active.shape[1]):
            shares[n, a] = math.nan
            x, y, size = position[n, a, 0] - origin[n, 0], position[n, a, 1] - origin[n, 1], radius[n, a]
            away = math.sqrt(x * x + y * y)
            if not active[n, a] or a == own or away <= size:
                continue
            cos, sin, cut = x / away, y / away, 0
            for b in range(active.shape[1]):
                if active[n, b] and b not in (a, own):
                    x, y = position[n, b, 0] - origin[n, 0], position[n, b, 1] - origin[n, 1]
                    cut |= _cut_by_disc(away, size, cos * x + sin * y, cos * y - sin * x, radius[n, b])
            for m in range(len(start)):
                x, y = start[m, 0] - origin[n, 0], start[m, 1] - origin[n, 1]
                u, v = end[m, 0] - origin[n, 0], end[m, 1] - origin[n, 1]
                cut |= _cut_by_line(
                    away, size, cos * x + sin * y, cos * y - sin * x, cos * u + sin * v, cos * v - sin * u
                )
            hidden = 0
            for k in range(SIGHT_LINES):
                hidden += (cut >> k) & 1
            shares[n, a] = hidden / SIGHT_LINES


@kernel(inline=True)
def _cut_by_disc(away: float, size: float, x: float, y: float, radius: float) -> int:
    """Return the sight lines to a person at (away, 0) that a disc at x, y cuts, as bits."""
    if x < -radius or x > away + radius or abs(y) > size + radius:
        return 0
    cut = 0
    for k in range(SIGHT_LINES):
        side = size * ((2.0 * k + 1.0) / SIGHT_LINES - 1.0)
        along = min(1.0, max(0.0, (x * away + y * side) / (away * away + side * side)))
        dx, dy = x - along * away, y - along * side
        if dx * dx + dy * dy < radius * radius:
            cut |= 1 << k
    return cut


@kernel(inline=True)
def _cut_by_line(away: float, size: float, x: float, y: float, u: float, v: float) -> int:
    """Return the sight lines to a person at (away, 0) that a wall from x, y to u, v cuts, as bits."""
    if max(x, u) < 0.0 or min(x, u) > away or min(y, v) > size or max(y, v) < -size:
        return 0
    cut = 0
    for k in range(SIGHT_LINES):
        side = size * ((2.0 * k + 1.0) / SIGHT_LINES - 1.0)
        across = away * (v - y) - side * (u - x)
        if across == 0.0:
            continue
        along, over = (x * (v - y) - y * (u - x)) / across, (x * side - y * away) / across
        if 0.0 < along < 1.0 and 0.0 <= over <= 1.0:
            cut |= 1 << k
    return cut
