"""GroundPart: a rectangle of uneven ground."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

HIGHEST = 100.0
"""Largest height [m] of a part."""


@dataclass(frozen=True)
class GroundPart:
    """A rectangle of uneven ground, solid down to the floor; its top is a plane.

    Fields:
        x, y: centre [m].
        heading: direction of its length [rad], in which a ramp rises.
        length, width: sides [m].
        rear, front: heights of the top at both ends of its length [m].
        stairs: whether it is a step of stairs.

    Raises:
        InputError: a number is not finite, a side is not above 0, or a height is below 0.

    >>> ramp = GroundPart(2.0, 0.0, length=4.0, width=1.5, rear=0.0, front=0.32)
    >>> ramp.slope, ramp.corners.tolist()[0]
    (0.08, [0.0, -0.75])
    """

    x: float
    y: float
    heading: float = 0.0
    length: float = 1.0
    width: float = 1.0
    rear: float = 0.0
    front: float = 0.0
    stairs: bool = False

    def __post_init__(self) -> None:
        for part in fields(self):
            value = getattr(self, part.name)
            if part.name != "stairs" and not math.isfinite(value):
                raise InputError(f"GroundPart: {part.name} = {value} must be finite")
        for name in ("length", "width"):
            if getattr(self, name) <= 0.0:
                raise InputError(f"GroundPart: {name} = {getattr(self, name)} m must be above 0")
        for name in ("rear", "front"):
            if not 0.0 <= getattr(self, name) <= HIGHEST:
                raise InputError(f"GroundPart: {name} = {getattr(self, name)} m must be from 0 to {HIGHEST:g} m")

    @property
    def slope(self) -> float:
        """Rise over length, below 0 if it descends."""
        return (self.front - self.rear) / self.length

    @property
    def corners(self) -> NDArray[np.float64]:
        """Corners ``[4, 2]`` [m], counter-clockwise from the right end of the rear side."""
        half = 0.5 * np.array(
            [
                [-self.length, -self.width],
                [self.length, -self.width],
                [self.length, self.width],
                [-self.length, self.width],
            ]
        )
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return np.asarray(half @ np.array([[cos, sin], [-sin, cos]]) + (self.x, self.y))

    @property
    def heights(self) -> NDArray[np.float64]:
        """Heights ``[4]`` [m] of the top at the corners."""
        return np.array([self.rear, self.front, self.front, self.rear])
