"""Displacement metrics against slow, obvious twins."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import (
    ade,
    best_of,
    collided,
    collision_share,
    distances,
    error_over_horizon,
    fde,
    miss_rate,
    person_errors,
)


def case(seed: int, W: int = 3, K: int = 4, T: int = 5, A: int = 6) -> tuple[Forecast, Windows]:
    """Random forecasts and futures that end early, have holes, padding and a robot."""
    rng = stream(seed, "displacement")
    present = rng.random((W, T, A)) < 0.8
    length = rng.integers(0, T + 1, (W, A))
    present &= np.arange(T)[:, None] < length[:, None]
    robot = np.zeros((W, A), dtype=bool)
    robot[:, 0] = True
    scored = present.any(axis=1) & ~robot & (rng.random((W, A)) < 0.8)
    position = np.where(present[..., None], rng.normal(size=(W, T, A, 2)), 0.0)
    id = np.tile(np.arange(A), (W, 1))
    frame = np.tile(np.arange(T), (W, 1))
    future = Windows(position, present, scored, robot, id, frame, 0.4, "partial", "test")
    guess = rng.normal(size=(W, K, T, A, 2)) * 0.5
    return Forecast.of(guess, np.ones((W, A), dtype=bool), 0.4, "guess"), future


def slow_errors(forecast: Forecast, future: Windows, w: int, k: int, a: int) -> list[tuple[int, float]]:
    """Step and distance of every step that counts, in plain Python."""
    found = []
    for t in range(forecast.steps):
        if future.present[w, t, a] and future.scored[w, a]:
            dx, dy = (forecast.position[w, k, t, a] - future.position[w, t, a]).tolist()
            found.append((t, math.hypot(dx, dy)))
    return found


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
def test_collided_equals_its_slow_twin(seed: int) -> None:
    forecast, future = case(seed)
    fast = collided(forecast, future, 0.4)
    W, K, T, A, _ = forecast.position.shape
    slow = np.zeros((W, K, A), dtype=bool)
    for w, k, t, a, b in np.ndindex(W, K, T, A, A):
        here = future.present[w, t] & future.scored[w]
        if a != b and here[a] and here[b]:
            slow[w, k, a] |= math.dist(forecast.position[w, k, t, a], forecast.position[w, k, t, b]) < 0.4
    assert np.array_equal(fast, slow)
    assert 0 < slow.sum() < slow.size


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


def test_collision_share_counts_people_who_have_company_and_weighs_samples() -> None:
    position = np.array([[[0.0, 0.0], [0.1, 0.0], [9.0, 0.0]], [[0.0, 0.0], [0.3, 0.0], [9.0, 0.0]]])[None, :, None]
    here = np.ones((1, 1, 3), dtype=bool)
    future = Windows(
        position[:, 0], here, here[:, 0], ~here[:, 0], np.array([[1, 2, 3]]), np.array([[0]]), 0.4, "all", "test"
    )
    forecast = Forecast(position, np.array([[0.75, 0.25]]), here[:, 0], 0.4, "two")
    assert collision_share(forecast, future) == pytest.approx(2 / 3 * 0.75)
    alone = Windows(
        position[:, 0], here, np.array([[True, False, False]]), ~here[:, 0], future.id, future.frame, 0.4, "all", "test"
    )
    assert math.isnan(collision_share(forecast, alone))


def test_miss_rate_counts_people_beyond_the_limit() -> None:
    assert miss_rate(np.array([[0.5, 2.5, np.nan], [2.0, 9.0, np.nan]])) == 0.5
    assert miss_rate(np.array([0.5, 2.5]), limit=0.4) == 1.0
    assert math.isnan(miss_rate(np.array([np.nan])))


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), angle=st.floats(-4, 4), shift=st.floats(-100, 100))
def test_turning_and_shifting_the_world_changes_no_error(seed: int, angle: float, shift: float) -> None:
    forecast, future = case(seed)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    moved = Forecast.of(forecast.position @ turn + shift, forecast.valid, 0.4, "guess")
    there = Windows(
        future.position @ turn + shift,
        future.present,
        future.scored,
        future.robot,
        future.id,
        future.frame,
        0.4,
        "",
        "",
    )
    np.testing.assert_allclose(ade(moved, there), ade(forecast, future), atol=1e-9)
    np.testing.assert_allclose(fde(moved, there), fde(forecast, future), atol=1e-9)


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


def test_steps_that_do_not_count_have_no_distance() -> None:
    forecast, future = case(2)
    distance, counted = distances(forecast, future)
    assert np.all(distance[:, 0][~counted] == 0.0)
    assert not counted[:, :, 0].any()


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
