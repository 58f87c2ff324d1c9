"""Ground: height, normal and slope of the surface on which people and robots stand."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, kernel
from crowdbot.typing import Floats

from .part import GroundPart

PEOPLE_STEP, PEOPLE_SLOPE = 0.25, 0.7
"""Largest step [m] and slope that people walk over (assumed; steps of stairs are 0.14 to 0.21 m high, EN 81-70 and
DIN 18065)."""
PIECE = 0.05
"""Largest length [m] of the pieces into which edges are cut."""
BESIDE = 1e-5
"""Distance [m] from an edge at which both heights are measured."""
SAME = 1e-6
"""Tolerance of heights [m] and slopes: a step of 2 cm is not above a limit of 2 cm."""


def barriers(
    parts: Sequence[GroundPart], height: Callable[[Floats], Floats], max_step: float, max_slope: float
) -> tuple[Floats, ...]:
    """Return lines ``[2, 2]`` along edges, and outlines ``[4, 2]`` of slopes, that cannot be passed [m].

    Args:
        parts: parts of the ground.
        height: returns the heights ``[N]`` [m] of points ``[N, 2]`` [m].
        max_step: largest step [m] that can be passed, up and down.
        max_slope: largest slope, as rise over length.

    >>> from crowdbot.world import Ground
    >>> kerb = Ground((GroundPart(0.0, 0.0, length=2.0, width=2.0, rear=0.12, front=0.12),))
    >>> len(barriers(kerb.parts, kerb.height, 0.25, 0.7)), len(barriers(kerb.parts, kerb.height, 0.02, 0.1))
    (0, 4)
    """
    steep = [part for part in parts if abs(part.slope) > max_slope + SAME]
    # the bevel of a threshold is no hill: a wheel that passes the step passes it
    found = [part.corners for part in steep if abs(part.front - part.rear) > max_step + SAME]
    seen: set[tuple[float, ...]] = set()
    for part in parts:
        corners = part.corners
        for k in range(4):
            for line in _blocked(height, corners[k], corners[(k + 1) % 4], max_step):
                one, two = sorted(np.round(line, 6).tolist())
                key = (*one, *two)
                if key not in seen:
                    seen.add(key)
                    found.append(line)
    return tuple(found)


def _blocked(height: Callable[[Floats], Floats], start: Floats, end: Floats, max_step: float) -> list[Floats]:
    """Return the pieces of an edge on which the height changes by more than a step."""
    along = end - start
    length = float(np.sqrt(along @ along))
    count = max(2, int(np.ceil(length / PIECE)))
    side = np.array([along[1], -along[0]]) / length * BESIDE
    middle = start + (np.arange(count)[:, None] + 0.5) / count * along
    jump = np.abs(height(middle + side) - height(middle - side))
    high = np.concatenate([[False], jump > max_step + SAME, [False]])
    begin, stop = np.flatnonzero(~high[:-1] & high[1:]), np.flatnonzero(high[:-1] & ~high[1:])
    return [np.array([start + a / count * along, start + b / count * along]) for a, b in zip(begin, stop, strict=True)]


X, Y, COS, SIN, LENGTH, WIDTH, REAR, FRONT, STAIRS = range(9)
"""Columns of the table of parts: centre, axis, half sides, heights at both ends, whether it is a step of stairs."""
STEEP = 1e9
"""Steepness of the support that makes it the highest point of a disc."""


@kernel
def _part_at(parts: Floats, x: float, y: float) -> int:
    """Return the number of the part with the highest top at a point, -1 for the floor."""
    found, top = -1, 0.0
    for k in range(len(parts)):
        one = parts[k]
        dx, dy = x - one[X], y - one[Y]
        along, across = one[COS] * dx + one[SIN] * dy, one[COS] * dy - one[SIN] * dx
        if abs(along) <= one[LENGTH] and abs(across) <= one[WIDTH]:
            share = 0.5 * (along / one[LENGTH] + 1.0)
            height = one[REAR] + share * (one[FRONT] - one[REAR])
            if height > top:
                found, top = k, height
    return found


@kernel
def _height_at(parts: Floats, x: float, y: float, reach: float, steep: float) -> float:
    """Return the height of the ground within ``reach`` of a point, falling by ``steep`` per metre beyond."""
    top = 0.0
    for k in range(len(parts)):
        one = parts[k]
        dx, dy = x - one[X], y - one[Y]
        along, across = one[COS] * dx + one[SIN] * dy, one[COS] * dy - one[SIN] * dx
        far_along, far_across = max(abs(along) - one[LENGTH], 0.0), max(abs(across) - one[WIDTH], 0.0)
        away = math.sqrt(far_along * far_along + far_across * far_across)
        slope = 0.5 * (one[FRONT] - one[REAR]) / one[LENGTH]
        spare = max(reach - away, 0.0)
        inside = min(max(along, -one[LENGTH]), one[LENGTH])
        inside = min(max(inside + (spare if slope > 0.0 else -spare), -one[LENGTH]), one[LENGTH])
        height = one[REAR] + slope * (inside + one[LENGTH]) - steep * max(away - reach, 0.0)
        top = max(top, height)
    return top


@kernel
def _heights(parts: Floats, points: Floats, reach: float, steep: float, out: Floats) -> None:
    for n in range(len(points)):
        if reach == 0.0 and steep == STEEP:
            out[n] = 0.0
            k = _part_at(parts, points[n, 0], points[n, 1])
            if k >= 0:
                one = parts[k]
                along = one[COS] * (points[n, 0] - one[X]) + one[SIN] * (points[n, 1] - one[Y])
                out[n] = one[REAR] + 0.5 * (along / one[LENGTH] + 1.0) * (one[FRONT] - one[REAR])
        else:
            out[n] = _height_at(parts, points[n, 0], points[n, 1], reach, steep)


@kernel
def _gradients(parts: Floats, points: Floats, out: Floats, stairs: NDArray[np.bool_]) -> None:
    for n in range(len(points)):
        out[n, 0], out[n, 1], stairs[n] = 0.0, 0.0, False
        k = _part_at(parts, points[n, 0], points[n, 1])
        if k >= 0:
            one = parts[k]
            slope = 0.5 * (one[FRONT] - one[REAR]) / one[LENGTH]
            out[n, 0], out[n, 1], stairs[n] = slope * one[COS], slope * one[SIN], one[STAIRS] > 0.0


@dataclass(frozen=True)
class Ground:
    """Surface of a stage: a floor at height 0 with parts on it. Where parts overlap, the highest counts.

    Fields:
        parts: the parts.

    >>> ground = Ground((GroundPart(2.0, 0.0, length=4.0, width=2.0, rear=0.0, front=0.4),))
    >>> ground.height([[-1.0, 0.0], [1.0, 0.5], [4.0, 0.0]]).round(3).tolist()
    [0.0, 0.1, 0.4]
    >>> ground.normal([[1.0, 0.5]]).round(3).tolist()
    [[-0.1, 0.0, 0.995]]
    """

    parts: tuple[GroundPart, ...]

    @functools.cached_property
    def table(self) -> Floats:
        """Table ``[P, 9]`` of the parts for kernels."""
        rows = [
            (p.x, p.y, math.cos(p.heading), math.sin(p.heading), 0.5 * p.length, 0.5 * p.width, p.rear, p.front)
            for p in self.parts
        ]
        stairs = [[part.stairs] for part in self.parts]
        return np.concatenate(
            [np.array(rows).reshape(-1, 8), np.array(stairs, dtype=np.float64).reshape(-1, 1)], axis=1
        )

    def height(self, points: ArrayLike) -> Floats:
        """Return the height ``[...]`` [m] of the ground at points ``[..., 2]`` [m]; an edge belongs to the upper part.

        Raises:
            InputError: the last axis has not two numbers.
        """
        return self._measured(points, 0.0, STEEP)

    def support(self, points: ArrayLike, reach: float, steep: float = STEEP) -> Floats:
        """Return the largest height ``[...]`` [m] within ``reach`` [m] of points ``[..., 2]`` [m].

        Farther parts count with ``steep`` times the distance beyond ``reach`` subtracted. So the height of a moving
        point is continuous, and it rises ahead of a step.

        Raises:
            InputError: the last axis has not two numbers.

        >>> ground = Ground((GroundPart(0.0, 0.0, length=2.0, width=2.0, rear=0.2, front=0.2),))
        >>> ground.support([[1.05, 0.0], [1.1, 0.0], [1.5, 0.0]], 0.05, steep=2.0).round(3).tolist()
        [0.2, 0.1, 0.0]
        """
        return self._measured(points, reach, steep)

    def gradient(self, points: ArrayLike) -> tuple[Floats, NDArray[np.bool_]]:
        """Return the gradient ``[..., 2]`` of the height, and ``[...]`` whether points ``[..., 2]`` are on stairs."""
        places = _places(points)
        flat = np.ascontiguousarray(places.reshape(-1, 2))
        out, stairs = np.empty_like(flat), np.empty(len(flat), dtype=np.bool_)
        _gradients(self.table, flat, out, stairs)
        return out.reshape(places.shape), stairs.reshape(places.shape[:-1])

    def normal(self, points: ArrayLike) -> Floats:
        """Return the unit normal ``[..., 3]`` of the surface at points ``[..., 2]`` [m]."""
        slope, _ = self.gradient(points)
        found = np.concatenate([0.0 - slope, np.ones((*slope.shape[:-1], 1))], axis=-1)
        return np.asarray(found / np.sqrt(np.sum(found * found, axis=-1, keepdims=True)))

    def barriers(self, max_step: float, max_slope: float) -> tuple[Floats, ...]:
        """Return lines and outlines ``[N, 2]`` [m] of what cannot be passed; see :func:`barriers`.

        Args:
            max_step: largest step [m] that can be passed, up and down.
            max_slope: largest slope, as rise over length.
        """
        return _barriers(self, max_step, max_slope)

    def people_barriers(self) -> tuple[Floats, ...]:
        """Return what people cannot pass."""
        return self.barriers(PEOPLE_STEP, PEOPLE_SLOPE)

    def is_level(self, x: float, y: float, radius: float) -> bool:
        """Return whether the ground has one height within a radius [m] of a point."""
        angle = np.linspace(0.0, 2.0 * math.pi, 16, endpoint=False)
        ring = np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)
        heights = self.height(np.concatenate([[[x, y]], ring, 0.5 * ring + (0.5 * x, 0.5 * y)]))
        return bool(np.ptp(heights) == 0.0)

    def _measured(self, points: ArrayLike, reach: float, steep: float) -> Floats:
        places = _places(points)
        out = np.empty(places.shape[:-1])
        flat = np.ascontiguousarray(places.reshape(-1, 2))
        _heights(self.table, flat, float(reach), float(steep), out.reshape(-1))
        return out


def _places(points: ArrayLike) -> Floats:
    places = np.asarray(points, dtype=np.float64)
    if places.ndim == 0 or places.shape[-1] != 2:
        raise InputError(f"Ground: points have shape {list(places.shape)}, expected [..., 2]")
    return places


@functools.lru_cache(maxsize=64)
def _barriers(ground: Ground, max_step: float, max_slope: float) -> tuple[Floats, ...]:
    return barriers(ground.parts, ground.height, max_step, max_slope)
