"""An infrared range finder: the smallest return within a narrow cone."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .beams import Beams, beams, cone
from .echo import Echo, nearest
from .noise import Randomness
from .ranging import Ranging
from .view import SensorView

__all__ = ["Infrared"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Infrared(Ranging):
    """An infrared range finder that looks along x and returns the smallest distance in a cone of its own frame.

    The cone is sampled by beams spread evenly over its solid angle, the axis among them; they are the same every time.

    Fields:
        dispersion: half the opening angle of the cone [rad].
        rays: beams that sample the cone.
        range_min, range_max: smallest and largest distance that is measured [m].
        max_incidence: largest angle between beam and surface normal that returns [rad].
        resolution: step of the returned distance [m], 0 for none.
        skins: whether agents that have triangle skins are seen by them and not by their limbs.

    Raises:
        InputError: a value is not allowed.

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

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[Echo, None]:
        """Return the smallest distance; ``rng`` is needed only when there is noise.

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
    directions = cone(half_angle, rays)
    return beams(directions), directions
