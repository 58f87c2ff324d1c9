"""Appearance: surfaces, sky and light of a stage."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core.fields import attribute, check

FLOORS = ("tiles", "checker", "wood", "concrete", "asphalt", "carpet", "grass", "paving", "plain")
WALL_SURFACES = ("plaster", "brick", "concrete", "panels", "plain")
SKIES = ("clear", "cloudy", "overcast", "dusk")
RANDOM = "random"


@dataclass(frozen=True)
class Appearance:
    """Surfaces, sky and light of a stage in images. Nothing else depends on them.

    Raises:
        InputError: there is no such surface or sky, or an angle is not allowed.

    >>> Appearance(floor="random").draw(np.random.default_rng(2)).floor in FLOORS
    True
    """

    floor: str = attribute(
        "tiles", about="surface of the floor; random: drawn for each seed", choices=(*FLOORS, RANDOM)
    )
    walls: str = attribute("plaster", about="surface of walls", choices=(*WALL_SURFACES, RANDOM))
    sky: str = attribute("clear", about="sky and light; random: also the place of the sun", choices=(*SKIES, RANDOM))
    sun_heading: float = attribute(
        2.15, about="direction in which the sun shines, counter-clockwise from +x", unit="rad"
    )
    sun_elevation: float = attribute(0.95, about="height of the sun", unit="rad", min=0.0872, max=1.5708)

    def __post_init__(self) -> None:
        check(self)

    def draw(self, rng: np.random.Generator) -> Appearance:
        """Return the appearance with what is ``random`` drawn; a random sky has a random place of the sun, too."""
        floor, walls, sky = (known[int(rng.integers(len(known)))] for known in (FLOORS, WALL_SURFACES, SKIES))
        heading, height = float(rng.uniform(-math.pi, math.pi)), float(rng.uniform(math.radians(20), math.radians(75)))
        free = self.sky == RANDOM
        return Appearance(
            floor if self.floor == RANDOM else self.floor,
            walls if self.walls == RANDOM else self.walls,
            sky if free else self.sky,
            heading if free else self.sun_heading,
            height if free else self.sun_elevation,
        )
