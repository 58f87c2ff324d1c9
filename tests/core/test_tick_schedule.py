"""TickSchedule: exact against rational arithmetic for any step and period."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.core import FreeClock, InputError, TickSchedule, whole_ticks

STEPS = st.one_of(st.integers(1, 3_600 * 10**9), st.sampled_from([16_666_667, 13_888_889, 11_111_111, 50_000_000]))


def exact_ticks(step: int, period: int, last: int) -> set[int]:
    """Ticks up to ``last``, each the first at or after a multiple of the period."""
    count = math.floor(Fraction(last * step, period)) + 1
    ticks = {math.ceil(Fraction(k * period, step)) for k in range(max(0, count - 200), count)}
    return {tick for tick in ticks if tick <= last}


@given(STEPS, st.data())
def test_every_instant_is_due_at_the_first_tick_at_or_after_it(step: int, data: st.DataObject) -> None:
    period = data.draw(st.integers(step, 50 * step))
    begin = data.draw(st.integers(0, 10**12))
    schedule = TickSchedule(step, period)
    period = schedule.every * step or period
    ticks = range(begin, begin + 60)
    wanted = exact_ticks(step, period, ticks[-1])
    assert [tick for tick in ticks if schedule.is_due(tick)] == sorted(wanted & set(ticks))
    assert [schedule.index(tick) for tick in ticks] == [math.floor(Fraction(tick * step, period)) for tick in ticks]
    for tick in (begin, begin + 1, begin + 7):
        assert schedule.next_due(tick) == min(item for item in exact_ticks(step, period, tick + 60) if item >= tick)


@given(STEPS, st.data())
def test_an_array_of_ticks_gives_what_each_tick_gives(step: int, data: st.DataObject) -> None:
    schedule = TickSchedule(step, data.draw(st.integers(step, 10**6 * step)))
    ticks = data.draw(st.lists(st.integers(0, 10**12), min_size=1, max_size=20))
    due = schedule.is_due(np.array(ticks))
    assert due.dtype == np.bool_
    assert due.tolist() == [schedule.is_due(tick) for tick in ticks]
    assert schedule.index(np.array(ticks)).tolist() == [schedule.index(tick) for tick in ticks]
    assert schedule.is_due(np.int64(ticks[0])) is schedule.is_due(ticks[0])


@given(st.integers(10**6, 10**10), st.integers(1, 5000), st.integers(-1000, 1000))
def test_a_whole_number_of_steps_within_a_microsecond_is_that_number(step: int, every: int, off: int) -> None:
    period = max(10**6, every * step + off)
    schedule = TickSchedule(step, period)
    assert schedule.every == every == whole_ticks(step, period)
    ticks = np.arange(4 * every + 3)
    assert np.array_equal(schedule.is_due(ticks), ticks % every == 0)
    assert np.array_equal(schedule.index(ticks), ticks // every)


@given(STEPS, st.data())
def test_an_instant_is_never_a_step_late_nor_early_however_long_it_runs(step: int, data: st.DataObject) -> None:
    schedule = TickSchedule(step, data.draw(st.integers(step, 100 * step)))
    number = data.draw(st.integers(0, 10**12))
    period = schedule.every * step or schedule.period_ns
    late = Fraction(schedule.tick_of(number) * step - number * period)
    assert 0 <= late < step
    assert abs(schedule.period_ns - period) * 1000 <= schedule.period_ns


@pytest.mark.parametrize(
    ("rate", "ticks"),
    [(60, [0, 6, 12, 18, 24, 30]), (72, [0, 8, 15, 22, 29, 36]), (90, [0, 9, 18, 27, 36, 45])],
)
def test_ten_hertz_in_steps_of_headsets(rate: int, ticks: list[int]) -> None:
    clock = FreeClock(1.0 / rate)
    schedule = clock.schedule(0.1)
    assert [tick for tick in range(46) if schedule.is_due(tick)][:6] == ticks
    day = np.arange(86_400 * rate // 24)
    assert np.count_nonzero(schedule.is_due(day)) == pytest.approx(36_000, abs=1)


@pytest.mark.parametrize("step", [0.05, 0.1, 0.02, 1.0 / 72.0, 1e-9])
@pytest.mark.parametrize("period", [0.3 / 0.1, 0.1 + 0.2, 1.0 / 3.0 * 3.0])
def test_floating_point_periods_are_whole_nanoseconds(step: float, period: float) -> None:
    assert FreeClock(step).schedule(period) == FreeClock(step).schedule(round(period, 6))


@pytest.mark.parametrize("dt", [1e-9, 3600.0])
def test_a_period_of_one_step_is_due_at_every_tick(dt: float) -> None:
    schedule = FreeClock(dt).schedule(dt)
    assert schedule.every == 1
    assert schedule.is_due(np.arange(9)).all()


def test_a_period_shorter_than_the_step_says_what_to_do() -> None:
    with pytest.raises(InputError, match=r"period 0.04 s is shorter than the time step of 0.05 s; it must be at least"):
        FreeClock(0.05).schedule(0.04)
    for period in (0.0, -1.0):
        with pytest.raises(InputError, match="is shorter than the time step"):
            FreeClock(0.05).schedule(period)
    for period in (math.nan, math.inf):
        with pytest.raises(InputError, match=r"must be finite and at least the time step of 0.05 s"):
            FreeClock(0.05).schedule(period)
    with pytest.raises(InputError, match="step_ns = 0 must be at least 1 ns"):
        TickSchedule(0, 10)
    with pytest.raises(InputError, match="ticks have dtype float64"):
        TickSchedule(10, 15).is_due(np.array([1.0]))


def test_below_a_millisecond_the_tolerance_is_a_thousandth_of_the_period() -> None:
    assert whole_ticks(3, 10) == 0
    assert whole_ticks(1300, 100_000) == 77
    assert whole_ticks(1301, 100_000) == 0
    assert whole_ticks(30, 99_990) == 3333
    assert whole_ticks(50_000_000, 400_001_000) == 8
    assert whole_ticks(50_000_000, 400_001_001) == 0
