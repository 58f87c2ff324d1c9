"""RayShapes: the shapes of a scene as rows for the ray casting kernel."""

from __future__ import annotations

import math
import weakref
from typing import NamedTuple

import numpy as np

from crowdbot.core import PERSON_HEIGHT, STAGE, Bodies, Scene, Skins, SpatialPose, Walls, kernel
from crowdbot.core.rays import BOX, CAPSULE, CYLINDER, WALL, WIDTH
from crowdbot.typing import Bools, Floats, Ints

NOTHING = -1
"""Value of ``hit`` without a return."""
WALLS = -2
"""Value of ``hit`` for a wall."""
FLOOR = -3
"""Value of ``hit`` for the floor."""
PROP = -4
"""Value of ``hit`` for a prop."""
OVERLAP = 1e-9
"""Walls are extended by this length [m] at both ends, against gaps at corners by rounding."""
TALLEST = 1e4
"""Height of infinitely high walls [m]."""
KINDS = (CAPSULE, BOX, CYLINDER, CYLINDER, WALL)
"""Order of the shapes: limbs, boxes, posts, agents without limbs, walls."""
NOBODY = Bodies.of()
BARE = Skins.of(np.zeros((1, 0, 3)), np.zeros((0, 3)), owner=())


class RayShapes(NamedTuple):
    """P shapes and the F triangles of skins in E environments.

    Fields:
        kind: ``[P]`` as in :mod:`crowdbot.core.rays`.
        rows: ``[E, P, 16]`` in the world.
        present: ``[E, P]``.
        owner, part: ``[P]`` labels of a hit.
        vertices, faces, face_owner, face_part: of the skins, see :class:`Skins`.
    """

    kind: Ints
    rows: Floats
    present: Bools
    owner: Ints
    part: Ints
    vertices: Floats
    faces: Ints
    face_owner: Ints
    face_part: Ints


def collect_shapes(scene: Scene, skin: Skins | None, skinned: Ints) -> RayShapes:
    """Return all shapes of ``scene``, without the limbs of the agents who are ``skinned``, whose skin is ``skin``."""
    bodies, skin = scene.bodies or NOBODY, skin or BARE
    limbs, discs = _seen_as(scene, bodies, skinned)
    walls = scene.walls
    counts = (len(limbs), len(bodies.box_owner), len(bodies.post_owner), len(discs), len(walls))
    rows = np.zeros((scene.shape[0], sum(counts), WIDTH))
    capsules, boxes, posts, people, fences = _sections(counts)
    if len(limbs):
        _write_capsules(bodies.start, bodies.end, bodies.radius, limbs, rows[:, capsules])
    if len(bodies.box_owner):
        _write_boxes(bodies, rows[:, boxes])
    if len(bodies.post_owner):
        _write_upright(rows[:, posts], bodies.post_foot, bodies.post_height, bodies.post_radius)
    if len(discs):
        tall = PERSON_HEIGHT if scene.height is None else scene.height[:, discs]
        _write_upright(rows[:, people], scene.position[:, discs], tall, scene.radius[:, discs])
    height = min(scene.wall_height, TALLEST)
    _write_walls(walls.start, walls.end, walls.previous, walls.next, height, rows[:, fences])
    kind = np.repeat(np.array(KINDS), counts)
    owner = np.concatenate(
        [bodies.owner[limbs], bodies.box_owner, bodies.post_owner, discs, np.full(len(walls), WALLS)]
    )
    part = np.full(len(kind), -1)
    for section, labels in (capsules, bodies.part[limbs]), (boxes, bodies.box_part):
        part[section] = labels
    part[posts] = bodies.post_part
    present = np.empty(rows.shape[:2], dtype=np.bool_)
    _mark_present(kind, rows, owner, scene.active, present)
    return RayShapes(kind, rows, present, owner, part, skin.vertices, skin.faces, skin.owner, skin.part)


def _seen_as(scene: Scene, bodies: Bodies, skinned: Ints) -> tuple[Ints, Ints]:
    """Return the capsules that are not replaced by a skin, and the agents represented by cylinders."""
    agents = scene.shape[1]
    bare = np.ones(agents + 1, dtype=np.bool_)  # the last entry is for shapes without agent
    for owner in (skinned, bodies.owner, bodies.box_owner, bodies.post_owner):
        if len(owner):
            _strike(owner, bare)
    limbs = np.arange(len(bodies.owner))
    if len(skinned):
        hidden = np.zeros(agents + 1, dtype=np.bool_)
        hidden[_known(skinned, agents)] = True
        hidden[agents] = False
        limbs = limbs[~hidden[_known(bodies.owner, agents)]]
    return limbs, np.flatnonzero(bare[:agents])


def _known(owner: Ints, agents: int) -> Ints:
    return np.where((owner >= 0) & (owner < agents), owner, agents)


