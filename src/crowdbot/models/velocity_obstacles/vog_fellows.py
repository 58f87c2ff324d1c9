"""Group members in VOG: selection of members to stay with, and common walking direction."""

from __future__ import annotations

import math

from crowdbot.core import kernel
from crowdbot.typing import Floats, Ints

from .vog_cost import DIRECTED

MOST_FELLOWS = 16
"""Maximum number of group members considered."""
ALIKE = 0.7
"""Group members are ignored if the cosine of the angle between the desired directions is lower."""
PURPOSE = 0.5
"""Minimum desired speed [m/s] that defines a direction in the selection of group members."""
POINTED = 0.1
"""Minimum desired speed [m/s] that defines the walking direction."""


@kernel
def pick_fellows(
    row: int, mates: Ints, place: Floats, velocity: Floats, desired: Floats, reach: float, most: int,
    found: Ints, key: Floats,
) -> int:  # fmt: skip
    """Find the group members to stay with: near, ahead and in the same direction; return their number."""
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
    """Return the direction of a velocity, or 0 if it is too slow."""
    length = math.sqrt(x * x + y * y)
    return (x / length, y / length) if length > DIRECTED else (0.0, 0.0)


@kernel
def walking_direction(px: float, py: float, qx: float, qy: float, vx: float, vy: float) -> tuple[float, float]:
    """Return the common walking direction of two agents: desired direction of either, otherwise current direction."""
    if px * px + py * py > POINTED * POINTED:
        return unit(px, py)
    if qx * qx + qy * qy > POINTED * POINTED:
        return unit(qx, qy)
    return unit(vx, vy)
