"""A depth camera: metric depth and labels of every pixel, by ray casting or from rendered images."""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, SpatialPose, check_number, storable
from crowdbot.typing import Floats, Ints

from .beams import Beams, sort_beams
from .lens import ImageSource, Lens, pixel_directions, stereo_depth
from .lidar import visible_agents
from .noise import Randomness, apply_noise
from .ray_casting import cast_rays
from .ray_shapes import NOTHING
from .sensor import Reading, Sensor, spatial_pose
from .view import SensorView


@storable
@dataclass(frozen=True)
class DepthImage(Reading):
    """Depth and labels of the pixels in E environments, rows from the top, columns from the left.

    Fields:
        depth: ``[E, H, W]`` [m] along the optical axis; ``+inf`` beyond the range, ``-inf`` too near.
        hit: ``[E, H, W]`` segmentation, coded as in :class:`Scan`.
        part: ``[E, H, W]`` index into ``scene.bodies.parts``, -1 where there is none.
        lens: the intrinsics.
    """

    shared_fields: ClassVar[tuple[str, ...]] = ("lens",)
    depth: Floats
    hit: Ints
    part: Ints
    lens: Lens

    def points(self, *, in_world: bool = False) -> Floats:
        """Return the points ``[E, H, W, 3]`` [m] in the camera frame (x forward), NaN without depth."""
        ahead = pixel_directions(self.lens)
        away = np.where(np.isfinite(self.depth), self.depth, np.nan)[..., None] * (ahead / ahead[..., :1])
        if not in_world:
            return np.asarray(away)
        pose = spatial_pose(self.pose)
        return np.asarray(pose.position[:, None, None] + np.einsum("eij,ehwj->ehwi", pose.matrix, away))

    def visible_agents(self, count: int) -> NDArray[np.bool_]:
        """Return which of ``count`` agents appear in at least one pixel, ``[E, A]``."""
        return visible_agents(self.hit, count)


