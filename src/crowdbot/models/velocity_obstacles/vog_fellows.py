"""Fellows in VOG: which members of the own group an agent keeps with, and the direction in which two walk together."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel

from .vog_cost import DIRECTED

__all__ = ["MOST_FELLOWS", "pick_fellows", "unit", "walking_direction"]

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]

MOST_FELLOWS = 16
"""Most fellows that count."""
ALIKE = 0.7
"""Fellows are ignored if the cosine of the angle between the desired directions is lower."""
PURPOSE = 0.5
"""Desired speeds [m/s] above this have a direction in the choice of fellows."""
POINTED = 0.1
"""A desired speed [m/s] above this gives the direction of walking."""


@kernel
def pick_fellows(
    row: int, mates: Rows, place: Floats, velocity: Floats, desired: Floats, reach: float, most: int,
    found: Rows, key: Floats,
) -> int:  # fmt: skip
    """Find the fellows to keep with: near, ahead and going the same way; return how many."""
    held = 0
    px, py = desired[row, 0], desired[row, 1]
    own = math.sqrt(px * px + py * py)
    lx, ly = (px, py) if own > PURPOSE else (velocity[row, 0], velocity[row, 1])
    look = math.sqrt(lx * lx + ly * ly)
    for other in mates:
        x, y = place[other, 0] - place[row, 0], place[other, 1] - place[row, 1]
        d2 = x * x + y * y
        if other == row or not d2 < reach * reach:
            continue
        qx, qy = desired[other, 0], desired[other, 1]
        its = math.sqrt(qx * qx + qy * qy)
        value = 1.5 * d2
        if look > DIRECTED and d2 > 0.0:
            value -= 0.5 * math.sqrt(d2) * (x * lx + y * ly) / look
        if own > PURPOSE and its > PURPOSE:
            cosine = (px * qx + py * qy) / (own * its)
            if cosine <= ALIKE:
                continue
            value *= 2.0 - cosine
        if held == most and not (most > 0 and value < key[held - 1]):
            continue
        n = min(held, most - 1)
        held = n + 1
        while n > 0 and value < key[n - 1]:
            key[n], found[n] = key[n - 1], found[n - 1]
            n -= 1
        key[n], found[n] = value, other
    return held


@kernel
def unit(x: float, y: float) -> tuple[float, float]:
    """Return the direction of a velocity, 0 when it has none."""
    length = math.sqrt(x * x + y * y)
    return (x / length, y / length) if length > DIRECTED else (0.0, 0.0)


@kernel
def walking_direction(px: float, py: float, qx: float, qy: float, vx: float, vy: float) -> tuple[float, float]:
    """Return the direction in which two fellows walk: as one wants to, or the other, or as one walks."""
    if px * px + py * py > POINTED * POINTED:
        return unit(px, py)
    if qx * qx + qy * qy > POINTED * POINTED:
        return unit(qx, qy)
    return unit(vx, vy)
