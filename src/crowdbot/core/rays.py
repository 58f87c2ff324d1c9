"""Kernels for rays in space, from the origin along a unit vector d, and shapes that do not contain the origin.

All are accurate to rounding at any distance: they use components perpendicular to ray or axis, which avoids
cancellation. The distance is inf if the ray misses. A shape is a row of 16 numbers, see :func:`meet`.
"""

from __future__ import annotations

import math

from crowdbot.typing import Floats

from .kernels import kernel

CAPSULE, CYLINDER, WALL, BOX, TRIANGLE = 0, 1, 2, 3, 4
"""Kinds of shapes, and the columns of their rows:

* capsule: start (3), unit axis (3), length, radius;
* cylinder: centre of one end (3), unit axis (3), length, radius;
* wall: a lower corner (3), lower edge (3), upward unit vector (3), height;
* box: centre (3), unit axes (9), half lengths (3);
* triangle: corners (9).
"""
WIDTH = 16


@kernel
def ray_to_sphere(dx: float, dy: float, dz: float, cx: float, cy: float, cz: float, radius: float) -> float:
    """Return the distance along d to a sphere."""
    along = dx * cx + dy * cy + dz * cz
    if along <= 0.0:
        return math.inf
    qx, qy, qz = along * dx - cx, along * dy - cy, along * dz - cz
    inside = radius * radius - (qx * qx + qy * qy + qz * qz)
    if inside < 0.0:
        return math.inf
    return along - math.sqrt(inside)


@kernel
def _enter_cylinder(
    dx: float, dy: float, dz: float, ax: float, ay: float, az: float, ux: float, uy: float, uz: float, length: float,
    radius: float,
) -> tuple[float, float, float, bool]:  # fmt: skip
    """Return where d enters the infinite cylinder of an axis: distance, height, slope of d, and whether it enters."""
    half = 0.5 * length
    near = dx * (ax + half * ux) + dy * (ay + half * uy) + dz * (az + half * uz)
    wx, wy, wz = near * dx - ax, near * dy - ay, near * dz - az
    slope = dx * ux + dy * uy + dz * uz
    nx, ny, nz = dx - slope * ux, dy - slope * uy, dz - slope * uz
    across = ux * (ny * wz - nz * wy) + uy * (nz * wx - nx * wz) + uz * (nx * wy - ny * wx)
    flat = nx * nx + ny * ny + nz * nz
    root = flat * radius * radius - across * across
    if root < 0.0:
        return math.inf, 0.0, slope, False
    height = wx * ux + wy * uy + wz * uz
    if flat < 1e-24:
        px, py, pz = wx - height * ux, wy - height * uy, wz - height * uz
        inside = px * px + py * py + pz * pz <= radius * radius
        return 0.0, -math.inf if slope > 0.0 else math.inf, slope, inside
    go = -(nx * wx + ny * wy + nz * wz + math.sqrt(root)) / flat
    return near + go, height + go * slope, slope, True


@kernel
def ray_to_capsule(
    dx: float, dy: float, dz: float, ax: float, ay: float, az: float, ux: float, uy: float, uz: float, length: float,
    radius: float,
) -> float:  # fmt: skip
    """Return the distance along d to a capsule from a along the unit axis u."""
    distance, height, _, enters = _enter_cylinder(dx, dy, dz, ax, ay, az, ux, uy, uz, length, radius)
    if not enters:
        return math.inf
    if 0.0 <= height <= length:
        return distance if distance >= 0.0 else math.inf
    if height < 0.0:
        return ray_to_sphere(dx, dy, dz, ax, ay, az, radius)
    return ray_to_sphere(dx, dy, dz, ax + length * ux, ay + length * uy, az + length * uz, radius)


@kernel
def ray_to_cylinder(
    dx: float, dy: float, dz: float, ax: float, ay: float, az: float, ux: float, uy: float, uz: float, length: float,
    radius: float,
) -> float:  # fmt: skip
    """Return the distance along d to a closed cylinder from a along the unit axis u."""
    distance, height, slope, enters = _enter_cylinder(dx, dy, dz, ax, ay, az, ux, uy, uz, length, radius)
    if not enters:
        return math.inf
    if 0.0 <= height <= length:
        return distance if distance >= 0.0 else math.inf
    if (height < 0.0) != (slope > 0.0) or slope == 0.0:
        return math.inf
    lid = 0.0 if height < 0.0 else length
    px, py, pz = ax + lid * ux, ay + lid * uy, az + lid * uz
    distance = (px * ux + py * uy + pz * uz) / slope
    qx, qy, qz = distance * dx - px, distance * dy - py, distance * dz - pz
    if distance < 0.0 or qx * qx + qy * qy + qz * qz > radius * radius:
        return math.inf
    return distance


@kernel
def ray_to_wall(
    dx: float, dy: float, dz: float, ax: float, ay: float, az: float, ex: float, ey: float, ez: float,
    ux: float, uy: float, uz: float, tall: float,
) -> float:  # fmt: skip
    """Return the distance along d to the rectangle from corner a along edge e and ``tall`` along the unit vector u.

    It is inf if they are parallel.
    """
    nx, ny, nz = ey * uz - ez * uy, ez * ux - ex * uz, ex * uy - ey * ux
    against = dx * nx + dy * ny + dz * nz
    if against == 0.0:
        return math.inf
    distance = (ax * nx + ay * ny + az * nz) / against
    if distance < 0.0:
        return math.inf
    px, py, pz = distance * dx - ax, distance * dy - ay, distance * dz - az
    along = px * ex + py * ey + pz * ez
    height = px * ux + py * uy + pz * uz
    if along < 0.0 or along > ex * ex + ey * ey + ez * ez or height < 0.0 or height > tall:
        return math.inf
    return distance


