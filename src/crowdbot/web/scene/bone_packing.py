"""Rotations of bones as 16-bit quaternions, for all people in one kernel."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.typing import Floats

BONE_UNIT = 32767.0
"""Quaternions are sent in units of ``1 / BONE_UNIT``."""


@kernel
def _pack(rotation: Floats, rows: NDArray[np.int64], out: NDArray[np.int16]) -> None:
    """Write the quaternions w, x, y, z of the bones of some people; the largest of the four is positive."""
    for n in range(len(rows)):
        for b in range(rotation.shape[1]):
            r = rotation[rows[n], b]
            s, x, y, z = r[0, 0] + r[1, 1] + r[2, 2], r[0, 0], r[1, 1], r[2, 2]
            if s >= x and s >= y and s >= z:
                q = 1.0 + s, r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
            elif x >= y and x >= z:
                q = r[2, 1] - r[1, 2], 1.0 + x - y - z, r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]
            elif y >= z:
                q = r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], 1.0 - x + y - z, r[1, 2] + r[2, 1]
            else:
                q = r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], 1.0 - x - y + z
            unit = 32767.0 / math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
            for k in range(4):
                out[n, 4 * b + k] = np.int16(math.floor(q[k] * unit + 0.5))


def pack_bones(rotation: Floats, rows: NDArray[np.int64]) -> NDArray[np.int16]:
    """Return quaternions w, x, y, z ``[N, 4 B]`` in units of 1/32767, the largest part of each positive.

    Args:
        rotation: rotations ``[P, B, 3, 3]`` of the bones of all people.
        rows: people ``[N]`` whose bones are returned.

    >>> pack_bones(np.eye(3)[None, None], np.array([0])).tolist()
    [[32767, 0, 0, 0]]
    """
    found = np.empty((len(rows), 4 * rotation.shape[1]), dtype=np.int16)
    _pack(rotation, rows, found)
    return found
