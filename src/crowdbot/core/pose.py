"""Where something is and how it is asked to move: poses and twists in the plane."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Pose", "Twist", "wrap"]


def wrap(angle: float) -> float:
    """Return ``angle`` [rad] in (-pi, pi].

    >>> round(wrap(3 * math.pi / 2), 6) == round(-math.pi / 2, 6)
    True
    """
    return math.pi - (math.pi - angle) % (2.0 * math.pi)


class Twist(NamedTuple):
    """A velocity command in the robot's own frame (REP-103: x forward, y left)."""

    forward: float = 0.0
    """[m/s]"""
    turn: float = 0.0
    """Counter-clockwise [rad/s]."""
    left: float = 0.0
    """[m/s]; a differential drive cannot follow it."""


@dataclass(frozen=True)
class Pose:
    """Positions ``[E, 2]`` [m] and headings ``[E]`` [rad] of one thing in every environment.

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

    def mounted(self, x: float, y: float, heading: float) -> Pose:
        """Return the pose of a part that sits at ``x``, ``y`` [m] and ``heading`` [rad] in this frame."""
        cos, sin = np.cos(self.heading), np.sin(self.heading)
        shift = np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
        return Pose(self.position + shift, self.heading + heading)
