"""Live with a time budget: a calibrated crowd evaluates what fits, and reports what it reached."""

from __future__ import annotations

import math

import numpy as np
import pytest

from crowdbot.calibration import Calibrator, SearchResult, TimeLimit, resolve_search
from crowdbot.core import InputError, stream
from crowdbot.data import example_windows
from crowdbot.prediction import ConstantVelocity, Live, Simulated

SEARCHES = ["genetic", "greedy", "annealing", "cma-es", "random-search"]


class Clock:
    """A clock that goes on by ``step`` seconds at each reading."""

    def __init__(self, step: float = 0.0) -> None:
        self.now, self.step = 0.0, step

    def __call__(self) -> float:
        self.now += self.step
        return self.now


def scheme(budget: int) -> Simulated:
    return Simulated("orca", cost="progressive", search="genetic", budget=budget, substep=0.4)


def follow(live: Live, rows: range) -> None:
    for row in rows:
        live.update([1, 2, 3], [[0.5 * row, 0.0], [6.0 - 0.5 * row, 0.3], [0.4 * row, 2.0]])


def test_a_calibration_stops_within_the_budget_and_reports_what_it_reached() -> None:
    clock = Clock()
    live = Live(scheme(2000), dt=0.4, budget="40 ms", clock=clock)
    assert live.budget == 0.04
    assert str(live.report) == "no prediction yet"
    follow(live, range(8))
    clock.step = 0.001
    counts = []
    for row in range(8, 16):
        live.predict(2)
        assert live.report.latency <= 0.04
        assert not live.report.is_late
        assert math.isfinite(live.report.cost)
        counts.append(live.report.evaluations)
        follow(live, range(row, row + 1))
    assert all(3 < count < 2000 for count in counts)
    clock.step = 0.004  # a slower computer
    live.predict(2)
    assert 3 <= live.report.evaluations < min(counts)
    assert "evaluations, cost" in str(live.report)


def test_a_larger_budget_reaches_a_smaller_cost() -> None:
    costs = []
    for budget in ("8 ms", "2 s"):
        live = Live(scheme(400), dt=0.4, budget=budget, clock=Clock(0.001))
        follow(live, range(8))
        live.predict(2)
        costs.append(live.report.cost)
    assert costs[1] < costs[0]


def test_start_values_are_evaluated_in_any_case() -> None:
    live = Live(scheme(100), dt=0.4, budget=0.1, clock=Clock(0.2))
    follow(live, range(8))
    live.predict(2)
    assert live.report.is_late
    assert live.report.evaluations == 2  # the given values and the mean speed
    assert ", too late: 2 of 100 evaluations" in str(live.report)


def test_what_fits_is_the_same_as_without_a_budget() -> None:
    plain, timed = Live(scheme(120), dt=0.4), Live(scheme(120), dt=0.4, budget=1e6, clock=Clock(1e-6))
    for live in (plain, timed):
        follow(live, range(8))
    np.testing.assert_array_equal(plain.predict(4).position, timed.predict(4).position)
    assert plain.report.evaluations == timed.report.evaluations == 120
    assert plain.report.budget == math.inf


def test_predictors_that_do_not_search_only_report_their_time() -> None:
    live = Live(ConstantVelocity(), dt=0.4, budget=1.0, clock=Clock(0.25))
    follow(live, range(8))
    live.predict(2)
    assert (live.report.latency, live.report.evaluations, live.report.wanted) == (0.25, 0, 0)
    assert str(live.report) == "250 ms of 1e+03 ms"


@pytest.mark.parametrize("search", SEARCHES)
def test_every_search_stops_in_time(search: str) -> None:
    clock = Clock()

    def bowl(candidates: np.ndarray, which: np.ndarray) -> np.ndarray:
        clock.now += 1e-3 * len(candidates)  # a candidate takes 1 ms
        return np.asarray((candidates**2).sum(axis=-1))

    def minimize(limit: TimeLimit) -> SearchResult:
        box = np.full(2, -1.0), np.full(2, 2.0)
        return resolve_search(search).minimize(bowl, *box, [stream(0, "x")], 300, np.ones((2, 1, 4, 2)), limit)

    result = minimize(TimeLimit(0.1, clock))
    assert 0.09 <= clock.now <= 0.1 + 1e-9
    assert result.evaluations[0] == round(clock.now / 1e-3)
    assert result.cost[0] < 2.0
    assert result.history[0, -1] == result.cost[0]
    whole = minimize(TimeLimit(1e6, clock))
    assert whole.evaluations[0] == 300
    assert whole.cost[0] <= result.cost[0]
    short = minimize(TimeLimit(0.0, clock))
    assert (short.evaluations[0], short.cost[0]) == (2, 2.0)


def test_a_shared_calibration_stops_in_time() -> None:
    calibrator = Calibrator("orca", "progressive", "genetic", budget=300, shared=True, substep=0.4)
    fit = calibrator.fit(example_windows(), limit=TimeLimit(0.01, Clock(0.001)))
    assert 1 <= fit.evaluations[0] < 300


@pytest.mark.parametrize(
    ("budget", "words"),
    [
        (0.0, "budget = 0 s must be above 0"),
        ("-3 ms", "budget = -0.003 s must be above 0"),
        ("40", "budget = '40' is no duration; give seconds as a number, or a text with a unit"),
        ("4 fortnights", "budget = '4 fortnights' is no duration"),
        (math.nan, "budget = nan s must be above 0"),
    ],
)
def test_impossible_budgets_are_refused(budget: float | str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Live(ConstantVelocity(), dt=0.4, budget=budget)


def test_the_window_of_late_frames_may_be_a_text() -> None:
    live = Live(ConstantVelocity(), dt=0.1, allowed_lateness="300 ms")
    for time in (0.0, 0.4, 0.1, 0.2):
        live.update([7], [[time, 0.0]], time=time)
    assert live.drop_count == 0
    np.testing.assert_allclose(live.past().position[0, :, 0, 0], [0.0, 0.1, 0.2, 0.3, 0.4], atol=1e-9)
    with pytest.raises(InputError, match="allowed_lateness = '3 days' is no duration"):
        Live(ConstantVelocity(), dt=0.1, allowed_lateness="3 days")
    with pytest.raises(InputError, match="allowed_lateness = -1 s must be finite and at least 0"):
        Live(ConstantVelocity(), dt=0.1, allowed_lateness=-1)


def test_the_end_of_a_time_limit_is_a_number() -> None:
    with pytest.raises(InputError, match="end = nan must be a number"):
        TimeLimit(math.nan)
