"""Legibility: how early the path of a robot shows its goal."""

from __future__ import annotations

import numpy as np

from crowdbot.typing import Floats

from .metric import undefined_metrics
from .robot_log import RobotLog

ANGLES = (-90.0, -45.0, 0.0, 45.0, 90.0)
"""Directions [degrees] of possible goals as seen from the start, relative to the true one."""


def legibility_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metric of the family ``legibility``; NaN without a goal or a time above 0."""
    if log.goal is None or log.duration <= 0.0:
        return undefined_metrics("legibility")
    turns = np.radians(ANGLES)
    way = log.goal - log.position[0]
    goals = log.position[0] + np.stack(
        [np.cos(turns) * way[0] - np.sin(turns) * way[1], np.sin(turns) * way[0] + np.cos(turns) * way[1]], axis=1
    )
    return {"legibility": legibility(log.times, log.position, goals, ANGLES.index(0.0))}


def legibility(times: Floats, position: Floats, goals: Floats, goal: int) -> float:
    """Return the legibility of a path, 0 to 1: the probability of its goal, early samples weighted more.

    ``sum P(G | path to t) (T - t) dt / sum (T - t) dt`` with ``P(G) ~ exp(-(L(t) + |G - x(t)| - |G - x(0)|))``, L(t)
    the length of the path so far [m]. Dragan, Lee, Srinivasa 2013, https://doi.org/10.1109/HRI.2013.6483603.

    Args:
        times, position: ``[T]`` [s], ``[T, 2]`` [m].
        goals: possible goals ``[G, 2]`` [m], all equally likely at first.
        goal: index of the true one.

    >>> t = np.linspace(0.0, 1.0, 11)
    >>> straight = np.stack([5.0 * t, 0.0 * t], axis=1)
    >>> round(legibility(t, straight, np.array([[5.0, 0.0], [0.0, 5.0]]), 0), 3)
    0.777
    """
    left = np.hypot(*np.moveaxis(goals[None] - position[:, None], -1, 0))
    # the length so far is the same for all goals and cancels
    score = left[0] - left
    share = np.exp(score - score.max(axis=1, keepdims=True))
    chance = share[:, goal] / share.sum(axis=1)
    weight = (times[-1] - times) * np.diff(times, append=times[-1])
    return float(np.sum(chance * weight) / np.sum(weight))
