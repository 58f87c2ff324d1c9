"""Wheel: what a robot drives and steers with."""

from __future__ import annotations

import math
from dataclasses import dataclass

from crowdbot.core import InputError

__all__ = ["Wheel"]


@dataclass(frozen=True)
class Wheel:
    """A wheel that a motor turns, or that steers.

    Fields:
        joint: whose axis is the axle.
        radius: [m].
        steering: the joint that steers it, whose axis is upright; empty when it does not steer.
        driven: whether a motor turns it.

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
            raise InputError(f"Wheel: {self.joint!r} neither drives nor steers; name the joint that steers it")
