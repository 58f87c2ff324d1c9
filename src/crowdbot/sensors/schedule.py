"""Measurement times and delays of sensors in ticks of the clock."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core import Clock, InputError

from .sensor import Sensor

__all__ = ["SensorSchedule"]


@dataclass(frozen=True)
class SensorSchedule:
    """Schedule of a sensor: it measures at every ``every``-th tick; readings arrive ``late`` ticks later.

    >>> from crowdbot.core import FreeClock
    >>> from crowdbot.sensors import Lidar2D
    >>> plan = SensorSchedule.of(Lidar2D(rate=10.0, delay=0.05), FreeClock(0.05))
    >>> [tick for tick in range(6) if plan.measures(tick)], plan.arrives(2)
    ([0, 2, 4], 3)
    """

    every: int
    late: int

    @classmethod
    def of(cls, sensor: Sensor, clock: Clock) -> SensorSchedule:
        """Return the schedule of ``sensor``.

        Raises:
            InputError: its period or delay is not a multiple of the time step.
        """
        try:
            late = clock.every(sensor.delay) if sensor.delay > 0.0 else 0
            return cls(clock.every(1.0 / sensor.rate), late)
        except InputError as error:
            raise InputError(
                f"{type(sensor).__name__}: rate {sensor.rate} Hz, delay {sensor.delay} s: {error}"
            ) from None

    def measures(self, tick: int) -> bool:
        """Return whether the sensor measures at ``tick``."""
        return tick % self.every == 0

    def arrives(self, tick: int) -> int:
        """Return the tick at which a reading of ``tick`` arrives."""
        return tick + self.late
