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


def out_of_distribution(numbers: Mapping[str, NDArray[Any]], people: AgentHistories) -> Floats:
    """Return scores ``[N]`` between 0 (like the training data) and 1; 0 for weights without a description of them."""
    if "situation_mean" not in numbers:
        return np.zeros(len(people.past))
    distance = _distances(situation_descriptors(people), numbers["situation_mean"], numbers["situation_whitening"])
    low, high = numbers["situation_range"]
    share = np.clip((distance - low) / (high - low), 0.0, 1.0)
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
