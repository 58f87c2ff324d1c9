"""Measurement times and delays of sensors in ticks of the clock."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, InputError, TickSchedule, whole_ticks
from crowdbot.typing import Ints

from .sensor import Sensor


@dataclass(frozen=True)
class SensorSchedule:
    """Schedule of a sensor: the ticks at which it measures, and the delay of its readings in whole ticks.

    Fields:
        ticks: ticks at which the sensor measures, see :class:`crowdbot.core.TickSchedule`.
        late: number of ticks from a measurement until its reading arrives.

    >>> from crowdbot.core import FreeClock
    >>> from crowdbot.sensors import Lidar2D
    >>> plan = SensorSchedule.of(Lidar2D(rate=10.0, delay=0.05), FreeClock(0.05))
    >>> [tick for tick in range(6) if plan.measures(tick)], plan.arrives(2)
    ([0, 2, 4], 3)
    """

    ticks: TickSchedule
    late: int

    @classmethod
    def of(cls, sensor: Sensor, clock: Clock) -> SensorSchedule:
        """Return the schedule of ``sensor``; a reading arrives at the first tick at or after time and delay.

        Raises:
            InputError: its period is shorter than the time step.
        """
        try:
            return cls(clock.schedule(1.0 / sensor.rate), _ticks_of(sensor.delay, clock))
        except InputError as error:
            raise InputError(
                f"{type(sensor).__name__}: rate {sensor.rate} Hz, delay {sensor.delay} s: {error}"
            ) from None

    @overload
    def measures(self, tick: int) -> bool: ...
    @overload
    def measures(self, tick: Ints) -> NDArray[np.bool_]: ...
    def measures(self, tick: int | Ints) -> bool | NDArray[np.bool_]:
        """Return whether the sensor measures at a tick, or at each of several."""
        return self.ticks.is_due(tick)

    @overload
    def arrives(self, tick: int) -> int: ...
    @overload
    def arrives(self, tick: Ints) -> Ints: ...
    def arrives(self, tick: int | Ints) -> int | Ints:
        """Return the tick at which a reading of a tick arrives."""
        return tick + self.late


def _ticks_of(delay: float, clock: Clock) -> int:
    """Return the number of ticks until a delay [s] is over."""
    if not 0.0 <= delay < math.inf:
        raise InputError(f"delay {delay} s must be finite and at least 0 s")
    nanoseconds = round(delay * 1e9)
    return whole_ticks(clock.step_ns, nanoseconds) or -(-nanoseconds // clock.step_ns)
