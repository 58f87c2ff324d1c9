"""Intervals and comparisons against published values, other programs and simulated coverage."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from crowdbot.core import InputError
from crowdbot.evaluation import (
    bootstrap_estimate,
    paired_comparison,
    parse_requirement,
    parse_statistic,
    proportion_interval,
)
from crowdbot.metrics import correct_p_values


@given(successes=st.integers(0, 200), more=st.integers(0, 200), level=st.sampled_from([0.8, 0.9, 0.95, 0.99]))
def test_wilson_is_the_published_formula(successes: int, more: int, level: float) -> None:
    count = successes + more
    if not count:
        assert math.isnan(proportion_interval(0, 0, method="wilson").value)
        return
    found = proportion_interval(successes, count, level, "wilson")
    z, share = float(stats.norm.ppf(0.5 + level / 2.0)), successes / count
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count)) / (1 + z * z / count)
    assert (found.low, found.high) == pytest.approx((middle - half, middle + half), abs=1e-12)
    assert found.low <= found.value <= found.high


def test_the_bootstrap_covers_the_mean_as_often_as_it_says() -> None:
    rng = np.random.default_rng(5)
    inside = 0
    for k in range(300):
        estimate = bootstrap_estimate(rng.exponential(2.0, 60), seed=k)
        inside += estimate.low <= 2.0 <= estimate.high
    assert 0.90 <= inside / 300 <= 0.985


def test_the_bootstrap_leaves_out_what_is_not_finite_and_repeats() -> None:
    values = np.array([1.0, 2.0, math.nan, 4.0, math.inf, 3.0])
    found = bootstrap_estimate(values)
    assert (found.value, found.runs) == (2.5, 4)
    assert found == bootstrap_estimate(np.array([1.0, 2.0, 4.0, 3.0]))
    assert math.isnan(bootstrap_estimate(np.array([math.nan])).value)
    assert bootstrap_estimate(np.full(9, 3.0))[:3] == (3.0, 3.0, 3.0)


def test_an_infinite_severity_counts_and_an_infinite_time_to_collision_does_not() -> None:
    values = np.array([0.0] * 97 + [0.5, 0.7, math.inf])
    assert parse_statistic("max-severity").estimate(values)[::2] == (math.inf, math.inf)
    assert parse_statistic("max:impact-severity-skull").estimate(values).value == math.inf
    assert parse_statistic("cvar95:severity-upper-bound").estimate(values).value == math.inf
    tail = parse_statistic("p98:max-severity").estimate(values)
    assert (tail.value, tail.high, tail.runs) == (0.7, math.inf, 100)
    assert parse_statistic("median:max-severity").estimate(values)[:3] == (0.0, 0.0, 0.0)
    assert parse_statistic("min-ttc").estimate(np.array([1.0, 2.0, math.inf]))[::3] == (1.5, 2)
    assert not parse_requirement("max-severity<1").judge(values).holds
    assert not parse_requirement("p98:max-severity<1@95%").judge(values).holds
    assert parse_requirement("p90:max-severity<1").judge(values).holds
    assert parse_statistic("max-severity").estimate(np.full(3, math.inf)).value == math.inf


def test_binary_pairs_are_compared_by_the_exact_test_of_mcnemar() -> None:
    first = np.array([1.0] * 10 + [0.0] * 10)
    second = np.array([1.0] * 8 + [0.0] * 2 + [1.0] * 9 + [0.0])
    difference, p_value = paired_comparison(first, second)
    assert difference.value == pytest.approx(7 / 20)
    assert p_value == pytest.approx(stats.binomtest(9, 11).pvalue)
    assert paired_comparison(first, first)[1] == 1.0


def test_other_pairs_are_compared_by_a_permutation_of_signs() -> None:
    rng = np.random.default_rng(3)
    first = rng.normal(0.0, 1.0, 10)
    second = first + rng.normal(0.6, 0.5, 10)
    _, few = paired_comparison(first, second)
    wanted = stats.permutation_test(
        (second - first,), np.mean, permutation_type="samples", n_resamples=np.inf, alternative="two-sided"
    ).pvalue
    assert few == pytest.approx(wanted, abs=1e-9)
    many = paired_comparison(np.tile(first, 10), np.tile(second, 10))[1]
    assert many < few
    assert math.isnan(paired_comparison(np.array([math.nan]), np.array([1.0]))[1])


def test_p_values_without_a_difference_are_uniform() -> None:
    rng = np.random.default_rng(8)
    found = [paired_comparison(*rng.normal(size=(2, 30)), seed=k)[1] for k in range(150)]
    assert 0.02 <= float(np.mean(np.array(found) < 0.1)) <= 0.2


@given(values=st.lists(st.floats(1e-6, 1.0) | st.just(math.nan), max_size=12))
def test_corrected_p_values_are_larger_and_keep_their_order(values: list[float]) -> None:
    found = correct_p_values(values)
    real = [(a, b) for a, b in zip(values, found, strict=True) if not math.isnan(a)]
    assert [math.isnan(a) for a in values] == [math.isnan(b) for b in found]
    assert all(a <= b <= 1.0 for a, b in real)
    assert [b for _, b in sorted(real)] == sorted(b for _, b in real)


@pytest.mark.parametrize("level", [0.0, 1.0, 1.5])
def test_a_confidence_out_of_range_is_refused(level: float) -> None:
    with pytest.raises(InputError, match="must be between 0 and 1"):
        proportion_interval(1, 2, level, "wilson")
    with pytest.raises(InputError, match="must be between 0 and 1"):
        bootstrap_estimate(np.ones(3), confidence=level)


def test_more_successes_than_runs_are_refused() -> None:
    with pytest.raises(InputError, match="successes = 3 must be from 0 to the number of runs, 2"):
        proportion_interval(3, 2, method="wilson")


def test_the_tail_is_the_mean_of_the_largest_values() -> None:
    values = np.arange(100.0)
    assert parse_statistic("cvar95:max-severity").estimate(values).value == np.mean(values[95:])
    assert parse_statistic("cvar50:max-severity").estimate(np.array([4.0, 1.0, 3.0, 2.0])).value == 3.5
    assert parse_statistic("cvar99:max-severity").estimate(np.array([4.0, 1.0])).value == 4.0
    with pytest.raises(InputError, match="cvar5 to cvar99"):
        parse_statistic("cvar:max-severity")
