"""Rasterizer: images of triangles, drawn by the processor with the same bytes on every machine."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Bytes, Floats, Ints

from .camera import CameraView
from .raster_kernels import BAND, bin_triangles, cover, project, start_depth
from .shade_kernels import shade, soften
from .shadow_kernels import BLOCK, cover_shadow, project_shadow, spread_limits

SAMPLES = {
    1: ((0.5, 0.5),),
    2: ((0.25, 0.25), (0.75, 0.75)),
    4: ((0.375, 0.125), (0.875, 0.375), (0.125, 0.625), (0.625, 0.875)),
    8: ((0.5625, 0.3125), (0.4375, 0.6875), (0.8125, 0.5625), (0.3125, 0.1875),
        (0.1875, 0.8125), (0.0625, 0.4375), (0.6875, 0.9375), (0.9375, 0.0625)),
}  # fmt: skip
"""Places of the samples in a pixel, by their number."""
SHADOW_SIZES = (1024, 2048)
"""Sides of the shadow map, of images up to :data:`SMALL` pixels and of larger ones."""
SMALL = 512 * 1024
FARTHEST_SHADOW = 14.0
"""Largest distance [m] from the camera that the shadow map covers, for a camera near the floor."""
SOFT = 4
"""Samples per pixel from which on their filter reaches into the pixels around, as that of a lens does."""
TALLEST = 12.0
"""Height [m] above the floor from which things cast shadows."""


class DrawList(NamedTuple):
    """Triangles to draw.

    Fields:
        vertex, normal: ``[V, 3]`` [m] and unit vectors.
        faces: ``[T, 3]`` indices of vertices, counter-clockwise seen from outside.
        uv: texture coordinates of the corners ``[T, 3, 2]``.
        material: row of ``paint`` of each triangle ``[T]``.
        closed: whether a triangle belongs to a closed surface, whose inside is never seen ``[T]``.
        code: label of each triangle in a segmentation image ``[T]``.
        paint: ``[M, 6]``: red, green, blue (linear, multiplied with the texture), texture or -1, gloss, softness.
    """

    vertex: Floats
    normal: Floats
    faces: Ints
    uv: Floats
    material: Ints
    closed: NDArray[np.bool_]
    code: Ints
    paint: Floats


class TexturePool(NamedTuple):
    """Textures with half-sized copies: ``texels`` one after another, ``table [N, 4]`` start, width, height, copies."""

    texels: Bytes
    table: Ints


@dataclass(frozen=True, eq=False)
class Illumination:
    """Light of a scene, in linear colours.

    Fields:
        sun: ``[4, 3]`` direction of the light, its colour, light from above and from below.
        sky: ``[6, 3]`` colour at the horizon and above, of the glow; share, lower limit and slope of clouds; direction
            of the light; colour of clouds.
        lamps: ``[L, 4]`` position [m] and brightness.
        softness: radius [m] of the edge of shadows.
        haze: distance [m] at which half of the colour is that of the horizon, 0 for none.
    """

    sun: Floats
    sky: Floats
    lamps: Floats
    softness: float = 0.0
    haze: float = 0.0


def pack_textures(images: list[Bytes]) -> TexturePool:
    """Return textures ``[H, W, 3]`` whose sides are powers of two, each with half-sized copies down to one pixel."""
    parts, rows, first = [], [], 0
    for image in images:
        begin, level, count = first, image, 0
        while True:
            parts.append(level.reshape(-1))
            first += level.size
            count += 1
            if min(level.shape[:2]) == 1:
                break
            wide = level.astype(np.uint16)
            total = wide[::2, ::2] + wide[1::2, ::2] + wide[::2, 1::2] + wide[1::2, 1::2]
            level = ((total + 2) // 4).astype(np.uint8)
        rows.append((begin, image.shape[1], image.shape[0], count))
    return TexturePool(np.concatenate(parts), np.array(rows, dtype=np.int64))


class Rasterizer:
    """Draws triangles; it needs no graphics library. Buffers are kept between images of one size."""

    def __init__(self) -> None:
        self._depth = np.empty((0, 0, 1), dtype=np.float32)
        self._who = np.empty((0, 0, 1), dtype=np.int32)
        self._shadow = np.empty((1, 1), dtype=np.float32)
        self._block = self._limits = np.empty((1, 1, 2), dtype=np.float32)

    def image(
        self, drawn: DrawList, view: CameraView, light: Illumination, textures: TexturePool, ground: Floats,
        samples: int = 4, shadows: bool = True,
    ) -> Bytes:  # fmt: skip
        """Return the colours ``[H, W, 3]``.

        Args:
            drawn: triangles.
            view: camera.
            light: light and sky.
            textures: textures; the first is that of clouds, the second that of the floor.
            ground: red, green, blue (linear) and copies per metre of the texture of the floor ``[4]``.
            samples: samples per pixel, a key of :data:`SAMPLES`.
            shadows: whether the sun casts shadows.
        """
        camera, ray = _camera(view)
        edges, places = self._cover(drawn, view, camera, ray, samples)
        axes = np.zeros((5, 3))
        shadow, wide = np.empty((1, 1), dtype=np.float32), 1
        if shadows:
            size = SHADOW_SIZES[view.width * view.height > SMALL]
            axes, texel = _shadow_axes(view, ray, light.sun[0], size)
            shadow = self._shadows(drawn, axes, size)
            wide = max(1, min(BLOCK, int(light.softness / texel + 0.5)))
        out = np.empty((view.height, view.width, 3), dtype=np.uint8)
        shade(
            self._who, places, camera, ray, len(drawn.faces), edges, drawn.faces, drawn.vertex, drawn.normal, drawn.uv,
            drawn.material, drawn.paint, ground, light.sky, light.sun, light.lamps, textures.texels, textures.table,
            shadow, self._limits, axes, wide, light.haze, out,
        )  # fmt: skip
        return soften(out) if samples >= SOFT else out

    def labels(self, drawn: DrawList, view: CameraView, floor: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """Return depth ``[H, W]`` [m] along the axis, infinite without a surface, and labels (``floor``, -1: none)."""
        camera, ray = _camera(view)
        self._cover(drawn, view, camera, ray, 1)
        who, inverse = self._who[..., 0], self._depth[..., 0]
        codes = np.concatenate([drawn.code, [floor, -1]]).astype(np.int32)
        depth = np.where(who >= 0, 1.0 / inverse, np.inf).astype(np.float32)
        return depth, codes[who]

    def _cover(
        self, drawn: DrawList, view: CameraView, camera: Floats, ray: Floats, samples: int
    ) -> tuple[Floats, Floats]:
        """Fill the buffers, and return the edge functions and the places of the samples."""
        shape = (view.height, view.width, samples)
        if self._depth.shape != shape:
            self._depth, self._who = np.empty(shape, dtype=np.float32), np.empty(shape, dtype=np.int32)
        places = np.array(SAMPLES[samples])
        count = len(drawn.faces)
        edges, box = np.empty((count, 3, 3)), np.empty((count, 4), dtype=np.int64)
        project(drawn.vertex, drawn.faces, drawn.closed, camera, view.near, view.width, view.height, edges, box)
        plane = -ray[1:, 2] / ray[0, 2] if ray[0, 2] > 0.0 else np.zeros(3)
        start_depth(plane, view.far, places, count, self._depth, self._who)
        first, found = bin_triangles(box, (view.height + BAND - 1) // BAND)
        cover(edges, box, first, found, view.near, places, self._depth, self._who)
        return edges, places

    def _shadows(self, drawn: DrawList, axes: Floats, size: int) -> NDArray[np.float32]:
        if len(self._shadow) != size:
            self._shadow = np.empty((size, size), dtype=np.float32)
            self._block, self._limits = (np.empty((size // BLOCK, size // BLOCK, 2), dtype=np.float32) for _ in "ab")
        count = len(drawn.faces)
        plane, box = np.empty((count, 4, 3)), np.empty((count, 4), dtype=np.int64)
        project_shadow(drawn.vertex, drawn.faces, drawn.closed, axes, size, plane, box)
        first, found = bin_triangles(box, size // BAND)
        cover_shadow(plane, box, first, found, self._shadow, self._block)
        spread_limits(self._block, self._limits)
        return self._shadow


def _camera(view: CameraView) -> tuple[Floats, Floats]:
    """Return position and axes of a camera that give column, row and depth, and those that give rays of pixels."""
    ahead, up = view.forward, view.up
    right = _cross(ahead, up)
    kx, ky = view.width / (view.right - view.left), view.height / (view.top - view.bottom)
    camera = np.array([view.place, kx * right - kx * view.left * ahead, ky * view.top * ahead - ky * up, ahead])
    return camera, np.array([view.place, right / kx, -up / ky, ahead + view.left * right + view.top * up])


def _cross(a: Floats, b: Floats) -> Floats:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _shadow_axes(view: CameraView, ray: Floats, sun: Floats, size: int) -> tuple[Floats, float]:
    """Return the axes ``[5, 3]`` of the shadow map of what a camera sees, and the width of its pixels [m].

    The map moves in whole pixels, so that edges of shadows do not crawl when the camera moves.
    """
    points = [view.place]
    for x in (0.0, 0.5 * view.width, float(view.width)):
        for y in (0.0, 0.5 * view.height, float(view.height)):
            way = ray[1] * x + ray[2] * y + ray[3]
            length = math.sqrt(float(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]))
            far = max(FARTHEST_SHADOW, 2.5 * abs(float(view.place[2]))) / length
            if way[2] < -1e-9:
                far = min(far, float(view.place[2] / -way[2])) if view.place[2] > 0.0 else far
            points.append(view.place + far * way)
    side = _cross(sun, np.array([0.0, 1.0, 0.0]) if abs(sun[1]) < 0.9 else np.array([1.0, 0.0, 0.0]))
    side = side / math.sqrt(float(np.sum(side * side)))
    other = _cross(sun, side)
    flat = np.array([[sum(p * side), sum(p * other)] for p in (np.array([q[0], q[1], 0.0]) for q in points)])
    low, high = flat.min(axis=0) - 1.0, flat.max(axis=0) + 1.0
    texel = _rounded(float(np.max(high - low)) / (size - 32.0))
    middle = np.floor(0.5 * (low + high) / texel) * texel
    origin = side * middle[0] + other * middle[1] - sun * TALLEST
    scale = 1.0 / texel
    half = 0.5 * size * texel
    start = origin - half * side - half * other
    return np.array([start, side * scale, other * scale, sun, [1.5 * texel + 0.008, 0.0, 0.0]]), texel


def _rounded(value: float) -> float:
    """Return the next number of the form 2^k / 4096 * (1, 1.25, 1.5 or 1.75), at least ``value``."""
    found = 1.0 / 4096.0
    while 1.75 * found < value:
        found *= 2.0
    return found * next(step for step in (1.0, 1.25, 1.5, 1.75) if step * found >= value)
