"""Wheel: a wheel of a robot that holds it on its path."""

from __future__ import annotations

import math
from dataclasses import dataclass

from crowdbot.core import InputError

__all__ = ["Wheel"]

MAX_ROLLERS = 1.4
"""Largest angle [rad] of rollers: at pi / 2 the wheel could not push."""


@dataclass(frozen=True)
class Wheel:
    """A wheel that drives, steers, or rolls freely and holds the base sideways. Castors are no such wheels.

    Fields:
        joint: joint of the axle.
        radius: radius [m].
        steering: joint with a vertical axis that steers the wheel; empty without steering.
        driven: whether the wheel has a motor.
        rollers: angle [rad] from the rolling direction to the axes of the rollers on the ground, counter-clockwise seen
            from above: 0 for omnidirectional wheels, +-pi / 4 for mecanum wheels; None for a wheel without rollers.

    Raises:
        InputError: the radius is not finite and above 0, or rollers are more than 80 degrees from the rolling
            direction.

    >>> Wheel("rear_left", 0.2).driven
    True
    """

    joint: str
    radius: float
    steering: str = ""
    driven: bool = True
    rollers: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 < self.radius < math.inf:
            raise InputError(f"Wheel: radius = {self.radius} m must be finite and above 0")
        if self.rollers is not None and not abs(self.rollers) <= MAX_ROLLERS:
            raise InputError(f"Wheel: rollers = {self.rollers} rad of {self.joint!r} must be at most 1.4 (80 degrees)")
