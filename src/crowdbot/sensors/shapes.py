"""Shapes: what rays can meet in a scene, as one list of rows for the kernel."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import STAGE, Bodies, InputError, Scene, SpatialPose
from crowdbot.core.rays import BOX, CAPSULE, CYLINDER, TRIANGLE, WALL, WIDTH
from crowdbot.core.scene import PERSON_HEIGHT

__all__ = ["FLOOR", "NOTHING", "PROP", "WALLS", "Shapes", "gathered", "lengthened"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

NOTHING = -1
"""Value of ``hit`` where a beam returned nothing."""
WALLS = -2
"""Value of ``hit`` where a beam met a wall."""
FLOOR = -3
"""Value of ``hit`` where a beam met the floor."""
PROP = -4
"""Value of ``hit`` where a beam met something of the stage that is neither wall nor floor."""
OVERLAP = 1e-9
"""Walls are this much longer [m] at both ends, so that rounding lets no beam slip through a corner."""
TALLEST = 1e4
"""Walls without end are this high [m]."""


class Shapes(NamedTuple):
    """P shapes in E environments; those of kind ``TRIANGLE`` come first and have no rows of their own.

    Fields:
        kind: ``[P]`` as in :mod:`crowdbot.core.rays`.
        rows: ``[E, P, 16]`` in the world.
        present: ``[E, P]``.
        owner, part: ``[P]`` what a hit is called.
        vertices, faces: of the triangles, ``[E, V, 3]`` and ``[F, 3]``.
        floor: whether there is one at z = 0.
        nothing, ground: what no hit and the floor are called.
    """

    kind: Ints
    rows: Floats
    present: Bools
    owner: Ints
    part: Ints
    vertices: Floats
    faces: Ints
    floor: bool
    nothing: int
    ground: int


def gathered(scene: Scene, skins: bool) -> Shapes:
    """Return everything in ``scene`` that a ray can meet."""
    bodies = scene.bodies or Bodies.of()
    if skins and bodies.skins is None:
        raise InputError("skins: the scene has no triangle skins; give Scene.bodies skins, or leave skins=False")
    environments, agents = scene.shape
    skinned = bodies.skins.owner if skins and bodies.skins is not None else np.zeros(0, dtype=np.int64)
    limbs = ~np.isin(bodies.owner, skinned[skinned >= 0])
    embodied = np.isin(np.arange(agents), np.concatenate([bodies.owner, bodies.box_owner, bodies.post_owner, skinned]))
    groups = [
        _capsules(bodies, limbs),
        _boxes(bodies),
        _posts(bodies),
        _discs(scene, np.flatnonzero(~embodied)),
        _walls(scene),
    ]
    faces = np.zeros((0, 3), dtype=np.int64)
    vertices = np.zeros((environments, 0, 3))
    kinds, owners, parts, here = [], [], [], []
    if skins and bodies.skins is not None:
        faces, vertices = bodies.skins.faces, np.ascontiguousarray(bodies.skins.vertices)
        kinds.append(np.full(len(faces), TRIANGLE))
        owners.append(bodies.skins.owner)
        parts.append(bodies.skins.part)
        here.append(np.isfinite(vertices).all(axis=-1)[:, faces].all(axis=-1))
    rows = [np.zeros((environments, len(faces), WIDTH))]
    for kind, row, owner, part in groups:
        kinds.append(np.full(len(owner), kind))
        rows.append(np.broadcast_to(row, (environments, *row.shape[1:])))
        owners.append(owner)
        parts.append(part)
        here.append(np.broadcast_to(_sound(kind, row), (environments, len(owner))))
    owner = np.concatenate(owners)
    return Shapes(
        np.concatenate(kinds),
        np.concatenate(rows, axis=1),
        np.concatenate(here, axis=1) & _active(owner, scene.active),
        np.where(owner == STAGE, PROP, owner),
        np.concatenate(parts),
        vertices,
        np.ascontiguousarray(faces),
        True,
        NOTHING,
        FLOOR,
    )


def _active(owner: Ints, active: Bools) -> Bools:
    agents = active.shape[1]
    known = np.concatenate([active, np.ones((len(active), 1), dtype=np.bool_)], axis=1)
    return known[:, np.where((owner >= 0) & (owner < agents), owner, agents)] & (owner < agents)


def _sound(kind: int, row: Floats) -> Bools:
    """``[E, P]``, whether a shape is there: finite, and with an extent above 0."""
    fine = np.isfinite(row).all(axis=-1)
    if kind in (CAPSULE, CYLINDER):
        fine &= row[..., 7] > 0.0
    if kind == BOX:
        fine &= (row[..., 12:15] > 0.0).all(axis=-1)
    return fine


Group = tuple[int, Floats, Ints, Ints]


def _capsules(bodies: Bodies, chosen: Bools) -> Group:
    start, end = bodies.start[:, chosen], bodies.end[:, chosen]
    row = np.zeros((*start.shape[:2], WIDTH))
    axis = end - start
    length = np.sqrt((axis**2).sum(axis=-1))
    row[..., :3] = start
    row[..., 3:6] = np.where(length[..., None] > 0.0, axis / np.maximum(length, 1e-300)[..., None], [0.0, 0.0, 1.0])
    row[..., 6] = length
    row[..., 7] = bodies.radius[:, chosen]
    return CAPSULE, row, bodies.owner[chosen], bodies.part[chosen]


def _boxes(bodies: Bodies) -> Group:
    environments, count = bodies.box_half.shape[:2]
    row = np.zeros((environments, count, WIDTH))
    turn = SpatialPose(bodies.box_centre.reshape(-1, 3), bodies.box_turn.reshape(-1, 4)).matrix
    row[..., :3] = bodies.box_centre
    row[..., 3:12] = turn.transpose(0, 2, 1).reshape(environments, count, 9)
    row[..., 12:15] = bodies.box_half
    return BOX, row, bodies.box_owner, bodies.box_part


def _posts(bodies: Bodies) -> Group:
    row = np.zeros((*bodies.post_radius.shape, WIDTH))
    row[..., :3] = bodies.post_foot
    row[..., 5] = 1.0
    row[..., 6] = bodies.post_height
    row[..., 7] = np.where(bodies.post_height > 0.0, bodies.post_radius, 0.0)
    return CYLINDER, row, bodies.post_owner, bodies.post_part


def _discs(scene: Scene, agents: Ints) -> Group:
    row = np.zeros((scene.shape[0], len(agents), WIDTH))
    row[..., :2] = scene.position[:, agents]
    row[..., 5] = 1.0
    row[..., 6] = PERSON_HEIGHT if scene.height is None else scene.height[:, agents]
    row[..., 7] = scene.radius[:, agents]
    return CYLINDER, row, agents, np.full(len(agents), -1)


def _walls(scene: Scene) -> Group:
    walls = lengthened(scene.walls.segments())
    row = np.zeros((1, len(walls), WIDTH))
    row[0, :, :2] = walls[:, :2]
    row[0, :, 3:5] = walls[:, 2:] - walls[:, :2]
    row[0, :, 8] = 1.0
    row[0, :, 9] = min(scene.wall_height, TALLEST)
    return WALL, row, np.full(len(walls), WALLS), np.full(len(walls), -1)


def lengthened(walls: Floats) -> Floats:
    """Return segments ``[N, 4]`` a little longer at both ends."""
    along = walls[:, 2:] - walls[:, :2]
    along = along * (OVERLAP / np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-300))[:, None]
    return np.ascontiguousarray(np.concatenate([walls[:, :2] - along, walls[:, 2:] + along], axis=1))
