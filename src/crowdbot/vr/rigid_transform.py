"""Rotations and rigid transforms between two rooms, and their calibration from pairs of points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError
from crowdbot.typing import Floats

FLAT = 1e-3
"""Smallest spread [m] of points across their main direction; below it they define no rotation."""


@dataclass(frozen=True, eq=False)
class RigidTransform:
    """A rigid transform ``q = rotation p + translation``; x forward, y left, z up, metres.

    Fields:
        rotation: rotation matrix ``[3, 3]``.
        translation: translation ``[3]`` [m].

    >>> turn = RigidTransform.at(1.0, 0.0, math.pi / 2)
    >>> turn.apply([2.0, 0.0, 1.0]).round(6).tolist(), turn.inverse().apply(turn.apply([2.0, 0.0, 1.0])).tolist()
    ([1.0, 2.0, 1.0], [2.0, 0.0, 1.0])
    """

    rotation: Floats
    translation: Floats

    @classmethod
    def at(cls, x: float, y: float, heading: float = 0.0, z: float = 0.0) -> RigidTransform:
        """Return the transform of a room whose origin is at x, y, z [m] and whose x axis has a heading [rad]."""
        c, s = math.cos(heading), math.sin(heading)
        return cls(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array([x, y, z], dtype=np.float64))

    @property
    def heading(self) -> float:
        """Rotation about z [rad]."""
        return math.atan2(self.rotation[1, 0], self.rotation[0, 0])

    def apply(self, points: ArrayLike) -> Floats:
        """Return transformed points ``[..., 3]``."""
        return np.asarray(np.asarray(points, dtype=np.float64) @ self.rotation.T + self.translation)

    def turn(self, rotations: Floats) -> Floats:
        """Return rotations ``[..., 3, 3]`` as seen from the other room."""
        return np.asarray(self.rotation @ rotations)

    def inverse(self) -> RigidTransform:
        """Return the transform back."""
        return RigidTransform(self.rotation.T.copy(), -self.rotation.T @ self.translation)

    def after(self, other: RigidTransform) -> RigidTransform:
        """Return the transform that applies ``other`` first."""
        return RigidTransform(self.rotation @ other.rotation, self.apply(other.translation))


class RigidFit(NamedTuple):
    """A calibration.

    Fields:
        transform: from the first room to the second.
        residual: distance ``[N]`` [m] of each pair after the transform.
        rms: root mean square of the residuals [m].
        noise: estimated standard deviation [m] of one coordinate of a pair, from the residuals and the degrees of
            freedom; NaN if there are none left.
    """

    transform: RigidTransform
    residual: Floats
    rms: float
    noise: float


def fit_rigid(
    source: Sequence[ArrayLike] | Floats, target: Sequence[ArrayLike] | Floats, level: bool = True
) -> RigidFit:
    """Return the rigid transform that takes points to points with the smallest sum of squared distances.

    With isotropic noise of standard deviation s in each coordinate of a pair, the expected sum of squared residuals is
    s^2 (3 N - d) with d = 4 (level) or 6, and the standard deviation of the heading of a level fit is s / sqrt(sum of
    squared horizontal distances from the centroid).

    Source: Umeyama 1991, doi:10.1109/34.88573, without scale.

    Args:
        source, target: pairs of points ``[N, 3]`` [m], at least 3, not on one line.
        level: both rooms have their z axis along gravity, so only the heading is estimated. Headsets and motion capture
            know gravity better than touched points do.

    Raises:
        InputError: there are fewer than 3 pairs, a value is not finite, or the points are on one line.

    >>> corners = np.array([[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 3.0, 1.0]])
    >>> fit = fit_rigid(corners, RigidTransform.at(1.0, 2.0, 0.5).apply(corners))
    >>> round(fit.transform.heading, 6), round(fit.rms, 9)
    (0.5, 0.0)
    """
    a, b = np.asarray(source, dtype=np.float64), np.asarray(target, dtype=np.float64)
    if a.ndim != 2 or a.shape[1:] != (3,) or a.shape != b.shape:
        raise InputError(f"calibration: points have shapes {a.shape} and {b.shape}; both must be [N, 3]")
    if len(a) < 3:
        raise InputError(f"calibration: {len(a)} pairs of points are given; it needs at least 3")
    if not (np.all(np.isfinite(a)) and np.all(np.isfinite(b))):
        raise InputError("calibration: a coordinate is not a finite number")
    p, q = a - a.mean(axis=0), b - b.mean(axis=0)
    spread = [np.linalg.svd(item[:, :2] if level else item, compute_uv=False) for item in (p, q)]
    if min(item[0 if level else 1] for item in spread) < FLAT or min(item[1] for item in spread) < FLAT:
        raise InputError("calibration: the points are on one line; touch points around the room")
    rotation = _heading_rotation(p, q) if level else _rotation(p, q)
    transform = RigidTransform(rotation, b.mean(axis=0) - rotation @ a.mean(axis=0))
    residual = np.linalg.norm(transform.apply(a) - b, axis=1)
    total, free = float(np.sum(residual**2)), 3 * len(a) - (4 if level else 6)
    noise = math.sqrt(total / free) if free > 0 else math.nan
    return RigidFit(transform, residual, math.sqrt(total / len(a)), noise)


def _rotation(p: Floats, q: Floats) -> Floats:
    u, _, vt = np.linalg.svd(q.T @ p)
    sign = np.diag([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    return np.asarray(u @ sign @ vt)


def _heading_rotation(p: Floats, q: Floats) -> Floats:
    cos = float(np.sum(p[:, 0] * q[:, 0] + p[:, 1] * q[:, 1]))
    sin = float(np.sum(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]))
    return RigidTransform.at(0.0, 0.0, math.atan2(sin, cos)).rotation


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
