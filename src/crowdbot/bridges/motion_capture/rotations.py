"""Rotations of many segments: quaternions w, x, y, z and matrices."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.typing import Floats


def to_matrices(quaternions: Floats) -> Floats:
    """Return the rotation matrices ``[..., 3, 3]`` of unit quaternions ``[..., 4]``."""
    w, x, y, z = np.moveaxis(quaternions, -1, 0)
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def to_quaternions(matrices: Floats) -> Floats:
    """Return unit quaternions ``[..., 4]`` of rotation matrices ``[..., 3, 3]``, with w at least 0.

    Source: Bar-Itzhack 2000, doi:10.2514/2.4654 (the sign-safe form of Shepperd 1978).

    >>> to_quaternions(rotate_about([0.0, 0.0, 1.0], math.pi)).round(6).tolist()
    [0.0, 0.0, 0.0, 1.0]
    """
    m = np.asarray(matrices, dtype=np.float64)
    a, b, c = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    squares = np.stack([1.0 + a + b + c, 1.0 + a - b - c, 1.0 - a + b - c, 1.0 - a - b + c], axis=-1)
    yz, zx, xy = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    p, q, r = m[..., 1, 0] + m[..., 0, 1], m[..., 0, 2] + m[..., 2, 0], m[..., 2, 1] + m[..., 1, 2]
    w2, x2, y2, z2 = np.moveaxis(squares, -1, 0)
    columns = [[w2, yz, zx, xy], [yz, x2, p, q], [zx, p, y2, r], [xy, q, r, z2]]
    table = np.moveaxis(np.array(columns), (0, 1), (-2, -1))
    largest = np.argmax(squares, axis=-1)
    found = np.take_along_axis(table, largest[..., None, None], axis=-2)[..., 0, :]
    found = found / np.linalg.norm(found, axis=-1, keepdims=True)
    return np.asarray(np.where(found[..., :1] < 0.0, -found, found))


def rotate_about(axis: Floats | list[float], angle: float) -> Floats:
    """Return the rotation matrix about a unit vector by an angle [rad]."""
    half = math.sin(0.5 * angle)
    return to_matrices(np.array([math.cos(0.5 * angle), *(half * float(one) for one in axis)]))


def align_vectors(first: Floats, second: Floats) -> Floats:
    """Return the smallest rotation matrix that turns the direction of one vector into that of another.

    >>> align_vectors(np.array([2.0, 0, 0]), np.array([0, 0.5, 0])).round(6).tolist()[0]
    [0.0, -1.0, 0.0]
    """
    a, b = first / np.linalg.norm(first), second / np.linalg.norm(second)
    w = 1.0 + float(a @ b)
    if w < 1e-9:  # opposite: half a turn about any axis across
        across = np.cross(a, np.eye(3)[int(np.argmin(np.abs(a)))])
        return rotate_about(across / np.linalg.norm(across), math.pi)
    quaternion = np.array([w, *np.cross(a, b)])
    return to_matrices(quaternion / np.linalg.norm(quaternion))


def normalize(quaternions: Floats) -> Floats | None:
    """Return quaternions ``[..., 4]`` with unit length, None if one is not finite or its length is not near 1.

    >>> normalize(np.array([2.0, 0, 0, 0])) is None
    True
    """
    size = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    if not np.all(np.abs(size - 1.0) < 0.1):
        return None
    return np.asarray(quaternions / size)


def yaw_of(matrix: Floats) -> float:
    """Return the heading of a rotation matrix: the direction of its x axis on the floor [rad].

    For a body whose x axis is within 6 degrees of the vertical, it is a quarter turn less than that of the y axis.
    """
    x, y = float(matrix[0, 0]), float(matrix[1, 0])
    if math.hypot(x, y) < 0.1:
        return math.atan2(-float(matrix[0, 1]), float(matrix[1, 1]))
    return math.atan2(y, x)
