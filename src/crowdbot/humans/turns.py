"""Rotations for postures; matrices are written to ``out [3, 3]``."""

from __future__ import annotations

import math

from crowdbot.core import kernel
from crowdbot.typing import Floats


@kernel
def cross(a: Floats, b: Floats, out: Floats) -> None:
    """Write ``a x b``."""
    out[0], out[1], out[2] = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def unit(a: Floats) -> float:
    """Normalise ``a`` in place and return its length; the zero vector becomes z."""
    length = math.sqrt(a[0] ** 2 + a[1] ** 2 + a[2] ** 2)
    if length < 1e-9:
        a[0], a[1], a[2] = 0.0, 0.0, 1.0
        return 0.0
    a[0], a[1], a[2] = a[0] / length, a[1] / length, a[2] / length
    return length


@kernel
def about(axis: Floats, angle: float, a: Floats, out: Floats) -> None:
    """Write ``a`` rotated by ``angle`` [rad] about the unit vector ``axis``."""
    c, s = math.cos(angle), math.sin(angle)
    dot = (axis[0] * a[0] + axis[1] * a[1] + axis[2] * a[2]) * (1.0 - c)
    x = c * a[0] + s * (axis[1] * a[2] - axis[2] * a[1]) + dot * axis[0]
    y = c * a[1] + s * (axis[2] * a[0] - axis[0] * a[2]) + dot * axis[1]
    z = c * a[2] + s * (axis[0] * a[1] - axis[1] * a[0]) + dot * axis[2]
    out[0], out[1], out[2] = x, y, z


@kernel
def align_frame(frame: Floats, axis: Floats, hinge: Floats, out: Floats) -> None:
    """Write the rotation from the rest frame (rows axis, hinge, cross product) to ``axis`` and ``hinge``."""
    for r in range(3):
        third = axis[(r + 1) % 3] * hinge[(r + 2) % 3] - axis[(r + 2) % 3] * hinge[(r + 1) % 3]
        for c in range(3):
            out[r, c] = axis[r] * frame[0, c] + hinge[r] * frame[1, c] + third * frame[2, c]
