"""Departure of people at their goals and in exits."""

from __future__ import annotations

import numpy as np

from crowdbot.core import Scene, kernel
from crowdbot.typing import Bools, Floats

from .agent_arrays import BOOL, FLOAT, dense
from .waypoint import PolygonZone, is_inside


def leave_at_goals(scene: Scene, radius: float) -> Scene:
    """Return the scene without the people within a radius [m] of their goal; robots stay.

    >>> leave_at_goals(Scene.of([[0.0, 0.0], [1.0, 0.0]], goal=[[0.1, 0.0], [9.0, 0.0]]), 0.3).active.tolist()
    [[False, True]]
    """
    pairs, goal = (*scene.shape, 2), scene.goal
    stay = np.empty(scene.shape, dtype=np.bool_)
    some = _stay_away(*_people(scene), dense(goal, pairs, FLOAT), float(radius), stay)
    return scene.replace(active=stay) if some else scene


def leave_in_zone(scene: Scene, zone: PolygonZone) -> Scene:
    """Return the scene without the people in a zone; robots stay.

    >>> corner = PolygonZone(((0, 0), (2, 0), (2, 2), (0, 2)))
    >>> leave_in_zone(Scene.of([[1.0, 1.0], [3.0, 1.0]]), corner).active.tolist()
    [[False, True]]
    """
    stay = np.empty(scene.shape, dtype=np.bool_)
    return scene.replace(active=stay) if _stay_outside(*_people(scene), zone.ring, stay) else scene


def _people(scene: Scene) -> tuple[Floats, Bools, Bools]:
    shape = scene.shape
    return (
        dense(scene.position, (*shape, 2), FLOAT),
        dense(scene.active, shape, BOOL),
        dense(scene.external, shape, BOOL),
    )


@kernel
def _stay_away(position: Floats, active: Bools, external: Bools, goal: Floats, radius: float, stay: Bools) -> bool:
    """Write who stays, and return whether somebody leaves."""
    some = False
    for e in range(len(active)):
        for a in range(active.shape[1]):
            stay[e, a] = active[e, a]
            if active[e, a] and not external[e, a]:
                x, y = goal[e, a, 0] - position[e, a, 0], goal[e, a, 1] - position[e, a, 1]
                if x * x + y * y < radius * radius:
                    stay[e, a], some = False, True
    return some


@kernel
def _stay_outside(position: Floats, active: Bools, external: Bools, ring: Floats, stay: Bools) -> bool:
    """Write who stays, and return whether somebody leaves."""
    some = False
    for e in range(len(active)):
        for a in range(active.shape[1]):
            stay[e, a] = active[e, a]
            if active[e, a] and not external[e, a] and is_inside(ring, position[e, a, 0], position[e, a, 1]):
                stay[e, a], some = False, True
    return some
