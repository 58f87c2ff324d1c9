"""StageAppearance: surfaces, sky and light of a stage."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, UnknownName

FLOORS = ("tiles", "checker", "wood", "concrete", "asphalt", "carpet", "grass", "paving", "plain")
WALL_SURFACES = ("plaster", "brick", "concrete", "panels", "plain")
SKIES = ("clear", "cloudy", "overcast", "dusk")
RANDOM = "random"
LOWEST = math.radians(5.0)


@dataclass(frozen=True)
class StageAppearance:
    """Surfaces, sky and light of a stage in images of the renderer ``software``.

    Fields:
        floor: one of :data:`FLOORS`, or ``random``.
        walls: one of :data:`WALL_SURFACES`, or ``random``.
        sky: one of :data:`SKIES`, or ``random``; it sets the colour and the strength of the light.
        sun_heading: direction in which the light shines [rad].
        sun_elevation: height of the sun [rad], from 5 to 90 degrees.

    Raises:
        UnknownName: there is no such surface or sky.
        InputError: an angle is not allowed.

    >>> StageAppearance(floor="random").draw(np.random.default_rng(2)).floor in FLOORS
    True
    """

    floor: str = "tiles"
    walls: str = "plaster"
    sky: str = "clear"
    sun_heading: float = 2.15
    sun_elevation: float = 0.95

    def __post_init__(self) -> None:
        for name, known in (("floor", FLOORS), ("walls", WALL_SURFACES), ("sky", SKIES)):
            if getattr(self, name) not in (*known, RANDOM):
                raise UnknownName(
                    name if name == "sky" else f"surface of {name}", getattr(self, name), (*known, RANDOM)
                )
        if not math.isfinite(self.sun_heading):
            raise InputError(f"StageAppearance: sun_heading = {self.sun_heading} rad must be finite")
        if not LOWEST - 1e-9 <= self.sun_elevation <= 0.5 * math.pi + 1e-9:
            raise InputError(
                f"StageAppearance: sun_elevation = {self.sun_elevation} rad must be from {LOWEST:.3f} to"
                f" {0.5 * math.pi:.3f}"
            )

    def draw(self, rng: np.random.Generator) -> StageAppearance:
        """Return the appearance with what is ``random`` drawn; a random sky has a random place of the sun, too."""
        floor, walls, sky = (known[int(rng.integers(len(known)))] for known in (FLOORS, WALL_SURFACES, SKIES))
        heading, height = float(rng.uniform(-math.pi, math.pi)), float(rng.uniform(math.radians(20), math.radians(75)))
        free = self.sky == RANDOM
        return StageAppearance(
            floor if self.floor == RANDOM else self.floor,
            walls if self.walls == RANDOM else self.walls,
            sky if free else self.sky,
            heading if free else self.sun_heading,
            height if free else self.sun_elevation,
        )
