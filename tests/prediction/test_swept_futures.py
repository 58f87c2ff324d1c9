"""Collisions between the rows of a forecast: counted, and kept apart by the sum of radii."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from crowdbot.core import stream
from crowdbot.data import Forecast, Trajectories, Windows
from crowdbot.metrics import collision_share, swept_collision_shares
from crowdbot.prediction import AnchorNet, ConstantVelocity
from crowdbot.prediction.joint_kernels import separate_paths

Maker = Callable[..., Windows]


def gap(one: np.ndarray, other: np.ndarray) -> float:
    """Return the smallest distance of two paths ``[T, 2]`` that are straight between rows."""
    fine = np.linspace(0.0, len(one) - 1.0, 4001)
    away = [np.interp(fine, np.arange(len(one)), (one - other)[:, axis]) for axis in (0, 1)]
    return float(np.hypot(*away).min())


def test_people_who_pass_through_each_other_between_rows_collide() -> None:
    track = np.array([[[0.0, 0.0], [1.0, 0.05]], [[1.0, 0.0], [0.0, 0.05]]])
    tracks = Trajectories(
        np.tile([1, 2], 2), np.repeat([0, 10], 2), track[..., 0].ravel(), track[..., 1].ravel(), row_rate=2.5
    )
    past, future = tracks.windows(observe=1, predict=1)
    forecast = ConstantVelocity().predict(past, 1)
    swapped = Forecast.of(future.position[:, None], past.present[:, -1], 0.4, "true")
    assert swept_collision_shares(swapped, past, future) == (1.0, 1.0)
    assert collision_share(swapped, future) == 0.0
    assert swept_collision_shares(forecast, past, future) == (0.0, 1.0)
    assert swept_collision_shares(swapped, past, future, 0.04) == (0.0, 0.0)


@pytest.mark.parametrize("limit", [0.25, 0.4, 0.6])
def test_paths_are_apart_by_the_sum_of_radii_between_rows_too(limit: float) -> None:
    for seed in range(20):
        rng = stream(seed, "swept")
        speed = rng.normal(0.0, 0.5, (2, 1, 2)) + rng.normal(0.0, 0.05, (2, 12, 2))
        start = np.array([[[-1.5, 0.0]], [[1.5, 0.0]]])
        path = start + np.cumsum(speed - 0.15 * np.sign(start), axis=1)
        assert gap(*separate_paths(path, np.zeros(2, dtype=bool), np.full(2, 0.5 * limit), 12)) > 0.98 * limit


def test_futures_of_one_draw_collide_less_than_those_of_single_people(
    recorded: Callable[[str], Trajectories],
) -> None:
    past, future = recorded("crowds_zara02").windows()
    past, future = past[::40], future[::40]
    found = {
        contact: swept_collision_shares(AnchorNet("zara2", contact=contact).predict(past, 12, 20), past, future, 0.4)
        for contact in (0.0, 0.25, 0.4)
    }
    assert found[0.4][0] < 0.3 * found[0.25][0] < 0.3 * found[0.0][0]
    assert found[0.0][1] == found[0.4][1]
