"""The contract of detectors: ``detect(reading, walls) -> Detections``."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from crowdbot.core import InputError, Walls
from crowdbot.sensors import Reading

from .detections import Detections


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
