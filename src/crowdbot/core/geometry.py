"""Kernels of plane geometry for models, sensors and metrics. Points are x, y [m]."""

from __future__ import annotations

import math

from .kernels import kernel


@kernel
def nearest_on_segment(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> tuple[float, float]:
    """Return the point of segment a-b nearest to x, y."""
    ex, ey = bx - ax, by - ay
    length2 = ex * ex + ey * ey
    if length2 == 0.0:
        return ax, ay
    s = min(1.0, max(0.0, ((x - ax) * ex + (y - ay) * ey) / length2))
    return ax + s * ex, ay + s * ey


@kernel
def ray_to_disc(x: float, y: float, ux: float, uy: float, cx: float, cy: float, radius: float) -> float:
    """Return the distance along the unit ray u from x, y to a disc; inf if it misses, 0 from inside."""
    rx, ry = cx - x, cy - y
    gap = rx * rx + ry * ry - radius * radius
    if gap <= 0.0:
        return 0.0
    along = rx * ux + ry * uy
    if along <= 0.0:
        return math.inf
    across = rx * uy - ry * ux
    inside = radius * radius - across * across
    if inside < 0.0:
        return math.inf
    return gap / (along + math.sqrt(inside))


@kernel
def ray_to_segment(x: float, y: float, ux: float, uy: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Return the distance along the unit ray u from x, y to segment a-b; inf if it misses or is parallel."""
    ex, ey = bx - ax, by - ay
    cross = ux * ey - uy * ex
    if cross == 0.0:
        return math.inf
    rx, ry = ax - x, ay - y
    distance = (rx * ey - ry * ex) / cross
    place = (rx * uy - ry * ux) / cross
    if distance < 0.0 or place < 0.0 or place > 1.0:
        return math.inf
    return distance


@kernel
def time_to_contact(x: float, y: float, vx: float, vy: float, reach: float) -> float:
    """Return the time [s] until two discs touch: relative position x, y, relative velocity v, sum of radii ``reach``.

    The result is 0 if they overlap, inf without contact (numerically stable root, Karamouzas et al. 2014).
    """
    c = x * x + y * y - reach * reach
    if c <= 0.0:
        return 0.0
    a = vx * vx + vy * vy
    b = x * vx + y * vy
    if a == 0.0 or b >= 0.0:
        return math.inf
    root = b * b - a * c
    if root <= 0.0:
        return math.inf
    return c / (-b + math.sqrt(root))


@kernel
def time_to_segment(
    x: float, y: float, vx: float, vy: float, radius: float, ax: float, ay: float, bx: float, by: float
) -> float:
    """Return the time [s] until a disc at x, y with velocity v touches segment a-b; 0 in contact, inf without one."""
    nx, ny = nearest_on_segment(x, y, ax, ay, bx, by)
    if (x - nx) ** 2 + (y - ny) ** 2 <= radius * radius:
        return 0.0
    best = min(time_to_contact(x - ax, y - ay, vx, vy, radius), time_to_contact(x - bx, y - by, vx, vy, radius))
    ex, ey = bx - ax, by - ay
    length = math.sqrt(ex * ex + ey * ey)
    if length == 0.0:
        return best
    ux, uy = -ey / length, ex / length
    height = (x - ax) * ux + (y - ay) * uy
    rate = vx * ux + vy * uy
    if height < 0.0:
        height, rate = -height, -rate
    if rate < 0.0 and height > radius:
        t = (height - radius) / -rate
        along = ((x + vx * t - ax) * ex + (y + vy * t - ay) * ey) / length
        if 0.0 <= along <= length:
            best = min(best, t)
    return best
