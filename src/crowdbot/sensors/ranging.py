"""Range limits, incidence limit, noise and resolution of all range sensors."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, Self

import numpy as np

from crowdbot.core import InputError, SpatialPose, check_number, kernel
from crowdbot.typing import Floats, Ints

from .noise import Randomness, add_noise
from .ray_shapes import NOTHING
from .sensor import Sensor

MOST_BEAMS = 1_000_000
"""Largest number of beams of a sensor."""


class Ranging(Sensor):
    """A sensor with the fields ``range_min``, ``range_max``, ``max_incidence``, ``resolution`` and ``skins``.

    A beam ends at the first surface. There is no return beyond ``range_max`` or ``max_incidence``. Noise is added to
    the true distances, then the limits apply: below ``range_min`` (before or after noise) the range is ``-inf``, above
    ``range_max`` it is ``+inf`` (ROS REP-117). The result is rounded to ``resolution``, inwards at the limits. Both
    limits are inclusive.
    """

    range_min: float
    range_max: float
    max_incidence: float
    resolution: float
    skins: bool

    @property
    def sees_skins(self) -> bool:
        return self.skins

    def with_skins(self) -> Self:
        anything: Any = self
        copy: Self = dataclasses.replace(anything, skins=True)
        return copy

    def check_ranges(self) -> None:
        """Raise :class:`InputError` if the limits are not finite, not in order, or too narrow for the resolution."""
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
    def limits(self) -> tuple[float, float, float, float]:
        """Smallest cosine of incidence, smallest and largest range [m], resolution [m]."""
        return self.min_cos_incidence, float(self.range_min), float(self.range_max), float(self.resolution)

    @property
    def min_cos_incidence(self) -> float:
        """Smallest cosine of incidence with a return; the limit is inclusive despite rounding."""
        return math.cos(self.max_incidence) - 1e-12 if self.max_incidence < math.pi / 2 else -2.0


@kernel
def settle_ranges(
    distance: Floats, measured: Floats, cos_incidence: Floats, hit: Ints, part: Ints,
    limits: tuple[float, float, float, float], ranges: Floats,
) -> None:  # fmt: skip
    """Write the ranges of beams ``[R]``; clear ``hit`` and ``part`` without a return.

    ``limits`` are the smallest cosine of incidence, the smallest and largest range [m] and the resolution [m];
    ``ranges`` may be one of the other arrays.
    """
    least, low, high, step = limits
    first, last = 0.0, 0.0
    if step > 0.0:
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    for k in range(len(distance)):
        true, value = distance[k], measured[k]
        back = true <= high and cos_incidence[k] >= least and value < np.inf
        if back and (true < low or value < low):
            ranges[k] = -np.inf
        elif back and value <= high:
            ranges[k] = value if step == 0.0 else min(max(np.rint(value / step), first), last) * step
        else:
            ranges[k] = np.inf
            hit[k] = NOTHING
            part[k] = -1


@kernel
def _settle(
    distance: Floats, measured: Floats, cos_incidence: Floats, hit: Ints, part: Ints,
    limits: tuple[float, float, float, float],
) -> None:  # fmt: skip
    for e in range(len(distance)):
        settle_ranges(distance[e], measured[e], cos_incidence[e], hit[e], part[e], limits, distance[e])


@kernel
def _hide_far(distance: Floats, cos_incidence: Floats, least: float, high: float, shown: Floats) -> None:
    """Write the distances with a return; the others are infinite."""
    for e in range(distance.shape[0]):
        for k in range(distance.shape[1]):
            back = (distance[e, k] <= high) & (cos_incidence[e, k] >= least)
            shown[e, k] = distance[e, k] if back else np.inf


def apply_limits(
    sensor: Ranging, distance: Floats, cos_incidence: Floats, hit: Ints, part: Ints, rng: Randomness | None
) -> Floats:
    """Return the ranges ``[E, R]`` [m] from true distances, which they replace; clear ``hit`` and ``part`` without a
    return.
    """
    measured = distance
    if sensor.noises:
        measured = np.empty(distance.shape)
        _hide_far(distance, cos_incidence, sensor.min_cos_incidence, float(sensor.range_max), measured)
        add_noise(measured, sensor.noises, rng)
    _settle(distance, measured, cos_incidence, hit, part, sensor.limits)
    return distance


def incidence_of(cos_incidence: Floats, hit: Ints) -> Floats:
    """Return angles [rad] between beams and surface normals from their cosines, NaN without a return."""
    return np.asarray(np.where(hit != NOTHING, np.arccos(np.clip(cos_incidence, -1.0, 1.0)), np.nan))


def end_points(pose: SpatialPose, directions: Floats, ranges: Floats, *, in_world: bool) -> Floats:
    """Return the end points ``[E, ..., 3]`` [m] of beams ``[..., 3]`` in the sensor frame; NaN without a range."""
    away = np.where(np.isfinite(ranges), ranges, np.nan)
    ends = away[..., None] * directions
    if not in_world:
        return np.asarray(ends)
    batch = (len(ends),) + (1,) * (ends.ndim - 2)
    turned = np.einsum("eij,e...j->e...i", pose.matrix, ends)
    return np.asarray(pose.position.reshape(*batch, 3) + turned)
