"""BlindSensor: a sensor without readings."""

from __future__ import annotations

from dataclasses import dataclass

from .fault import SensorFault


@dataclass(frozen=True)
class BlindSensor(SensorFault):
    """A sensor that has no reading: the navigator gets none, and does not see the people in the earlier one.

    >>> BlindSensor(begin=2.0, end=4.0).end
    4.0
    """
