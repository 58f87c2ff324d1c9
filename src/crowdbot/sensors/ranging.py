"""What all range sensors share: their limits, and how a true distance becomes a reading."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, SpatialPose, check_number, kernel

from .noise import Randomness, disturbed
from .sensor import Sensor
from .shapes import NOTHING

__all__ = ["Ranging", "ended", "incidence_of", "settled"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
MOST_BEAMS = 1_000_000
"""Of a sensor: more would not fit into the memory of a usual machine."""


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

    @property
    def sees_skins(self) -> bool:
        """Whether the sensor sees people by their triangle skins."""
        return self.skins

    def with_skins(self) -> Self:
        """Return a copy that sees people by their triangle skins."""
        anything: Any = self
        copy: Self = dataclasses.replace(anything, skins=True)
        return copy

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
        """Raise :class:`InputError` unless the field ``name`` is a whole number from 1 to ``MOST_BEAMS``."""
        owner = type(self).__name__
        check_number(owner, name, getattr(self, name), min=1, max=MOST_BEAMS, whole=True)

    @property
    def least_facing(self) -> float:
        """Smallest cosine of the incidence that returns; the limit itself does, whatever the rounding."""
        return math.cos(self.max_incidence) - 1e-12 if self.max_incidence < math.pi / 2 else -2.0


@kernel
def _settle(
    distance: Floats, measured: Floats, facing: Floats, hit: Ints, part: Ints, least: float, low: float, high: float,
    step: float, ranges: Floats,
) -> None:  # fmt: skip
    """Write the readings, and in ``hit`` and ``part`` what they are of."""
    first, last = 0.0, 0.0
    if step > 0.0:
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    for e in range(distance.shape[0]):
        for k in range(distance.shape[1]):
            true, value = distance[e, k], measured[e, k]
            back = true <= high and facing[e, k] >= least and value < np.inf
            if back and (true < low or value < low):
                ranges[e, k] = -np.inf
            elif back and value <= high:
                ranges[e, k] = value if step == 0.0 else min(max(np.rint(value / step), first), last) * step
            else:
                ranges[e, k] = np.inf
                hit[e, k] = NOTHING
                part[e, k] = -1


def settled(sensor: Ranging, distance: Floats, facing: Floats, hit: Ints, part: Ints, rng: Randomness | None) -> Floats:
    """Return the readings ``[E, R]`` [m] from true distances; ``hit`` and ``part`` lose what does not return."""
    measured = distance
    if sensor.noises:
        back = (distance <= sensor.range_max) & (facing >= sensor.least_facing)
        measured = disturbed(np.where(back, distance, np.inf), sensor.noises, rng)
    ranges = np.empty(distance.shape)
    limits = (sensor.least_facing, float(sensor.range_min), float(sensor.range_max), float(sensor.resolution))
    _settle(distance, measured, facing, hit, part, *limits, ranges)
    return ranges


def incidence_of(facing: Floats, hit: Ints) -> Floats:
    """Return angles [rad] between beams and surface normals from their cosines, NaN where nothing returned."""
    return np.asarray(np.where(hit != NOTHING, np.arccos(np.clip(facing, -1.0, 1.0)), np.nan))


def ended(pose: SpatialPose, directions: Floats, ranges: Floats, *, in_world: bool) -> Floats:
    """Return where beams ``[..., 3]`` of the sensor's frame ended, ``[E, ..., 3]`` [m], NaN without a finite range."""
    away = np.where(np.isfinite(ranges), ranges, np.nan)
    ends = away[..., None] * directions
    if not in_world:
        return np.asarray(ends)
    batch = (len(ends),) + (1,) * (ends.ndim - 2)
    turned = np.einsum("eij,e...j->e...i", pose.matrix, ends)
    return np.asarray(pose.position.reshape(*batch, 3) + turned)
