"""A place of a running simulation with room for one more person."""

from __future__ import annotations

import numpy as np

from crowdbot.metrics import wall_clearance
from crowdbot.simulation import Simulation

__all__ = ["free_place"]

RADIUS = 0.3
ENOUGH = 1.5
"""Clearance [m] above which another place is not better."""
REACH, SPACING = 6.0, 0.5
"""Extent and spacing [m] of the places that are compared."""
NEARNESS = 0.05
"""Clearance [m] that is worth one metre of distance."""


def free_place(simulation: Simulation) -> tuple[float, float]:
    """Return x, y [m] of a place with clearance to walls and everybody, that is seen by a robot or person.

    Places near the middle of all are preferred.

    >>> from crowdbot.trials import load_trial
    >>> x, y = free_place(Simulation(load_trial("frontal")))
    >>> abs(x) < 20.0 and abs(y) < 20.0
    True
    """
    scene = simulation.world.environment_scene(0)
    others, walls = scene.position[0, scene.active[0]], scene.walls.segments()
    middle = others.mean(axis=0) if len(others) else np.zeros(2)
    start = others[np.argmin(np.linalg.norm(others - middle, axis=1))] if len(others) else middle
    steps = np.arange(-REACH, REACH + SPACING, SPACING)
    best, found = -np.inf, start
    for place in np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) + middle:
        gap = float(np.min(np.linalg.norm(others - place, axis=1), initial=np.inf)) - 2.0 * RADIUS
        gap = min(gap, float(wall_clearance(np.stack([start, place]), 0.01, walls)[1]), _gap(place, walls), ENOUGH)
        score = gap - NEARNESS * float(np.linalg.norm(place - middle))
        if score > best:
            best, found = score, place
    return round(float(found[0]), 3), round(float(found[1]), 3)


def _gap(place: np.ndarray, walls: np.ndarray) -> float:
    return float(wall_clearance(place[None], RADIUS, walls)[0])
