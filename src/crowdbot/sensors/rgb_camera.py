"""A colour camera: rendered images, or plain shapes by ray casting."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, SpatialPose, storable
from crowdbot.typing import Floats, Ints

from .depth_camera import pixel_beams
from .lens import Lens, distort_image
from .noise import Randomness, apply_noise
from .ray_casting import cast_rays
from .ray_shapes import FLOOR, NOTHING, PROP, WALLS
from .sensor import Reading, Sensor, spatial_pose
from .view import SensorView

COLORS = {NOTHING: (204, 222, 240), WALLS: (219, 214, 204), FLOOR: (190, 190, 186), PROP: (204, 158, 97)}
"""Colours of shapes without a renderer."""
PEOPLE = ((196, 78, 82), (76, 114, 176), (85, 168, 104), (129, 114, 178), (221, 132, 82), (100, 181, 205))
AMBIENT = 0.4
RENDERERS = ("opengl", "software")
"""``opengl`` draws plain colours with a graphics library. ``software`` draws textures, shadows and smooth edges on the
processor, with the same bytes on every machine."""
SAMPLE_COUNTS = (1, 2, 4, 8)


def check_renderer(who: str, renderer: str, antialiasing: int) -> None:
    """Check the choice of a renderer and its samples per pixel.

    Raises:
        InputError: a value is not allowed.
    """
    if renderer not in RENDERERS:
        raise InputError(f"{who}: renderer = {renderer!r} must be one of {', '.join(RENDERERS)}")
    if antialiasing not in SAMPLE_COUNTS:
        raise InputError(f"{who}: antialiasing = {antialiasing} must be one of {', '.join(map(str, SAMPLE_COUNTS))}")
    if renderer == "opengl" and antialiasing != 1:
        raise InputError(f"{who}: antialiasing = {antialiasing} needs renderer = 'software'")


@storable
@dataclass(frozen=True)
class RgbImage(Reading):
    """A colour image in E environments, rows from the top, columns from the left.

    Fields:
        rgb: ``[E, H, W, 3]`` red, green, blue from 0 to 255.
        hit: ``[E, H, W]`` segmentation, coded as in :class:`Scan`; None unless requested.
        lens: the intrinsics.
        intrinsics: ``[E, 4]`` fx, fy, cx, cy [pixels]; keypoints: ``[E, A, 17, 3]`` column and row [pixels] of the
            points of COCO, and 2 (visible), 1 (hidden) or 0 (outside); solid_boxes: ``[E, A, 7]`` centre x, y, z,
            length, width, height [m] and heading [rad] in the world. None unless the camera has ``labels``.
    """

    shared_fields: ClassVar[tuple[str, ...]] = ("lens",)
    rgb: NDArray[np.uint8]
    hit: Ints | None
    lens: Lens
    intrinsics: Floats | None = None
    keypoints: Floats | None = None
    solid_boxes: Floats | None = None


@dataclass(frozen=True, kw_only=True)
class RGBCamera(Sensor):
    """A colour camera. It looks along the x axis of its pose, z is up in the image.

    The image comes from the renderer of the view, with the distortion of the lens. Without a renderer, the camera uses
    ray casting and shows each shape of the scene in one colour. Noise is added to the values from 0 to 255; dropouts
    are 0.

    Fields:
        width, height: size of the image [pixels].
        field_of_view: horizontal field of view [rad]; pixels are square.
        distortion: coefficients k1, k2, p1, p2, k3 of the lens (default: none).
        near, far: clipping distances [m].
        segmentation: whether the image includes the segmentation.
        labels: whether the image includes keypoints and boxes of people; this needs a renderer.
        renderer: one of :data:`RENDERERS`.
        shadows: whether the sun casts shadows; ``opengl`` draws none.
        antialiasing: samples per pixel, 1, 2, 4 or 8; ``opengl`` has 1.

    Raises:
        InputError: a value is not allowed.

    >>> scene = Scene.of([[2.0, 0.0]], radius=0.5)
    >>> camera = RGBCamera(width=5, height=1, field_of_view=math.radians(60.0), segmentation=True)
    >>> picture = camera.read(scene, SpatialPose.of((0.0, 0.0, 1.0)))
    >>> picture.rgb.shape, picture.hit[0, 0].tolist()
    ((1, 1, 5, 3), [-1, 0, 0, 0, -1])
    """

    spatial: ClassVar[bool] = True
    renders: ClassVar[bool] = True
    batched = True
    width: int = 320
    height: int = 240
    field_of_view: float = math.radians(60.0)
    distortion: tuple[float, ...] = ()
    near: float = 0.05
    far: float = 100.0
    segmentation: bool = False
    labels: bool = False
    renderer: str = "opengl"
    shadows: bool = False
    antialiasing: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        check_renderer("RGBCamera", self.renderer, self.antialiasing)
        if self.renderer == "opengl" and self.shadows:
            raise InputError("RGBCamera: shadows need renderer = 'software'")
        object.__setattr__(self, "distortion", tuple(float(k) for k in self.distortion))
        if not 0.0 < self.near < self.far < math.inf:
            raise InputError(
                f"RGBCamera: near = {self.near} m must be above 0 and below far = {self.far} m, and both finite"
            )
        _ = self.lens

    @property
    def lens(self) -> Lens:
        """Intrinsics."""
        return Lens.of(self.width, self.height, self.field_of_view, self.distortion or (0.0,) * 5)

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[RgbImage, None]:
        """Return the image of the renderer of ``view``, or by ray casting without a renderer.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        pose, lens = view.pose, self.lens
        if view.renderer is None:
            rgb, hit = self._by_rays(view.scene, spatial_pose(pose))
        else:
            images = view.renderer.render(self, spatial_pose(pose))
            rgb = np.asarray(images["rgb"])
            hit = np.asarray(images.get("hit", np.full(rgb.shape[:3], NOTHING)))
            if any(self.distortion):
                rgb, hit = distort_image(rgb, lens), distort_image(hit, lens, fill=NOTHING)
        if self.noises:
            values = apply_noise(rgb.astype(np.float64), self.noises, rng)
            rgb = np.round(np.clip(np.where(np.isfinite(values), values, 0.0), 0.0, 255.0))
        more: dict[str, Floats] = {}
        if self.labels and view.renderer is not None:
            more = {name: np.asarray(images[name]) for name in ("keypoints", "solid_boxes")}
            more["intrinsics"] = np.tile((lens.fx, lens.fy, lens.cx, lens.cy), (len(rgb), 1))
        masks = hit if self.segmentation else None
        return RgbImage(view.time, pose, rgb.astype(np.uint8), masks, lens, **more), None

    def _by_rays(self, scene: Scene, pose: SpatialPose) -> tuple[NDArray[np.uint8], Ints]:
        bundle, ahead = pixel_beams(self.lens)
        hits = cast_rays(scene, pose, bundle, self.far / float(ahead.min()), skins=False, normals=False)
        depth = hits.distance * ahead
        hit = np.where((depth >= self.near) & (depth <= self.far), hits.hit, NOTHING)
        colors = np.empty((*hit.shape, 3))
        colors[:] = np.array(PEOPLE, dtype=np.float64)[hit % len(PEOPLE)]
        for code, color in COLORS.items():
            colors[hit == code] = color
        light = np.where(hit == NOTHING, 1.0, AMBIENT + (1.0 - AMBIENT) * hits.cos_incidence)
        shape = (scene.shape[0], self.height, self.width)
        shown = np.round(colors * light[..., None]).astype(np.uint8)
        return shown.reshape(*shape, 3), hit.reshape(shape)
