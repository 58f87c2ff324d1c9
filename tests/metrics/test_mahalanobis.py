"""Mahalanobis distance and spread against a slow twin and against what is known of them."""

import math

import numpy as np
import pytest
from guesses import case, scene, weighted

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import mahalanobis


def slow(forecast: Forecast, future: Windows, w: int, a: int) -> tuple[float, float]:
    far, wide = [], []
    weight = forecast.weight[w]
    for t in range(forecast.steps):
        if future.present[w, t, a] and future.scored[w, a]:
            cloud = forecast.position[w, weight > 0, t, a]
            covariance = np.cov(cloud.T, aweights=weight[weight > 0])
            away = future.position[w, t, a] - np.average(cloud, axis=0, weights=weight[weight > 0])
            far.append(math.sqrt(away @ np.linalg.inv(covariance) @ away))
            wide.append(float(np.linalg.eigvalsh(covariance)[-1]))
    return (float(np.mean(far)), float(np.mean(wide))) if far else (math.nan, math.nan)


@pytest.mark.parametrize("equal", [True, False])
@pytest.mark.parametrize("seed", range(3))
def test_it_equals_its_slow_twin(seed: int, equal: bool) -> None:
    forecast, future = case(seed, K=12)
    forecast = forecast if equal else weighted(forecast, seed)
    found = np.stack(mahalanobis(forecast, future), axis=-1)
    np.testing.assert_allclose(found, [[slow(forecast, future, w, a) for a in range(6)] for w in range(3)], rtol=1e-9)


def test_truth_from_the_same_density_is_a_rayleigh_distance_away() -> None:
    rng = stream(3, "cloud")
    samples = rng.normal(0.0, [0.5, 2.0], (2000, 1, 1, 2))
    truth = rng.normal(0.0, [0.5, 2.0], (1, 2000, 2))
    far, wide = [], []
    for place in truth[0]:
        one, other = mahalanobis(*scene([[place]], samples))
        far.append(one[0, 0])
        wide.append(other[0, 0])
    assert np.mean(far) == pytest.approx(math.sqrt(math.pi / 2.0), abs=0.06)
    assert wide[0] == pytest.approx(4.0, rel=0.05)


def test_one_sample_equal_samples_and_samples_on_a_line_have_none() -> None:
    line = np.linspace(-1.0, 1.0, 5)[:, None, None, None] * np.array([1.0, 2.0])
    for samples in (line[:1], np.repeat(line[:1], 5, axis=0), line):
        assert np.isnan(np.stack(mahalanobis(*scene([[[0.3, 0.4]]], samples)))).all()


def test_what_does_not_belong_together_is_said() -> None:
    forecast, future = case(0)
    with pytest.raises(InputError, match="window"):
        mahalanobis(forecast, future[:1])
