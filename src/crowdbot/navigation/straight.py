"""A navigator that drives straight to the goal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Twist, check_number
from crowdbot.typing import Floats

from .batch_rows import drive_numbers, rows_for_kernels, share_time
from .decisions import Decisions
from .goal_motion import holonomic_twists, twists_towards, velocities_towards
from .navigator import Navigator
from .observation import Observation
from .observation_batch import ObservationBatch


@dataclass(frozen=True)
class Straight(Navigator):
    """Drives straight to the waypoint and ignores people and walls; a baseline for comparisons.

    It turns on the spot if the waypoint is beside or behind the robot, and slows down near the goal. A holonomic drive
    moves to the waypoint in any direction, and turns towards its motion.

    Fields:
        speed: largest speed [m/s], limited by the drive.

    Raises:
        InputError: the speed is not finite or not above 0.

    >>> from crowdbot.navigation import DriveLimits
    >>> behind = Observation(pose=(0.0, 0.0, 0.0), goal=(-4.0, 0.1), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1)
    >>> Straight().act(behind)
    Twist(forward=0.0, turn=2.0, left=0.0)
    >>> limits = DriveLimits(1.0, 2.0, holonomic=True)
    >>> beside = Observation(pose=(0.0, 0.0, 0.0), goal=(0.0, 4.0), radius=0.3, limits=limits, dt=0.1)
    >>> round(Straight().act(beside).left, 3)
    0.995
    """

    speed: float = 1.0

    def __post_init__(self) -> None:
        check_number("Straight", "speed", self.speed, "m/s", exclusive_min=0.0)

    def act(self, observation: Observation) -> Twist:
        """Return the twist towards the waypoint."""
        if not observation.limits.holonomic:
            return observation.towards_goal(self.speed)
        place, goal, out = (
            np.array([observation.pose], np.float64),
            np.array([observation.goal], np.float64),
            np.zeros((1, 3)),
        )
        waypoint, asking = np.array([observation.waypoint], np.float64), np.ones(1, dtype=np.bool_)
        numbers = drive_numbers(observation.limits, self.speed)
        _move_to(asking, place, goal, waypoint, numbers, float(observation.dt), out)
        return Twist(*out[0].tolist())

    def decide_batch(
        self,
        batch: ObservationBatch,
        memories: Sequence[Any],
        robot: str = "",
        timer: Callable[[], float] | None = None,
        limit: float | None = None,
    ) -> Decisions:
        """Return the decisions in N environments, with one kernel; see :meth:`Navigator.decide_batch`."""
        if not self._keeps(Straight, "act"):
            return super().decide_batch(batch, memories, robot, timer, limit)
        decisions, begin = Decisions.still(memories), timer() if timer else 0.0
        asking = rows_for_kernels(batch, with_people=False)
        places, numbers = (batch.pose, batch.goal, batch.waypoint), drive_numbers(batch.limits, self.speed)
        if batch.limits.holonomic:
            _move_to(asking, *places, numbers, float(batch.dt), decisions.twist)
        else:
            twists_towards(asking, *places, numbers, decisions.twist)
        share_time(decisions, asking, begin, timer)
        if not asking.all():
            self._decide_rows(np.flatnonzero(~asking).tolist(), batch, decisions, robot, timer, limit)
        return decisions


def _move_to(
    asking: NDArray[np.bool_], pose: Floats, goal: Floats, waypoint: Floats, numbers: Floats, dt: float, out: Floats
) -> None:
    """Write the twists ``[N, 3]`` of a holonomic drive towards the waypoints."""
    velocity = np.zeros((len(pose), 2))
    velocities_towards(asking, pose, goal, waypoint, numbers, velocity)
    holonomic_twists(asking, pose, velocity, numbers, dt, out)
