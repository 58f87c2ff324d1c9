"""The energy score against its formula, written out."""

import dataclasses
import math

import numpy as np
import pytest
from guesses import case, moved, scene, shuffled, weighted
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import ade, energy_score

OVER = pytest.mark.parametrize("over", ["steps", "path"])


def slow_energy(forecast: Forecast, future: Windows, w: int, a: int, over: str) -> float:
    """One person by the formula of Gneiting and Raftery, every pair twice."""
    steps = [t for t in range(forecast.steps) if future.present[w, t, a] and future.scored[w, a]]
    if not steps:
        return math.nan
    weight, x = forecast.weight[w], forecast.position[w, :, :, a][:, steps]
    y = future.position[w, steps, a]

    def distance(one: np.ndarray, other: np.ndarray) -> float:
        if over == "steps":
            return sum(math.dist(p, q) for p, q in zip(one, other, strict=True)) / len(steps)
        return math.dist(one.ravel(), other.ravel()) / math.sqrt(len(steps))

    samples = range(len(weight))
    near = sum(weight[k] * distance(x[k], y) for k in samples)
    apart = sum(weight[k] * weight[j] * distance(x[k], x[j]) for k in samples for j in samples)
    return near - apart / 2.0


@OVER
@pytest.mark.parametrize("equal", [True, False])
@pytest.mark.parametrize("seed", range(3))
def test_it_equals_its_slow_twin(seed: int, equal: bool, over: str) -> None:
    forecast, future = case(seed)
    if not equal:
        forecast = weighted(forecast, seed)
    slow = [[slow_energy(forecast, future, w, a, over) for a in range(6)] for w in range(3)]
    np.testing.assert_allclose(energy_score(forecast, future, over), slow, atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_one_sample_or_equal_samples_score_their_distance(seed: int) -> None:
    forecast, future = case(seed, K=1)
    same = Forecast.of(np.repeat(forecast.position, 3, axis=1), forecast.valid, 0.4, "same")
    np.testing.assert_allclose(energy_score(forecast, future), ade(forecast, future)[:, 0])
    np.testing.assert_allclose(energy_score(same, future), ade(forecast, future)[:, 0], atol=1e-12)
    root = energy_score(*scene([[[0.0, 0.0]], [[0.0, 0.0]]], [[[[3.0, 0.0]], [[4.0, 0.0]]]]), "path")
    assert root[0, 0] == pytest.approx(math.sqrt((9.0 + 16.0) / 2.0))


def test_two_samples_by_hand() -> None:
    truth, samples = [[[0.0, 0.0]]], [[[[3.0, 0.0]]], [[[-1.0, 0.0]]]]
    assert energy_score(*scene(truth, samples))[0, 0] == pytest.approx((3.0 + 1.0) / 2.0 - 4.0 / 4.0)
    assert energy_score(*scene(truth, samples, [0.25, 0.75]))[0, 0] == pytest.approx(
        0.25 * 3.0 + 0.75 * 1.0 - 0.25 * 0.75 * 4.0
    )


@OVER
def test_splitting_a_sample_into_equal_halves_changes_nothing(over: str) -> None:
    forecast, future = case(3)
    forecast = weighted(forecast, 3)
    twice = dataclasses.replace(
        forecast,
        position=np.concatenate([forecast.position, forecast.position], axis=1),
        weight=np.concatenate([0.3 * forecast.weight, 0.7 * forecast.weight], axis=1),
    )
    np.testing.assert_allclose(energy_score(twice, future, over), energy_score(forecast, future, over), atol=1e-12)


@OVER
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), angle=st.floats(-4, 4), shift=st.floats(-100, 100))
def test_turning_shifting_and_reordering_changes_nothing(over: str, seed: int, angle: float, shift: float) -> None:
    forecast, future = case(seed)
    forecast = weighted(forecast, seed)
    whole = energy_score(forecast, future, over)
    mixed, there, people = shuffled(forecast, future, seed)
    np.testing.assert_allclose(energy_score(*moved(forecast, future, angle, shift), over), whole, atol=1e-9)
    np.testing.assert_allclose(energy_score(mixed, there, over), whole[:, people], atol=1e-12)
    assert np.all(whole[future.scored] >= 0.0)


@OVER
def test_who_knows_the_distribution_scores_best(over: str) -> None:
    """Proper: neither more nor less spread, nor a shift, nor losing the tie between the steps does better."""
    rng = stream(4, "proper")

    def drawn(count: int, width: float = 1.0, shift: float = 0.0, tied: bool = True) -> np.ndarray:
        steps = rng.normal(size=(count, 1, 2 if tied else 4))
        both = np.concatenate([steps, steps], axis=2) if tied else steps
        return shift + width * both.reshape(count, 1, 2, 2)

    W = 2000
    truth = np.moveaxis(drawn(W), 1, 2)
    here = np.ones((W, 2, 1), dtype=bool)
    future = Windows(
        truth, here, here[:, 0], ~here[:, 0], np.zeros((W, 1), dtype=int), np.zeros((W, 2), dtype=int), 0.4, "all", ""
    )

    def mean(**how: object) -> float:
        guess = np.moveaxis(drawn(W * 20, **how).reshape(W, 20, 1, 2, 2), 2, 3)
        return float(energy_score(Forecast.of(guess, here[:, 0], 0.4, "guess"), future, over).mean())

    best = mean()
    assert best < min(mean(width=0.6), mean(width=1.6), mean(shift=0.5)) - 0.01
    if over == "path":
        assert best < mean(tied=False) - 0.01


def test_an_unknown_choice_is_refused() -> None:
    with pytest.raises(InputError, match="energy score: over = 'pathe' must be steps or path, did you mean 'path'"):
        energy_score(*case(0), over="pathe")
