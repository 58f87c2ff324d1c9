"""A colour camera: pictures of what somebody draws, or of plain shapes by rays."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, SpatialPose

from .camera import Lens, distorted
from .cast import cast
from .depth import pixel_beams
from .noise import Randomness, disturbed
from .sensor import Reading, Sensor, spatial_pose
from .shapes import FLOOR, NOTHING, PROP, WALLS
from .view import SensorView

__all__ = ["Picture", "RGBCamera"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
COLORS = {NOTHING: (204, 222, 240), WALLS: (219, 214, 204), FLOOR: (190, 190, 186), PROP: (204, 158, 97)}
"""What shapes look like without a source of images."""
PEOPLE = ((196, 78, 82), (76, 114, 176), (85, 168, 104), (129, 114, 178), (221, 132, 82), (100, 181, 205))
AMBIENT = 0.4


@dataclass(frozen=True)
class Picture(Reading):
    """A colour image in E environments, rows from the top, columns from the left.

    Fields:
        rgb: ``[E, H, W, 3]`` red, green, blue from 0 to 255.
        hit: ``[E, H, W]`` what the pixel shows, as in :class:`Scan`: the segmentation; None unless it was asked for.
        lens: the intrinsics.
    """

    rgb: NDArray[np.uint8]
    hit: Ints | None
    lens: Lens


@dataclass(frozen=True, kw_only=True)
class RGBCamera(Sensor):
    """A colour camera that looks along x of its pose, with z up in the image.

    It shows what an :class:`ImageSource` draws, such as a physics world or its studio, with the distortion of its lens.
    Without a source it shows the plain shapes of the scene by rays, in one colour each, which needs no graphics.
    Noise is added to the values from 0 to 255; what a dropout loses is 0.

    Fields:
        width, height: of the image [pixels].
        field_of_view: horizontal [rad]; pixels are square.
        distortion: k1, k2, p1, p2, k3 of the lens; empty for none.
        near, far: limits of what is shown [m].
        segmentation: whether the picture also tells what each pixel shows.

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
    width: int = 320
    height: int = 240
    field_of_view: float = math.radians(60.0)
    distortion: tuple[float, ...] = ()
    near: float = 0.05
    far: float = 100.0
    segmentation: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
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

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[Picture, None]:
        """Return the image of the renderer of ``view``, or one by rays if there is no renderer.

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
                rgb, hit = distorted(rgb, lens), distorted(hit, lens, fill=NOTHING)
        if self.noises:
            values = disturbed(rgb.astype(np.float64), self.noises, rng)
            rgb = np.round(np.clip(np.where(np.isfinite(values), values, 0.0), 0.0, 255.0))
        return Picture(view.time, pose, rgb.astype(np.uint8), hit if self.segmentation else None, lens), None

    def _by_rays(self, scene: Scene, pose: SpatialPose) -> tuple[NDArray[np.uint8], Ints]:
        bundle, ahead = pixel_beams(self.lens)
        hits = cast(scene, pose, bundle, self.far / float(ahead.min()), skins=False, normals=False)
        depth = hits.distance * ahead
        hit = np.where((depth >= self.near) & (depth <= self.far), hits.hit, NOTHING)
        colors = np.empty((*hit.shape, 3))
        colors[:] = np.array(PEOPLE, dtype=np.float64)[hit % len(PEOPLE)]
        for code, color in COLORS.items():
            colors[hit == code] = color
        light = np.where(hit == NOTHING, 1.0, AMBIENT + (1.0 - AMBIENT) * hits.facing)
        shape = (scene.shape[0], self.height, self.width)
        shown = np.round(colors * light[..., None]).astype(np.uint8)
        return shown.reshape(*shape, 3), hit.reshape(shape)
