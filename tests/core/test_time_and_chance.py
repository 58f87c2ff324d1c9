"""Clocks, streams of randomness, parameters, poses, papers and the error tree."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.core import (
    CrowdbotError,
    ExternalClock,
    FreeClock,
    InputError,
    MissingExtra,
    PacedClock,
    Paper,
    Parameter,
    Pose,
    TrialError,
    check_parameters,
    errors,
    parameter,
    parameters,
    per_agent,
    stream,
    wrap_angle,
)


def test_time_is_exact_after_a_day_of_ticks():
    clock = FreeClock(0.1)
    clock.tick = 864_000
    assert clock.time == 86_400.0


@pytest.mark.parametrize("dt", [0.0, -1.0, math.nan, 1e9])
def test_a_wrong_step_is_refused(dt):
    with pytest.raises(InputError, match="is outside"):
        FreeClock(dt)


def test_external_time_never_goes_back():
    clock = ExternalClock(0.1)
    assert clock.due(250_000_000) == 2
    clock.advance()
    clock.advance()
    assert clock.due(250_000_000) == 0
    with pytest.raises(InputError, match="went back"):
        clock.due(1)


@given(st.integers(-(2**70), 2**70), st.text(max_size=5), st.integers())
def test_streams_repeat_and_differ(seed, name, number):
    draws = {
        tuple(stream(seed, *path).integers(2**62, size=2)) for path in ((name,), (name, number), (name, str(number)))
    }
    assert len(draws) == 3
    assert tuple(stream(seed, name).integers(2**62, size=2)) in draws


def test_stream_values_are_pinned():
    assert stream(0, "spawner", 3).integers(1_000_000, size=3).tolist() == [907676, 615294, 744122]
    assert stream(2026).integers(1_000_000, size=3).tolist() == [83049, 535409, 421730]


@dataclass(frozen=True)
class _Model:
    tau: float = parameter(0.5, unit="s", low=0.1, high=1.5, source="test", min=0.01)


def test_parameter_tables():
    (row,) = parameters(_Model)
    assert (row.name, row.unit, row.low, row.high) == ("tau", "s", 0.1, 1.5)
    check_parameters(_Model(0.2))
    for wrong in (math.nan, 0.0, np.array([0.5, math.inf])):
        with pytest.raises(InputError, match="_Model: tau"):
            check_parameters(_Model(wrong))


def test_per_agent_broadcasts_or_says_why_not():
    assert per_agent([[1.0], [2.0]], (2, 3)).tolist() == [[1.0] * 3, [2.0] * 3]
    with pytest.raises(InputError, match=r"tau has shape \(4,\), which does not broadcast to \[E, A\] = \[2, 3\]"):
        per_agent(np.ones(4), (2, 3), "tau")


@given(st.floats(-1e3, 1e3))
def test_wrap_keeps_the_direction(angle):
    turned = wrap_angle(angle)
    assert -math.pi < turned <= math.pi
    assert math.cos(turned) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(turned) == pytest.approx(math.sin(angle), abs=1e-9)


def test_mounted_pose():
    part = Pose.of((1.0, 1.0), math.pi / 2).offset(2.0, 0.5, 0.1)
    np.testing.assert_allclose(part.position, [[0.5, 3.0]])
    assert part.heading[0] == pytest.approx(math.pi / 2 + 0.1)


def test_the_error_tree_is_what_it_draws():
    kinds = {
        name for name, kind in vars(errors).items() if isinstance(kind, type) and kind.__module__ == errors.__name__
    }
    assert all(issubclass(getattr(errors, name), CrowdbotError | Warning) for name in kinds)
    drawn = {word for word in errors.__doc__.replace("(", " ").split() if word in kinds}
    assert drawn == kinds
    assert TrialError("one", "two").problems == ("one", "two")
    assert "pip install 'crowdbot[learn]'" in str(MissingExtra("training", "learn"))


def test_bibtex():
    assert "@article{reynolds1987" in Paper("C. Reynolds", 1987, "Flocks", "SIGGRAPH", "10.1145/37401.37406").bibtex()


@given(st.floats(1e-9, 3600.0), st.integers(0, 10**6))
def test_time_is_the_tick_times_a_whole_number_of_nanoseconds(dt, tick):
    clock = FreeClock(dt)
    clock.tick = tick
    assert clock.step_ns == round(dt * 1e9)
    assert clock.nanoseconds == tick * clock.step_ns
    assert clock.time == clock.nanoseconds / 10**9


@pytest.mark.parametrize("dt", [1e-9, 3600.0])
def test_the_ends_of_the_range_of_steps_are_allowed(dt):
    assert FreeClock(dt).tick == 0


def test_a_period_may_differ_by_a_microsecond_from_whole_ticks():
    clock = FreeClock(0.1)
    assert clock.schedule(0.1).every == 1
    assert clock.schedule(0.300001).every == 3
    assert clock.schedule(0.3000011).every == 0
    with pytest.raises(InputError, match="is shorter than the time step"):
        clock.schedule(0.04)


def test_external_time_counts_from_the_tick():
    clock = ExternalClock(0.1, tick=5)
    assert [clock.due(n) for n in (500_000_000, 599_999_999, 600_000_000)] == [0, 0, 1]


@pytest.mark.parametrize("rate", [0.0, -1.0, math.nan, math.inf])
def test_a_wrong_rate_of_a_paced_clock_is_refused(rate):
    with pytest.raises(InputError, match="must be above 0"):
        PacedClock(0.1, rate=rate)


def test_a_parameter_is_bounded_by_itself_or_by_the_largest_number():
    @dataclass(frozen=True)
    class Model:
        free: float = parameter(1.0, unit="1", low=0.5, high=2.0, source="here")
        tight: float = parameter(1.0, unit="m", low=0.5, high=2.0, source="here", min=-1.0, max=3.0)

    free, tight = parameters(Model)
    assert free.bounds().describe() == "finite and at least 0, without an upper limit"
    assert free.bounds(9.0).describe() == "at least 0 and at most 9"
    assert tight.bounds(9.0).describe() == tight.bounds().describe() == "at least -1 m and at most 3 m"
    assert (free.min, free.max) == (Parameter("a", "m", 1.0, 0.0, 2.0, "here").min, None) == (0.0, None)
