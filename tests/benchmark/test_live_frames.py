"""Measurements of live forecasts, with a clock that does not depend on the computer."""

from __future__ import annotations

import pytest

from crowdbot.benchmark.speed.forecast_frames import LIVE_FRAMES, live_frames
from crowdbot.core import UnknownName


class Clock:
    """A clock that goes on by one millisecond at each reading."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        self.now += 1e-3
        return self.now


def test_a_forecast_of_anchor_net_is_timed_from_begin_to_end() -> None:
    gauge = live_frames("live-anchor-net", frames=2, clock=Clock())
    assert gauge.value == pytest.approx(1.0)
    assert (gauge.unit, gauge.reference) == ("ms", 20.0)
    assert gauge.against == "20 ms at p95; median 1.0 ms, largest 1.0 ms, 30 people, 20 x 12 rows, 2 frames"


def test_a_calibrated_crowd_keeps_its_budget_and_says_what_it_bought() -> None:
    gauge = live_frames("live-orca-budget", frames=3, clock=Clock())
    assert 1.0 < gauge.value <= gauge.reference == 50.0
    assert "1 x 12 rows, " in gauge.against
    assert gauge.against.endswith(" evaluations, 3 frames")


def test_an_unknown_measurement_is_refused() -> None:
    with pytest.raises(UnknownName, match="live-anchor"):
        live_frames("live-anchor")
    assert set(LIVE_FRAMES) == {"live-anchor-net", "live-anchor-net-10hz", "live-orca-budget"}
