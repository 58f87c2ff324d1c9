"""Quaternions w, x, y, z and rotation matrices of single poses."""

from __future__ import annotations

import numpy as np

from crowdbot.typing import Floats


def matrices(q: Floats) -> Floats:
    """Return the rotation matrices ``[..., 3, 3]`` of quaternions ``[..., 4]`` of any length above 0.

    >>> matrices(np.array([1.0, 0.0, 0.0, 1.0])).round(6).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    w, x, y, z = np.moveaxis(q / np.linalg.norm(q, axis=-1, keepdims=True), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def unit_quaternions(rotation: Floats) -> Floats:
    """Return the unit quaternion ``[4]`` of a rotation ``[3, 3]``; w is at least 0.

    >>> unit_quaternions(matrices(np.array([0.6, 0.0, 0.8, 0.0]))).round(6).tolist()
    [0.6, 0.0, 0.8, 0.0]
    """
    m = rotation
    table = np.array(
        [
            [1 + m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
            [m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], 1 - m[0, 0] + m[1, 1] - m[2, 2], m[1, 2] + m[2, 1]],
            [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], 1 - m[0, 0] - m[1, 1] + m[2, 2]],
        ]
    )  # 4 q q^T: its largest row is the most accurate
    row = table[int(np.argmax(np.diagonal(table)))]
    row = row / np.linalg.norm(row)
    return np.asarray(-row if row[0] < 0.0 else row)


def quaternion_blend(a: Floats, b: Floats, share: float) -> Floats:
    """Return the normalized linear interpolation of two near quaternions, on the shorter arc."""
    found = (1.0 - share) * a + share * (b if float(a @ b) >= 0.0 else -b)
    return np.asarray(found / np.linalg.norm(found))
