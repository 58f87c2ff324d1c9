"""Solids of uneven ground: geoms for the engine and the camera, and boxes for range sensors."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import Element
from crowdbot.typing import Floats
from crowdbot.world.urdf.geoms import row
from crowdbot.world.urdf.transforms import axis_rotation, frame

from .ground import Ground
from .part import GroundPart

SLAB = 0.02
"""Least thickness [m] of the boxes below a slope."""
LAYERS = 16
"""Largest number of boxes below a slope."""
COLORS = {"ramp": "0.70 0.72 0.76 1", "step": "0.74 0.68 0.60 1", "platform": "0.72 0.72 0.68 1"}


def ground_geoms(ground: Ground, layer: dict[str, str]) -> tuple[list[Element], list[Element]]:
    """Return the assets and the geoms of the ground; ``layer`` has collision filter and friction."""
    assets, geoms = [], []
    for number, part in enumerate(ground.parts):
        if max(part.rear, part.front) <= 0.0:
            continue
        kind = "ramp" if part.slope else ("step" if part.stairs else "platform")
        shared = {"name": f"ground/{number}", "rgba": COLORS[kind], "group": "0", **layer}
        if part.slope:
            corners = np.concatenate(
                [
                    np.column_stack([part.corners, np.zeros(4)]),
                    np.column_stack([part.corners, part.heights])[part.heights > 0.0],
                ]
            )
            assets.append(Element("mesh", {"name": f"ground{number}", "vertex": row(corners.ravel())}))
            geoms.append(Element("geom", {**shared, "type": "mesh", "mesh": f"ground{number}"}))
        else:
            size = (0.5 * part.length, 0.5 * part.width, 0.5 * part.front)
            place = {"pos": row((part.x, part.y, size[2])), "euler": row((0.0, 0.0, part.heading))}
            geoms.append(Element("geom", {**shared, "type": "box", "size": row(size), **place}))
    return assets, geoms


def ground_boxes(ground: Ground) -> tuple[Floats, Floats]:
    """Return frames ``[K, 4, 4]`` and half sizes ``[K, 3]`` [m] of boxes with the surface of the ground.

    The top of a slope is the face of a thin box, exactly; the solid below it is filled with level boxes that end below
    the top.
    """
    rows = [box for part in ground.parts for box in (_slope_boxes(part) if part.slope else _level_box(part))]
    if not rows:
        return np.zeros((0, 4, 4)), np.zeros((0, 3))
    return np.stack([place for place, _ in rows]), np.stack([size for _, size in rows])


def _level_box(part: GroundPart) -> list[tuple[Floats, Floats]]:
    if part.front <= 0.0:
        return []
    turn = axis_rotation((0.0, 0.0, 1.0), part.heading)
    size = np.array([0.5 * part.length, 0.5 * part.width, 0.5 * part.front])
    return [(frame((part.x, part.y, 0.5 * part.front), turn), size)]


def _slope_boxes(part: GroundPart) -> list[tuple[Floats, Floats]]:
    turn = axis_rotation((0.0, 0.0, 1.0), part.heading)
    base = frame((part.x, part.y, 0.0), turn)
    rise = abs(part.front - part.rear)
    thick = max(SLAB, rise / LAYERS)
    angle = math.atan(part.slope)
    # the middle of the top is at the mean height; the box hangs below it
    down = np.array([math.sin(angle), 0.0, -math.cos(angle)]) * 0.5 * thick
    top = np.array([0.0, 0.0, 0.5 * (part.rear + part.front)])
    size = np.array([0.5 * part.length / math.cos(angle), 0.5 * part.width, 0.5 * thick])
    slope_boxes = [(base @ frame(top + down, axis_rotation((0.0, 1.0, 0.0), -angle)), size)]
    count = max(1, math.ceil(rise / thick))
    for k in range(count):
        low, high = (k / count, (k + 1) / count)
        tall = min(part.rear + low * (part.front - part.rear), part.rear + high * (part.front - part.rear))
        if tall <= 0.0:
            continue
        middle = (0.5 * (low + high) - 0.5) * part.length
        half = np.array([0.5 * part.length / count, 0.5 * part.width, 0.5 * tall])
        slope_boxes.append((base @ frame((middle, 0.0, 0.5 * tall)), half))
    return slope_boxes
