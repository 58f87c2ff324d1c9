"""Vectors as three numbers, for kernels: they stay in registers, where each view of an array counts its references."""

from __future__ import annotations

import math

from crowdbot.core import kernel
from crowdbot.typing import Floats

Vector = tuple[float, float, float]


@kernel(inline=True)
def cross_product(a: Vector, b: Vector) -> Vector:
    """Return ``a x b``."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel(inline=True)
def normalize(a: Vector) -> tuple[Vector, float]:
    """Return the unit vector of ``a`` and the length of ``a``; the zero vector becomes z."""
    length = math.sqrt(a[0] ** 2 + a[1] ** 2 + a[2] ** 2)
    if length < 1e-9:
        return (0.0, 0.0, 1.0), 0.0
    return (a[0] / length, a[1] / length, a[2] / length), length


@kernel(inline=True)
def rotate(axis: Vector, angle: float, a: Vector) -> Vector:
    """Return ``a`` rotated by ``angle`` [rad] about the unit vector ``axis``."""
    c, s = math.cos(angle), math.sin(angle)
    dot = (axis[0] * a[0] + axis[1] * a[1] + axis[2] * a[2]) * (1.0 - c)
    x = c * a[0] + s * (axis[1] * a[2] - axis[2] * a[1]) + dot * axis[0]
    y = c * a[1] + s * (axis[2] * a[0] - axis[0] * a[2]) + dot * axis[1]
    z = c * a[2] + s * (axis[0] * a[1] - axis[1] * a[0]) + dot * axis[2]
    return x, y, z


@kernel(inline=True)
def write_frame(frames: Floats, k: int, axis: Vector, hinge: Vector, R: Floats, bone: int) -> None:
    """Write the rotation of a bone from its rest frame ``k`` (rows axis, hinge, third) to ``axis`` and ``hinge``."""
    third = cross_product(axis, hinge)
    for c in range(3):
        a, b, d = frames[k, 0, c], frames[k, 1, c], frames[k, 2, c]
        R[bone, 0, c] = axis[0] * a + hinge[0] * b + third[0] * d
        R[bone, 1, c] = axis[1] * a + hinge[1] * b + third[1] * d
        R[bone, 2, c] = axis[2] * a + hinge[2] * b + third[2] * d


@kernel(inline=True)
def write_turn(yaw: float, roll: float, pitch: float, R: Floats, bone: int) -> None:
    """Write ``Rz(yaw) Rx(roll) Ry(pitch)``: a positive pitch bends forward, a positive roll raises the left side."""
    cz, sz, cx, sx = math.cos(yaw), math.sin(yaw), math.cos(roll), math.sin(roll)
    cy, sy = math.cos(pitch), math.sin(pitch)
    R[bone, 0, 0], R[bone, 0, 1], R[bone, 0, 2] = cz * cy - sz * sx * sy, -sz * cx, cz * sy + sz * sx * cy
    R[bone, 1, 0], R[bone, 1, 1], R[bone, 1, 2] = sz * cy + cz * sx * sy, cz * cx, sz * sy - cz * sx * cy
    R[bone, 2, 0], R[bone, 2, 1], R[bone, 2, 2] = -cx * sy, sx, cx * cy
