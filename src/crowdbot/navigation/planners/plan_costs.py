"""Costs of plans for model-predictive control: progress, contacts and lack of space."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Floats

from .rollout import PlanMotions

LOGISTIC = 1.702
"""Factor with which the logistic function is within 0.01 of the normal distribution."""


def progress_cost(rollout: PlanMotions, top: float, smoothness: float) -> Floats:
    """Return the cost ``[C]`` [s] of the remaining path and of a change of the motion.

    Args:
        rollout: the motion under C plans.
        top: largest speed [m/s].
        smoothness: cost of a full change of the motion [s].
    """
    late = (rollout.remaining.mean(axis=1) + rollout.remaining[:, -1]) / top
    return np.asarray(late + smoothness * rollout.change)


def contact_probability(gap: Floats, margin: float, sigma: Floats) -> Floats:
    """Return the largest probability of a contact over time ``[C, ...]``, ``Phi(-(gap - margin) / sigma)``.

    Args:
        gap: clearances ``[C, T, ...]`` [m].
        margin: clearance at which a contact is as likely as not [m].
        sigma: standard deviations of the clearances [m], of a shape that fits to ``gap``.

    >>> contact_probability(np.array([[0.1, 0.5]]), 0.1, np.array([0.05, 0.05])).tolist()
    [0.5]
    """
    return probability_of((LOGISTIC * (gap - margin) / sigma).min(axis=1))


def probability_of(steep: Floats) -> Floats:
    """Return the probabilities of contact for least scaled clearances, see :func:`nearest_people`."""
    return np.asarray(1.0 / (1.0 + np.exp(np.clip(steep, -50.0, 50.0))))


@kernel
def nearest_people(
    position: Floats, place: Floats, reach: Floats, margin: float, sigma: Floats, covariance: Floats, steep: Floats,
    gap: Floats,
) -> None:  # fmt: skip
    """Write how near C plans come to N people, who are expected at one place at each of T steps.

    Args:
        position: places of the robot ``[C, T, 2]`` [m].
        place: expected places of the people ``[T, N, 2]`` [m].
        reach: distances of centres at contact ``[N]`` [m].
        margin: clearance at which a contact is as likely as not [m].
        sigma: ``[T, N]`` standard deviations of the clearances without the covariances [m].
        covariance: ``[T, N, 2, 2]`` [m^2] of the places, or ``[0, N, 2, 2]``; they count along the line of sight.
        steep: written ``[C, N]``: the least ``1.702 (clearance - margin) / deviation``.
        gap: written ``[C, T]``: the clearance to the nearest person [m].

    >>> steep, gap = np.empty((1, 1)), np.empty((1, 1))
    >>> spread = np.array([[[[0.16, 0.0], [0.0, 1.0]]]])
    >>> nearest_people(np.zeros((1, 1, 2)), np.array([[[1.5, 0.0]]]), np.array([0.5]), 0.1, np.array([[0.3]]), spread,
    ...     steep, gap)
    >>> gap.tolist(), (steep / LOGISTIC).round(9).tolist()
    ([[1.0]], [[1.8]])
    """
    for c in range(len(position)):
        steep[c] = np.inf
        for t in range(position.shape[1]):
            gap[c, t] = np.inf
            for n in range(len(reach)):
                x, y = position[c, t, 0] - place[t, n, 0], position[c, t, 1] - place[t, n, 1]
                square = x * x + y * y
                own = math.sqrt(square) - reach[n]
                deviation = sigma[t, n]
                if len(covariance):
                    s = covariance[t, n]
                    along = (x * x * s[0, 0] + 2.0 * x * y * s[0, 1] + y * y * s[1, 1]) / max(square, 1e-18)
                    deviation = math.sqrt(deviation * deviation + max(along, 0.0))
                steep[c, n] = min(steep[c, n], LOGISTIC * (own - margin) / deviation)
                gap[c, t] = min(gap[c, t], own)


def space_lack(gap: Floats, space: float) -> Floats:
    """Return the lack of a wanted ``space`` [m] as a share, for clearances ``gap`` [m] of any shape.

    >>> space_lack(np.array([-0.1, 0.1, 0.4]), 0.4).tolist()
    [1.0, 0.75, 0.0]
    """
    return np.asarray(np.maximum(1.0 - np.maximum(gap, 0.0) / space, 0.0))