@dataclass(frozen=True)
class DepthCamera(Sensor):
    """A camera that measures the depth of every pixel along its optical axis, the x axis of its pose.

    It casts one ray per pixel. :meth:`from_image` applies the same errors to a rendered depth image. With a
    ``baseline`` the error is that of stereo (:func:`stereo_depth`); ``noise`` is added after that.

    Fields:
        width, height: size of the image [pixels].
        field_of_view: horizontal field of view of the undistorted lens [rad].
        distortion: k1, k2, p1, p2, k3, or nothing.
        range_min, range_max: smallest and largest measured depth [m].
        max_incidence: largest measured angle between ray and surface normal [rad].
        baseline: distance of the stereo pair [m], 0 for no stereo error.
        disparity_noise: standard deviation of the disparity [pixels]; disparity_step: its subpixel step [pixels].
        resolution: step of the depth [m], 0 for none.
        skins: whether triangle skins of agents are used instead of their limbs.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> scene = Scene.of([[50.0, 0.0]], walls=[[(3.0, -9.0), (3.0, 9.0)]])
    >>> image = DepthCamera(width=5, height=3).read(scene, Pose.of((0.0, 0.0), 0.0).to_spatial(1.5))
    >>> image.depth[0, 0].round(9).tolist()
    [3.0, 3.0, 3.0, 3.0, 3.0]
    """

    spatial: ClassVar[bool] = True
    batched = True
    width: int = 160
    height: int = 120
    field_of_view: float = math.radians(87.0)
    distortion: tuple[float, ...] = ()
    range_min: float = 0.1
    range_max: float = 10.0
    max_incidence: float = math.pi / 2
    baseline: float = 0.0
    disparity_noise: float = 0.0
    disparity_step: float = 0.0
    resolution: float = 0.0
    skins: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "distortion", tuple(float(k) for k in self.distortion))
        if not 0.0 <= self.range_min < self.range_max < math.inf:
            raise InputError(
                f"DepthCamera: range_min = {self.range_min} m and range_max = {self.range_max} m must be finite,"
                " not negative, and range_min the smaller one"
            )
        if not 0.0 < self.max_incidence <= math.pi / 2 + 1e-9:
            raise InputError(
                f"DepthCamera: max_incidence = {self.max_incidence} rad must be above 0 and at most pi / 2"
            )
        for name in ("baseline", "disparity_noise", "disparity_step", "resolution"):
            unit = "m" if name in ("baseline", "resolution") else "pixels"
            check_number("DepthCamera", name, getattr(self, name), unit, min=0.0)
        if self.baseline == 0.0 and (self.disparity_noise or self.disparity_step):
            raise InputError("DepthCamera: disparity noise and steps need a baseline above 0")
        _ = self.lens

    @property
    def sees_skins(self) -> bool:
        return self.skins

    def with_skins(self) -> Self:
        return dataclasses.replace(self, skins=True)

    @property
    def lens(self) -> Lens:
        """Intrinsics."""
        return Lens.of(self.width, self.height, self.field_of_view, self.distortion or (0.0,) * 5)

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[DepthImage, None]:
        """Return depth and labels by ray casting.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        scene, pose = view.scene, view.pose
        bundle, ahead = pixel_beams(self.lens)
        hits = cast_rays(
            scene, spatial_pose(pose), bundle, self.range_max / float(ahead.min()), skins=self.skins, normals=False
        )
        back = hits.cos_incidence >= math.cos(self.max_incidence) - 1e-12
        shape = (scene.shape[0], self.height, self.width)
        depth = np.where(back, hits.distance * ahead, np.inf).reshape(shape)
        hit, part = hits.hit.reshape(shape), hits.part.reshape(shape)
        return self._finished(scene.time, pose, depth, hit, part, rng), None

    def from_image(
        self, source: ImageSource, time: float | Floats, pose: SpatialPose, rng: Randomness | None = None
    ) -> DepthImage:
        """Return depth and labels from images of ``source`` (``depth``, ``hit``, ``part``), without distortion."""
        images = source.render(self, pose)
        depth = np.asarray(images["depth"], dtype=np.float64)
        nothing = np.full(depth.shape, NOTHING)
        hit, part = images.get("hit", nothing), images.get("part", np.full(depth.shape, -1))
        return self._finished(time, pose, depth, np.asarray(hit), np.asarray(part), rng)

    def _finished(
        self,
        time: float | Floats,
        pose: Pose | SpatialPose,
        depth: Floats,
        hit: Ints,
        part: Ints,
        rng: Randomness | None,
    ) -> DepthImage:
        near = depth < self.range_min
        measured = np.where(depth <= self.range_max, depth, np.inf)
        if self.baseline > 0.0:
            focal = self.lens.fx
            measured = stereo_depth(measured, focal, self.baseline, self.disparity_noise, self.disparity_step, rng)
            measured = np.where(depth > 0.0, measured, depth)
        measured = apply_noise(measured, self.noises, rng)
        kept = measured < np.inf
        near = kept & (near | (measured < self.range_min))
        far = ~kept | (measured > self.range_max)
        if self.resolution > 0.0:
            low = math.ceil(self.range_min / self.resolution - 1e-9)
            high = math.floor(self.range_max / self.resolution + 1e-9)
            measured = np.clip(np.round(measured / self.resolution), low, high) * self.resolution
        shown = np.where(near, -np.inf, np.where(far, np.inf, measured))
        gone = far & ~near
        return DepthImage(time, pose, shown, np.where(gone, NOTHING, hit), np.where(gone, -1, part), self.lens)


@functools.lru_cache(maxsize=16)
def pixel_beams(lens: Lens) -> tuple[Beams, Floats]:
    """Return the beams of the pixels, row by row, and the cosine of the angle to the optical axis."""
    directions = pixel_directions(lens).reshape(-1, 3)
    return sort_beams(directions), np.ascontiguousarray(directions[:, 0])
