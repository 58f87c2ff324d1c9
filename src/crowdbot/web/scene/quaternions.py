"""Quaternions of many rotations."""

from __future__ import annotations

import numpy as np

from crowdbot.typing import Floats


def quaternions(rotation: Floats) -> Floats:
    """Return the unit quaternions w, x, y, z ``[..., 4]`` of rotations ``[..., 3, 3]``; the largest part is positive.

    >>> quaternions(np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])).round(3).tolist()
    [0.707, 0.0, 0.0, 0.707]
    """
    r = rotation.reshape(-1, 9).T
    table = np.empty((4, 4, r.shape[1]))  # 4 q q^T: its largest row is the most accurate
    a, b, c = r[0], r[4], r[8]
    table[0, 0], table[1, 1], table[2, 2], table[3, 3] = 1 + a + b + c, 1 + a - b - c, 1 - a + b - c, 1 - a - b + c
    table[0, 1] = table[1, 0] = r[7] - r[5]
    table[0, 2] = table[2, 0] = r[2] - r[6]
    table[0, 3] = table[3, 0] = r[3] - r[1]
    table[1, 2] = table[2, 1] = r[1] + r[3]
    table[1, 3] = table[3, 1] = r[2] + r[6]
    table[2, 3] = table[3, 2] = r[5] + r[7]
    best = np.argmax(np.stack([table[k, k] for k in range(4)]), axis=0)
    rows = table[best, :, np.arange(r.shape[1])]
    rows = rows / np.sqrt(np.einsum("ni,ni->n", rows, rows))[:, None]
    return np.asarray(rows.reshape(*rotation.shape[:-2], 4))
