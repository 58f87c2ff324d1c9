"""Uneven ground of a stage: ramps, stairs, platforms and thresholds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from crowdbot import world
from crowdbot.core.fields import attribute, check


@dataclass(frozen=True, kw_only=True)
class Ramp:
    """A slope that rises along its heading, in the physics world.

    >>> ramp = Ramp(x=2, y=0, length=4, width=1.5, height=0.32)
    >>> ramp.parts()[0].slope
    0.08
    """

    x: float = attribute(about="x of the centre", unit="m")
    y: float = attribute(about="y of the centre", unit="m")
    heading: float = attribute(0.0, about="direction in which it rises, counter-clockwise from +x", unit="rad")
    length: float = attribute(about="length on the floor plan", unit="m", min=0.01, max=1000.0)
    width: float = attribute(1.5, about="width", unit="m", min=0.01, max=1000.0)
    height: float = attribute(about="height of the upper end", unit="m", min=0.001, max=100.0)
    bottom: float = attribute(0.0, about="height of the lower end", unit="m", min=0.0, max=100.0)

    def __post_init__(self) -> None:
        check(self)

    def parts(self) -> list[world.GroundPart]:
        """Return its parts in the physics world."""
        return [
            world.GroundPart(self.x, self.y, self.heading, self.length, self.width, self.bottom, self.height),
        ]


@dataclass(frozen=True, kw_only=True)
class Stairs:
    """Steps that rise along their heading, in the physics world. The last step is as high as the upper floor."""

    x: float = attribute(about="x of the centre", unit="m")
    y: float = attribute(about="y of the centre", unit="m")
    heading: float = attribute(0.0, about="direction in which they rise, counter-clockwise from +x", unit="rad")
    steps: int = attribute(about="number of steps", min=1, max=200)
    rise: float = attribute(0.17, about="height of a step", unit="m", min=0.001, max=1.0)
    tread: float = attribute(0.29, about="depth of a step", unit="m", min=0.05, max=10.0)
    width: float = attribute(1.5, about="width", unit="m", min=0.01, max=1000.0)
    bottom: float = attribute(0.0, about="height of the floor before the first step", unit="m", min=0.0, max=50.0)

    def __post_init__(self) -> None:
        check(self)

    def parts(self) -> list[world.GroundPart]:
        """Return its parts in the physics world."""
        ground_parts = []
        for k in range(self.steps):
            away = (k + 0.5 - 0.5 * self.steps) * self.tread
            x, y = self.x + away * math.cos(self.heading), self.y + away * math.sin(self.heading)
            top = self.bottom + (k + 1) * self.rise
            ground_parts.append(world.GroundPart(x, y, self.heading, self.tread, self.width, top, top, stairs=True))
        return ground_parts


@dataclass(frozen=True, kw_only=True)
class Platform:
    """A raised area with a level top in the physics world, such as a pavement behind a kerb."""

    x: float = attribute(about="x of the centre", unit="m")
    y: float = attribute(about="y of the centre", unit="m")
    heading: float = attribute(0.0, about="heading of the length, counter-clockwise from +x", unit="rad")
    length: float = attribute(about="length", unit="m", min=0.01, max=1000.0)
    width: float = attribute(about="width", unit="m", min=0.01, max=1000.0)
    height: float = attribute(0.12, about="height of the top", unit="m", min=0.001, max=100.0)

    def __post_init__(self) -> None:
        check(self)

    def parts(self) -> list[world.GroundPart]:
        """Return its parts in the physics world."""
        return [
            world.GroundPart(self.x, self.y, self.heading, self.length, self.width, self.height, self.height),
        ]


@dataclass(frozen=True, kw_only=True)
class Threshold:
    """A low bar across a passage in the physics world, such as a door sill; its edges are vertical or bevelled."""

    x: float = attribute(about="x of the centre", unit="m")
    y: float = attribute(about="y of the centre", unit="m")
    heading: float = attribute(0.0, about="direction of the passage, counter-clockwise from +x", unit="rad")
    depth: float = attribute(0.1, about="size along the passage, with bevels", unit="m", min=0.005, max=10.0)
    width: float = attribute(1.0, about="size across the passage", unit="m", min=0.01, max=1000.0)
    height: float = attribute(0.02, about="height of the top", unit="m", min=0.001, max=0.3)
    bevel: float = attribute(0.0, about="depth of the slopes at both edges", unit="m", min=0.0, max=1.0)

    def __post_init__(self) -> None:
        check(self)

    def parts(self) -> list[world.GroundPart]:
        """Return its parts in the physics world: the bar, and its bevels."""
        bevel = min(self.bevel, 0.5 * self.depth)
        flat = self.depth - 2.0 * bevel
        ground_parts = []
        if flat > 0.0:
            ground_parts.append(
                world.GroundPart(self.x, self.y, self.heading, flat, self.width, self.height, self.height),
            )
        for turn in (0.0, math.pi) if bevel > 0.0 else ():
            heading = self.heading + turn
            away = -0.5 * (flat + bevel)
            x, y = self.x + away * math.cos(heading), self.y + away * math.sin(heading)
            ground_parts.append(world.GroundPart(x, y, heading, bevel, self.width, 0.0, self.height))
        return ground_parts


UNEVEN = (
    'has uneven ground (ramp, stairs, platform or threshold), which only the physics world has; set world="physics"'
)
GroundElement = Ramp | Stairs | Platform | Threshold


def ground_of(elements: Sequence[GroundElement]) -> world.Ground | None:
    """Return the ground of elements; None without parts.

    >>> ground_of((Platform(x=0, y=0, length=2, width=2),)).height([[0.0, 0.0], [3.0, 0.0]]).tolist()
    [0.12, 0.0]
    """
    parts = [part for element in elements for part in element.parts()]
    return world.Ground(tuple(parts)) if parts else None
