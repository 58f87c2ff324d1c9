"""Mecanum drive: four wheels with rollers at 45 degrees, which move the base in every direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import check_number
from crowdbot.typing import Floats

from .wheeled import WheeledDrive


@dataclass(frozen=True)
class MecanumDrive(WheeledDrive):
    """Mecanum drive with rollers in the usual arrangement: seen from above, their axes point along the diagonals.

    With ``reach = (wheelbase + track) / 2``, the wheel speeds are

    * front left and rear right: ``(forward - left -+ turn * reach) / wheel_radius``,
    * front right and rear left: ``(forward + left +- turn * reach) / wheel_radius``.

    Four wheels for three velocities: the speeds of real motions fulfil ``front left + front right = rear left + rear
    right``, and :meth:`twist_of` returns the mean. The limits of speed apply to the velocity vector. A command beyond
    the wheel limits is shortened to a slower one on the same curve.

    Source: H. Taheri, B. Qiao, N. Ghaeminezhad, Kinematic Model of a Four Mecanum Wheeled Mobile Robot, IJCA 113(3),
    2015.

    Fields:
        track: distance between the left and right wheels [m].
        wheelbase: distance between the front and rear wheels [m].
        max_speed, max_turn_rate, max_acceleration, max_turn_acceleration, wheel_radius, max_wheel_speed: as in
            :class:`WheeledDrive`.

    Raises:
        InputError: a limit or a length is not finite and above 0.

    >>> from crowdbot.core import Twist
    >>> MecanumDrive().wheel_speeds(Twist(0.0, 0.0, left=0.5)).tolist()
    [-5.0, 5.0, 5.0, -5.0]
    """

    track: float = 0.4
    wheelbase: float = 0.3

    sideways = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("MecanumDrive", "track", self.track, "m", exclusive_min=0.0)
        check_number("MecanumDrive", "wheelbase", self.wheelbase, "m", exclusive_min=0.0)

    @property
    def matrix(self) -> Floats:
        """Wheel speeds per twist ``[4, 3]``: front left, front right, rear left, rear right."""
        reach = 0.5 * (self.track + self.wheelbase)
        rows = [[1.0, -reach, -1.0], [1.0, reach, 1.0], [1.0, -reach, 1.0], [1.0, reach, -1.0]]
        return np.array(rows) / self.wheel_radius
