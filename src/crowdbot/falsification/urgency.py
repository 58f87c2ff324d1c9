"""Urgency: how long, and how close in time, a robot is on a collision course."""

from __future__ import annotations

import numpy as np

from crowdbot.simulation import Episode

FADE = 1.0
"""Time to collision [s] at which the urgency is 1/e."""


def collision_urgency(episode: Episode) -> float:
    """Return the time integral [s] of the urgency of the first robot: exp(-TTC / 1 s) of its most urgent neighbour.

    TTC is the time to collision of two circles that keep their present velocities; it is infinite if they miss each
    other. A method that holds a margin keeps its smallest clearance there in nearly every run; this integral still
    differs from run to run.

    Source: after the time integrated time-to-collision of Minderhoud & Bovy 2001, doi:10.1016/S0001-4575(00)00019-1.

    >>> from crowdbot.simulation import simulate
    >>> from crowdbot.trials import load_trial
    >>> 0.0 < collision_urgency(simulate(load_trial("frontal", duration=4.0), 0)) < 4.0
    True
    """
    robot = episode.robots[0]
    others = np.delete(np.arange(len(episode.ids)), robot)
    if not len(others) or len(episode.times) < 2:
        return 0.0
    away = episode.position[:, others] - episode.position[:, [robot]]
    speed = episode.velocity[:, others] - episode.velocity[:, [robot]]
    square = np.maximum(np.sum(speed**2, axis=2), 1e-12)
    approach = -np.sum(away * speed, axis=2)
    gap = np.maximum(np.sum(away**2, axis=2) - (episode.radius[others] + episode.radius[robot]) ** 2, 0.0)
    root = approach**2 - square * gap
    meets = (root >= 0.0) & (approach > 0.0) & episode.active[:, others]
    time = np.where(meets, (approach - np.sqrt(np.maximum(root, 0.0))) / square, np.inf)
    urgency = np.exp(-time / FADE).max(axis=1)
    return float(np.sum(urgency[:-1] * np.diff(episode.times)))
