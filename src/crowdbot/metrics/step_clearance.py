"""Clearances during one time step, for many environments at once; motion is straight and uniform."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from crowdbot.core import kernel
from crowdbot.core.outlines import Outlines, swept_gap, swept_wall_gap
from crowdbot.typing import Bools, Floats, Ints


@kernel
def swept_length(sx: float, sy: float, ex: float, ey: float) -> float:
    """Return the smallest distance to the origin on the line from s to e, as :func:`swept_distance` does."""
    wx, wy = ex - sx, ey - sy
    length2 = wx * wx + wy * wy
    share = min(1.0, max(0.0, -(sx * wx + sy * wy) / (length2 if length2 > 0.0 else 1.0)))
    nx, ny = sx + share * wx, sy + share * wy
    return math.sqrt(nx * nx + ny * ny)


@kernel
def _cross(ax: float, ay: float, bx: float, by: float, px: float, py: float) -> float:
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@kernel
def _agents(before: Floats, after: Floats, radius: Floats, active: Bools, robot: int, out: Floats) -> float:
    """Write the clearance of each agent to the robot, and return the smallest."""
    least = math.inf
    for e in range(len(before)):
        bx, by, ax, ay = before[e, robot, 0], before[e, robot, 1], after[e, robot, 0], after[e, robot, 1]
        for a in range(before.shape[1]):
            out[e, a] = math.inf
            if a == robot or not active[e, a] or not active[e, robot]:
                continue
            sx, sy = before[e, a, 0] - bx, before[e, a, 1] - by
            gap = swept_length(sx, sy, after[e, a, 0] - ax, after[e, a, 1] - ay) - radius[e, a] - radius[e, robot]
            out[e, a] = gap
            least = min(least, gap)
    return least


@kernel
def _walls(before: Floats, after: Floats, radius: Floats, wall: Floats, out: Floats) -> None:
    for e in range(len(before)):
        px, py, qx, qy = before[e, 0], before[e, 1], after[e, 0], after[e, 1]
        least = math.inf
        for m in range(len(wall)):
            ax, ay, bx, by = wall[m, 0], wall[m, 1], wall[m, 2], wall[m, 3]
            gap = min(
                swept_length(ax - px, ay - py, ax - qx, ay - qy),
                swept_length(bx - px, by - py, bx - qx, by - qy),
                swept_length(ax - px, ay - py, bx - px, by - py),
                swept_length(ax - qx, ay - qy, bx - qx, by - qy),
            )
            one = _cross(px, py, qx, qy, ax, ay) * _cross(px, py, qx, qy, bx, by)
            two = _cross(ax, ay, bx, by, px, py) * _cross(ax, ay, bx, by, qx, qy)
            if one < 0.0 and two < 0.0:
                gap = 0.0
            least = min(least, gap)
        out[e] = least - radius[e]


def step_clearance(before: Floats, after: Floats, radius: Floats, active: Bools, robot: int) -> tuple[Floats, float]:
    """Return the smallest clearance of each agent to a robot during a step ``[E, A]`` [m], and the smallest of all.

    It is negative for contact, and infinite for the robot itself and for absent agents.

    Args:
        before, after: positions at the start and the end of the step, ``[E, A, 2]`` [m].
        radius: ``[E, A]`` [m].
        active: ``[E, A]`` who is present.
        robot: index of the robot.

    >>> before, after = np.array([[[0.0, 0.0], [1.0, 0.0]]]), np.array([[[1.0, 0.0], [0.0, 0.0]]])
    >>> step_clearance(before, after, np.array([[0.3, 0.2]]), np.ones((1, 2), bool), robot=0)[0].tolist()
    [[inf, -0.5]]
    """
    out = np.empty(before.shape[:2])
    start, end, size = map(np.ascontiguousarray, (before, after, radius))
    least = _agents(start, end, size, np.ascontiguousarray(active), robot, out)
    return out, float(least)


def step_wall_clearance(before: Floats, after: Floats, radius: Floats, walls: Floats) -> Floats:
    """Return the smallest clearance of one disc to walls during a step, ``[E]`` [m]; infinite without walls.

    Args:
        before, after: positions at the start and the end of the step, ``[E, 2]`` [m].
        radius: radius of the disc, ``[E]`` [m].
        walls: segments ``[N, 4]`` x, y, x, y [m].

    >>> wall = np.array([[1.0, 0.0, 1.0, 0.5]])
    >>> step_wall_clearance(np.array([[0.0, 1.0]]), np.array([[2.0, 1.0]]), np.array([0.3]), wall).round(3).tolist()
    [0.2]
    """
    if len(walls) == 0:
        return np.full(len(before), math.inf)
    out = np.empty(len(before))
    start, end, size, segments = map(np.ascontiguousarray, (before, after, radius, walls))
    _walls(start, end, size, segments, out)
    return out


@kernel
def _agents_of_outlines(
    before: Floats, turn: Floats, after: Floats, turned: Floats, radius: Floats, active: Bools, robot: int,
    corner: Floats, first: Ints, out: Floats,
) -> float:  # fmt: skip
    """Write the clearance of each agent to the robot, and return the smallest."""
    least = math.inf
    for e in range(len(before)):
        for a in range(before.shape[1]):
            out[e, a] = math.inf
            if a == robot or not (active[e, a] and active[e, robot]):
                continue
            out[e, a] = swept_gap(
                before[e, robot, 0], before[e, robot, 1], turn[e, robot],
                after[e, robot, 0], after[e, robot, 1], turned[e, robot],
                radius[e, robot], first[robot], first[robot + 1],
                before[e, a, 0], before[e, a, 1], turn[e, a], after[e, a, 0], after[e, a, 1], turned[e, a],
                radius[e, a], first[a], first[a + 1], corner, 0.0,
            )  # fmt: skip
            least = min(least, out[e, a])
    return least


@kernel
def _walls_of_outlines(
    before: Floats, turn: Floats, after: Floats, turned: Floats, radius: Floats, corner: Floats, wall: Floats,
    out: Floats,
) -> None:  # fmt: skip
    for e in range(len(before)):
        out[e] = swept_wall_gap(
            before[e, 0], before[e, 1], turn[e], after[e, 0], after[e, 1], turned[e], radius[e],
            corner, 0, len(corner), wall,
        )  # fmt: skip


def step_outline_clearance(
    before: Floats, turn: Floats, after: Floats, turned: Floats, radius: Floats, active: Bools, robot: int,
    outlines: Outlines,
) -> tuple[Floats, float]:  # fmt: skip
    """Return what :func:`step_clearance` does, for bodies with outlines; a clearance above 0 is a lower bound.

    Args:
        before, after: positions at the start and the end of the step, ``[E, A, 2]`` [m].
        turn, turned: headings at these times, ``[E, A]`` [rad].
        radius: radii of the circumscribed discs, ``[E, A]`` [m].
        active: ``[E, A]`` who is present.
        robot: index of the robot.
        outlines: outlines of the agents.

    >>> box = Outlines.of({0: np.array([[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]])}, agents=2)
    >>> here, still = np.array([[[0.0, 0.0], [0.0, 0.3]]]), np.zeros((1, 2))
    >>> radius, there = np.array([[0.54, 0.2]]), np.ones((1, 2), bool)
    >>> step_outline_clearance(here, still, here, still, radius, there, 0, box)[0].round(3).tolist()
    [[inf, -0.1]]
    """
    out = np.empty(before.shape[:2])
    arrays = map(np.ascontiguousarray, (before, turn, after, turned, radius, active))
    everything: Any = (*arrays, robot, outlines.corner, outlines.first, out)
    least = _agents_of_outlines(*everything)
    return out, float(least)


def step_outline_wall_clearance(
    before: Floats, turn: Floats, after: Floats, turned: Floats, radius: Floats, outline: Floats, walls: Floats
) -> Floats:
    """Return the smallest clearance of an outline to walls during a step, ``[E]`` [m]; infinite without walls.

    Args:
        before, after: positions at the start and the end of the step, ``[E, 2]`` [m].
        turn, turned: headings at these times, ``[E]`` [rad].
        radius: radius of the circumscribed disc, ``[E]`` [m].
        outline: corners ``[K, 2]`` in the frame of the body [m].
        walls: segments ``[N, 4]`` x, y, x, y [m].

    >>> box = np.array([[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]])
    >>> here, wall = np.zeros((1, 2)), np.array([[-2.0, 0.3, 2.0, 0.3]])
    >>> still, turned = np.zeros(1), np.array([np.pi / 2])
    >>> step_outline_wall_clearance(here, still, here, still, np.array([0.54]), box, wall).round(3).tolist()
    [0.1]
    >>> step_outline_wall_clearance(here, still, here, turned, np.array([0.54]), box, wall).round(2).tolist()
    [-0.24]
    """
    out = np.empty(len(before))
    arrays: Any = (*map(np.ascontiguousarray, (before, turn, after, turned, radius, outline, walls)), out)
    _walls_of_outlines(*arrays)
    return out
