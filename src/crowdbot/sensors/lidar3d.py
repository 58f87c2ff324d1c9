"""A three-dimensional laser scanner: rings of beams."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, storable
from crowdbot.typing import Floats, Ints

from .beams import Beams, sort_beams, unit_vectors
from .lidar import visible_agents
from .noise import Randomness
from .ranging import MOST_BEAMS, Ranging, apply_limits, end_points, incidence_of
from .ray_casting import cast_rays
from .sensor import Reading, spatial_pose
from .view import SensorView

TURN = 2.0 * math.pi
SIXTEEN_RINGS = tuple(round(math.radians(-15.0 + 2.0 * k), 12) for k in range(16))


@storable
@dataclass(frozen=True)
class PointCloud(Reading):
    """One scan of a 3-D laser scanner in E environments, K rings of R beams (infinities as in ROS REP-117).

    Fields:
        ranges: ``[E, K, R]`` [m]; ``+inf`` beyond the range, ``-inf`` below the smallest range.
        elevation: ``[K]`` [rad], positive upward; azimuth: ``[R]`` [rad], counter-clockwise, 0 is forward.
        hit: ``[E, K, R]`` object hit by the beam, coded as in :class:`Scan`.
        part: ``[E, K, R]`` index into ``scene.bodies.parts``, -1 where there is none.
        cos_incidence: ``[E, K, R]`` cosine of the angle between beam and surface normal, 1 without a hit.
    """

    shared_fields: ClassVar[tuple[str, ...]] = ("elevation", "azimuth")
    ranges: Floats
    elevation: Floats
    azimuth: Floats
    hit: Ints
    part: Ints
    cos_incidence: Floats

    @property
    def incidence(self) -> Floats:
        """``[E, K, R]`` angle between beam and surface normal [rad], NaN without a return."""
        return incidence_of(self.cos_incidence, self.hit)

    def points(self, *, in_world: bool = False) -> Floats:
        """Return the end points of the beams ``[E, K, R, 3]`` [m] in the sensor frame, NaN without a finite range."""
        return end_points(
            spatial_pose(self.pose), unit_vectors(self.azimuth, self.elevation[:, None]), self.ranges, in_world=in_world
        )

    def visible_agents(self, count: int) -> NDArray[np.bool_]:
        """Return which of ``count`` agents were hit by at least one beam, ``[E, A]``."""
        return visible_agents(self.hit, count)


@dataclass(frozen=True)
class Lidar3D(Ranging):
    """A laser scanner with rings of beams, all measured at the same instant.

    Ranges, incidence and noise are those of :class:`Lidar2D`. A planar pose is level, at the height of a usual mount.

    Fields:
        elevations: elevations of the K rings [rad], positive upward.
        columns: number of beams R of a ring.
        azimuth_from, azimuth_to: first and last azimuth of a ring [rad], both included; a full circle does not repeat
            its first beam.
        range_min, range_max: smallest and largest measured distance [m].
        max_incidence: largest angle between beam and surface normal that gives a return [rad].
        resolution: step of the distances [m], 0 for none.
        skins: whether triangle skins of agents are used instead of their limbs.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> cloud = Lidar3D(columns=4).read(Scene.of([[3.0, 0.0]], radius=0.5), Pose.of((0.0, 0.0), 0.0).to_spatial(1.0))
    >>> cloud.ranges.shape, cloud.hit[0, 7].tolist()
    ((1, 16, 4), [-1, -1, 0, -1])
    """

    spatial: ClassVar[bool] = True
    batched = True
    elevations: tuple[float, ...] = SIXTEEN_RINGS
    columns: int = 900
    azimuth_from: float = -math.pi
    azimuth_to: float = math.pi
    range_min: float = 0.1
    range_max: float = 30.0
    max_incidence: float = math.pi / 2
    resolution: float = 0.0
    skins: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        rings = tuple(float(value) for value in self.elevations)
        object.__setattr__(self, "elevations", rings)
        if not rings or not all(abs(value) <= math.pi / 2 for value in rings):
            raise InputError(f"Lidar3D: elevations = {rings} rad must be at least one, each within -pi / 2 to pi / 2")
        self.check_count("columns")
        if len(rings) * self.columns > MOST_BEAMS:
            raise InputError(
                f"Lidar3D: columns = {self.columns} with {len(rings)} elevations must be at most {MOST_BEAMS} beams"
            )
        if not 0.0 < self.azimuth_to - self.azimuth_from <= TURN + 1e-9 or not abs(self.azimuth_from) <= TURN:
            raise InputError(
                f"Lidar3D: azimuth_from = {self.azimuth_from} and azimuth_to = {self.azimuth_to} rad must be"
                " in this order and at most 2 pi apart"
            )
        self.check_ranges()

    @classmethod
    def sphere(
        cls, azimuth: tuple[float, float], elevation: tuple[float, float], resolution: float, **fields: float
    ) -> Lidar3D:
        """Return a scanner of a part of the sphere, with one angular ``resolution`` [rad] for both.

        >>> part = Lidar3D.sphere((-1.0, 1.0), (-0.5, 0.5), 0.1)
        >>> len(part.elevations), part.columns
        (11, 21)
        """
        rows = round((elevation[1] - elevation[0]) / resolution) + 1
        columns = round((azimuth[1] - azimuth[0]) / resolution) + 1
        rings = tuple(np.linspace(*elevation, rows).tolist())
        return cls(rings, columns, *azimuth, **fields)  # type: ignore[arg-type]

    @property
    def azimuth(self) -> Floats:
        """Azimuths of the beams of a ring ``[R]`` [rad]."""
        width = self.azimuth_to - self.azimuth_from
        full = width >= TURN - 1e-9
        return np.linspace(self.azimuth_from, self.azimuth_to, self.columns, endpoint=not full)

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[PointCloud, None]:
        """Return the cloud from the pose of the view; ``rng`` is needed only with noise.

        Raises:
            InputError: scene and pose have different numbers of environments, noise lacks a generator, or skins are
                requested and the scene has none.
        """
        self.check(view)
        scene, pose = view.scene, view.pose
        hits = cast_rays(scene, spatial_pose(pose), _made(self), self.range_max, skins=self.skins, normals=False)
        ranges = apply_limits(self, hits.distance, hits.cos_incidence, hits.hit, hits.part, rng)
        shape = (len(ranges), len(self.elevations), self.columns)
        ranges, cos_incidence = ranges.reshape(shape), hits.cos_incidence.reshape(shape)
        hit, part = hits.hit.reshape(shape), hits.part.reshape(shape)
        return PointCloud(
            scene.time, pose, ranges, np.array(self.elevations), self.azimuth, hit, part, cos_incidence
        ), None


@functools.lru_cache(maxsize=64)
def _of(elevations: tuple[float, ...], columns: int, first: float, last: float) -> Beams:
    lidar = Lidar3D(elevations, columns, first, last)
    return sort_beams(unit_vectors(lidar.azimuth, np.array(elevations)[:, None]).reshape(-1, 3))


def _made(lidar: Lidar3D) -> Beams:
    return _of(lidar.elevations, lidar.columns, lidar.azimuth_from, lidar.azimuth_to)
