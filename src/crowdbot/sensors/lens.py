"""Camera intrinsics, lens distortion and stereo noise."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, SpatialPose, check_number
from crowdbot.typing import Floats

from .noise import Randomness, normals

MOST_PIXELS = 1 << 24
"""Largest number of pixels of an image."""


class ImageSource(Protocol):
    """A renderer of camera images."""

    def render(self, camera: Any, pose: SpatialPose) -> Mapping[str, NDArray[Any]]:
        """Return images of an ideal pinhole camera with the intrinsics of ``camera``, axis E first.

        ``rgb`` ``[E, H, W, 3]`` uint8; ``depth`` ``[E, H, W]`` [m] along the optical axis, inf for nothing; ``hit``
        and ``part`` ``[E, H, W]`` as in :class:`Scan`. The camera looks along x of its pose, z is up in the image.
        """


@dataclass(frozen=True)
class Lens:
    """Intrinsics of a camera: a pinhole with Brown-Conrady distortion (as in OpenCV and ROS ``plumb_bob``).

    Fields:
        width, height: size of the image [pixels].
        fx, fy: focal lengths [pixels]; cx, cy: principal point [pixels]; the centre of the first pixel is (0, 0).
        distortion: coefficients k1, k2, p1, p2, k3.

    Raises:
        InputError: a value is not allowed.

    >>> Lens.of(640, 480, math.radians(60.0)).fx.__round__(3)
    554.256
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("width", "height"):
            check_number("camera", name, getattr(self, name), min=1, max=MOST_PIXELS, whole=True)
        if self.width * self.height > MOST_PIXELS:
            raise InputError(f"camera: {self.width} x {self.height} pixels exceed the limit of {MOST_PIXELS} pixels")
        for name in ("fx", "fy"):
            check_number("camera", name, getattr(self, name), exclusive_min=0.0)
        if len(self.distortion) != 5 or not all(math.isfinite(k) for k in (*self.distortion, self.cx, self.cy)):
            raise InputError(f"camera: distortion = {self.distortion} must be five finite numbers k1, k2, p1, p2, k3")

    @classmethod
    def of(cls, width: int, height: int, field_of_view: float, distortion: tuple[float, ...] = (0.0,) * 5) -> Lens:
        """Return a lens with the horizontal field of view [rad], square pixels and a centred principal point."""
        if not 0.0 < field_of_view < math.pi:
            raise InputError(f"camera: field_of_view = {field_of_view} rad must be above 0 and below pi")
        focal = 0.5 * width / math.tan(0.5 * field_of_view)
        return cls(width, height, focal, focal, 0.5 * (width - 1), 0.5 * (height - 1), distortion)  # type: ignore[arg-type]

    def distort(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Return the distorted coordinates of points ``x`` (right), ``y`` (down) at distance 1."""
        k1, k2, p1, p2, k3 = self.distortion
        r2 = x * x + y * y
        bend = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        return (
            x * bend + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * bend + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        )

    def undistort(self, x: Floats, y: Floats, rounds: int = 40) -> tuple[Floats, Floats]:
        """Return the inverse of :meth:`distort` at ``x``, ``y``, by iteration."""
        u, v = x.copy(), y.copy()
        for _ in range(rounds if any(self.distortion) else 0):
            bx, by = self.distort(u, v)
            u, v = u + (x - bx), v + (y - by)
        return u, v

    def rays(self) -> tuple[Floats, Floats]:
        """Return the viewing rays of the pixels: right and down ``[H, W]`` at distance 1."""
        column, row = np.meshgrid(np.arange(self.width, dtype=np.float64), np.arange(self.height, dtype=np.float64))
        return self.undistort(np.asarray((column - self.cx) / self.fx), np.asarray((row - self.cy) / self.fy))


def pixel_directions(lens: Lens) -> Floats:
    """Return the viewing directions ``[H, W, 3]`` of the pixels in the camera frame: x forward, y left, z up.

    >>> pixel_directions(Lens.of(3, 1, math.pi / 2))[0, 1].tolist()
    [1.0, -0.0, -0.0]
    """
    right, down = lens.rays()
    ahead = np.stack([np.ones_like(right), -right, -down], axis=-1)
    return np.asarray(ahead / np.sqrt((ahead**2).sum(axis=-1, keepdims=True)))


def distort_image(image: NDArray[Any], lens: Lens, fill: float = 0.0) -> NDArray[Any]:
    """Return a pinhole image ``[E, H, W, ...]`` with the distortion of the lens.

    Colours are interpolated (bilinear, rounded for integers). Depth and labels take the nearest pixel. Pixels outside
    the pinhole image are ``fill``.
    """
    right, down = lens.rays()
    column, row = right * lens.fx + lens.cx, down * lens.fy + lens.cy
    inside = (column >= -0.5) & (column <= lens.width - 0.5) & (row >= -0.5) & (row <= lens.height - 0.5)
    column, row = np.clip(column, 0.0, lens.width - 1.0), np.clip(row, 0.0, lens.height - 1.0)
    if image.ndim == 3:
        nearest = image[:, np.round(row).astype(int), np.round(column).astype(int)]
        return np.asarray(np.where(inside, nearest, np.asarray(fill, dtype=image.dtype)))
    c0, r0 = np.floor(column).astype(int), np.floor(row).astype(int)
    c1, r1 = np.minimum(c0 + 1, lens.width - 1), np.minimum(r0 + 1, lens.height - 1)
    a, b = (column - c0)[..., None], (row - r0)[..., None]
    upper = image[:, r0, c0] * (1.0 - a) + image[:, r0, c1] * a
    lower = image[:, r1, c0] * (1.0 - a) + image[:, r1, c1] * a
    mixed = np.where(inside[..., None], upper * (1.0 - b) + lower * b, fill)
    return np.asarray(np.round(mixed) if image.dtype.kind in "ui" else mixed).astype(image.dtype)


def stereo_depth(
    depth: Floats, focal: float, baseline: float, sd: float, step: float, rng: Randomness | None
) -> Floats:
    """Return the depth ``[E, ...]`` [m] of a stereo pair with noise and resolution of the disparity.

    The disparity is ``focal baseline / depth`` [pixels]. Its noise ``sd`` [pixels] causes a depth error of
    ``depth^2 sd / (focal baseline)``; its ``step`` [pixels] causes depth steps that grow in the same way
    (Grunnet-Jepsen et al., Subpixel linearity improvement for RealSense D400, revision 1.3). Infinite depths and
    disparities of at most 0 give inf.

    >>> stereo_depth(np.array([[2.0]]), 424.0, 0.05, 0.0, 1.0 / 32.0, None).round(4).tolist()
    [[2.0012]]
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        disparity = focal * baseline / depth
        if sd > 0.0:
            disparity = disparity + sd * normals(depth.shape, rng)
        if step > 0.0:
            disparity = np.round(disparity / step) * step
        found = focal * baseline / disparity
    return np.asarray(np.where(np.isfinite(depth) & (depth > 0.0) & (disparity > 0.0), found, np.inf))
