"""When a sensor measures and when its reading is handed over, in whole ticks of the one clock."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core import Clock, InputError

from .sensor import Sensor

__all__ = ["Schedule"]


@dataclass(frozen=True)
class Schedule:
    """Ticks of a sensor: it measures every ``every``-th, and each reading arrives ``late`` ticks after.

    >>> from crowdbot.core import FreeClock
    >>> from crowdbot.sensors import Lidar2D
    >>> plan = Schedule.of(Lidar2D(rate=10.0, delay=0.05), FreeClock(0.05))
    >>> [tick for tick in range(6) if plan.measures(tick)], plan.arrives(2)
    ([0, 2, 4], 3)
    """

    every: int
    late: int

    @classmethod
    def of(cls, sensor: Sensor, clock: Clock) -> Schedule:
        """Return the ticks of ``sensor``.

        Raises:
            InputError: its period or its delay is not a whole number of time steps.
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
        """Return when what was measured at ``tick`` is handed over."""
        return tick + self.late
