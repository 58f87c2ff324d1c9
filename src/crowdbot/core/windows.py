"""Kernels for conservative bounds of the azimuth and elevation of shapes, seen from the origin.

A hull is the convex hull of corners ``[count, 3]``; a rod is a capsule, or a cylinder inside a capsule.
"""

from __future__ import annotations

import math

from crowdbot.typing import Floats

from .kernels import kernel

TURN = 2.0 * math.pi


@kernel
def _extent(corner: Floats, count: int) -> tuple[float, float, float]:
    """Return the lowest and highest z of a hull, and its largest horizontal distance."""
    low, high, far2 = math.inf, -math.inf, 0.0
    for i in range(count):
        low, high = min(low, corner[i, 2]), max(high, corner[i, 2])
        far2 = max(far2, corner[i, 0] * corner[i, 0] + corner[i, 1] * corner[i, 1])
    return low, high, math.sqrt(far2)


@kernel
def hull_gap(corner: Floats, count: int) -> float:
    """Return the horizontal distance to a hull that does not contain the origin seen from above."""
    near2 = math.inf
    for i in range(count):
        for j in range(i):
            ex, ey = corner[j, 0] - corner[i, 0], corner[j, 1] - corner[i, 1]
            length2, s = ex * ex + ey * ey, 0.0
            if length2 > 0.0:
                s = min(1.0, max(0.0, -(corner[i, 0] * ex + corner[i, 1] * ey) / length2))
            x, y = corner[i, 0] + s * ex, corner[i, 1] + s * ey
            near2 = min(near2, x * x + y * y)
    return math.sqrt(near2)


@kernel
def _half_angle(radius: float, away: float) -> float:
    """Return half the visual angle of a disc, or an upper bound for small discs."""
    share = radius / away
    return share / math.sqrt(1.0 - share * share) if share < 0.5 else math.asin(share)


@kernel
def rod_width(ax: float, ay: float, bx: float, by: float, radius: float) -> tuple[float, float]:
    """Return start azimuth and width of two discs, or slightly more; see :func:`hull_width`."""
    a, b = math.sqrt(ax * ax + ay * ay), math.sqrt(bx * bx + by * by)
    if a <= radius or b <= radius or a == 0.0 or b == 0.0:
        return -math.pi, TURN
    dot, cross = ax * bx + ay * by, ax * by - ay * bx
    one, two = _half_angle(radius, a), _half_angle(radius, b)
    if abs(cross) < 0.3 * dot:  # t - t^3 / 3 <= atan(t) <= t for t >= 0
        off = cross / dot
        inner = off - off * off * off / 3.0
    else:
        off = inner = math.atan2(cross, dot)
    least, most = min(-one, min(off, inner) - two), max(one, max(off, inner) + two)
    if most - least >= math.pi - 1e-6:
        return -math.pi, TURN
    return math.atan2(ay, ax) + least, most - least


@kernel
def rod_levels(
    ax: float, ay: float, az: float, bx: float, by: float, bz: float, radius: float, around: bool
) -> tuple[float, float]:
    """Return conservative bounds of the elevation of a rod, lowest and highest."""
    ex, ey = bx - ax, by - ay
    flat2, near = ex * ex + ey * ey, 0.0
    if not around:
        s = min(1.0, max(0.0, -(ax * ex + ay * ey) / flat2)) if flat2 > 0.0 else 0.0
        near = max(0.0, math.sqrt((ax + s * ex) ** 2 + (ay + s * ey) ** 2) - radius)
    far = math.sqrt(max(ax * ax + ay * ay, bx * bx + by * by)) + radius
    low, high = min(az, bz) - radius, max(az, bz) + radius
    return math.atan2(low, far if low > 0.0 else near), math.atan2(high, near if high > 0.0 else far)


@kernel
def hull_width(corner: Floats, count: int) -> tuple[float, float]:
    """Return start azimuth and width of a hull; a full turn if it contains the origin seen from above."""
    least, most, cx, cy = math.inf, -math.inf, 0.0, 0.0
    for i in range(count):
        cx += corner[i, 0]
        cy += corner[i, 1]
    middle = math.atan2(cy, cx)
    for i in range(count):
        if corner[i, 0] == 0.0 and corner[i, 1] == 0.0:
            return -math.pi, TURN
        off = math.atan2(corner[i, 1], corner[i, 0]) - middle
        off -= TURN * math.floor((off + math.pi) / TURN)
        least, most = min(least, off), max(most, off)
    if most - least >= math.pi - 1e-6:
        return -math.pi, TURN
    return middle + least, most - least


@kernel
def hull_in_view(corner: Floats, count: int, limit: float, down: float, up: float) -> bool:
    """Return whether a hull is within range and between the lowest and the highest beam."""
    low, high, far = _extent(corner, count)
    return low <= far * up and high >= far * down and hull_gap(corner, count) <= limit


@kernel
def hull_levels(corner: Floats, count: int, around: bool) -> tuple[float, float]:
    """Return conservative bounds of the elevation of a hull, lowest and highest."""
    low, high, far = _extent(corner, count)
    near = 0.0 if around else hull_gap(corner, count)
    return math.atan2(low, far if low > 0.0 else near), math.atan2(high, near if high > 0.0 else far)


@kernel
def ball_in_view(
    x: float, y: float, z: float, slope: float, height: float, half: float, radius: float, limit: float,
    down: float, up: float,
) -> bool:  # fmt: skip
    """Return whether a rod with its centre at x, y, z may be within range and between the outer beams."""
    away = math.sqrt(x * x + y * y + z * z)
    far, tall = away + half + radius, half * abs(slope) + radius + 1e-9
    return away - half - radius <= limit and height - tall <= far * up and height + tall >= far * down


@kernel
def rod_gap(ax: float, ay: float, az: float, ux: float, uy: float, uz: float, length: float, radius: float) -> float:
    """Return the distance of a capsule to the origin, 0 inside."""
    s = min(length, max(0.0, -(ax * ux + ay * uy + az * uz)))
    x, y, z = ax + s * ux, ay + s * uy, az + s * uz
    return max(0.0, math.sqrt(x * x + y * y + z * z) - radius)
