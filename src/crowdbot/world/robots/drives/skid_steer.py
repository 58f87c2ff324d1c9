"""Skid-steer drive: left and right wheels or tracks at different speeds, which slide sideways in a turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import check_number

from .wheeled import Floats, WheeledDrive

__all__ = ["SkidSteerDrive", "slip_of"]


def slip_of(track: float, wheelbase: float) -> float:
    """Return the slip factor of a skid-steer base: effective track divided by track.

    At a wheel with the centre ``(+-wheelbase / 2, +-track / 2)`` whose rim runs at the speed ``v``, a base that turns
    at the rate ``w`` slides by ``(v - w track / 2, w wheelbase / 2)``. Coulomb friction opposes the slide. With equal
    loads its moment about the centre is zero for ``w = 2 v / (track (1 + (wheelbase / track)^2))``, whatever the
    friction coefficient and the forward speed. Real controllers have the same factor: 1.5 for Jackal (1.49 here),
    1.875 for Husky (1.80 here).

    Source: J. L. Martinez et al., Approximating Kinematics for Tracked Mobile Robots, IJRR 24(10), 2005 (instantaneous
    centres of rotation of the sides); ``wheel_separation_multiplier`` of jackal_control and husky_control.

    >>> round(slip_of(0.3756, 0.262), 2), round(slip_of(0.5708, 0.512), 2)
    (1.49, 1.8)
    """
    return 1.0 + (wheelbase / track) ** 2


@dataclass(frozen=True)
class SkidSteerDrive(WheeledDrive):
    """Skid-steer drive, as in Husky, Jackal and Pioneer 3-AT: four wheels or two tracks that do not steer.

    In a turn the wheels slide sideways, so they run faster than those of a differential drive: by ``slip``, the
    effective track divided by the track. Speeds of the left and right wheels are
    ``(forward -+ turn * slip * track / 2) / wheel_radius``. The lateral speed of a command is ignored. A command beyond
    the wheel limits is shortened to a slower one on the same curve.

    Fields:
        track: distance between the left and right wheels [m].
        wheelbase: distance between the first and the last axle [m].
        slip: slip factor; 0: :func:`slip_of`.
        max_speed, max_turn_rate, max_acceleration, max_turn_acceleration, wheel_radius, max_wheel_speed: as in
            :class:`WheeledDrive`.

    Raises:
        InputError: a number is not finite, a length or limit is not above 0, or ``slip`` is between 0 and 1.

    >>> from crowdbot.core import Twist
    >>> drive = SkidSteerDrive(track=0.4, wheelbase=0.4, wheel_radius=0.1)
    >>> drive.wheel_speeds(Twist(1.0, 0.5)).round(9).tolist()
    [8.0, 12.0]
    """

    track: float = 0.4
    wheelbase: float = 0.3
    slip: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("SkidSteerDrive", "track", self.track, "m", exclusive_min=0.0)
        check_number("SkidSteerDrive", "wheelbase", self.wheelbase, "m", exclusive_min=0.0)
        if self.slip != 0.0:
            check_number("SkidSteerDrive", "slip", self.slip, min=1.0)

    @property
    def slip_factor(self) -> float:
        """Effective track divided by the track."""
        return self.slip or slip_of(self.track, self.wheelbase)

    @property
    def matrix(self) -> Floats:
        """Wheel speeds of the left and the right side per twist, ``[2, 3]``."""
        half = 0.5 * self.track * self.slip_factor
        return np.array([[1.0, -half, 0.0], [1.0, half, 0.0]]) / self.wheel_radius
