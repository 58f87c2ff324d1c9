"""Reward: of success, collision, discomfort and progress."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Reward"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Reward:
    """Terms of the reward of one control step; the defaults are those of CrowdNav, without progress.

    Chen et al. 2019, Crowd-Robot Interaction, https://arxiv.org/abs/1809.08835.

    Fields:
        success, collision: added at the end of an episode.
        discomfort_distance: clearance [m] below which people feel discomfort.
        discomfort: factor [1/(m s)] of the missing clearance and the time.
        progress: factor [1/m] of the distance to the goal that the robot has gained.

    >>> Reward().values(np.array([0.1]), np.zeros(1, bool), np.zeros(1, bool), np.zeros(1), 0.25).round(4).tolist()
    [-0.0125]
    """

    success: float = 1.0
    collision: float = -0.25
    discomfort_distance: float = 0.2
    discomfort: float = 0.5
    progress: float = 0.0

    def values(self, clearance: Floats, success: Bools, collision: Bools, gain: Floats, dt: float) -> Floats:
        """Return the rewards ``[N]`` of a step.

        Args:
            clearance: ``[N]`` clearance to the nearest person [m].
            success, collision: ``[N]`` whether the episode has ended so.
            gain: ``[N]`` distance to the goal gained [m].
            dt: duration of the step [s].
        """
        missing = np.maximum(0.0, self.discomfort_distance - np.maximum(clearance, 0.0))
        near = np.where(success | collision, 0.0, -self.discomfort * missing * dt)
        return self.success * success + self.collision * collision + near + self.progress * gain
