"""Omnidirectional wheels: three or more wheels on a circle whose rollers let them slide along their axles."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import check_number
from crowdbot.typing import Floats

from .wheeled import WheeledDrive


@dataclass(frozen=True)
class OmniWheelDrive(WheeledDrive):
    """Omnidirectional wheels on a circle around the origin, as in Robotino: each rolls along the circle.

    A wheel at the angle ``a`` on a circle of the radius ``distance`` turns at
    ``(-sin(a) * forward + cos(a) * left + distance * turn) / wheel_radius``; its rollers slide along the axle, which
    points to the centre. The limits of speed apply to the velocity vector. A command beyond the wheel limits is
    shortened to a slower one on the same curve.

    Source: R. Siegwart, I. Nourbakhsh, Introduction to Autonomous Mobile Robots, 3.2.3 (Swedish 90 degree wheels).

    Fields:
        wheels: number of wheels at equal angles, at least 3.
        distance: distance of the wheels from the origin [m].
        first_angle: angle of the first wheel, from the x axis [rad].
        max_speed, max_turn_rate, max_acceleration, max_turn_acceleration, wheel_radius, max_wheel_speed: as in
            :class:`WheeledDrive`.

    Raises:
        InputError: a limit or a length is not finite and above 0, or there are fewer than 3 wheels.

    >>> from crowdbot.core import Twist
    >>> drive = OmniWheelDrive(wheels=3, distance=0.2, wheel_radius=0.1)
    >>> drive.wheel_speeds(Twist(0.0, 1.0)).round(9).tolist()
    [2.0, 2.0, 2.0]
    """

    wheels: int = 3
    distance: float = 0.2
    first_angle: float = 0.0

    sideways = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("OmniWheelDrive", "wheels", self.wheels, min=3, whole=True)
        check_number("OmniWheelDrive", "distance", self.distance, "m", exclusive_min=0.0)
        check_number("OmniWheelDrive", "first_angle", self.first_angle, "rad", min=-2.0 * math.pi, max=2.0 * math.pi)

    @property
    def matrix(self) -> Floats:
        """Wheel speeds per twist ``[W, 3]``, counter-clockwise from the first wheel."""
        angles = self.first_angle + 2.0 * math.pi * np.arange(self.wheels) / self.wheels
        reach = np.full(self.wheels, self.distance)
        return np.stack([-np.sin(angles), reach, np.cos(angles)], axis=1) / self.wheel_radius
