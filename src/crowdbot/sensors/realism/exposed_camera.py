"""ExposedCamera: a colour camera with exposure time, rolling shutter and noise that grows with the light."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from crowdbot.core import InputError, Pose, SpatialPose, check_number
from crowdbot.sensors.noise import Randomness, apply_noise, normals
from crowdbot.sensors.rgb_camera import RGBCamera, RgbImage
from crowdbot.sensors.sensor import planar_pose, spatial_pose
from crowdbot.sensors.view import SensorView
from crowdbot.typing import Floats

from .moving_scene import SweepState, move_scene, sensor_motion

BANDS = 8
"""Number of bands of rows of a rolling shutter."""
MOST = 16
"""Largest number of images of an exposure."""


@dataclass(frozen=True, kw_only=True)
class ExposedCamera(RGBCamera):
    """A colour camera with the effects of a real one; each is off by default.

    The image is the mean of images during the exposure, band of rows by band with a rolling shutter; the last row ends
    at the time of the reading. Without a renderer, people and the camera move meanwhile; with a renderer only the
    camera does, since it draws one instant. Noise is added to the mean.

    Fields:
        width, height, field_of_view, distortion, near, far, segmentation, labels, renderer, shadows, antialiasing: as
            of :class:`RGBCamera`.
        exposure: exposure time [s]: motion blur.
        blur_images: number of images of an exposure.
        readout: time from the first to the last row [s]: rolling shutter.
        full_well: electrons of the brightest value; the noise of light is the root of the number of electrons. 0 for
            none.
        read_noise: standard deviation of the noise of the electronics, in values from 0 to 255.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Scene
    >>> camera = ExposedCamera(width=40, height=30, exposure=0.05)
    >>> image = camera.read(Scene.of([[3.0, 0.0]], [[0.0, 1.5]]), SpatialPose.of((0.0, 0.0, 1.0)))
    >>> image.rgb.shape
    (1, 30, 40, 3)
    """

    exposure: float = 0.0
    blur_images: int = 4
    readout: float = 0.0
    full_well: float = 0.0
    read_noise: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("exposure", "readout"):
            check_number("ExposedCamera", name, getattr(self, name), "s", min=0.0, max=1.0)
        check_number("ExposedCamera", "blur_images", self.blur_images, min=2, max=MOST, whole=True)
        for name in ("full_well", "read_noise"):
            check_number("ExposedCamera", name, getattr(self, name), min=0.0)

    def measure(self, view: SensorView, state: Any, rng: Randomness | None = None) -> tuple[RgbImage, Any]:
        """Return the image; with an exposure or a readout, the state is the pose of the camera.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        motion = sensor_motion(state, view.time, view.pose)
        bands = min(BANDS, self.height) if self.readout > 0.0 else 1
        count = self.blur_images if self.exposure > 0.0 else 1
        last: RgbImage | None = None
        total = np.zeros((view.environments, self.height, self.width, 3))
        for band, rows in enumerate(np.array_split(np.arange(self.height), bands)):
            end = -self.readout * (1.0 - (band + 1) / bands)
            for k in range(count):
                ahead = end - self.exposure * (1.0 - (k + 1) / count)
                last = self._image(view, motion, ahead)
                total[:, rows] += last.rgb[:, rows] / count
        assert last is not None
        values = apply_noise(self._with_noise(total, rng), self.noises, rng)
        values = np.where(np.isfinite(values), values, 0.0)
        rgb = np.round(np.clip(values, 0.0, 255.0)).astype(np.uint8)
        moving = self.exposure > 0.0 or self.readout > 0.0
        after = SweepState(view.time, view.pose) if moving else None
        return replace(last, time=view.time, pose=view.pose, rgb=rgb), after

    @property
    def _plain(self) -> RGBCamera:
        """The camera without noise and effects."""
        names = (
            "width", "height", "field_of_view", "distortion", "near", "far", "segmentation", "labels", "renderer",
            "shadows", "antialiasing",
        )  # fmt: skip
        return RGBCamera(**{name: getattr(self, name) for name in names})

    def _image(self, view: SensorView, motion: tuple[Floats, Floats], ahead: float) -> RgbImage:
        """Return the image some time after the view, without the noise of this class."""
        pose = spatial_pose(view.pose)
        if ahead != 0.0:
            velocity, turn = motion
            here = planar_pose(pose)
            flat = Pose(here.position + ahead * velocity, here.heading)
            place = np.concatenate([flat.position, pose.position[:, 2:]], axis=1)
            pose = _turn(SpatialPose(place, pose.rotation), ahead * turn)
        scene = move_scene(view.scene, ahead)
        return self._plain.measure(SensorView(scene, pose, view.renderer), None)[0]

    def _with_noise(self, values: Floats, rng: Randomness | None) -> Floats:
        if self.full_well == 0.0 and self.read_noise == 0.0:
            return values
        if rng is None:
            raise InputError("ExposedCamera: noise needs a random generator: pass rng=stream(seed, ...)")
        light = 255.0 * values / self.full_well if self.full_well > 0.0 else np.zeros_like(values)
        return np.asarray(values + np.sqrt(light + self.read_noise**2) * normals(values.shape, rng))


def _turn(pose: SpatialPose, angle: Floats) -> SpatialPose:
    """Return the pose turned about the vertical by ``angle`` ``[E]`` [rad]."""
    cos, sin = np.cos(0.5 * angle)[:, None], np.sin(0.5 * angle)[:, None]
    w, x, y, z = (pose.rotation[:, k : k + 1] for k in range(4))
    rotation = np.concatenate([cos * w - sin * z, cos * x - sin * y, cos * y + sin * x, cos * z + sin * w], axis=1)
    return SpatialPose(pose.position, rotation)
