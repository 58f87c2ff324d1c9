"""Rotations and frames; a frame is a 4 x 4 matrix that transforms points to its parent frame."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.typing import Floats


def roll_pitch_yaw(roll: float, pitch: float, yaw: float) -> Floats:
    """Return the rotation ``[3, 3]`` of URDF angles [rad]: about the fixed x, then y, then z axis.

    >>> roll_pitch_yaw(0.0, 0.0, math.pi / 2).round(3).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [-0.0, 0.0, 1.0]]
    """
    cr, sr, cp, sp, cy, sy = (part(angle) for angle in (roll, pitch, yaw) for part in (math.cos, math.sin))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def frame(place: ArrayLike = (0.0, 0.0, 0.0), rotation: Floats | None = None) -> Floats:
    """Return the frame ``[4, 4]`` with position ``place`` ``[3]`` [m] and a rotation ``[3, 3]``.

    >>> frame((1.0, 2.0, 3.0))[:3, 3].tolist()
    [1.0, 2.0, 3.0]
    """
    matrix = np.eye(4)
    matrix[:3, 3] = place
    if rotation is not None:
        matrix[:3, :3] = rotation
    return matrix


def axis_rotation(axis: ArrayLike, angle: float) -> Floats:
    """Return the rotation ``[3, 3]`` by ``angle`` [rad] about a unit ``axis`` ``[3]`` (Rodrigues).

    >>> axis_rotation((0.0, 0.0, 1.0), math.pi).round(3).tolist()
    [[-1.0, -0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    x, y, z = np.asarray(axis, dtype=np.float64)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * skew + (1.0 - math.cos(angle)) * (skew @ skew))


def transform_points(matrix: Floats, points: Floats) -> Floats:
    """Transform points ``[N, 3]`` from a frame ``[4, 4]`` to its parent."""
    return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])


def across(axis: ArrayLike) -> Floats:
    """Return the shortest rotation ``[3, 3]`` from z to a unit ``axis``.

    Its columns x and y span the plane of a planar joint.

    >>> across((0.0, 0.0, 1.0)).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    target = np.asarray(axis, dtype=np.float64)
    side = np.cross((0.0, 0.0, 1.0), target)
    length = float(np.linalg.norm(side))
    if length < 1e-12:
        return np.diag([1.0, 1.0, 1.0] if target[2] > 0.0 else [1.0, -1.0, -1.0])
    return axis_rotation(side / length, math.atan2(length, float(target[2])))


def quaternion(rotation: Floats) -> Floats:
    """Return the unit quaternion ``[w, x, y, z]`` of a rotation ``[3, 3]``, with w >= 0.

    >>> quaternion(np.eye(3)).tolist()
    [1.0, 0.0, 0.0, 0.0]
    """
    r = rotation
    squares = np.array([1 + r[0, 0] + r[1, 1] + r[2, 2], 1 + r[0, 0] - r[1, 1] - r[2, 2],
                        1 - r[0, 0] + r[1, 1] - r[2, 2], 1 - r[0, 0] - r[1, 1] + r[2, 2]])  # fmt: skip
    best = int(np.argmax(squares))
    rows = (
        (squares[0], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]),
        (r[2, 1] - r[1, 2], squares[1], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]),
        (r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], squares[2], r[1, 2] + r[2, 1]),
        (r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], squares[3]),
    )
    found = np.array(rows[best]) / np.linalg.norm(rows[best])
    return np.asarray(-found if found[0] < 0.0 else found)


def from_quaternion(wxyz: ArrayLike) -> Floats:
    """Return the rotation ``[3, 3]`` of a quaternion ``[w, x, y, z]`` of any positive norm."""
    w, x, y, z = np.asarray(wxyz, dtype=np.float64) / np.linalg.norm(wxyz)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
