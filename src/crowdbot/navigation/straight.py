"""A navigator that drives straight to the goal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import Twist, check_number

from .batch_rows import drive_numbers, rows_for_kernels, share_time
from .decisions import Decisions
from .goal_motion import twists_towards
from .navigator import Navigator
from .observation import Observation
from .observation_batch import ObservationBatch

__all__ = ["Straight"]


@dataclass(frozen=True)
class Straight(Navigator):
    """Drives straight to the waypoint and ignores people and walls; a baseline for comparisons.

    It turns on the spot if the waypoint is beside or behind the robot, and slows down near the goal.

    Fields:
        speed: largest speed [m/s], limited by the drive.

    Raises:
        InputError: the speed is not finite or not above 0.

    >>> from crowdbot.navigation import DriveLimits
    >>> behind = Observation(pose=(0.0, 0.0, 0.0), goal=(-4.0, 0.1), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1)
    >>> Straight().act(behind)
    Twist(forward=0.0, turn=2.0, left=0.0)
    """

    speed: float = 1.0

    def __post_init__(self) -> None:
        check_number("Straight", "speed", self.speed, "m/s", exclusive_min=0.0)

    def act(self, observation: Observation) -> Twist:
        """Return the twist towards the waypoint."""
        return observation.towards_goal(self.speed)

    def decide_batch(
        self,
        batch: ObservationBatch,
        memories: Sequence[Any],
        robot: str = "",
        timer: Callable[[], float] | None = None,
    ) -> Decisions:
        """Return the decisions in N environments, with one kernel; see :meth:`Navigator.decide_batch`."""
        if not self._keeps(Straight, "act"):
            return super().decide_batch(batch, memories, robot, timer)
        decisions, begin = Decisions.still(memories), timer() if timer else 0.0
        asking = rows_for_kernels(batch, with_people=False)
        twists_towards(
            asking, batch.pose, batch.goal, batch.waypoint, drive_numbers(batch.limits, self.speed), decisions.twist
        )
        share_time(decisions, asking, begin, timer)
        if not asking.all():
            self._decide_rows(np.flatnonzero(~asking).tolist(), batch, decisions, robot, timer)
        return decisions