@kernel
def ray_to_box(dx: float, dy: float, dz: float, s: Floats) -> float:
    """Return the distance along d to an oriented box."""
    enter, leave = -math.inf, math.inf
    for k in range(3):
        ax, ay, az, half = s[3 + 3 * k], s[4 + 3 * k], s[5 + 3 * k], s[12 + k]
        slope = dx * ax + dy * ay + dz * az
        middle = s[0] * ax + s[1] * ay + s[2] * az
        if slope == 0.0:
            if abs(middle) > half:
                return math.inf
            continue
        one, two = (middle - half) / slope, (middle + half) / slope
        enter = max(enter, min(one, two))
        leave = min(leave, max(one, two))
    if enter > leave or enter < 0.0:
        return math.inf
    return float(enter)


@kernel
def ray_to_triangle(
    dx: float, dy: float, dz: float, ax: float, ay: float, az: float, bx: float, by: float, bz: float,
    cx: float, cy: float, cz: float,
) -> float:  # fmt: skip
    """Return the distance along d to a triangle, from either side; no ray passes between two with a common edge."""
    # d . (b x c) changes only its sign, to the last bit, if b and c are swapped
    one = dx * (by * cz - bz * cy) + dy * (bz * cx - bx * cz) + dz * (bx * cy - by * cx)
    two = dx * (cy * az - cz * ay) + dy * (cz * ax - cx * az) + dz * (cx * ay - cy * ax)
    three = dx * (ay * bz - az * by) + dy * (az * bx - ax * bz) + dz * (ax * by - ay * bx)
    size = max(abs(ax), abs(ay), abs(az), abs(bx), abs(by), abs(bz), abs(cx), abs(cy), abs(cz))
    hair = 1e-15 * size * size  # tolerance at corners, where each edge is rounded separately
    if (one < -hair or two < -hair or three < -hair) and (one > hair or two > hair or three > hair):
        return math.inf
    ex, ey, ez, fx, fy, fz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    against = dx * nx + dy * ny + dz * nz
    if against == 0.0:
        return math.inf
    distance = (ax * nx + ay * ny + az * nz) / against
    return distance if distance >= 0.0 else math.inf


@kernel
def meet(kind: int, dx: float, dy: float, dz: float, s: Floats) -> float:
    """Return the distance along d to the shape of a row."""
    if kind == CAPSULE:
        return ray_to_capsule(dx, dy, dz, s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7])
    if kind == TRIANGLE:
        return ray_to_triangle(dx, dy, dz, s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8])
    if kind == CYLINDER:
        return ray_to_cylinder(dx, dy, dz, s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7])
    if kind == WALL:
        return ray_to_wall(dx, dy, dz, s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8], s[9])
    return ray_to_box(dx, dy, dz, s)


@kernel
def within(kind: int, s: Floats) -> bool:
    """Return whether the origin is in or on the shape of a row; walls and triangles have no inside."""
    if kind in (CAPSULE, CYLINDER):
        height = -(s[0] * s[3] + s[1] * s[4] + s[2] * s[5])
        if kind == CYLINDER and (height < 0.0 or height > s[6]):
            return False
        near = min(s[6], max(0.0, height))
        x, y, z = s[0] + near * s[3], s[1] + near * s[4], s[2] + near * s[5]
        return bool(x * x + y * y + z * z <= s[7] * s[7])
    if kind == BOX:
        inside = True
        for k in range(3):
            inside &= abs(s[0] * s[3 + 3 * k] + s[1] * s[4 + 3 * k] + s[2] * s[5 + 3 * k]) <= s[12 + k]
        return bool(inside)
    return False


@kernel
def normal_at(kind: int, x: float, y: float, z: float, s: Floats) -> tuple[float, float, float]:
    """Return the unit normal of the shape of a row at its surface point x, y, z; outward, either side for flat ones."""
    if kind in (CAPSULE, CYLINDER):
        height = (x - s[0]) * s[3] + (y - s[1]) * s[4] + (z - s[2]) * s[5]
        near = min(s[6], max(0.0, height))
        nx, ny, nz = x - s[0] - near * s[3], y - s[1] - near * s[4], z - s[2] - near * s[5]
        if kind == CYLINDER and nx * nx + ny * ny + nz * nz < s[7] * s[7] * (1.0 - 1e-9):
            side = 1.0 if height > 0.5 * s[6] else -1.0
            return side * s[3], side * s[4], side * s[5]
    elif kind == WALL:
        nx, ny, nz = s[4] * s[8] - s[5] * s[7], s[5] * s[6] - s[3] * s[8], s[3] * s[7] - s[4] * s[6]
    elif kind == TRIANGLE:
        ex, ey, ez, fx, fy, fz = s[3] - s[0], s[4] - s[1], s[5] - s[2], s[6] - s[0], s[7] - s[1], s[8] - s[2]
        nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    else:
        nx, ny, nz = 0.0, 0.0, 0.0
        best = -math.inf
        for k in range(3):
            ax, ay, az = s[3 + 3 * k], s[4 + 3 * k], s[5 + 3 * k]
            place = (x - s[0]) * ax + (y - s[1]) * ay + (z - s[2]) * az
            if abs(place) - s[12 + k] > best:
                best = abs(place) - s[12 + k]
                side = 1.0 if place > 0.0 else -1.0
                nx, ny, nz = side * ax, side * ay, side * az
    size = math.sqrt(nx * nx + ny * ny + nz * nz)
    if size == 0.0:
        return 0.0, 0.0, 0.0
    return nx / size, ny / size, nz / size
