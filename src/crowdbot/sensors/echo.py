"""The reading of sensors that return one distance: the smallest of what their beams meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Pose, Scene, SpatialPose

from .beams import Beams
from .cast import cast
from .noise import Randomness
from .ranging import Ranging, settled
from .sensor import Reading, spatial_pose
from .shapes import NOTHING

__all__ = ["Echo", "nearest"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Echo(Reading):
    """The smallest distance within a zone in E environments (infinities as in ROS REP-117).

    Fields:
        ranges: ``[E]`` [m]; ``+inf`` nothing in the zone, ``-inf`` something nearer than the smallest distance.
        hit: ``[E]`` what it was: index of an agent or -1 nothing, -2 a wall, -3 the floor, -4 a prop.
        part: ``[E]`` index into ``scene.bodies.parts``, -1 where there is none.
        direction: ``[E, 3]`` unit vector of the beam in the sensor's frame, NaN for nothing. Ground truth.
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
) -> Echo:
    """Return the smallest return of a bundle: sorted beams, their directions ``[R, 3]`` and lengths ``[R]`` [m]."""
    bundle, directions, length = fan
    hits = cast(scene, spatial_pose(pose), bundle, float(length.max()), skins=sensor.skins, normals=False)
    back = (hits.distance <= length) & (hits.facing >= sensor.least_facing)
    best = np.argmin(np.where(back, hits.distance, np.inf), axis=1)
    rows = np.arange(len(best))
    distance = np.where(back, hits.distance, np.inf)[rows, best][:, None]
    hit, part = hits.hit[rows, best][:, None], hits.part[rows, best][:, None]
    ranges = settled(sensor, distance, np.ones_like(distance), hit, part, rng)[:, 0]
    direction = np.where(hit != NOTHING, directions[best], np.nan)
    return Echo(scene.time, pose, ranges, hit[:, 0], part[:, 0], direction)
