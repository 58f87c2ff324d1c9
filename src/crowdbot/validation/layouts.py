"""Walls of the checks: rooms, openings, corridors, corners and cabins as solid rectangles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .scenario import SEEN, CrowdTracks, Solid

THICK = 0.5
"""Thickness of the walls [m]; those of cabins have 0.1 m."""
CORNER_SOLIDS: list[Solid] = [
    (-2.0, -0.5, 12.5, 0.0),
    (12.0, 0.0, 12.5, 18.0),
    (-2.0, 2.0, 10.0, 18.0),
]
"""The corner of RiMEA 6: a corridor 2 m wide with arms of 12 m along the outer walls."""


def rings(solids: Sequence[Solid]) -> list[list[tuple[float, float]]]:
    """Return solid rectangles as rings for :class:`crowdbot.core.Walls`."""
    return [[(x0, y0), (x1, y0), (x1, y1), (x0, y1)] for x0, y0, x1, y1 in solids]


def inside_solids(walk: CrowdTracks, solids: Sequence[Solid]) -> float:
    """Return the share of people whose centre is inside a solid at any time."""
    x, y = walk.position[..., 0], walk.position[..., 1]
    wrong = np.zeros(walk.present.shape, dtype=np.bool_)
    for x0, y0, x1, y1 in solids:
        wrong |= (x > x0) & (x < x1) & (y > y0) & (y < y1)
    return float(np.any(wrong & walk.present, axis=0)[walk.present[0]].mean())


def corridor_walls(length: float, width: float) -> list[list[tuple[float, float]]]:
    """Return the two walls of a corridor along x, ``0 < y < width``, extended at both ends of the track."""
    x0, x1 = -2.0 * SEEN, length + 2.0 * SEEN
    return rings([(x0, -THICK, x1, 0.0), (x0, width, x1, width + THICK)])


def bottleneck_solids(length: float, half: float, door: float, deep: float) -> list[Solid]:
    """Return a room along negative x, closed at ``-length``, that opens into a passage at x = 0.

    Args:
        length: length of the room [m].
        half: half width of the room [m].
        door: width of the passage [m].
        deep: length of the passage [m].
    """
    side = 0.5 * door
    return [
        (0.0, side, deep, half + THICK),
        (0.0, -half - THICK, deep, -side),
        (-length - THICK, half, 0.0, half + THICK),
        (-length - THICK, -half - THICK, 0.0, -half),
        (-length - THICK, -half, -length, half),
    ]


def waiting_room() -> list[Solid]:
    """Return the room of 8 x 5 m of RiMEA 5 with a door of 1 m in the middle of its right wall."""
    return [(-0.5, -0.5, 8.5, 0.0), (-0.5, 5.0, 8.5, 5.5), (-0.5, 0.0, 0.0, 5.0), (8.0, 0.0, 8.5, 2.0),
            (8.0, 3.0, 8.5, 5.0)]  # fmt: skip


def hall_solids(length: float, deep: float, door: float) -> list[Solid]:
    """Return a hall from 0, 0 to ``length, deep`` [m] with two doors of width ``door`` in each long side."""
    solids: list[Solid] = [(-THICK, -THICK, 0.0, deep + THICK), (length, -THICK, length + THICK, deep + THICK)]
    half = 0.5 * door
    for y0, y1 in ((-THICK, 0.0), (deep, deep + THICK)):
        ends = [0.0, 0.25 * length - half, 0.25 * length + half, 0.75 * length - half, 0.75 * length + half, length]
        solids += [(a, y0, b, y1) for a, b in zip(ends[::2], ends[1::2], strict=True)]
    return solids


def two_rooms(way: float, door: float, leave: bool) -> list[Solid]:
    """Return two rooms of 10 x 10 m along x, with a corridor in their middle at y = 5 m.

    Args:
        way: length of the corridor [m].
        door: width of the corridor [m], and of the exit.
        leave: whether the second room has an exit opposite the corridor.
    """
    end = 20.0 + way
    walls: list[Solid] = [(-THICK, -THICK, 0.0, 10.0 + THICK)]
    for x0, x1 in ((0.0, 10.0), (10.0 + way, end)):
        walls += [(x0, -THICK, x1, 0.0), (x0, 10.0, x1, 10.0 + THICK)]
    low, high = 5.0 - 0.5 * door, 5.0 + 0.5 * door
    for x0, x1 in ((10.0, 10.0 + way), (end, end + THICK)) if leave else ((10.0, 10.0 + way),):
        walls += [(x0, -THICK, x1, low), (x0, high, x1, 10.0 + THICK)]
    return walls if leave else [*walls, (end, -THICK, end + THICK, 10.0 + THICK)]


def long_corner_solids(straight: float | None) -> list[Solid]:
    """Return a corridor 10 m wide, straight of a length [m], or (None) with a corner to the right seen from its top."""
    if straight is None:
        return [
            (-0.5, -0.5, 0.0, 30.5),
            (0.0, 30.0, 10.0, 30.5),
            (10.0, 10.0, 18.0, 30.5),
            (0.0, -0.5, 18.0, 0.0),
        ]
    top = straight
    return [(-0.5, -4.0, 0.0, top + 0.5), (10.0, -4.0, 10.5, top + 0.5), (0.0, top, 10.0, top + 0.5)]


def cabin_solids(cabins: int, width: float, deep: float, way: float) -> list[Solid]:
    """Return walls 0.1 m thick around cabins on both sides of a corridor along x, with doors of 1 m in their middle.

    Args:
        cabins: cabins on each side.
        width: width of a cabin [m].
        deep: depth of a cabin [m].
        way: width of the corridor [m].
    """
    half, end = 0.5 * way, cabins * width
    solids: list[Solid] = []
    for sign in (1.0, -1.0):
        near, far = (half, half + deep) if sign > 0.0 else (-half - deep, -half)
        edge = half if sign > 0.0 else -half - 0.1
        back = far if sign > 0.0 else near - 0.1
        solids.append((-0.1, back, end + 0.1, back + 0.1))
        for k in range(cabins + 1):
            solids.append((k * width - 0.05, near, k * width + 0.05, far))
        for k in range(cabins):
            middle = (k + 0.5) * width
            solids += [(k * width, edge, middle - 0.5, edge + 0.1), (middle + 0.5, edge, (k + 1) * width, edge + 0.1)]
    return solids
