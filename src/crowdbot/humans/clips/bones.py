"""Bones of one person, for poses that replace a part of the gait."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.humans.asset import shapes

__all__ = ["Bones", "mix_rotations", "turn_about", "unit", "yaw_pitch"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Bones:
    """Bones of one person, changed in place.

    Fields:
        R, P: rotation ``[B, 3, 3]`` relative to rest and position ``[B, 3]`` [m] of each bone in the world.
        head: start of each bone at rest ``[B, 3]`` [m]; frame: rest frames of arms and legs, see ``Measures``.
        yaw: heading of the trunk [rad]; stature [m].
    """

    R: Floats
    P: Floats
    head: Floats
    frame: Floats
    yaw: float
    stature: float

    @property
    def shoulders(self) -> Floats:
        """Middle between the shoulder joints ``[3]`` [m]."""
        return np.asarray(0.5 * (self.P[bone("upperarm_l")] + self.P[bone("upperarm_r")]))

    def from_shoulders(self, ahead: float, left: float, up: float) -> Floats:
        """Return a point ``[3]`` [m] at this distance from the shoulders, in shares of the stature."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        away = np.array([cos * ahead - sin * left, sin * ahead + cos * left, up])
        return np.asarray(self.shoulders + self.stature * away)

    def place(self, first: str) -> None:
        """Put all bones below a bone at the ends of their parents."""
        moved = {bone(first)}
        for b, parent in enumerate(shapes().parents.tolist()):
            if parent in moved:
                moved.add(b)
                self.P[b] = self.P[parent] + self.R[parent] @ (self.head[b] - self.head[parent])

    def reach(self, side: int, wrist: Floats, pole: Floats, share: float) -> None:
        """Take a wrist to a point [m], with the elbow towards ``pole``, by a share of the way from its pose.

        The hand continues the forearm. ``side`` is 0 for left, 1 for right.
        """
        letter = "lr"[side]
        upper, lower, hand = (bone(f"{name}_{letter}") for name in ("upperarm", "lowerarm", "hand"))
        a, b = (float(np.linalg.norm(self.head[j] - self.head[i])) for i, j in ((upper, lower), (lower, hand)))
        away = wrist - self.P[upper]
        far = float(np.linalg.norm(away))
        aim = away / max(far, 1e-9)
        far = min(max(far, abs(a - b) + 0.03), 0.995 * (a + b))
        hinge = unit(np.cross(pole, aim))
        inner = math.acos(min(max((a * a + far * far - b * b) / (2.0 * a * far), -1.0), 1.0))
        elbow = math.acos(min(max((a * a + b * b - far * far) / (2.0 * a * b), -1.0), 1.0))
        first = turn_about(hinge, -inner) @ aim
        second = turn_about(hinge, math.pi - elbow) @ first
        for name, k, axis in ((upper, 4 + side, first), (lower, 6 + side, second)):
            goal = np.stack([axis, hinge, np.cross(axis, hinge)], axis=1) @ self.frame[k]
            self.R[name] = mix_rotations(self.R[name], goal, share)
        for outer in ("hand", "fingers_01", "fingers_02", "thumb"):
            k = bone(f"{outer}_{letter}")
            self.R[k] = mix_rotations(self.R[k], self.R[lower], share)
        self.place(f"upperarm_{letter}")


def bone(name: str) -> int:
    """Return the index of a bone."""
    return shapes().bone(name)


def turn_about(axis: Floats, angle: float) -> Floats:
    """Return the rotation ``[3, 3]`` by an angle [rad] about a unit vector."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross)


def yaw_pitch(yaw: float, pitch: float) -> Floats:
    """Return the rotation of a heading [rad], then forward by a pitch [rad]."""
    c, s, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return np.array([[c * cp, -s, c * sp], [s * cp, c, s * sp], [-sp, 0.0, cp]])


def mix_rotations(a: Floats, b: Floats, share: float) -> Floats:
    """Return the rotation that is nearest to the weighted mean of two."""
    if share >= 1.0:
        return b
    u, _, v = np.linalg.svd((1.0 - share) * a + share * b)
    return np.asarray(u @ np.diag([1.0, 1.0, float(np.sign(np.linalg.det(u @ v)))]) @ v)


def unit(a: Floats) -> Floats:
    """Return the vector of length 1 in this direction."""
    return np.asarray(a / max(float(np.linalg.norm(a)), 1e-9))
