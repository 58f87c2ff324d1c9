"""Pairs of legs: clusters as wide as a leg that are at most a stride apart are one person."""

from __future__ import annotations

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Bools, Floats, Ints

LONE_LEG = 0.08
"""Additional standard deviation [m] of a person of whom one leg is seen."""
HIDDEN = 0.12
"""Additional standard deviation [m] of a person of whom an edge is hidden."""


def join_legs(
    place: Floats, width: Floats, hidden: Bools, size: Ints, leg_width: float, stride: float
) -> tuple[Floats, Floats, Ints]:
    """Return position ``[N, 2]``, additional deviation ``[N]`` [m] and beams ``[N]`` of the people in clusters.

    Legs are paired in the order of their distances, each at most once.

    Args:
        place: ``[C, 2]`` centres of the clusters [m].
        width: ``[C]`` [m].
        hidden: ``[C]`` whether an edge is hidden.
        size: ``[C]`` number of beams.
        leg_width: largest width of a leg [m].
        stride: largest distance of a pair [m].
    """
    leg = width <= leg_width
    partner = np.full(len(place), -1, dtype=np.int64)
    _pair(place, np.flatnonzero(leg), stride, partner)
    paired = partner >= 0
    first = paired & (np.arange(len(place)) < partner)
    centre = place.copy()
    centre[first] = 0.5 * (place[first] + place[partner[first]])
    beams = size.copy()
    beams[first] += size[partner[first]]
    spread = np.where(hidden, HIDDEN, np.where(leg & ~paired, LONE_LEG, 0.0))
    kept = ~paired | first
    return np.ascontiguousarray(centre[kept]), spread[kept], beams[kept]


@kernel
def _pair(place: Floats, legs: Ints, stride: float, partner: Ints) -> None:
    """Write the partner of each leg, the nearest pairs first."""
    while True:
        best, one, other = stride * stride, -1, -1
        for i in range(len(legs)):
            a = legs[i]
            for j in range(i + 1, len(legs)):
                b = legs[j]
                if partner[a] < 0 and partner[b] < 0:
                    square = (place[a, 0] - place[b, 0]) ** 2 + (place[a, 1] - place[b, 1]) ** 2
                    if square <= best:
                        best, one, other = square, a, b
        if one < 0:
            return
        partner[one], partner[other] = other, one
