"""An infrared range finder: the smallest distance within a narrow cone."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .beams import Beams, cone_directions, sort_beams
from .noise import Randomness
from .range_reading import RangeReading, nearest
from .ranging import Ranging
from .view import SensorView


@dataclass(frozen=True)
class Infrared(Ranging):
    """An infrared range finder: the smallest distance in a cone around the x axis of its pose.

    The cone is sampled by fixed beams, spread evenly over its solid angle. The first beam is the axis.

    Fields:
        dispersion: half the opening angle of the cone [rad].
        rays: number of beams.
        range_min, range_max: smallest and largest measured distance [m].
        max_incidence: largest angle between beam and surface normal that returns an echo [rad].
        resolution: step of the distance [m], 0 for none.
        skins: whether triangle skins of agents are used instead of their limbs.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> scene = Scene.of([[1.0, 0.0]], radius=0.3)
    >>> Infrared().read(scene, Pose.of((0.0, 0.0), 0.0)).ranges.tolist()
    [0.7]
    """

    spatial: ClassVar[bool] = True
    dispersion: float = math.radians(0.5)
    rays: int = 100
    range_min: float = 0.05
    range_max: float = 1.5
    max_incidence: float = math.radians(45.0)
    resolution: float = 0.0
    skins: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        self.check_count("rays")
        if not 0.0 < self.dispersion <= 0.5 * math.pi:
            raise InputError(f"Infrared: dispersion = {self.dispersion} rad must be above 0 and at most pi / 2")
        self.check_ranges()

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[RangeReading, None]:
        """Return the smallest distance in the zone.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        scene, pose = view.scene, view.pose
        bundle, directions = _bundle(self.dispersion, self.rays)
        length = np.full(self.rays, self.range_max)
        return nearest(self, scene, pose, (bundle, directions, length), rng), None


@functools.lru_cache(maxsize=64)
def _bundle(half_angle: float, rays: int) -> tuple[Beams, Floats]:
    directions = cone_directions(half_angle, rays)
    return sort_beams(directions), directions
