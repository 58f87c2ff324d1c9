"""SlippingWheel: a wheel that moves the robot less than it turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .fault import Fault

SIDES = {"left": 1.0, "right": -1.0}


@dataclass(frozen=True)
class SlippingWheel(Fault):
    """A wheel of a differential drive that slips: its side moves at ``1 - slip`` of its commanded speed.

    The command becomes the twist of the two sides, at the distance of the radius of the robot from its centre, so the
    robot drives slower and turns to the side of the wheel. Commands to the left (of omnidirectional drives) are not
    changed. Odometry measures the motion of the robot, not the turns of the wheel.

    Fields:
        side: ``left`` or ``right``.
        slip: share of the speed that is lost, above 0 to 1.

    Raises:
        InputError: the side is unknown, or the slip is not above 0 and at most 1.

    >>> forward, numbers = np.array([[1.0, 0.0, 0.0]]), np.array([[0.0, 9.0, 0.5]])
    >>> SlippingWheel(slip=0.5).change_commands(numbers, forward, 0.25)
    array([[0.75, 1.  , 0.  ]])
    """

    side: str = "left"
    slip: float = 0.3

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.side not in SIDES:
            raise InputError(f"side = {self.side!r} must be left or right")
        if not 0.0 < self.slip <= 1.0:
            raise InputError(f"slip = {self.slip:g} must be above 0 and at most 1")

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        """Return the names of the numbers."""
        return (*super().number_names(), "slip")

    def change_commands(
        self, numbers: NDArray[np.float64], command: NDArray[np.float64], radius: float
    ) -> NDArray[np.float64]:
        """Return the commands as the drive gets them, see :meth:`Fault.change_commands`."""
        sign = SIDES[self.side]
        lost = numbers[:, 2] * (command[:, 0] - sign * radius * command[:, 1])
        changed = command.copy()
        changed[:, 0] -= 0.5 * lost
        changed[:, 1] += sign * 0.5 * lost / radius
        return changed
