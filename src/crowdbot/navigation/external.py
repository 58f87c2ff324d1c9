"""The port of a robot that a program outside the simulation commands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Twist, check_number

from .navigator import Navigator
from .observation import Observation


@dataclass(frozen=True)
class ExternalNavigator(Navigator):
    """Leaves the robot to velocity orders from outside, such as those of a bridge to ROS.

    The robot follows the latest order and stops if no order came for ``timeout``, as the controllers of ROS do
    (``cmd_vel_timeout``). Time is simulated time, so a replay stops at the same tick. The robot stands until its first
    order. The control period of the robot has no effect on its commands.

    Fields:
        timeout: age of the latest order at which the robot stops [s].

    Raises:
        InputError: the timeout is not finite or not above 0.

    >>> ExternalNavigator(timeout=0.2).is_stale(np.array([0, 3, 4]), step_ns=50_000_000).tolist()
    [False, False, True]
    """

    source: ClassVar[str] = ""
    always_returns = True
    """Address ``module:function`` of what opens the source of its orders in a run; empty: the caller gives one."""

    timeout: float = 0.5

    def __post_init__(self) -> None:
        check_number("ExternalNavigator", "timeout", self.timeout, "s", exclusive_min=0.0)

    @property
    def mirrors(self) -> bool:
        """Whether poses from outside move the robot, instead of velocities."""
        return False

    def act(self, observation: Observation) -> Twist:
        # it stands
        return Twist()

    def is_stale(self, ticks: NDArray[np.int64], step_ns: int) -> NDArray[np.bool_]:
        """Return whether the latest order is so old that the robot stops.

        Args:
            ticks: steps since the latest order.
            step_ns: time step [ns].
        """
        return np.asarray(ticks * step_ns >= round(self.timeout * 1e9))
