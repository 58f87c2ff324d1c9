"""A navigator that drives straight to the goal."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Twist, check_number
from crowdbot.typing import Bools, Floats

from .batch_rows import drive_numbers, rows_for_kernels
from .goal_motion import holonomic_twists, twists_towards, velocities_towards
from .navigator import BatchKernels, Navigator
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

    always_returns = True

    speed: float = 1.0

    def __post_init__(self) -> None:
        check_number("Straight", "speed", self.speed, "m/s", exclusive_min=0.0)

    def act(self, observation: Observation) -> Twist:
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

    def _kernels(self) -> BatchKernels | None:
        return self._decided if self._keeps(Straight, "act") else None

    def _decided(self, batch: ObservationBatch, out: Floats) -> Bools:
        """Write the twists of the environments with regular values, and return which they are."""
        asking = rows_for_kernels(batch, with_people=False)
        places, numbers = (batch.pose, batch.goal, batch.waypoint), drive_numbers(batch.limits, self.speed)
        if batch.limits.holonomic:
            _move_to(asking, *places, numbers, float(batch.dt), out)
        else:
            twists_towards(asking, *places, numbers, out)
        return asking


def _move_to(
    asking: NDArray[np.bool_], pose: Floats, goal: Floats, waypoint: Floats, numbers: Floats, dt: float, out: Floats
) -> None:
    """Write the twists ``[N, 3]`` of a holonomic drive towards the waypoints."""
    velocity = np.zeros((len(pose), 2))
    velocities_towards(asking, pose, goal, waypoint, numbers, velocity)
    holonomic_twists(asking, pose, velocity, numbers, dt, out)
