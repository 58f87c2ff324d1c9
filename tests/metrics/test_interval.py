"""Intervals by the bootstrap: against a slow twin, against theory, and how often they hold the truth."""

import math

import numpy as np
import pytest
from scipy import stats

from crowdbot.core import InputError, stream
from crowdbot.metrics import bootstrap_interval, corrected_interval, draw_counts, interval, percentile_interval


def slow_interval(values: np.ndarray, person: np.ndarray, resamples: int, level: float, seed: int) -> list[float]:
    """Draw people one by one, put all their windows in a list, and take the mean of the list."""
    people = sorted(set(person.tolist()))
    windows = {item: [value for value, own in zip(values, person, strict=True) if own == item] for item in people}
    drawn = stream(seed, "bootstrap").integers(0, len(people), (resamples, len(people)))
    means = []
    for row in drawn:
        every = [value for index in row for value in windows[people[index]] if not math.isnan(value)]
        if every:
            means.append(sum(every) / len(every))
    return np.percentile(means, [50.0 * (1.0 - level), 50.0 * (1.0 + level)]).tolist()


@pytest.mark.parametrize(("share", "level"), [(0.0, 0.95), (0.3, 0.8), (0.8, 0.5)])
def test_it_equals_its_slow_twin(share: float, level: float, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = stream(1, "values")
    person = rng.integers(0, 12, 60) * 7
    values = np.where(rng.random(60) < share, np.nan, rng.normal(size=60))
    slow = slow_interval(values, person, 200, level, 3)
    assert bootstrap_interval(values, person, 200, level, 3) == pytest.approx(slow, abs=1e-12)
    monkeypatch.setattr(interval, "DRAWS_AT_ONCE", 25)  # two resamples at a time
    assert bootstrap_interval(values, person, 200, level, 3) == pytest.approx(slow, abs=1e-12)


def test_it_does_not_depend_on_the_order_of_the_rows() -> None:
    rng = stream(2, "values")
    person, values = rng.integers(0, 9, 50), rng.normal(size=50)
    order = rng.permutation(50)
    found = bootstrap_interval(values[order], person[order])
    assert found == pytest.approx(bootstrap_interval(values, person), abs=1e-12)
    assert found != bootstrap_interval(values, person, seed=1)


def test_for_independent_people_it_is_the_interval_of_the_normal_distribution() -> None:
    values = stream(3, "values").normal(5.0, 2.0, 2000)
    low, high = bootstrap_interval(values, np.arange(2000), resamples=4000)
    assert (high - low) / 2.0 == pytest.approx(1.96 * values.std() / math.sqrt(2000), rel=0.05)
    assert (high + low) / 2.0 == pytest.approx(values.mean(), abs=0.01)


def test_it_holds_the_truth_as_often_as_it_says_where_windows_overlap() -> None:
    held = {"person": 0, "window": 0}
    for trial in range(200):
        rng = stream(trial, "overlap")
        person = np.repeat(np.arange(40), 15)
        values = rng.normal(size=40)[person] + rng.normal(0.0, 0.1, 600)
        for name, by in (("person", person), ("window", np.arange(600))):
            low, high = bootstrap_interval(values, by, resamples=200)
            held[name] += low <= 0.0 <= high
    assert 0.88 <= held["person"] / 200 <= 0.98
    assert held["window"] / 200 < 0.6


def test_intervals_of_resamples_are_those_of_scipy() -> None:
    values = stream(4, "values").exponential(2.0, 50)
    wanted = {
        method: stats.bootstrap(
            (values,), np.mean, n_resamples=2000, method=method, rng=np.random.default_rng(3), confidence_level=0.9
        )
        for method in ("percentile", "BCa")
    }
    samples = wanted["BCa"].bootstrap_distribution
    assert np.ravel(percentile_interval(samples, 0.9)) == pytest.approx(tuple(wanted["percentile"].confidence_interval))
    left_out = (values.sum() - values) / 49
    away = left_out.mean() - left_out
    acceleration = float(np.sum(away**3) / (6.0 * np.sum(away**2) ** 1.5))
    found = corrected_interval(samples, float(values.mean()), 0.9, acceleration)
    assert found == pytest.approx(tuple(wanted["BCa"].confidence_interval), rel=1e-9)
    plain = corrected_interval(samples, float(values.mean()), 0.9)
    assert plain != pytest.approx(found, rel=1e-3)


def test_an_infinite_end_is_not_interpolated() -> None:
    samples = np.array([0.0] * 45 + [1.0] * 45 + [math.inf] * 10)
    assert corrected_interval(samples, 0.5) == (0.0, math.inf)
    assert corrected_interval(samples[:90], 0.5) == (0.0, 1.0)


def test_draws_are_those_of_the_generator_one_by_one() -> None:
    counts = draw_counts(stream(5, "draws"), 7, 40)
    rng = stream(5, "draws")
    assert counts.tolist() == [np.bincount(rng.integers(0, 7, 7), minlength=7).tolist() for _ in range(40)]


def test_without_two_people_there_is_none() -> None:
    for values, person in (([], []), ([1.0, 2.0], [7, 7]), ([1.0, np.nan], [7, 8])):
        assert np.isnan(bootstrap_interval(np.array(values), np.array(person, dtype=int))).all()


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(InputError, match=r"at least 1 resample and a level in 0..1, not 0 and 0.95"):
        bootstrap_interval(np.ones(2), np.arange(2), resamples=0)
    with pytest.raises(InputError, match="not 1000 and 95"):
        bootstrap_interval(np.ones(2), np.arange(2), level=95)
