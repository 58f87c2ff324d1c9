"""FrozenSensor: a sensor that delivers nothing new."""

from __future__ import annotations

from dataclasses import dataclass

from .fault import SensorFault


@dataclass(frozen=True)
class FrozenSensor(SensorFault):
    """A sensor that stops to measure: its latest reading stays, with the places and velocities of the people in it.

    >>> FrozenSensor(begin=2.0, end=4.0, sensor="scan").sensor
    'scan'
    """
