"""Cutouts of a scan around each beam, and people from the votes of beams."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Floats, Ints

SAMPLES = 48
"""Number of ranges of a cutout."""
WIDTH = 1.66
"""Width of a cutout at the range of its beam [m]."""
DEPTH = 1.0
"""Ranges are cut off this far before and behind that of the beam [m]."""


@kernel
def cut_windows(ranges: Floats, beams: Ints, step: float, circle: bool, windows: Floats) -> None:
    """Write the cutout ``[B, SAMPLES]`` of each beam: ranges relative to its own, from -1 to 1 [m].

    A cutout has the same width in metres at all ranges. Of the beams between two samples, the nearest surface counts.
    """
    count = len(ranges)
    for b in range(len(beams)):
        k = beams[b]
        centre = ranges[k]
        half = math.atan(0.5 * WIDTH / centre) / step
        for s in range(SAMPLES):
            low = k + half * (2.0 * s / SAMPLES - 1.0)
            high = k + half * (2.0 * (s + 1) / SAMPLES - 1.0)
            first, last = math.floor(low + 0.5), math.floor(high + 0.5)
            near = np.inf
            for beam in range(first, max(first + 1, last)):
                if circle:
                    value = ranges[beam % count]
                elif 0 <= beam < count:
                    value = ranges[beam]
                else:
                    continue
                if 0.0 < value < near:
                    near = value
            windows[b, s] = min(max(near - centre, -DEPTH), DEPTH)


@kernel
def collect_votes(
    votes: Floats, score: Floats, least: float, radius: float, fewest: Floats, place: Floats, count: Ints
) -> int:
    """Write place ``[P, 2]`` and number of votes of each person, and return the number P of people.

    The vote with the highest score takes the others within ``radius`` [m] of it; the person is their weighted mean.
    People with a total score below ``fewest`` ``[B]`` of their first vote are left out.
    """
    free = score >= least
    found = 0
    while True:
        best, top = -1, 0.0
        for k in range(len(score)):
            if free[k] and score[k] > top:
                best, top = k, score[k]
        if best < 0:
            return found
        x, y, weight, number = 0.0, 0.0, 0.0, 0
        for k in range(len(score)):
            away = (votes[k, 0] - votes[best, 0]) ** 2 + (votes[k, 1] - votes[best, 1]) ** 2
            if free[k] and away <= radius * radius:
                free[k] = False
                x, y = x + score[k] * votes[k, 0], y + score[k] * votes[k, 1]
                weight, number = weight + score[k], number + 1
        if weight >= fewest[best]:
            place[found, 0], place[found, 1], count[found] = x / weight, y / weight, number
            found += 1
