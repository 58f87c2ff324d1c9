"""SensorSchedule: measurements and arrivals in steps that do not divide the period or the delay."""

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.core import FreeClock, InputError
from crowdbot.sensors import Lidar2D, SensorSchedule


@given(st.integers(1_000_000, 10**9), st.integers(0, 10**9))
def test_a_reading_arrives_at_the_first_tick_at_or_after_its_delay(step: int, delay: int) -> None:
    plan = SensorSchedule.of(Lidar2D(rate=1e9 / step / 2.0, delay=delay / 1e9), FreeClock(step / 1e9))
    ticks = round(Fraction(delay, step))
    whole = abs(ticks * step - delay) <= min(1000, delay // 1000)
    assert plan.arrives(7) == 7 + (ticks if whole and ticks else math.ceil(Fraction(delay, step)))


@pytest.mark.parametrize("rate", [60, 72, 90])
def test_ten_hertz_with_a_delay_in_steps_of_headsets(rate: int) -> None:
    plan = SensorSchedule.of(Lidar2D(rate=10.0, delay=0.02), FreeClock(1.0 / rate))
    ticks = [tick for tick in range(10 * rate) if plan.measures(tick)]
    assert len(ticks) == 100
    assert max(abs(tick / rate - 0.1 * k) for k, tick in enumerate(ticks)) < 1.0 / rate
    assert plan.arrives(9) == 9 + math.ceil(0.02 * rate)


@pytest.mark.parametrize("delay", [-0.1, math.nan, math.inf])
def test_an_impossible_delay_is_refused(delay: float) -> None:
    sensor = Lidar2D()
    object.__setattr__(sensor, "delay", delay)
    with pytest.raises(InputError, match="must be finite and at least 0 s"):
        SensorSchedule.of(sensor, FreeClock(0.05))
