"""Vectors and quaternions for kernels."""

from __future__ import annotations

import math

import numpy as np

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


@kernel
def to_matrix(q: Floats, out: Floats) -> None:
    """Write the rotation matrix of a quaternion of any length above 0."""
    n = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    if n < 1e-12:
        w, x, y, z = 1.0, 0.0, 0.0, 0.0
    else:
        w, x, y, z = q[0] / n, q[1] / n, q[2] / n, q[3] / n
    out[0, 0], out[0, 1], out[0, 2] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    out[1, 0], out[1, 1], out[1, 2] = 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    out[2, 0], out[2, 1], out[2, 2] = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)


@kernel
def from_matrix(m: Floats, out: Floats) -> None:
    """Write the quaternion of a rotation matrix, with w at least 0."""
    trace = m[0, 0] + m[1, 1] + m[2, 2]
    if trace > 0.0:
        s = 2.0 * math.sqrt(trace + 1.0)
        out[0], out[1] = 0.25 * s, (m[2, 1] - m[1, 2]) / s
        out[2], out[3] = (m[0, 2] - m[2, 0]) / s, (m[1, 0] - m[0, 1]) / s
        return
    i = 0
    if m[1, 1] > m[0, 0]:
        i = 1
    if m[2, 2] > m[i, i]:
        i = 2
    j, k = (i + 1) % 3, (i + 2) % 3
    s = 2.0 * math.sqrt(max(1.0 + m[i, i] - m[j, j] - m[k, k], 1e-12))
    out[0] = (m[k, j] - m[j, k]) / s
    out[1 + i] = 0.25 * s
    out[1 + j] = (m[j, i] + m[i, j]) / s
    out[1 + k] = (m[k, i] + m[i, k]) / s
    if out[0] < 0.0:
        for r in range(4):
            out[r] = -out[r]


@kernel
def multiply(a: Floats, b: Floats, out: Floats) -> None:
    """Write the matrix product ``a b``; ``out`` is another array."""
    for r in range(3):
        for c in range(3):
            out[r, c] = a[r, 0] * b[0, c] + a[r, 1] * b[1, c] + a[r, 2] * b[2, c]


@kernel
def transpose_times(a: Floats, b: Floats, out: Floats) -> None:
    """Write the matrix product ``transpose(a) b``; ``out`` is another array."""
    for r in range(3):
        for c in range(3):
            out[r, c] = a[0, r] * b[0, c] + a[1, r] * b[1, c] + a[2, r] * b[2, c]


@kernel
def limit_rotation(m: Floats, share: float, most: float, q: Floats) -> None:
    """Replace a rotation by this share of it, of at most an angle [rad], in place; ``q [4]`` is work space."""
    from_matrix(m, q)
    size = math.sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    if size < 1e-9:
        return
    angle = min(2.0 * math.atan2(size, q[0]) * share, most)
    s = math.sin(0.5 * angle) / size
    q[0], q[1], q[2], q[3] = math.cos(0.5 * angle), q[1] * s, q[2] * s, q[3] * s
    to_matrix(q, m)


@kernel
def twist_angle(m: Floats, axis: Floats, q: Floats) -> float:
    """Return the angle [rad] of a rotation about an axis, from -pi to pi; ``q [4]`` is work space."""
    from_matrix(m, q)
    return 2.0 * math.atan2(q[1] * axis[0] + q[2] * axis[1] + q[3] * axis[2], q[0])


def slerp(a: Floats, b: Floats, share: float) -> Floats:
    """Return the spherical interpolation between quaternions ``[K, 4]``, on the shorter arc, with unit length.

    Source: Shoemake 1985, doi:10.1145/325165.325242.

    >>> half = slerp(np.array([[1.0, 0, 0, 0]]), np.array([[0.0, 0, 0, 2.0]]), 0.5)
    >>> half.round(6).tolist()
    [[0.707107, 0.0, 0.0, 0.707107]]
    """
    a = a / np.sqrt(np.sum(a * a, axis=-1, keepdims=True))
    b = b / np.sqrt(np.sum(b * b, axis=-1, keepdims=True))
    dot = np.sum(a * b, axis=-1, keepdims=True)
    b = np.where(dot < 0.0, -b, b)
    angle = np.arccos(np.minimum(np.abs(dot), 1.0))
    near = angle < 1e-6
    size = np.where(near, 1.0, np.sin(angle))
    first = np.where(near, 1.0 - share, np.sin((1.0 - share) * angle) / size)
    second = np.where(near, share, np.sin(share * angle) / size)
    found = first * a + second * b
    return np.asarray(found / np.sqrt(np.sum(found * found, axis=-1, keepdims=True)))
