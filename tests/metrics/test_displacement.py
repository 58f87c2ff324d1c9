"""Displacement metrics against slow, obvious twins."""

import math

import numpy as np
import pytest
from guesses import case, moved, scene, weighted, without_padding
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import ade, best_of, distances, error_over_horizon, fde, miss_rate, person_errors


def slow_errors(forecast: Forecast, future: Windows, w: int, k: int, a: int) -> list[tuple[int, float]]:
    """Step and distance of every step that counts, in plain Python."""
    result = []
    for t in range(forecast.steps):
        if future.present[w, t, a] and future.scored[w, a]:
            dx, dy = (forecast.position[w, k, t, a] - future.position[w, t, a]).tolist()
            result.append((t, math.hypot(dx, dy)))
    return result


@pytest.mark.parametrize("seed", range(5))
def test_ade_and_fde_equal_their_slow_twin(seed: int) -> None:
    forecast, future = case(seed)
    fast = ade(forecast, future), fde(forecast, future)
    for w, k, a in np.ndindex(fast[0].shape):
        steps = slow_errors(forecast, future, w, k, a)
        if not steps:
            assert math.isnan(fast[0][w, k, a])
            assert math.isnan(fast[1][w, k, a])
            continue
        assert fast[0][w, k, a] == pytest.approx(sum(d for _, d in steps) / len(steps), abs=1e-12)
        assert fast[1][w, k, a] == pytest.approx(steps[-1][1], abs=1e-12)


def slow_best(every: np.ndarray, ends: np.ndarray, rule: str, w: int, a: int) -> tuple[float, float]:
    K, A = every.shape[1:]
    if rule == "person":
        return min(every[w, k, a] for k in range(K)), min(ends[w, k, a] for k in range(K))
    if rule == "same":
        k = min(range(K), key=lambda k: every[w, k, a])
        return every[w, k, a], ends[w, k, a]
    people = [p for p in range(A) if not math.isnan(every[w, 0, p])]
    best = [min(range(K), key=lambda k, v=v: sum(v[w, k, p] for p in people)) for v in (every, ends)]
    return every[w, best[0], a], ends[w, best[1], a]


@pytest.mark.parametrize("rule", ["person", "scene", "same"])
@pytest.mark.parametrize("seed", range(3))
def test_best_of_equals_its_slow_twin(seed: int, rule: str) -> None:
    forecast, future = case(seed)
    every, ends = ade(forecast, future), fde(forecast, future)
    fast = best_of(every, ends, rule)
    for w, a in np.argwhere(future.scored):
        assert (fast[0][w, a], fast[1][w, a]) == slow_best(every, ends, rule, w, a)
    assert np.isnan(fast[0][~future.scored]).all()


@pytest.mark.parametrize("seed", range(3))
def test_error_over_horizon_equals_its_slow_twin(seed: int) -> None:
    forecast, future = case(seed)
    every = ade(forecast, future)
    steps: list[list[float]] = [[] for _ in range(forecast.steps)]
    for w, a in np.argwhere(future.scored):
        for t, distance in slow_errors(forecast, future, w, int(np.argmin(every[w, :, a])), a):
            steps[t].append(distance)
    slow = [sum(s) / len(s) if s else math.nan for s in steps]
    np.testing.assert_allclose(error_over_horizon(forecast, future), slow, atol=1e-12)


def test_miss_rate_counts_people_beyond_the_limit() -> None:
    assert miss_rate(np.array([[0.5, 2.5, np.nan], [2.0, 9.0, np.nan]])) == 0.5
    assert miss_rate(np.array([0.5, 2.5]), limit=0.4) == 1.0
    assert math.isnan(miss_rate(np.array([np.nan])))


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), angle=st.floats(-4, 4), shift=st.floats(-100, 100))
def test_turning_and_shifting_the_world_changes_no_error(seed: int, angle: float, shift: float) -> None:
    forecast, future = case(seed)
    elsewhere, there = moved(forecast, future, angle, shift)
    np.testing.assert_allclose(ade(elsewhere, there), ade(forecast, future), atol=1e-9)
    np.testing.assert_allclose(fde(elsewhere, there), fde(forecast, future), atol=1e-9)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), best=st.sampled_from(["person", "scene", "same"]))
def test_renumbering_people_and_splitting_windows_changes_no_error(seed: int, best: str) -> None:
    forecast, future = case(seed)
    whole = person_errors(forecast, future, best)
    parts = [person_errors(forecast[w : w + 1], future[w : w + 1], best) for w in range(3)]
    assert np.array_equal(np.concatenate([part.ade for part in parts]), whole.ade)
    order = stream(seed, "order").permutation(6)
    mixed = Windows(
        future.position[:, :, order], future.present[..., order], future.scored[:, order], future.robot[:, order],
        future.id[:, order], future.frame, 0.4, "", "",
    )  # fmt: skip
    other = person_errors(Forecast.of(forecast.position[..., order, :], forecast.valid, 0.4, ""), mixed, best)
    np.testing.assert_allclose(np.sort(other.ade), np.sort(whole.ade), atol=1e-12)
    np.testing.assert_allclose(np.sort(other.fde), np.sort(whole.fde), atol=1e-12)


