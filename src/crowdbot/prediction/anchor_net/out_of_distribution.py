"""Out-of-distribution score of a person: how far the person's situation is from those of the training data.

The situation of a person is described by 8 numbers of the person's track and neighbors. The training stores their mean,
a whitening matrix and two distances; the score increases smoothly from 0 to 1 between the two distances.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .agent_frame import ROWS, AgentHistories

__all__ = ["DESCRIPTORS", "distribution_of", "out_of_distribution", "situation_descriptors"]

Floats = NDArray[np.float64]

DESCRIPTORS = (
    "log speed over the history", "log last speed", "log roughness of the track", "change of speed",
    "number of neighbors", "proximity of the nearest neighbor", "mean relative speed of the neighbors", "observed rows",
)  # fmt: skip
"""Names of the 8 numbers, see :func:`situation_descriptors`."""
SURE, FOREIGN = 0.98, 0.999
"""Quantiles of the distances of the training data; the score is 0 up to the first, 1 from ``WIDE`` times the second."""
WIDE = 1.5
"""Factor of the second distance."""
EVEN = (0.005, 0.015)
"""Deviation of a track from a straight line at constant speed [m]: even below the first, not even above the second."""
EVEN_SHARE = (0.1, 0.3)
"""Share of even tracks among the moving people of a window from which, and above which, all of them are foreign."""
FEWEST_EVEN = 3
"""Number of moving people in a window for which the share of even tracks counts."""
FAST = (1.6, 2.4)
"""Mean displacement in 0.4 s [m] from which, and above which, a person is foreign: 4 and 6 m/s."""
SLOW = 0.08
"""Displacement in 0.4 s below which a person does not count as moving [m]."""


def situation_descriptors(people: AgentHistories) -> Floats:
    """Return descriptors ``[N, 8]`` of people: see :data:`DESCRIPTORS`; lengths are in metres per 0.4 s.

    Roughness is the root mean square of the second differences of the track. Descriptors depend neither on the
    position nor on the heading.
    """
    step = people.past[:, 1:] - people.past[:, :-1]
    speed = np.hypot(step[..., 0], step[..., 1])
    whole = np.hypot(*(people.past[:, -1] - people.past[:, 0]).T) / (ROWS - 1.0)
    bend = step[:, 1:] - step[:, :-1]
    rough = np.sqrt((bend[..., 0] ** 2 + bend[..., 1] ** 2).mean(axis=1))
    distance = np.where(people.there, np.hypot(people.near[..., 0], people.near[..., 1]), np.inf)
    relative = people.pace - step[:, None, -1]
    count = people.there.sum(axis=1)
    closing = np.where(people.there, np.hypot(relative[..., 0], relative[..., 1]), 0.0).sum(axis=1)
    return np.stack(
        [
            np.log(0.02 + whole), np.log(0.02 + speed[:, -1]), np.log(0.01 + rough), speed[:, -1] - speed.mean(axis=1),
            count / people.there.shape[1], 1.0 / (1.0 + distance.min(axis=1, initial=np.inf)),
            closing / np.maximum(count, 1), people.seen.mean(axis=1),
        ],
        axis=1,
    )  # fmt: skip


def distribution_of(people: AgentHistories) -> dict[str, Floats]:
    """Return the arrays of the weights that describe the situations of training data, for the score."""
    found = situation_descriptors(people)
    middle = found.mean(axis=0)
    values, vectors = np.linalg.eigh(np.cov(found.T) + 1e-4 * np.eye(found.shape[1]))
    whitening = vectors / np.sqrt(values)
    distance = _distances(found, middle, whitening)
    low, high = np.quantile(distance, (SURE, FOREIGN))
    return {"situation_mean": middle, "situation_whitening": whitening, "situation_range": np.array([low, WIDE * high])}


def out_of_distribution(
    numbers: Mapping[str, NDArray[Any]], people: AgentHistories, window: NDArray[np.int64]
) -> Floats:
    """Return scores ``[N]`` between 0 (like the training data) and 1; 0 for weights without a description of them.

    Args:
        numbers: weights.
        people: histories.
        window: ``[N]`` window of each person.

    The score is the largest of four: the distance of the person's situation from the training data, the speed above
    4 m/s, the evenness of the person's track, and the share of even tracks in the window. No measured person walks in
    a straight line at constant speed to a few millimetres; simulated people do.
    """
    if "situation_mean" not in numbers:
        return np.zeros(len(people.past))
    distance = _distances(situation_descriptors(people), numbers["situation_mean"], numbers["situation_whitening"])
    low, high = numbers["situation_range"]
    even, moves = _evenness(people)
    count = np.bincount(window, moves.astype(np.float64))
    share = np.bincount(window, np.where(moves, even, 0.0)) / np.maximum(count, 1.0)
    simulated = np.where(count >= FEWEST_EVEN, _ramp(share, *EVEN_SHARE), 0.0)
    fast = _ramp(np.hypot(*(people.past[:, -1] - people.past[:, 0]).T) / (ROWS - 1.0), *FAST)
    return np.asarray(np.max([_ramp(distance, low, high), even, simulated[window], fast], axis=0))


def _evenness(people: AgentHistories) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the evenness ``[N]`` of tracks of moving people, between 0 and 1, and who moves with all rows observed."""
    row = np.arange(ROWS) - 0.5 * (ROWS - 1)
    away = people.past - people.past.mean(axis=1, keepdims=True)
    step = (away * row[:, None]).sum(axis=1) / float((row * row).sum())
    rest = away - step[:, None] * row[:, None]
    deviation = np.sqrt((rest[..., 0] ** 2 + rest[..., 1] ** 2).mean(axis=1))
    moves = (np.hypot(step[:, 0], step[:, 1]) > SLOW) & people.seen.all(axis=1)
    return np.where(moves, 1.0 - _ramp(deviation, *EVEN), 0.0), moves


def _ramp(value: Floats, low: float, high: float) -> Floats:
    """Return 0 below ``low``, 1 above ``high`` and a smooth value between."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share))


def _distances(found: Floats, middle: Floats, whitening: Floats) -> Floats:
    """Return Mahalanobis distances ``[N]``; the order of the sums does not depend on the batch."""
    away = found - middle
    square = np.zeros(len(found))
    for column in range(whitening.shape[1]):
        along = np.zeros(len(found))
        for row in range(whitening.shape[0]):
            along = along + away[:, row] * whitening[row, column]
        square = square + along * along
    return np.sqrt(square)
