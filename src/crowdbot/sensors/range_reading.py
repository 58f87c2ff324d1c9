"""The reading of sensors that measure a single distance, the smallest within a zone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import Pose, Scene, SpatialPose, storable
from crowdbot.typing import Floats, Ints

from .beams import Beams
from .noise import Randomness
from .ranging import Ranging, apply_limits
from .ray_casting import cast_rays
from .ray_shapes import NOTHING
from .sensor import Reading, spatial_pose


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


def nearest(
    sensor: Ranging,
    scene: Scene,
    pose: Pose | SpatialPose,
    fan: tuple[Beams, Floats, Floats],
    rng: Randomness | None,
) -> RangeReading:
    """Return the smallest distance of a bundle of beams: sorted beams, directions ``[R, 3]`` and lengths ``[R]``
    [m].
    """
    bundle, directions, length = fan
    hits = cast_rays(scene, spatial_pose(pose), bundle, float(length.max()), skins=sensor.skins, normals=False)
    back = (hits.distance <= length) & (hits.cos_incidence >= sensor.min_cos_incidence)
    best = np.argmin(np.where(back, hits.distance, np.inf), axis=1)
    rows = np.arange(len(best))
    distance = np.where(back, hits.distance, np.inf)[rows, best][:, None]
    hit, part = hits.hit[rows, best][:, None], hits.part[rows, best][:, None]
    ranges = apply_limits(sensor, distance, np.ones_like(distance), hit, part, rng)[:, 0]
    direction = np.where(hit != NOTHING, directions[best], np.nan)
    return RangeReading(scene.time, pose, ranges, hit[:, 0], part[:, 0], direction)
