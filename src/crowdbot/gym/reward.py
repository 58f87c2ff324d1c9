"""Reward: of success, collision, discomfort and progress."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.typing import Bools, Floats


@dataclass(frozen=True)
class Reward:
    """Terms of the reward of one control step.

    The defaults are those of CrowdNav with two changes: a reward of progress, since proximal policy optimisation learns
    to stand still from CrowdNav's own, and a collision that costs as much as the progress of 10 m.

    * Progress is shaping by the potential ``-progress * distance to the goal``: over an episode, its sum is
      ``progress * (distance at the start - distance at the end)``, whatever the path, and 0 for a robot that stands.
      Without a discount, all paths to the goal get the same sum, up to the tolerance of the goal.
    * With CrowdNav's -0.25, a collision close to the goal would be better than standing. Long et al. have 15 for an
      arrival, -15 for a collision and 2.5 per metre of progress: -1 and 1/6 for an arrival of 1.

    Sources: Chen et al. 2019, Crowd-Robot Interaction, https://arxiv.org/abs/1809.08835 (success 1, collision -0.25,
    discomfort); Ng, Harada and Russell 1999, Policy invariance under reward transformations, ICML (shaping); Long et
    al. 2018, https://arxiv.org/abs/1709.10082 (collision, progress).

    Fields:
        success, collision: added at the end of an episode.
        discomfort_distance: clearance [m] below which people feel discomfort.
        discomfort: factor [1/(m s)] of the missing clearance and the time.
        progress: factor [1/m] of the distance to the goal that the robot has gained.

    >>> arguments = np.array([0.1]), np.zeros(1, bool), np.zeros(1, bool), np.array([0.2]), 0.25
    >>> Reward().values(*arguments).round(4).tolist()
    [0.0075]
    >>> Reward(collision=-0.25, progress=0.0).values(*arguments).round(4).tolist()  # as CrowdNav
    [-0.0125]
    """

    success: float = 1.0
    collision: float = -1.0
    discomfort_distance: float = 0.2
    discomfort: float = 0.5
    progress: float = 0.1

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
