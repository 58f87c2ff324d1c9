"""Floor plan of uneven ground and doors, as lines of a drawing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from crowdbot.core import Path2D
from crowdbot.typing import Floats

from .elements import Stairs

GROUND_COLOR, DOOR_COLOR = "#b08d57", "#2a7f9e"
HEAD = 0.25
"""Length of the strokes of an arrowhead, as a share of the width of a slope."""


def floor_plan(stage: Any, shares: Mapping[str, float] | None = None) -> list[Path2D]:
    """Return the lines of uneven ground and doors of a stage, seen from above.

    Parts of the ground are outlines. A slope or stairs have an arrow in the direction in which they rise. A door is a
    thick line at its current place, with a thin line along its way: the arc of a hinged leaf, or the closed sliding
    leaf.

    Args:
        stage: the stage of a trial.
        shares: how far doors are open, by name: from 0, closed, to 1; below 0, a hinged leaf opens to the other side
            (default: as at the start of the trial).

    >>> from crowdbot.trials import Door, Ramp, Stage
    >>> ramp = Ramp(x=2, y=0, length=4, width=2, height=0.3)
    >>> door = Door(name="hall", points=[(6, -1), (6, 1)], open=True)
    >>> lines = floor_plan(Stage(ground=(ramp,), doors=(door,)))
    >>> len(lines), lines[-1].points.round(3).tolist()
    (4, [[6.0, -1.0], [4.0, -1.0]])
    """
    physical, found = stage.physical(), list[Path2D]()
    for part in physical.ground.parts if physical.ground is not None else ():
        corners = part.corners
        found.append(Path2D(np.concatenate([corners, corners[:1]]), GROUND_COLOR, 1.0))
        if part.front != part.rear:
            turn = 0.0 if part.front > part.rear else math.pi
            arrow = _arrow(part.x, part.y, part.heading + turn, part.length, part.width)
            found.append(Path2D(arrow, GROUND_COLOR, 1.0))
    for item in stage.ground:
        if isinstance(item, Stairs):
            found.append(
                Path2D(_arrow(item.x, item.y, item.heading, item.steps * item.tread, item.width), GROUND_COLOR, 1.0)
            )
    starts = {door.name: float(door.open and door.opening in ("order", "schedule")) for door in stage.doors}
    for leaf in physical.doors:
        share = (shares or {}).get(leaf.name, starts[leaf.name])
        side = -1.0 if share < 0.0 else 1.0
        way = np.linspace(0.0, side, 17)
        arc = leaf.line(0.0) if leaf.kind == "sliding" else np.stack([leaf.line(float(item))[1] for item in way])
        found += [Path2D(arc, DOOR_COLOR, 0.7, 0.7), Path2D(leaf.line(float(share)), DOOR_COLOR, 3.0)]
    return found


def _arrow(x: float, y: float, heading: float, length: float, width: float) -> Floats:
    """Return the line of an arrow along a part of the ground; NaN interrupts it."""
    ahead = np.array([math.cos(heading), math.sin(heading)])
    aside, middle = np.array([-ahead[1], ahead[0]]), np.array([x, y])
    tip, size = middle + 0.4 * length * ahead, HEAD * min(length, width)
    gap = np.full(2, np.nan)
    rows = [middle - 0.4 * length * ahead, tip, gap, tip - size * (ahead + aside), tip]
    return np.stack([*rows, tip - size * (ahead - aside)])
