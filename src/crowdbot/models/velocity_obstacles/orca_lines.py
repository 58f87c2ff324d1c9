"""ORCA lines: permitted velocities with respect to neighbours and walls (van den Berg et al. 2011).

A line is a row ``x, y, ux, uy``: a point and a unit direction in velocity space; velocities on its left are permitted.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Walls, kernel
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.models.agent_rows import RADIUS, VX, VY, X, Y
from crowdbot.typing import Floats

COVERED = 1e-5
"""An edge is skipped if earlier lines cover it up to this tolerance [m/s]."""
BLOCK = 32
"""Number of neighbours whose lines are computed together."""
LANES = 4
"""Number of values in a vector register; blocks are filled up to a multiple."""
SHARE, LINE, BLOCK_ROWS = 5, 6, 10
"""Rows of a block: relative position, velocity and sum of the radii as in :mod:`crowdbot.models.agent_rows`, share of
the agent, and 4 rows of the line."""


class Edges(NamedTuple):
    """Walls for kernels: edge k leads from corner k to corner ``next[k]``, with the solid on its left."""

    corner: Floats
    """``[M, 2]`` start of the edge [m]."""
    direction: Floats
    """``[M, 2]`` unit direction of the edge."""
    previous: NDArray[np.int64]
    next: NDArray[np.int64]
    convex: NDArray[np.bool_]


def edges_of(walls: Walls) -> Edges:
    """Return the edges of ``walls``, which are kept with the walls."""
    return walls.derive(_edges)


def _edges(walls: Walls) -> Edges:
    along = walls.end - walls.start
    length = np.sqrt(along[:, :1] ** 2 + along[:, 1:] ** 2)
    direction = along / np.where(length > 0.0, length, 1.0)
    return Edges(
        np.require(walls.start, np.float64, ["C", "W"]),
        direction,
        np.require(walls.previous, np.int64, ["C", "W"]),
        np.require(walls.next, np.int64, ["C", "W"]),
        np.require(walls.convex, np.bool_, ["C", "W"]),
    )


@kernel
def avoid_agent(
    lines: Floats,
    at: int,
    x: float,
    y: float,
    vx: float,
    vy: float,
    other_vx: float,
    other_vy: float,
    reach: float,
    horizon: float,
    dt: float,
    share: float,
    side: float,
) -> None:
    """Write the line of one neighbour to ``lines[at]``.

    Args:
        lines, at: output array and row.
        x, y: position of the neighbour relative to the agent [m].
        vx, vy, other_vx, other_vy: velocities of the agent and of the neighbour [m/s].
        reach: sum of the radii [m].
        horizon: time without contact [s].
        dt: time step [s], in which an overlap is resolved.
        share: share of the agent in the change: 1/2, or 1 if the neighbour does not react.
        side: 1 or -1, direction along x if no other direction is defined.
    """
    wx, wy = vx - other_vx, vy - other_vy
    distance2 = x * x + y * y
    apart = distance2 > reach * reach
    inverse = 1.0 / horizon if apart else 1.0 / dt
    cx, cy = wx - inverse * x, wy - inverse * y  # from the centre of the cut-off disc to the relative velocity
    inward = cx * x + cy * y
    if not apart or (inward < 0.0 and inward * inward > reach * reach * (cx * cx + cy * cy)):
        nx, ny = _exit_direction(cx, cy, x, y, side)
        ux, uy = ny, -nx
        change = reach * inverse - math.sqrt(cx * cx + cy * cy)
        px, py = change * nx, change * ny
    else:
        turn = 1.0 if x * cy - y * cx > 0.0 else -1.0
        ux, uy = _tangent(x, y, reach, turn)
        ux, uy = turn * ux, turn * uy
        along = wx * ux + wy * uy
        px, py = along * ux - wx, along * uy - wy
    lines[at, 0], lines[at, 1] = vx + share * px, vy + share * py
    lines[at, 2], lines[at, 3] = ux, uy


@kernel(inline=True)
def avoid_agents(
    block: Floats, held: int, vx: float, vy: float, horizon: float, dt: float, best_x: float, best_y: float
) -> int:
    """Write the lines of neighbours to the last rows of a block: the results of :func:`avoid_agent`.

    The loop has no branches, so that the compiler vectorizes it. A line without a direction is NaN. Return how many
    lines do not permit a velocity.

    Args:
        block: ``[BLOCK_ROWS, BLOCK]``, see its rows.
        held: number of neighbours.
        vx, vy: velocity of the agent [m/s].
        horizon, dt: as in :func:`avoid_agent`.
        best_x, best_y: the velocity that is tested [m/s].
    """
    violated = int(np.int64(0))  # a literal 0 has its own type
    quads = (held + LANES - 1) // LANES
    for n in range(held, LANES * quads):
        block[X, n] = block[Y, n] = block[VX, n] = block[VY, n] = block[RADIUS, n] = block[SHARE, n] = 1.0
    far, near = 1.0 / horizon, 1.0 / dt
    for n in range(LANES * quads):
        x, y, reach = block[X, n], block[Y, n], block[RADIUS, n]
        wx, wy = vx - block[VX, n], vy - block[VY, n]
        distance2, reach2 = x * x + y * y, reach * reach
        apart = distance2 > reach2
        inverse = far if apart else near
        cx, cy = wx - inverse * x, wy - inverse * y
        inward, size2 = cx * x + cy * y, cx * cx + cy * cy
        rounds = (not apart) | ((inward < 0.0) & (inward * inward > reach2 * size2))
        size = math.sqrt(size2)
        nx, ny = cx / size, cy / size
        change = reach * inverse - size
        turn = 1.0 if x * cy - y * cx > 0.0 else -1.0
        gap2 = distance2 - reach2
        leg = math.sqrt(gap2 if gap2 > 0.0 else 0.0)
        tx = turn * ((x * leg - turn * y * reach) / distance2)
        ty = turn * ((turn * x * reach + y * leg) / distance2)
        along = wx * tx + wy * ty
        px, py = change * nx if rounds else along * tx - wx, change * ny if rounds else along * ty - wy
        lx, ly, ux, uy = (
            vx + block[SHARE, n] * px,
            vy + block[SHARE, n] * py,
            ny if rounds else tx,
            -nx if rounds else ty,
        )
        block[LINE, n], block[LINE + 1, n], block[LINE + 2, n], block[LINE + 3, n] = lx, ly, ux, uy
        allowed = ux * (ly - best_y) - uy * (lx - best_x) <= 0.0  # False for NaN, too
        violated += 0 if (n >= held) | allowed else 1
    return violated


@kernel
def _exit_direction(cx: float, cy: float, x: float, y: float, side: float) -> tuple[float, float]:
    """Return the unit vector along c; if c is 0, away from x, y; if that is 0, too, to the given side."""
    length = math.sqrt(cx * cx + cy * cy)
    if length > 0.0:
        return cx / length, cy / length
    distance = math.sqrt(x * x + y * y)
    if distance > 0.0:
        return -x / distance, -y / distance
    return side, 0.0


@kernel
def _tangent(px: float, py: float, radius: float, turn: float) -> tuple[float, float]:
    """Return the unit direction of the tangent to a disc at p, on the left (``turn`` 1) or right (-1)."""
    distance2 = px * px + py * py
    leg = math.sqrt(max(0.0, distance2 - radius * radius))
    return (px * leg - turn * py * radius) / distance2, (turn * px * radius + py * leg) / distance2


@kernel
def edges_in_reach(
    corner: Floats,
    following: NDArray[np.int64],
    x: float,
    y: float,
    reach: float,
    found: NDArray[np.int64],
    gap2: Floats,
) -> int:
    """Find the edges within ``reach`` that face x, y with their free side, nearest first; return their number."""
    held = 0
    for k in range(len(corner)):
        ax, ay = corner[k, 0], corner[k, 1]
        bx, by = corner[following[k], 0], corner[following[k], 1]
        if (ax - x) * (by - ay) - (ay - y) * (bx - ax) >= 0.0:
            continue
        nx, ny = nearest_on_segment(x, y, ax, ay, bx, by)
        d2 = (nx - x) ** 2 + (ny - y) ** 2
        if not d2 < reach * reach:
            continue
        n = held
        while n > 0 and d2 < gap2[n - 1]:
            gap2[n], found[n] = gap2[n - 1], found[n - 1]
            n -= 1
        gap2[n], found[n] = d2, k
        held += 1
    return held


@kernel
def avoid_edge(
    lines: Floats,
    at: int,
    a: int,
    corner: Floats,
    direction: Floats,
    previous: NDArray[np.int64],
    following: NDArray[np.int64],
    convex: NDArray[np.bool_],
    x: float,
    y: float,
    vx: float,
    vy: float,
    radius: float,
    horizon: float,
) -> int:
    """Write the line of the edge from corner a to the next to ``lines[at]``; return 1, or 0 if it needs none."""
    b = following[a]
    ax, ay, bx, by = corner[a, 0] - x, corner[a, 1] - y, corner[b, 0] - x, corner[b, 1] - y
    ex, ey = bx - ax, by - ay
    inverse = 1.0 / horizon
    if _is_covered(lines, at, ax, ay, bx, by, radius, inverse):
        return 0
    s = -(ax * ex + ay * ey) / (ex * ex + ey * ey)
    off2 = (ax + s * ex) ** 2 + (ay + s * ey) ** 2
    r2 = radius * radius
    if s < 0.0 and ax * ax + ay * ay <= r2:
        return _write_stop_line(lines, at, -ay, ax) if convex[a] else 0
    if s > 1.0 and bx * bx + by * by <= r2:
        behind = bx * direction[b, 1] - by * direction[b, 0] < 0.0
        return _write_stop_line(lines, at, -by, bx) if convex[b] and not behind else 0
    if 0.0 <= s <= 1.0 and off2 <= r2:
        return _write_stop_line(lines, at, -direction[a, 0], -direction[a, 1])
    left, right = a, b  # corners that bound the cone
    if off2 <= r2:  # oblique view: one corner hides the other
        left = right = a if s < 0.0 else b
        if not convex[left]:
            return 0
    return _write_cone_line(
        lines, at, a, left, right, corner, direction, previous, convex, x, y, vx, vy, radius, inverse
    )


@kernel
def _is_covered(
    lines: Floats, count: int, ax: float, ay: float, bx: float, by: float, radius: float, inverse: float
) -> bool:
    """Return whether an earlier line already excludes contact with both ends of an edge."""
    for k in range(count):
        px, py, ux, uy = lines[k, 0], lines[k, 1], lines[k, 2], lines[k, 3]
        of_a = (inverse * ax - px) * uy - (inverse * ay - py) * ux - inverse * radius
        of_b = (inverse * bx - px) * uy - (inverse * by - py) * ux - inverse * radius
        if of_a >= -COVERED and of_b >= -COVERED:
            return True
    return False


@kernel
def _write_stop_line(lines: Floats, at: int, ux: float, uy: float) -> int:
    """Write a line through zero velocity, for a wall in contact; return 1, or 0 without a direction."""
    length = math.sqrt(ux * ux + uy * uy)
    if length == 0.0:
        return 0
    lines[at, 0] = lines[at, 1] = 0.0
    lines[at, 2], lines[at, 3] = ux / length, uy / length
    return 1


@kernel
def _cone_legs(
    lx: float,
    ly: float,
    rx: float,
    ry: float,
    a: int,
    left: int,
    right: int,
    direction: Floats,
    previous: NDArray[np.int64],
    convex: NDArray[np.bool_],
    radius: float,
) -> tuple[float, float, bool, float, float, bool]:
    """Return the directions of the left and right leg of the cone, and whether each belongs to this edge.

    A leg that would point into the adjacent edge follows that edge instead, which has its own line.
    """
    mlx, mly = -direction[a, 0], -direction[a, 1]
    mrx, mry = direction[a, 0], direction[a, 1]
    left_own = right_own = True
    if convex[left]:
        mlx, mly = _tangent(lx, ly, radius, 1.0)
        before = previous[left]
        if mly * direction[before, 0] - mlx * direction[before, 1] >= 0.0:
            mlx, mly, left_own = -direction[before, 0], -direction[before, 1], False
    if convex[right]:
        mrx, mry = _tangent(rx, ry, radius, -1.0)
        if mrx * direction[right, 1] - mry * direction[right, 0] <= 0.0:
            mrx, mry, right_own = direction[right, 0], direction[right, 1], False
    return mlx, mly, left_own, mrx, mry, right_own


@kernel
def _write_cone_line(
    lines: Floats,
    at: int,
    a: int,
    left: int,
    right: int,
    corner: Floats,
    direction: Floats,
    previous: NDArray[np.int64],
    convex: NDArray[np.bool_],
    x: float,
    y: float,
    vx: float,
    vy: float,
    radius: float,
    inverse: float,
) -> int:
    """Write the line of the velocity obstacle between two corners at the point nearest to the velocity."""
    lx, ly = corner[left, 0] - x, corner[left, 1] - y
    rx, ry = corner[right, 0] - x, corner[right, 1] - y
    mlx, mly, left_own, mrx, mry, right_own = _cone_legs(
        lx, ly, rx, ry, a, left, right, direction, previous, convex, radius
    )
    same = left == right
    clx, cly, crx, cry = inverse * lx, inverse * ly, inverse * rx, inverse * ry
    reach = inverse * radius
    cx, cy = crx - clx, cry - cly
    t = 0.5 if same else ((vx - clx) * cx + (vy - cly) * cy) / (cx * cx + cy * cy)
    tl = (vx - clx) * mlx + (vy - cly) * mly
    tr = (vx - crx) * mrx + (vy - cry) * mry
    if (t < 0.0 and tl < 0.0) or (same and tl < 0.0 and tr < 0.0):
        return _write_disc_line(lines, at, clx, cly, vx, vy, reach)
    if t > 1.0 and tr < 0.0:
        return _write_disc_line(lines, at, crx, cry, vx, vy, reach)
    to_cut = math.inf if same or t < 0.0 or t > 1.0 else (vx - clx - t * cx) ** 2 + (vy - cly - t * cy) ** 2
    to_left = math.inf if tl < 0.0 else (vx - clx - tl * mlx) ** 2 + (vy - cly - tl * mly) ** 2
    to_right = math.inf if tr < 0.0 else (vx - crx - tr * mrx) ** 2 + (vy - cry - tr * mry) ** 2
    if to_cut <= to_left and to_cut <= to_right:
        return _write_offset_line(lines, at, clx, cly, -direction[a, 0], -direction[a, 1], reach)
    if to_left <= to_right:
        return _write_offset_line(lines, at, clx, cly, mlx, mly, reach) if left_own else 0
    return _write_offset_line(lines, at, crx, cry, -mrx, -mry, reach) if right_own else 0


@kernel
def _write_disc_line(lines: Floats, at: int, cx: float, cy: float, vx: float, vy: float, reach: float) -> int:
    """Write the tangent of the disc around c at the point nearest to the velocity."""
    length = math.sqrt((vx - cx) ** 2 + (vy - cy) ** 2)
    nx, ny = (vx - cx) / length, (vy - cy) / length
    lines[at, 0], lines[at, 1] = cx + reach * nx, cy + reach * ny
    lines[at, 2], lines[at, 3] = ny, -nx
    return 1


@kernel
def _write_offset_line(lines: Floats, at: int, cx: float, cy: float, ux: float, uy: float, reach: float) -> int:
    """Write the line with direction u at distance ``reach`` to the left of c."""
    lines[at, 0], lines[at, 1] = cx - reach * uy, cy + reach * ux
    lines[at, 2], lines[at, 3] = ux, uy
    return 1
