"""MJCF elements of the floor, walls, props and lights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Element, InputError, Walls
from crowdbot.typing import Floats
from crowdbot.world.ground.surfaces import ground_geoms
from crowdbot.world.urdf.geoms import row

from .layers import GROUND, RAISED, STANDING
from .stage import AbsentProp, PhysicsStage, PropBody

THIN, THICK = 0.01, 0.025
"""Half thickness [m] of thin walls and of the surfaces of non-convex solids."""
SLIVER = 1e-3
"""Solids with a smaller area [m2] become thin walls."""


def scenery(walls: Walls, stage: PhysicsStage) -> tuple[list[Element], list[Element]]:
    """Return the assets and world elements for solids, thin walls, props and lights.

    Convex solids become prisms. Each edge of other solids becomes a board on its solid side.
    """
    assets, world = _ground(stage)
    rgba = row((*stage.wall_color, 1.0))
    for number, ring in enumerate(_rings(walls)):
        points = walls.start[ring]
        if len(ring) > 2 and np.all(walls.convex[ring]) and _area(points) > SLIVER:
            heights = np.repeat([0.0, stage.wall_height], len(points))
            corners = np.column_stack([np.tile(points, (2, 1)), heights])
            assets.append(Element("mesh", {"name": f"wall{number}", "vertex": row(corners.ravel())}))
            shape = {"type": "mesh", "mesh": f"wall{number}"}
            world.append(Element("geom", {"name": f"wall/{number}", "rgba": rgba, "group": "0", **shape, **STANDING}))
            continue
        edges = ring[:1] if len(ring) == 2 else ring
        for k, edge in enumerate(edges):
            board = _board(walls.start[edge], walls.end[edge], stage.wall_height, thin=len(ring) == 2)
            name = f"wall/{number}.{k}"
            world.append(Element("geom", {"name": name, "rgba": rgba, "group": "0", **board, **STANDING}))
    world += [prop.body(f"prop{k}") for k, prop in enumerate(stage.props) if not isinstance(prop, AbsentProp)]
    world += [leaf.body(f"door{k}") for k, leaf in enumerate(stage.doors)]
    if stage.ground is not None:
        raised = ground_geoms(stage.ground, {**RAISED, "friction": row((stage.friction, 0.005, 0.0001))})
        assets, world = assets + raised[0], world + raised[1]
    return assets, world


def add_rings(walls: Walls, rings: tuple[Floats, ...]) -> Walls:
    """Return walls with additional rings.

    >>> len(add_rings(Walls.of([[(0, 0), (1, 0)]]), (np.array([[2.0, 0.0], [3.0, 0.0], [3.0, 1.0]]),)))
    5
    """
    more = Walls.of(rings)
    first = len(walls)
    return Walls(
        np.concatenate([walls.start, more.start]),
        np.concatenate([walls.end, more.end]),
        np.concatenate([walls.previous, more.previous + first]),
        np.concatenate([walls.next, more.next + first]),
        np.concatenate([walls.convex, more.convex]),
    )


def remove_ring(walls: Walls, ring: Floats) -> Walls:
    """Return walls without a ring that was added.

    >>> ring = np.array([[2.0, 0.0], [3.0, 0.0], [3.0, 1.0]])
    >>> len(remove_ring(add_rings(Walls.of([[(0, 0), (1, 0)]]), (ring,)), ring))
    2

    Raises:
        InputError: the walls do not have this ring.
    """
    points = Walls.of([ring]).start
    for edges in _rings(walls):
        if np.array_equal(walls.start[edges], points):
            kept = np.setdiff1d(np.arange(len(walls)), edges)
            number = np.zeros(len(walls), dtype=np.int64)
            number[kept] = np.arange(len(kept))
            return Walls(
                walls.start[kept], walls.end[kept], number[walls.previous[kept]], number[walls.next[kept]],
                walls.convex[kept],
            )  # fmt: skip
    raise InputError("the walls have no such outline of a prop")


def prop_outline(prop: PropBody) -> Floats:
    """Return the outline ``[N, 2]`` [m] of a prop at its place, also of a movable one."""
    ring = prop.outline()
    return _square(prop, (prop.x, prop.y), prop.heading) if ring is None else ring


def _square(prop: PropBody, place: Sequence[float] | Floats, turn: float) -> Floats:
    half = 0.5 * float(getattr(prop, "size", 1.0))
    corners = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    cos, sin = np.cos(turn), np.sin(turn)
    return np.asarray(corners @ np.array([[cos, sin], [-sin, cos]]) + place)


def outline_props(walls: Walls, stage: PhysicsStage, frames: Mapping[int, Floats]) -> Walls:
    """Return walls with the outlines of all props; ``frames`` ``[4, 4]`` are those of movable props by number."""
    rings = []
    for number, prop in enumerate(stage.props):
        ring = prop.outline()
        if ring is None and not prop.movable:
            continue
        if ring is None:
            matrix = frames[number]
            ring = _square(prop, matrix[:2, 3], np.arctan2(matrix[1, 0], matrix[0, 0]))
        rings.append(ring)
    edges = () if stage.ground is None else stage.ground.people_barriers()
    return add_rings(walls, (*rings, *edges))


def _ground(stage: PhysicsStage) -> tuple[list[Element], list[Element]]:
    dark = tuple(0.93 * part for part in stage.floor_color)
    squares = {"type": "2d", "builtin": "checker", "width": "256", "height": "256"}
    colors = {"rgb1": row(stage.floor_color), "rgb2": row(dark)}
    sky = {"type": "skybox", "builtin": "gradient", "width": "64", "height": "384"}
    assets = [
        Element("texture", {"name": "sky", "rgb1": "0.80 0.87 0.94", "rgb2": "0.97 0.97 0.97", **sky}),
        Element("texture", {"name": "floor", **squares, **colors}),
        Element("material", {"name": "floor", "texture": "floor", "texrepeat": "0.5 0.5", "texuniform": "true"}),
    ]
    floor = {"name": "floor", "type": "plane", "size": "0 0 1", "material": "floor", "group": "0"}
    world = [Element("geom", {**floor, "friction": row((stage.friction, 0.005, 0.0001)), **GROUND})]
    if stage.lights:
        world += [light.element(f"light{k}") for k, light in enumerate(stage.lights)]
    else:
        sun = {"directional": "true", "pos": "0 0 2.5", "diffuse": "0.55 0.55 0.53", "specular": "0.1 0.1 0.1"}
        world.append(Element("light", {"name": "sun", "dir": "-0.2 0.3 -1", "castshadow": "true", **sun}))
    return assets, world


def _rings(walls: Walls) -> list[NDArray[np.int64]]:
    """Return the edge indices of each ring, in order."""
    found, known = [], np.zeros(len(walls), dtype=np.bool_)
    for first in range(len(walls)):
        if known[first]:
            continue
        ring, edge = [], first
        while not known[edge]:
            known[edge] = True
            ring.append(edge)
            edge = int(walls.next[edge])
        found.append(np.array(ring, dtype=np.int64))
    return found


def _area(points: Floats) -> float:
    x, y = points.T
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))


def _board(start: Floats, end: Floats, height: float, thin: bool) -> dict[str, str]:
    along = end - start
    length = float(np.hypot(*along))
    left = np.array([-along[1], along[0]]) / length
    half = THIN if thin else THICK
    middle = 0.5 * (start + end) + (0.0 if thin else half) * left
    return {
        "type": "box",
        "pos": row((*middle, height / 2)),
        "euler": row((0.0, 0.0, float(np.arctan2(along[1], along[0])))),
        "size": row((length / 2, half, height / 2)),
    }
