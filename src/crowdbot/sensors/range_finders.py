"""Range finders, infrared and ultrasonic: the smallest distance within a zone."""

from __future__ import annotations

import functools
import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import InputError, check_number, storable
from crowdbot.typing import Floats, Ints

from .beams import Beams, cone_directions, sort_beams
from .noise import Randomness
from .ranging import Ranging, apply_limits
from .ray_casting import cast_rays
from .ray_shapes import NOTHING
from .sensor import Reading, spatial_pose
from .view import SensorView


@storable
@dataclass(frozen=True)
class RangeReading(Reading):
    """The smallest distance within a zone in E environments (infinities as in ROS REP-117).

    Fields:
        ranges: ``[E]`` [m]; ``+inf`` nothing in the zone, ``-inf`` below the smallest range.
        hit: ``[E]`` object: index of an agent, -1 nothing, -2 a wall, -3 the floor, -4 a prop.
        part: ``[E]`` index into ``scene.bodies.parts``, -1 where there is none.
        direction: ``[E, 3]`` unit vector of the beam in the sensor frame, NaN without a return. Ground truth.
    """

    ranges: Floats
    hit: Ints
    part: Ints
    direction: Floats


@dataclass(frozen=True)
class RangeFinder(Ranging):
    """Measures the smallest distance of a bundle of beams around the x axis of its pose."""

    spatial: ClassVar[bool] = True

    @abstractmethod
    def bundle(self) -> tuple[Beams, Floats, Floats]:
        """Return the sorted beams, their directions ``[R, 3]`` in the sensor frame and their lengths ``[R]`` [m]."""

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[RangeReading, None]:
        """Return the smallest distance in the zone.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        scene, (beams, directions, length) = view.scene, self.bundle()
        hits = cast_rays(scene, spatial_pose(view.pose), beams, float(length.max()), skins=self.skins, normals=False)
        back = (hits.distance <= length) & (hits.cos_incidence >= self.min_cos_incidence)
        best = np.argmin(np.where(back, hits.distance, np.inf), axis=1)
        rows = np.arange(len(best))
        distance = np.where(back, hits.distance, np.inf)[rows, best][:, None]
        hit, part = hits.hit[rows, best][:, None], hits.part[rows, best][:, None]
        ranges = apply_limits(self, distance, np.ones_like(distance), hit, part, rng)[:, 0]
        direction = np.where(hit != NOTHING, directions[best], np.nan)
        return RangeReading(scene.time, view.pose, ranges, hit[:, 0], part[:, 0], direction), None


@dataclass(frozen=True)
class Infrared(RangeFinder):
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

    batched = True

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

    def bundle(self) -> tuple[Beams, Floats, Floats]:
        return (*_cone(self.dispersion, self.rays), np.full(self.rays, self.range_max))


@functools.lru_cache(maxsize=64)
def _cone(half_angle: float, rays: int) -> tuple[Beams, Floats]:
    directions = cone_directions(half_angle, rays)
    return sort_beams(directions), directions


SLIM = 16.0 / (3.0 * math.sqrt(3.0))
"""Radius of the zone over its widest radius is ``SLIM u sqrt(u (1 - u))`` at the share u of its length."""


def teardrop(angle: Floats, radius: float, length: float) -> Floats:
    """Return the range of the zone [m] in directions at ``angle`` [rad] from its axis, 0 outside.

    The surface has the radius ``radius 16 / (3 sqrt 3) u sqrt(u (1 - u))`` at the distance ``u length`` along the
    axis; it is widest at ``u = 3/4`` (D4.2 of the CROWDBOT project, section 3.5.4). A direction crosses the
    surface twice; points before the first crossing belong to the zone too, since the sound passes them.

    >>> teardrop(np.array([0.0, math.atan2(1.0, 0.75 * 4.0), 1.0]), 1.0, 4.0).round(6).tolist()
    [4.0, 3.162278, 0.0]
    """
    slope = np.tan(np.clip(np.abs(angle), 0.0, 0.5 * math.pi - 1e-9)) * length / (SLIM * radius)
    root = 1.0 - 4.0 * slope**2
    share = 0.5 * (1.0 + np.sqrt(np.maximum(root, 0.0)))
    return np.asarray(np.where(root >= -1e-12, share * length / np.cos(angle), 0.0))


@dataclass(frozen=True)
class Ultrasound(RangeFinder):
    """An ultrasonic range finder: the smallest distance in a :func:`teardrop` around the x axis of its pose.

    Fields:
        radius: widest radius of the zone [m], at three quarters of ``range_max``.
        rays: number of beams, spread evenly over the solid angle of the zone.
        range_min, range_max: smallest and largest measured distance [m].
        max_incidence: largest angle between beam and surface normal that returns an echo [rad].
        resolution: step of the distance [m], 0 for none.
        skins: whether triangle skins of agents are used instead of their limbs.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> scene = Scene.of([[2.0, 0.0]], radius=0.3)
    >>> Ultrasound().read(scene, Pose.of((0.0, 0.0), 0.0).to_spatial(0.5)).ranges.tolist()
    [1.7]
    """

    batched = True

    radius: float = 0.5
    rays: int = 400
    range_min: float = 0.15
    range_max: float = 2.5
    max_incidence: float = math.pi / 2
    resolution: float = 0.0
    skins: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        self.check_count("rays")
        check_number("Ultrasound", "radius", self.radius, "m", exclusive_min=0.0)
        self.check_ranges()

    @property
    def half_angle(self) -> float:
        """Largest angle between the axis and a direction inside the zone [rad]."""
        return math.atan(0.5 * SLIM * self.radius / self.range_max)

    def bundle(self) -> tuple[Beams, Floats, Floats]:
        return _teardrop(self.radius, self.range_max, self.rays)


@functools.lru_cache(maxsize=64)
def _teardrop(radius: float, length: float, rays: int) -> tuple[Beams, Floats, Floats]:
    half = math.atan(0.5 * SLIM * radius / length)
    beams, directions = _cone(half, rays)
    angle = np.arctan2(np.hypot(directions[:, 1], directions[:, 2]), directions[:, 0])
    return beams, directions, teardrop(np.minimum(angle, half), radius, length)
