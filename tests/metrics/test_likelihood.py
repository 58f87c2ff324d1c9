"""The likelihood by kernel densities against scipy and against densities that are known."""

import dataclasses
import math

import numpy as np
import pytest
from guesses import case, moved, scene, shuffled, weighted
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import gaussian_kde

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import kde_nll, likelihood


def slow_nll(forecast: Forecast, future: Windows, w: int, a: int) -> float:
    """Mean over the steps of one person, density by density."""
    found = []
    weight = forecast.weight[w]
    for t in range(forecast.steps):
        if future.present[w, t, a] and future.scored[w, a]:
            kde = gaussian_kde(forecast.position[w, weight > 0, t, a].T, weights=weight[weight > 0])
            found.append(-max(kde.logpdf(future.position[w, t, a])[0], -20.0))
    return sum(found) / len(found) if found else math.nan


@pytest.mark.parametrize("equal", [True, False])
@pytest.mark.parametrize("seed", range(4))
def test_it_equals_scipy(seed: int, equal: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    forecast, future = case(seed, K=12)
    if not equal:
        forecast = weighted(forecast, seed)
    if seed == 0:
        future = dataclasses.replace(future, position=4.0 * future.position)  # some are so far off that they are cut
    slow = [[slow_nll(forecast, future, w, a) for a in range(6)] for w in range(3)]
    np.testing.assert_allclose(kde_nll(forecast, future), slow, rtol=1e-9)
    monkeypatch.setattr(likelihood, "NUMBERS_AT_ONCE", 1)  # one person at a time
    np.testing.assert_allclose(kde_nll(forecast, future), slow, rtol=1e-9)


def test_many_samples_of_a_normal_distribution_give_its_density() -> None:
    samples = stream(1, "normal").normal(0.0, [0.5, 2.0], (4000, 1, 1, 2))
    for place in ([0.0, 0.0], [0.5, -2.0]):
        exact = math.log(2.0 * math.pi * 0.5 * 2.0) + (place[0] / 0.5) ** 2 / 2.0 + (place[1] / 2.0) ** 2 / 2.0
        assert kde_nll(*scene([[place]], samples))[0, 0] == pytest.approx(exact, abs=0.1)


def test_far_off_is_cut_at_twenty_nat() -> None:
    cross = [[[[1.0, 0.0]]], [[[-1.0, 0.0]]], [[[0.0, 1.0]]], [[[0.0, -1.0]]]]
    assert kde_nll(*scene([[[900.0, 0.0]]], cross))[0, 0] == 20.0
    assert kde_nll(*scene([[[900.0, 0.0]]], cross), floor=-7.0)[0, 0] == 7.0


@pytest.mark.parametrize("place", [[0.0, 0.0], [123.456, -7.89]])
@pytest.mark.parametrize("angle", [0.0, 0.3, 2.0])
def test_one_sample_equal_samples_and_samples_on_a_line_have_no_density(place: list[float], angle: float) -> None:
    way = np.array([math.cos(angle), math.sin(angle)])
    along = np.linspace(-3.0, 5.0, 9)[:, None] * way + place
    for samples in (along[:1], np.repeat(along[:1], 9, axis=0), along):
        assert math.isnan(kde_nll(*scene([[place]], samples[:, None, None]))[0, 0])
    heavy = [1.0] + [0.0] * 8
    spread = along + np.linspace(0.0, 1.0, 9)[:, None] ** 2 * way[::-1] * [1.0, -1.0]
    assert math.isnan(kde_nll(*scene([[place]], spread[:, None, None], heavy))[0, 0])
    assert np.isfinite(kde_nll(*scene([[place]], spread[:, None, None]))[0, 0])


def test_steps_without_a_density_are_left_out_of_the_mean() -> None:
    cross = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    both = np.stack([np.zeros((4, 2)), cross], axis=1)[:, :, None]
    one = kde_nll(*scene([[[0.0, 0.0]]], cross[:, None, None]))
    assert kde_nll(*scene([[[0.0, 0.0]], [[0.0, 0.0]]], both)) == pytest.approx(one)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), angle=st.floats(-4, 4), shift=st.floats(-100, 100))
def test_turning_shifting_and_reordering_changes_nothing(seed: int, angle: float, shift: float) -> None:
    forecast, future = case(seed, K=8)
    forecast = weighted(forecast, seed)
    whole = kde_nll(forecast, future)
    mixed, there, people = shuffled(forecast, future, seed)
    known = {"rtol": 1e-6, "atol": 1e-6}  # samples that are nearly on a line magnify rounding
    np.testing.assert_allclose(kde_nll(*moved(forecast, future, angle, shift)), whole, **known)
    np.testing.assert_allclose(kde_nll(mixed, there), whole[:, people], **known)


def test_stretching_the_world_shifts_it_by_the_logarithm() -> None:
    forecast, future = case(1, K=8)
    wide = dataclasses.replace(forecast, position=2.0 * forecast.position)
    there = dataclasses.replace(future, position=2.0 * future.position)
    one, other = (kde_nll(*both, floor=-1e9) for both in ((forecast, future), (wide, there)))
    np.testing.assert_allclose(other, one + 2.0 * math.log(2.0), rtol=1e-9)


def test_a_sharper_forecast_around_the_truth_is_likelier() -> None:
    samples = stream(2, "sharp").normal(size=(50, 1, 1, 2))
    values = [kde_nll(*scene([[[0.0, 0.0]]], width * samples))[0, 0] for width in (0.5, 1.0, 2.0)]
    assert values == sorted(values)


def test_what_does_not_belong_together_is_refused() -> None:
    forecast, future = case(0)
    with pytest.raises(InputError, match="predict the past of the same windows"):
        kde_nll(forecast[:1], future)
