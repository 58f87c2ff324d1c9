"""TurnHistogram: turns of recorded people with similar position and heading."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Floats, Ints

WIDEST = math.pi / 2
"""Largest turn in the histogram [rad]."""
BINS = 61
"""Number of bins, 3 degrees apart; a sample is split between the two nearest bins."""


class TurnSamples(NamedTuple):
    """M rows of recordings as samples of the histogram.

    Fields:
        place: position ``[M, 2]`` [m].
        heading: unit vector of the velocity ``[M, 2]``.
        turn: turn after ``lookahead`` ``[M]`` [rad].
        worth: weight of the sample ``[M]``.
        straight: fraction of the sample that counts as straight on ``[M]``.
        exit: index of the exit at the end of the track ``[M]``, or the number of exits if unknown.
    """

    place: Floats
    heading: Floats
    turn: Floats
    worth: Floats
    straight: Floats
    exit: Ints


@kernel
def accumulate(
    place: Floats, heading: Floats, samples: TurnSamples, exits: int, reach: float, spread: float, histogram: Floats
) -> None:
    """Fill ``histogram [P, exits + 2, BINS]`` for people ``[P, 2]``: straight on, each exit, exit unknown.

    The weight of a sample is (1 - d/8)^4, d the squared distance in units of ``reach`` [m] plus the squared difference
    of headings in units of ``spread``. This approximates a Gaussian, and is 0 beyond d = 8.
    """
    step = 2.0 * WIDEST / (BINS - 1)
    farthest = 8.0 * reach * reach
    for person in range(place.shape[0]):
        for sample in range(samples.place.shape[0]):
            dx = samples.place[sample, 0] - place[person, 0]
            dy = samples.place[sample, 1] - place[person, 1]
            apart = dx * dx + dy * dy
            if apart >= farthest:
                continue
            hx = samples.heading[sample, 0] - heading[person, 0]
            hy = samples.heading[sample, 1] - heading[person, 1]
            near = 1.0 - (apart / (reach * reach) + (hx * hx + hy * hy) / (spread * spread)) / 8.0
            if near <= 0.0:
                continue
            weight = near * near * near * near * samples.worth[sample]
            at = (min(WIDEST, max(-WIDEST, samples.turn[sample])) + WIDEST) / step
            low = min(int(at), BINS - 2)
            share = at - low
            for layer, part in (
                (0, samples.straight[sample]),
                (1 + samples.exit[sample], 1.0 - samples.straight[sample]),
            ):
                histogram[person, layer, low] += weight * part * (1.0 - share)
                histogram[person, layer, low + 1] += weight * part * share


def median_turn(histogram: Floats, doubt: float = 0.0) -> Floats:
    """Return the median turn [rad] of ``histogram [..., BINS]`` plus a weight ``doubt`` for no turn; 0 if empty.

    >>> import numpy as np
    >>> histogram = np.zeros(BINS)
    >>> histogram[40] = 3.0
    >>> [round(float(np.degrees(median_turn(histogram, doubt))), 1) for doubt in (0.0, 1.0, 3.0, 30.0)]
    [30.0, 29.0, 3.0, 0.3]
    """
    counted = histogram.copy()
    counted[..., BINS // 2] += doubt
    total = np.cumsum(counted, axis=-1)
    # weights are spread uniformly within a bin, which makes the median continuous
    middle = total - 0.5 * counted
    half = 0.5 * total[..., -1:]
    above = np.clip(np.sum(middle < half, axis=-1, keepdims=True), 1, BINS - 1)
    start = np.take_along_axis(middle, above - 1, axis=-1)
    end = np.take_along_axis(middle, above, axis=-1)
    share = np.clip((half - start) / np.where(end > start, end - start, 1.0), 0.0, 1.0)
    turn = (above - 1 + share)[..., 0] * (2.0 * WIDEST / (BINS - 1)) - WIDEST
    return np.where(total[..., -1] > 0.0, turn, 0.0)
