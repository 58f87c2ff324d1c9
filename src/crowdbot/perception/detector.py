"""The contract of detectors: ``detect(reading, walls) -> Detections``."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, Walls, kernel, storable
from crowdbot.sensors import Reading
from crowdbot.typing import Floats

BODY = 0.25
"""Radius of a person [m] in the test whether a place is visible."""
BEHIND = 0.6
"""A place is hidden if the beams end this far [m] before it."""


@storable
@dataclass(frozen=True)
class Coverage:
    """What a scanner could see: the distance up to which each beam would have met a person.

    Fields:
        origin: ``[2]`` place of the scanner in the world [m].
        first, step: bearing of the first beam in the world, and angle between beams [rad].
        reach: ``[R]`` [m]; 0 for beams that saw nothing at all.

    >>> view = Coverage(np.zeros(2), -np.pi / 2, np.pi / 180, np.full(181, 4.0))
    >>> view.visible([[3.0, 0.0], [6.0, 0.0], [-3.0, 0.0]]).tolist()
    [1.0, 0.0, 0.0]
    """

    origin: Floats
    first: float
    step: float
    reach: Floats

    def visible(self, position: ArrayLike) -> Floats:
        """Return the share of a person that was visible at each position, ``[N]``, 0 to 1.

        Args:
            position: ``[N, 2]`` in the world [m].
        """
        place = np.ascontiguousarray(position, dtype=np.float64).reshape(-1, 2)
        share = np.zeros(len(place))
        _visible(place, self.origin, float(self.first), float(self.step), self.reach, share)
        return share


@dataclass(frozen=True)
class Detections:
    """People found in one reading of one environment, in the world frame.

    Fields:
        time: time of the reading [s].
        position: ``[N, 2]`` [m].
        covariance: ``[N, 2, 2]`` of the positions [m^2].
        points: ``[N]`` number of beams that returned from each.
        coverage: what the sensor could see, or None if unknown.

    Raises:
        InputError: a shape is wrong or a number is not finite.

    >>> found = Detections.of(0.5, [[1.0, 2.0]], 0.1)
    >>> len(found), found.covariance[0].round(3).tolist()
    (1, [[0.01, 0.0], [0.0, 0.01]])
    """

    time: float
    position: Floats
    covariance: Floats
    points: NDArray[np.int64]
    coverage: Coverage | None = None

    def __post_init__(self) -> None:
        count = len(self.position)
        for name, shape in (("position", (count, 2)), ("covariance", (count, 2, 2)), ("points", (count,))):
            value = getattr(self, name)
            if value.shape != shape:
                raise InputError(f"detections: {name} has shape {list(value.shape)}, it must be {list(shape)}")
            if not np.isfinite(value).all():
                raise InputError(f"detections: {name} has a number that is not finite; leave such a detection out")
        if not math.isfinite(self.time):
            raise InputError(f"detections: time = {self.time} s must be finite")

    @classmethod
    def of(cls, time: float, position: ArrayLike, deviation: float, coverage: Coverage | None = None) -> Detections:
        """Return detections with one standard deviation [m] for all coordinates."""
        place = np.asarray(position, dtype=np.float64).reshape(-1, 2)
        spread = np.tile(deviation**2 * np.eye(2), (len(place), 1, 1))
        return cls(float(time), place, spread, np.ones(len(place), dtype=np.int64), coverage)

    def __len__(self) -> int:
        """Return the number of detections."""
        return len(self.position)


@kernel
def _visible(place: Floats, origin: Floats, first: float, step: float, reach: Floats, share: Floats) -> None:
    """Write the share of the beams towards each place that would have met a person there."""
    count, turn = len(reach), 2.0 * math.pi
    for n in range(len(place)):
        x, y = place[n, 0] - origin[0], place[n, 1] - origin[1]
        away = math.hypot(x, y)
        if away <= BODY:
            share[n] = 1.0
            continue
        half = math.asin(BODY / away)
        low = math.floor(((math.atan2(y, x) - half - first) % turn) / step)
        beams = max(1, math.ceil(2.0 * half / step))
        whole = max(1, round(turn / step))
        seen = 0
        for k in range(beams):
            beam = (low + k) % whole
            if beam < count and reach[beam] > away - BODY - BEHIND * 0.5 and reach[beam] > 0.0:
                seen += 1
        share[n] = seen / beams


@dataclass(frozen=True, kw_only=True)
class Detector(ABC):
    """Finds people in one reading: a frozen specification and a pure function.

    A detector only uses what a real sensor measures: never ``hit``, ``part`` or other ground truth of a reading. The
    pose of the reading is that of the sensor in the world, as from a perfect localization.

    Class attributes:
        reads: the readings that the detector understands.
    """

    reads: ClassVar[tuple[type[Reading], ...]] = ()

    @abstractmethod
    def detect(self, reading: Reading, walls: Walls | None = None) -> Detections:
        """Return the people in a reading.

        Args:
            reading: reading of one environment.
            walls: map of the stage, whose walls are no people; default: no map.

        Raises:
            InputError: the reading is of another sensor or of several environments.
        """

    def check(self, reading: Reading) -> None:
        """Raise :class:`InputError` unless the reading is of one environment and of a sensor that is understood."""
        name = type(self).__name__
        if not isinstance(reading, self.reads):
            known = " or ".join(kind.__name__ for kind in self.reads)
            raise InputError(f"{name}: the reading is a {type(reading).__name__}, it must be a {known}")
        if len(reading.pose.position) != 1:
            count = len(reading.pose.position)
            raise InputError(f"{name}: the reading has {count} environments, it must have 1; use environment(number)")
