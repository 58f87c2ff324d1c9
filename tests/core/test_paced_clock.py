"""PacedClock with a fake source of time."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.core import InputError, PacedClock
from crowdbot.core.clock import MAX_LAG


class FakeTime:
    """Real time that passes only while a clock sleeps."""

    def __init__(self) -> None:
        self.now, self.slept = 100.0, 0.0

    def clock(self, dt: float, rate: float = 1.0) -> PacedClock:
        return PacedClock(dt, rate=rate, monotonic=lambda: self.now, sleep=self.sleep)

    def sleep(self, seconds: float) -> None:
        assert seconds > 0.0
        self.now += seconds
        self.slept += seconds

    def duration(self, clock: PacedClock, ticks: int) -> float:
        """Return the real time that some ticks take."""
        begin = self.now
        for _ in range(ticks):
            clock.advance()
        return self.now - begin


@given(st.sampled_from([0.5, 1.0, 3.0]), st.floats(0.0, 100.0))
def test_a_pause_of_any_length_is_not_caught_up(rate: float, pause: float) -> None:
    time = FakeTime()
    clock = time.clock(0.05, rate)
    assert time.duration(clock, 10) == pytest.approx(0.5 / rate)
    clock.pause()
    time.now += pause
    clock.resume()
    assert time.duration(clock, 20) == pytest.approx(1.0 / rate, abs=1e-9)


def test_a_pause_keeps_what_is_left_of_the_current_step() -> None:
    time = FakeTime()
    clock = time.clock(0.1)
    clock.advance()
    time.now += 0.04
    clock.pause()
    time.now += 5.0
    clock.resume()
    assert time.duration(clock, 1) == pytest.approx(0.06)


def test_pause_and_resume_may_be_called_twice() -> None:
    time = FakeTime()
    clock = time.clock(0.1)
    clock.resume()
    clock.pause()
    assert clock.paused
    clock.advance()
    assert (clock.tick, time.slept) == (1, 0.0)
    time.now += 1.0
    clock.pause()
    clock.resume()
    clock.resume()
    assert not clock.paused
    assert time.duration(clock, 3) == pytest.approx(0.3)


def test_a_small_delay_is_caught_up() -> None:
    time = FakeTime()
    clock = time.clock(0.05)
    clock.advance()
    time.now += 0.9 * MAX_LAG
    assert time.duration(clock, 20) == pytest.approx(1.0 - 0.9 * MAX_LAG)


def test_a_long_delay_shifts_the_schedule() -> None:
    time = FakeTime()
    clock = time.clock(0.05)
    clock.advance()
    time.now += 1.5
    clock.advance()  # late itself
    assert time.duration(clock, 20) == pytest.approx(1.0)


def test_the_rate_changes_from_the_next_tick_on() -> None:
    time = FakeTime()
    clock = time.clock(0.1)
    assert time.duration(clock, 10) == pytest.approx(1.0)
    clock.rate = 4.0
    assert time.duration(clock, 10) == pytest.approx(0.25)
    with pytest.raises(InputError, match="rate 0.0 of a paced clock must be above 0 and finite"):
        clock.rate = 0.0
    assert clock.rate == 4.0


@pytest.mark.parametrize("rate", [0.5, 2.0])
def test_a_clock_sleeps_for_the_rest_of_a_step(rate: float) -> None:
    time = FakeTime()
    clock = PacedClock(0.1, tick=3, rate=rate, monotonic=lambda: time.now, sleep=time.sleep)
    clock.advance()
    assert time.slept == pytest.approx(0.1 / rate)
    time.now += 0.02
    clock.advance()
    assert time.slept == pytest.approx(0.2 / rate - 0.02)
    assert clock.tick == 5