def _sections(counts: tuple[int, ...]) -> list[slice]:
    ends = np.cumsum(counts).tolist()
    return [slice(end - count, end) for end, count in zip(ends, counts, strict=True)]


@kernel
def _strike(owner: Ints, bare: Bools) -> None:
    for n in range(len(owner)):
        if 0 <= owner[n] < len(bare) - 1:
            bare[owner[n]] = False


@kernel
def _mark_present(kind: Ints, rows: Floats, owner: Ints, active: Bools, present: Bools) -> None:
    """Mark the shapes with an active owner, finite values and positive extent; label props."""
    for e in range(len(rows)):
        for n in range(len(kind)):
            here = owner[n] < 0 or (owner[n] < active.shape[1] and active[e, owner[n]])
            total = 0.0
            for k in range(WIDTH):
                total += abs(rows[e, n, k])
            here = here and total < np.inf
            if kind[n] == CAPSULE or kind[n] == CYLINDER:
                here = here and rows[e, n, 7] > 0.0
            if kind[n] == BOX:
                here = here and min(rows[e, n, 12], rows[e, n, 13], rows[e, n, 14]) > 0.0
            present[e, n] = here
    for n in range(len(kind)):
        if owner[n] == STAGE:
            owner[n] = PROP


@kernel
def _write_capsules(start: Floats, end: Floats, radius: Floats, chosen: Ints, row: Floats) -> None:
    for e in range(len(row)):
        for n in range(len(chosen)):
            b = chosen[n]
            dx, dy, dz = end[e, b, 0] - start[e, b, 0], end[e, b, 1] - start[e, b, 1], end[e, b, 2] - start[e, b, 2]
            length = math.sqrt(dx * dx + dy * dy + dz * dz)
            row[e, n, 0], row[e, n, 1], row[e, n, 2] = start[e, b, 0], start[e, b, 1], start[e, b, 2]
            if length == 0.0:
                row[e, n, 5] = 1.0
            else:
                row[e, n, 3], row[e, n, 4], row[e, n, 5] = dx / length, dy / length, dz / length
            row[e, n, 6], row[e, n, 7] = length, radius[e, b]


def _write_boxes(bodies: Bodies, row: Floats) -> None:
    turn = SpatialPose(bodies.box_centre.reshape(-1, 3), bodies.box_turn.reshape(-1, 4)).matrix
    row[..., :3] = bodies.box_centre
    row[..., 3:12] = turn.transpose(0, 2, 1).reshape(*bodies.box_half.shape[:2], 9)
    row[..., 12:15] = bodies.box_half


def _write_upright(row: Floats, foot: Floats, height: Floats | float, radius: Floats) -> None:
    row[..., : foot.shape[-1]] = foot
    row[..., 5] = 1.0
    row[..., 6] = height
    row[..., 7] = np.where(np.asarray(height) > 0.0, radius, 0.0)


@kernel
def _write_walls(start: Floats, end: Floats, before: Ints, after: Ints, height: float, row: Floats) -> None:
    """Write walls extended at both ends; the second side of a thin wall is absent."""
    for m in range(len(start)):
        dx, dy = end[m, 0] - start[m, 0], end[m, 1] - start[m, 1]
        longer = OVERLAP / max(math.sqrt(dx * dx + dy * dy), 1e-300)
        for e in range(len(row)):
            row[e, m, 0], row[e, m, 1] = start[m, 0] - longer * dx, start[m, 1] - longer * dy
            row[e, m, 3], row[e, m, 4] = dx + 2.0 * longer * dx, dy + 2.0 * longer * dy
            row[e, m, 8] = 1.0
            row[e, m, 9] = height
            if before[m] == after[m] and m > after[m]:
                row[e, m, 9] = np.nan


def extend_segments(walls: Floats) -> Floats:
    """Return segments ``[N, 4]`` extended at both ends."""
    along = walls[:, 2:] - walls[:, :2]
    along = along * (OVERLAP / np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-300))[:, None]
    return np.ascontiguousarray(np.concatenate([walls[:, :2] - along, walls[:, 2:] + along], axis=1))


def wall_segments(walls: Walls) -> Floats:
    """Return the segments of walls ``[N, 4]``, extended at both ends; they are computed once for each object."""
    known = _segments.get(id(walls))
    if known is not None and known[0]() is walls:
        return known[1]
    segments = extend_segments(walls.segments())
    segments.flags.writeable = False
    key = id(walls)
    _segments[key] = (weakref.ref(walls, lambda gone: _forget(key, gone)), segments)
    return segments


_segments: dict[int, tuple[weakref.ReferenceType[Walls], Floats]] = {}
"""Extended segments by the identity of the walls."""


def _forget(key: int, gone: weakref.ReferenceType[Walls]) -> None:
    """Remove the segments of walls that no longer exist, unless new walls have their identity."""
    if key in _segments and _segments[key][0] is gone:
        del _segments[key]