def test_more_samples_are_never_worse_and_scene_is_never_better_than_person() -> None:
    forecast, future = case(1, K=8)
    half = Forecast.of(forecast.position[:, :4], forecast.valid, 0.4, "half")
    assert person_errors(forecast, future).ade.mean() <= person_errors(half, future).ade.mean()
    assert person_errors(forecast, future, "scene").ade.mean() >= person_errors(forecast, future).ade.mean()


@pytest.mark.parametrize("rule", ["person", "scene", "same"])
@pytest.mark.parametrize("seed", range(5))
def test_samples_that_weigh_nothing_count_nowhere(seed: int, rule: str) -> None:
    forecast, future = case(seed, K=6)
    forecast = weighted(forecast, seed)
    padded = person_errors(forecast, future, rule)
    parts = [person_errors(*item, rule) for item in without_padding(forecast, future)]
    for name in ("ade", "fde", "distance", "collided", "true_collided", "nll", "energy"):
        apart = np.concatenate([getattr(part, name) for part in parts])
        np.testing.assert_allclose(getattr(padded, name), apart, atol=1e-12, err_msg=name)
    assert np.isnan(ade(forecast, future)[:, -1]).all()
    assert np.isnan(fde(forecast, future)[:, -1]).all()
    count = sum(part.exists.sum(axis=0) for part in parts)
    summed = sum(part.distance.sum(axis=0) for part in parts)[count > 0] / count[count > 0]
    np.testing.assert_allclose(error_over_horizon(forecast, future, rule)[count > 0], summed, atol=1e-12)


def test_a_perfect_sample_of_weight_zero_is_not_the_best() -> None:
    truth = [[[0.0, 0.0]], [[1.0, 0.0]]]
    off = [[[0.0, 3.0]], [[1.0, 4.0]]]
    for rule in ("person", "scene", "same"):
        errors = person_errors(*scene(truth, [truth, off, truth], [0.0, 1.0, 0.0]), rule)
        assert (errors.ade.tolist(), errors.fde.tolist()) == ([3.5], [4.0])
        assert errors.distance.tolist() == [[3.0, 4.0]]


@pytest.mark.parametrize("weight", [[0.5, 0.6], [1.5, -0.5], [0.0, 0.0], [np.nan, 1.0]])
def test_weights_that_are_no_shares_are_refused(weight: list[float]) -> None:
    truth = [[[0.0, 0.0]]]
    with pytest.raises(
        InputError, match=r"guess: the weights of window 0 start at .*; they must be at least 0 and sum"
    ):
        ade(*scene(truth, [truth, truth], weight))


def test_steps_that_do_not_count_have_no_distance() -> None:
    forecast, future = case(2)
    distance, counted = distances(forecast, future)
    assert np.all(distance[:, 0][~counted] == 0.0)
    assert not counted[:, :, 0].any()


def test_a_row_says_whose_windows_it_belongs_to() -> None:
    forecast, future = case(4)
    assert np.array_equal(person_errors(forecast, future).person, future.id[future.scored])


def test_what_does_not_belong_together_is_refused_in_a_sentence() -> None:
    forecast, future = case(3)
    with pytest.raises(InputError, match="predict the past of the same windows with as many steps"):
        ade(forecast[:2], future)
    with pytest.raises(InputError, match=r"steps of 0\.4 s, the future of 0\.5 s"):
        ade(forecast, Windows(*list(vars(future).values())[:6], 0.5, "all", "test"))
    with pytest.raises(InputError, match="did not predict person"):
        ade(Forecast.of(forecast.position, np.zeros((3, 6), dtype=bool), 0.4, "lazy"), future)
    nobody = np.zeros_like(future.present)
    with pytest.raises(InputError, match="scored but has no future"):
        ade(forecast, Windows(future.position, nobody, *list(vars(future).values())[2:]))
    with pytest.raises(InputError, match="best-of rule 'window' is unknown, it must be one of person, scene, same"):
        person_errors(forecast, future, "window")


def test_a_forecast_says_what_does_not_fit() -> None:
    good = np.zeros((2, 1, 3, 4, 2))
    here = np.ones((2, 4), dtype=bool)
    with pytest.raises(InputError, match=r"forecast of mine: position has shape \[2, 3, 4, 2\], not \[W, K, T, A, 2\]"):
        Forecast(good[:, 0], np.ones((2, 1)), here, 0.4, "mine")
    with pytest.raises(InputError, match=r"weight has shape \[2, 2\], it must be \[2, 1\]"):
        Forecast(good, np.ones((2, 2)), here, 0.4, "mine")
    bad = good.copy()
    bad[1, 0, 2, 3] = np.nan
    with pytest.raises(InputError, match="person 3 of window 1 has a position that is not finite"):
        Forecast(bad, np.ones((2, 1)), here, 0.4, "mine")
