"""Contract test of stages."""

from __future__ import annotations

import numpy as np

from crowdbot.core import InputError

from .stage import Stage

PERSON = 0.3
"""Room that a person needs around its centre [m]."""
CELLS = 100
"""Points per axis of the search for free room."""


def check_stage(stage: Stage) -> None:
    """Check that a stage has walls and room for people.

    Raises:
        InputError: the first violated rule.

    >>> check_stage(Stage(walkable=[(0, 0), (8, 0), (8, 4), (0, 4)]))
    >>> check_stage(Stage(walkable=[(0, 0), (8, 0), (8, 0.4), (0, 0.4)]))
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: the stage has no place for a person, 0.3 m from every wall
    """
    if not stage.rings:
        raise InputError("the stage has no walls; give it an area, a map or walls")
    corners = np.concatenate(stage.rings)
    low, high = corners.min(axis=0), corners.max(axis=0)
    axes = [np.linspace(low[k], high[k], CELLS) for k in (0, 1)]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    if not np.any(stage.clearance(points) >= PERSON):
        raise InputError(f"the stage has no place for a person, {PERSON:g} m from every wall")
