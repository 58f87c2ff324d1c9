"""Collisions between the rows of a forecast: counted, and kept apart by the sum of radii."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Trajectories, Windows
from crowdbot.evaluation import score_predictor
from crowdbot.metrics import collision_share, swept_collisions
from crowdbot.prediction import AnchorNet, ConstantVelocity
from crowdbot.prediction.joint_kernels import separate_paths

Maker = Callable[..., Windows]


def gap(one: np.ndarray, other: np.ndarray) -> float:
    """Return the smallest distance of two paths ``[T, 2]`` that are straight between rows."""
    fine = np.linspace(0.0, len(one) - 1.0, 4001)
    away = [np.interp(fine, np.arange(len(one)), (one - other)[:, axis]) for axis in (0, 1)]
    return float(np.hypot(*away).min())


def shares(forecast: Forecast, past: Windows, future: Windows, limit: float = 0.2) -> tuple[float, ...]:
    """Return the mean share of swept collisions of the forecast, and of the truth."""
    return tuple(float(np.nanmean(each)) for each in swept_collisions(forecast, past, future, limit))


def test_people_who_pass_through_each_other_between_rows_collide() -> None:
    track = np.array([[[0.0, 0.0], [1.0, 0.05]], [[1.0, 0.0], [0.0, 0.05]]])
    tracks = Trajectories(
        np.tile([1, 2], 2), np.repeat([0, 10], 2), track[..., 0].ravel(), track[..., 1].ravel(), row_rate=2.5
    )
    past, future = tracks.windows(observe=1, predict=1)
    forecast = ConstantVelocity().predict(past, 1)
    swapped = Forecast.of(future.position[:, None], past.present[:, -1], 0.4, "true")
    assert shares(swapped, past, future) == (1.0, 1.0)
    assert collision_share(swapped, future) == 0.0
    assert shares(forecast, past, future) == (0.0, 1.0)
    assert shares(swapped, past, future, 0.04) == (0.0, 0.0)


def test_bodies_collide_by_their_radii_where_they_are_known() -> None:
    x = np.tile([0.0, 0.5, 9.0], 2)
    tracks = Trajectories(np.tile([1, 2, 3], 2), np.repeat([0, 10], 3), x, np.zeros(6), row_rate=2.5)
    past, future = tracks.windows(observe=1, predict=1)
    stand = ConstantVelocity().predict(past, 1)
    assert swept_collisions(stand, past, future, None)[0].tolist() == [[0.0, 0.0, 0.0]]  # 0.2 m each
    wide = dataclasses.replace(past, radius=np.array([[0.25, 0.3, np.nan]]))
    assert swept_collisions(stand, wide, future, None)[0].tolist() == [[1.0, 1.0, 0.0]]
    total = score_predictor(ConstantVelocity(), wide, future)
    assert (total.swept_collisions, total.swept_contacts, total.swept_contacts_truth) == (0.0, 2.0 / 3.0, 2.0 / 3.0)


def test_swept_collisions_need_the_past_of_the_same_people() -> None:
    here = np.ones((1, 1, 2), dtype=bool)
    future = Windows(
        np.zeros((1, 1, 2, 2)), here, here[:, 0], ~here[:, 0], np.array([[1, 2]]), np.array([[1]]), 0.4, "all", "street"
    )
    other = dataclasses.replace(future, id=np.array([[1, 3]]))
    with pytest.raises(InputError, match="past and future of street have different people"):
        swept_collisions(Forecast.of(np.zeros((1, 1, 1, 2, 2)), here[:, 0], 0.4, "me"), other, future)


@pytest.mark.parametrize("limit", [0.25, 0.4, 0.6])
def test_paths_are_apart_by_the_sum_of_radii_between_rows_too(limit: float) -> None:
    for seed in range(20):
        rng = stream(seed, "swept")
        speed = rng.normal(0.0, 0.5, (2, 1, 2)) + rng.normal(0.0, 0.05, (2, 12, 2))
        start = np.array([[[-1.5, 0.0]], [[1.5, 0.0]]])
        path = start + np.cumsum(speed - 0.15 * np.sign(start), axis=1)
        assert gap(*separate_paths(path, np.ones(2, dtype=np.int64), np.full(2, 0.5 * limit), 12)) > 0.98 * limit


def test_futures_of_one_draw_collide_less_than_those_of_single_people(
    recorded: Callable[[str], Trajectories],
) -> None:
    past, future = recorded("crowds_zara02").windows()
    past, future = past[::40], future[::40]
    found = {
        contact: shares(AnchorNet("zara2", contact=contact).predict(past, 12, 20), past, future, 0.4)
        for contact in (0.0, 0.25, 0.4)
    }
    assert found[0.4][0] < 0.3 * found[0.25][0] < 0.3 * found[0.0][0]
    assert found[0.0][1] == found[0.4][1]


@pytest.mark.parametrize("samples", [1, 20])
def test_a_robot_without_a_plan_gives_way_and_one_with_a_plan_does_not(samples: int, windows: Maker) -> None:
    time = 0.4 * np.arange(-7.0, 1.0)
    sway = 0.01 * np.sin(1.7 * np.arange(8.0))
    tracks = np.stack([np.stack([1.2 * time - 3.0, sway], 1), np.stack([3.0 - 1.2 * time, 0.05 + 0.0 * sway], 1)], 1)
    past = windows(tracks[None], robot=[[False, True]])
    alone = AnchorNet("open", contact=0.0).predict(past, 12, samples).position
    free = AnchorNet("open").predict(past, 12, samples).position
    if samples == 1:
        np.testing.assert_array_equal(free[..., 0, :], alone[..., 0, :])
        assert np.abs(free - alone).max() > 0.1
    assert min(gap(item[:, 0], item[:, 1]) for item in free[0]) > 0.24
    ahead = np.stack([np.full((12, 2), np.nan), [3.0, 0.05] - np.arange(1.0, 13.0)[:, None] * [0.48, 0.0]], 1)[None]
    planned = AnchorNet("open", reaction="none").predict(dataclasses.replace(past, plan=ahead), 12, samples).position
    np.testing.assert_array_equal(planned[0, :, :, 1], np.repeat(ahead[:, :, 1], len(planned[0]), axis=0))
    assert min(gap(item[:, 0], item[:, 1]) for item in planned[0]) > 0.24


@pytest.mark.parametrize(("speed", "noise", "steady"), [(0.0, 0.0, True), (1.2, 0.0, True), (1.2, 0.01, False)])
def test_people_with_equal_displacements_are_predicted_with_constant_velocity(
    speed: float, noise: float, steady: bool, windows: Maker
) -> None:
    bend = np.array([[-3.0, 0.3], [-2.3, 0.2], [-1.6, 0.1], [-1.0, 0.0]])
    late = np.stack([speed * 0.4 * np.arange(4.0), np.zeros(4)], 1)
    track = np.concatenate([bend, late]) + noise * stream(0, "steady").standard_normal((8, 2))
    past = windows(track[None, :, None])
    answer, line = AnchorNet("open").predict(past, 12).position, ConstantVelocity().predict(past, 12).position
    assert np.allclose(answer, line, atol=1e-9) == steady
    hidden = dataclasses.replace(past, present=past.present & (np.arange(8) != 6)[None, :, None])
    unseen = AnchorNet("open").predict(hidden, 12).position
    assert not np.allclose(unseen, ConstantVelocity().predict(hidden, 12).position, atol=1e-9)
