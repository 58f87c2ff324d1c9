"""Procedural textures of floors, walls, props and clouds, the same on every machine."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import stream
from crowdbot.typing import Bytes, Floats

SIZE = 512
FLOOR_SIZE = 2.4
"""Width [m] of floor and that of wall that a texture covers."""
Color = tuple[float, float, float]


def periodic_noise(name: str, cells: int, octaves: int = 4, size: int = SIZE) -> Floats:
    """Return value noise ``[size, size]`` from 0 to 1 that repeats at its edges.

    Args:
        name: what it is for; each name has its own pattern.
        cells: grid cells of the first octave along a side; the next ones have twice as many, at half the strength.
        octaves: number of octaves.
        size: side [pixels].
    """
    rng, total, weight = stream(0, "surface", name), np.zeros((size, size)), 0.0
    for octave in range(octaves):
        rows = min(size, cells << octave)
        grid = rng.uniform(0.0, 1.0, (rows, rows))
        total += 0.5**octave * _interpolated(grid, size)
        weight += 0.5**octave
    return total / weight


def _interpolated(grid: Floats, size: int) -> Floats:
    """Return a periodic grid, smoothly interpolated to ``[size, size]``."""
    result = grid
    for axis in (0, 1):
        place = np.arange(size) * (grid.shape[axis] / size)
        first = np.floor(place).astype(np.int64)
        share = place - first
        share = share * share * (3.0 - 2.0 * share)
        a, b = (np.take(result, (first + k) % grid.shape[axis], axis=axis) for k in (0, 1))
        share = share[:, None] if axis == 0 else share
        result = a + share * (b - a)
    return result


def _painted(light: Floats, color: Color = (1.0, 1.0, 1.0), other: Floats | None = None) -> Bytes:
    base = light[..., None] * np.array(color) if other is None else light[..., None] * other
    return np.asarray(np.clip(np.floor(255.0 * base + 0.5), 0.0, 255.0), dtype=np.uint8)


def _joints(count: int, wide: int, shift: bool = False, rows: int = 0) -> tuple[Floats, NDArray[np.int64]]:
    """Return how deep a pixel lies in the joint between tiles (0 to 1), and the number of its tile."""
    rows = rows or count
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    row = y * rows // SIZE
    x = (x + (row % 2) * (SIZE // count // 2)) % SIZE if shift else x
    column = x * count // SIZE
    inside_x, inside_y = x - column * SIZE // count, y - row * SIZE // rows
    near = np.minimum(np.minimum(inside_x, SIZE // count - 1 - inside_x), np.minimum(
        inside_y, SIZE // rows - 1 - inside_y))  # fmt: skip
    return np.clip(1.0 - near / wide, 0.0, 1.0), row * count + column


@functools.cache
def floor_texture(kind: str) -> Bytes:
    """Return the texture of a floor; it covers :data:`FLOOR_SIZE` and is multiplied with the colour of the floor."""
    fine, coarse = periodic_noise("fine", 64, 3), periodic_noise("coarse", 4, 5)
    if kind == "checker":
        y, x = np.mgrid[0:SIZE, 0:SIZE]
        return _painted(np.where((x < SIZE // 2) == (y < SIZE // 2), 1.0, 0.93))
    if kind == "tiles":
        deep, tile = _joints(4, 3)
        tone = stream(0, "surface", "tiles").uniform(0.94, 1.0, 16)[tile]
        return _painted((tone * (0.95 + 0.05 * fine) + 0.03 * (coarse - 0.5)) * (1.0 - 0.35 * deep))
    if kind == "paving":
        deep, stone = _joints(8, 4, shift=True)
        tone = stream(0, "surface", "paving").uniform(0.62, 0.92, 64)[stone]
        return _painted(tone * (0.8 + 0.3 * fine) * (1.0 - 0.55 * deep), (1.0, 0.96, 0.9))
    if kind == "wood":
        deep, board = _joints(2, 2, shift=True, rows=16)
        tone = stream(0, "surface", "wood").uniform(0.72, 1.0, 64)[board]
        streak = _interpolated(stream(0, "surface", "fibre").uniform(0, 1, (256, 8)), SIZE)
        return _painted(tone * (0.78 + 0.22 * streak) * (1.0 - 0.5 * deep), (0.95, 0.70, 0.46))
    if kind == "grass":
        blade = periodic_noise("blade", 128, 2)
        green = np.stack([0.36 + 0.22 * coarse, 0.52 + 0.12 * coarse, 0.20 + 0.08 * coarse], axis=-1)
        return _painted(0.55 + 0.6 * blade, other=green)
    if kind == "carpet":
        return _painted(0.75 + 0.25 * periodic_noise("loops", 256, 1), (0.62, 0.68, 0.82))
    if kind == "asphalt":
        return _painted(0.42 + 0.22 * periodic_noise("gravel", 128, 2) + 0.10 * (coarse - 0.5), (1.0, 1.0, 1.02))
    if kind == "concrete":
        return _painted(0.78 + 0.14 * (coarse - 0.5) + 0.08 * (fine - 0.5))
    return _painted(np.ones((SIZE, SIZE)))


@functools.cache
def wall_texture(kind: str) -> Bytes:
    """Return the texture of a wall; it covers :data:`FLOOR_SIZE` and is multiplied with the colour of the wall."""
    fine, coarse = periodic_noise("wall", 64, 3), periodic_noise("stain", 4, 4)
    if kind == "plaster":
        return _painted(0.94 + 0.06 * (fine - 0.5) + 0.06 * (coarse - 0.5))
    if kind == "brick":
        deep, stone = _joints(10, 3, shift=True, rows=32)
        tone = stream(0, "surface", "brick").uniform(0.65, 1.0, 320)[stone]
        red = np.stack([tone * 0.78, tone * 0.40, tone * 0.31], axis=-1)
        mortar = np.array([0.74, 0.71, 0.66])
        return _painted(0.85 + 0.25 * (fine - 0.5), other=red + (deep > 0.3)[..., None] * (mortar - red))
    if kind == "concrete":
        deep, _ = _joints(2, 2)
        return _painted((0.74 + 0.14 * (coarse - 0.5) + 0.06 * (fine - 0.5)) * (1.0 - 0.3 * deep))
    if kind == "panels":
        deep, board = _joints(4, 3, rows=1)
        streak = _interpolated(stream(0, "surface", "panel").uniform(0, 1, (8, 256)), SIZE)
        tone = stream(0, "surface", "panels").uniform(0.85, 1.0, 4)[board]
        return _painted(tone * (0.80 + 0.20 * streak) * (1.0 - 0.6 * deep), (0.80, 0.58, 0.38))
    return _painted(np.ones((SIZE, SIZE)))


@functools.cache
def grain() -> Bytes:
    """Return the texture of props and doors."""
    streak = _interpolated(stream(0, "surface", "grain").uniform(0, 1, (96, 6)), SIZE)
    return _painted(0.86 + 0.14 * streak + 0.06 * (periodic_noise("pores", 128, 2) - 0.5))


@functools.cache
def clouds() -> Bytes:
    """Return the texture of clouds."""
    return _painted(periodic_noise("clouds", 5, 6))
