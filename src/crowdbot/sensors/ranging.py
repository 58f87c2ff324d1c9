"""What all range sensors share: their limits, and how a true distance becomes a reading."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, SpatialPose

from .noise import Randomness, disturbed
from .sensor import Sensor
from .shapes import NOTHING

__all__ = ["Ranging", "ended", "rounded", "settled"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Ranging(Sensor):
    """A sensor with the fields ``range_min``, ``range_max``, ``max_incidence``, ``resolution`` and ``skins``.

    A beam ends at the first surface. It returns nothing when that is beyond ``range_max`` or met at more than
    ``max_incidence``. Noise is added to the true distances that return, then the limits decide: below ``range_min``
    (before or after noise) it reads ``-inf``, above ``range_max`` ``+inf`` (ROS REP-117); then it is rounded to
    ``resolution``, inwards at the limits. Both limits themselves are measured.
    """

    range_min: float
    range_max: float
    max_incidence: float
    resolution: float
    skins: bool

    def check_ranges(self) -> None:
        """Raise :class:`InputError` when limits are not finite, not in order, or too narrow for the resolution."""
        name = type(self).__name__
        if not 0.0 <= self.range_min < self.range_max < math.inf:
            raise InputError(
                f"{name}: range_min = {self.range_min} m and range_max = {self.range_max} m must be finite,"
                " not negative, and range_min the smaller one"
            )
        if not 0.0 < self.max_incidence <= math.pi / 2 + 1e-9:
            raise InputError(f"{name}: max_incidence = {self.max_incidence} rad must be above 0 and at most pi / 2")
        if not 0.0 <= self.resolution <= self.range_max - self.range_min:
            raise InputError(f"{name}: resolution = {self.resolution} m must be at least 0 and fit between the ranges")

    def check_count(self, name: str) -> None:
        """Raise :class:`InputError` unless the field ``name`` is a whole number of at least 1."""
        value = getattr(self, name)
        if value != int(value) or value < 1:
            raise InputError(f"{type(self).__name__}: {name} = {value} must be a whole number of at least 1")

    def returns(self, distance: Floats, facing: Floats, reach: Floats | float) -> NDArray[np.bool_]:
        """Return which beams come back: within ``reach`` [m] and not too slanted."""
        back = distance <= reach
        if self.max_incidence < math.pi / 2:
            back = back & (facing >= math.cos(self.max_incidence) - 1e-12)  # the limit itself, whatever the rounding
        return np.asarray(back)


def settled(
    sensor: Ranging, distance: Floats, back: NDArray[np.bool_], hit: Ints, rng: Randomness | None
) -> tuple[Floats, Ints]:
    """Return the readings ``[E, ...]`` [m] and what was hit, from true distances and which of them return."""
    measured = disturbed(np.where(back, distance, np.inf), sensor.noises, rng)
    kept = back & (measured < np.inf)  # a dropped return is nothing, even from too near
    near = kept & ((distance < sensor.range_min) | (measured < sensor.range_min))
    far = ~back | (measured > sensor.range_max)
    values = np.where(near, -np.inf, np.where(far, np.inf, rounded(measured, sensor)))
    return np.asarray(values), np.asarray(np.where(far & ~near, NOTHING, hit))


def rounded(measured: Floats, sensor: Ranging) -> Floats:
    """Return distances as whole multiples of the resolution that lie between the limits."""
    if sensor.resolution == 0.0:
        return measured
    lowest = math.ceil(sensor.range_min / sensor.resolution - 1e-9)
    highest = math.floor(sensor.range_max / sensor.resolution + 1e-9)
    steps = np.clip(np.round(measured / sensor.resolution), lowest, highest)
    return np.asarray(steps * sensor.resolution)


def ended(pose: SpatialPose, directions: Floats, ranges: Floats, *, in_world: bool) -> Floats:
    """Return where beams ``[..., 3]`` of the sensor's frame ended, ``[E, ..., 3]`` [m], NaN without a finite range."""
    away = np.where(np.isfinite(ranges), ranges, np.nan)
    ends = away[..., None] * directions
    if not in_world:
        return np.asarray(ends)
    batch = (len(ends),) + (1,) * (ends.ndim - 2)
    turned = np.einsum("eij,e...j->e...i", pose.matrix, ends)
    return np.asarray(pose.position.reshape(*batch, 3) + turned)
