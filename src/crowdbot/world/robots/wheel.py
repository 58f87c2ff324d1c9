"""Wheel: a driven or steered wheel of a robot."""

from __future__ import annotations

import math
from dataclasses import dataclass

from crowdbot.core import InputError

__all__ = ["Wheel"]


@dataclass(frozen=True)
class Wheel:
    """A driven or steered wheel.

    Fields:
        joint: joint of the axle.
        radius: radius [m].
        steering: joint with a vertical axis that steers the wheel; empty without steering.
        driven: whether the wheel has a motor.

    Raises:
        InputError: the radius is not finite and above 0, or the wheel neither steers nor drives.

    >>> Wheel("rear_left", 0.2).driven
    True
    """

    joint: str
    radius: float
    steering: str = ""
    driven: bool = True

    def __post_init__(self) -> None:
        if not 0.0 < self.radius < math.inf:
            raise InputError(f"Wheel: radius = {self.radius} m must be finite and above 0")
        if not (self.driven or self.steering):
            raise InputError(f"Wheel: {self.joint!r} is neither driven nor steered; give its steering joint")
