"""Costs of plans for model-predictive control: progress, contacts and lack of space."""

from __future__ import annotations

import numpy as np

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
    steep = np.clip(LOGISTIC * (gap - margin) / sigma, -50.0, 50.0)
    return np.asarray(1.0 / (1.0 + np.exp(steep.min(axis=1))))


def along_variance(away: Floats, covariance: Floats) -> Floats:
    """Return the variance ``[..., N]`` [m^2] of the distance of people along the lines of sight to a robot.

    Args:
        away: ``[..., N, 2]`` [m] from the people to the robot.
        covariance: ``[..., N, 2, 2]`` [m^2] of the positions of the people.

    >>> along_variance(np.array([[3.0, 0.0], [0.0, 2.0]]), np.diag([0.04, 0.01])).tolist()
    [0.04, 0.01]
    """
    x, y = away[..., 0], away[..., 1]
    own = x * x * covariance[..., 0, 0] + 2.0 * x * y * covariance[..., 0, 1] + y * y * covariance[..., 1, 1]
    return np.asarray(np.maximum(own, 0.0) / np.maximum(x * x + y * y, 1e-18))


def space_lack(gap: Floats, space: float) -> Floats:
    """Return the lack of a wanted ``space`` [m] as a share, for clearances ``gap`` [m] of any shape.

    >>> space_lack(np.array([-0.1, 0.1, 0.4]), 0.4).tolist()
    [1.0, 0.75, 0.0]
    """
    return np.asarray(np.maximum(1.0 - np.maximum(gap, 0.0) / space, 0.0))
