"""Poses in the plane and in space, and velocity commands."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.typing import Floats

from .tree import storable

MOUNT_HEIGHT = 0.4
"""Default height [m] of a sensor with a planar pose, typical for laser scanners of indoor robots."""


Angle = TypeVar("Angle", float, Floats)


def wrap_angle(angle: Angle) -> Angle:
    """Return an angle, or an array of angles [rad], in (-pi, pi].

    >>> round(wrap_angle(3 * math.pi / 2), 6) == round(-math.pi / 2, 6)
    True
    """
    return math.pi - (math.pi - angle) % (2.0 * math.pi)


@storable
class Twist(NamedTuple):
    """A velocity command in the frame of the robot (REP-103: x forward, y left).

    >>> Twist(forward=0.8, turn=-0.2)
    Twist(forward=0.8, turn=-0.2, left=0.0)
    """

    forward: float = 0.0
    """[m/s]"""
    turn: float = 0.0
    """Counter-clockwise [rad/s]."""
    left: float = 0.0
    """[m/s]; not supported by differential drives."""


@storable
@dataclass(frozen=True)
class Pose:
    """Planar pose of one object in each environment: positions ``[E, 2]`` [m] and headings ``[E]`` [rad].

    >>> Pose.of((1.0, 2.0), 0.5).position.tolist()
    [[1.0, 2.0]]
    """

    position: NDArray[np.float64]
    heading: NDArray[np.float64]

    @classmethod
    def of(cls, position: ArrayLike, heading: ArrayLike) -> Pose:
        """Make a pose from ``[2]`` and a number, or from ``[E, 2]`` and ``[E]``."""
        point = np.atleast_2d(np.asarray(position, dtype=np.float64))
        angle = np.broadcast_to(np.asarray(heading, dtype=np.float64), point.shape[:1]).copy()
        return cls(point, angle)

    def offset(self, x: float, y: float, heading: float) -> Pose:
        """Return the pose of a part at ``x``, ``y`` [m] and ``heading`` [rad] in this frame."""
        cos, sin = np.cos(self.heading), np.sin(self.heading)
        place = np.empty((len(self.heading), 2))
        np.add(self.position[:, 0], cos * x - sin * y, out=place[:, 0])
        np.add(self.position[:, 1], sin * x + cos * y, out=place[:, 1])
        return Pose(place, self.heading + heading)

    def to_spatial(self, z: ArrayLike = MOUNT_HEIGHT, roll: ArrayLike = 0.0, pitch: ArrayLike = 0.0) -> SpatialPose:
        """Return the spatial pose at height ``z`` [m] with ``roll`` and ``pitch`` [rad].

        >>> Pose.of((1.0, 2.0), 0.5).to_spatial(0.3).position.tolist()
        [[1.0, 2.0, 0.3]]
        """
        height = np.broadcast_to(np.asarray(z, dtype=np.float64), self.heading.shape)
        return SpatialPose.of(np.column_stack([self.position, height]), roll, pitch, self.heading)


@storable
@dataclass(frozen=True)
class SpatialPose:
    """Spatial pose of one object in each environment.

    Positions ``[E, 3]`` [m] and rotations ``[E, 4]`` (unit quaternions w, x, y, z) from the frame of the object to the
    world frame. Axes follow REP-103: x forward, y left, z up.

    >>> ahead = SpatialPose.of((0.0, 0.0, 1.0), yaw=math.pi / 2).offset(0.2, 0.0, 0.1)
    >>> ahead.position.round(12).tolist(), ahead.heading.round(6).tolist()
    ([[0.0, 0.2, 1.1]], [1.570796])
    """

    position: Floats
    rotation: Floats

    @classmethod
    def of(
        cls, position: ArrayLike, roll: ArrayLike = 0.0, pitch: ArrayLike = 0.0, yaw: ArrayLike = 0.0
    ) -> SpatialPose:
        """Make a pose from ``[3]`` or ``[E, 3]`` and rotations [rad] about the world axes x, then y, then z.

        Positive ``pitch`` points down, as in URDF and ROS.
        """
        point = np.atleast_2d(np.asarray(position, dtype=np.float64))
        angles = [np.broadcast_to(np.asarray(a, dtype=np.float64), point.shape[:1]) * 0.5 for a in (roll, pitch, yaw)]
        (cr, cp, cy), (sr, sp, sy) = (np.cos(a) for a in angles), (np.sin(a) for a in angles)
        turn = [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
        return cls(point, np.stack(turn, axis=-1))

    @property
    def matrix(self) -> Floats:
        """Rotation matrices ``[E, 3, 3]``; the columns are the axes of the object in the world frame."""
        turn = self.rotation / np.sqrt((self.rotation**2).sum(axis=-1, keepdims=True))
        w, x, y, z = turn.T
        result = np.empty((len(turn), 3, 3))
        result[:, 0] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=-1)
        result[:, 1] = np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=-1)
        result[:, 2] = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=-1)
        return result

    @property
    def heading(self) -> Floats:
        """Direction of the object's x axis in the plane, ``[E]`` [rad]."""
        forward = self.matrix[:, :, 0]
        return np.asarray(np.arctan2(forward[:, 1], forward[:, 0]))

    @property
    def planar(self) -> Pose:
        """The pose projected to the plane."""
        return Pose(self.position[:, :2].copy(), self.heading)

    def offset(
        self, x: float, y: float, z: float = 0.0, roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0
    ) -> SpatialPose:
        """Return the pose of a part at ``x``, ``y``, ``z`` [m] in this frame, rotated by the angles [rad]."""
        place = self.position + self.matrix @ np.array([x, y, z])
        part = SpatialPose.of((0.0, 0.0, 0.0), roll, pitch, yaw).rotation
        return SpatialPose(place, product(self.rotation, part))


def product(first: Floats, second: Floats) -> Floats:
    """Return the quaternions ``[..., 4]`` (w, x, y, z) of the rotation ``second`` followed by ``first``."""
    a, b, c, d = np.moveaxis(first, -1, 0)
    w, x, y, z = np.moveaxis(second, -1, 0)
    parts = [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ]
    return np.stack(parts, axis=-1)
