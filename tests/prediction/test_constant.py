"""Constant velocity and acceleration against slow, obvious twins; the sampler against its own distribution."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.data import Windows
from crowdbot.prediction import ConstantAcceleration, ConstantVelocity, LeastSquares, SampledConstantVelocity

Maker = Callable[..., Windows]


def slow_velocity(rows: list[np.ndarray | None], displacements: int) -> np.ndarray:
    """Mean displacement per row of one person up to the last row, on the track with straight bridges over holes."""
    now = len(rows) - 1
    seen = [row for row in range(len(rows)) if rows[row] is not None]
    since = max(seen[0], now - displacements)
    if since == now:
        return np.zeros(2)
    start = [np.interp(since, seen, [rows[row][axis] for row in seen]) for axis in (0, 1)]
    return (rows[now] - start) / (now - since)


def slow_acceleration(rows: list[np.ndarray | None], steps: int) -> list[np.ndarray]:
    seen = [row for row in range(len(rows)) if rows[row] is not None][-3:]
    velocity, change = np.zeros(2), np.zeros(2)
    if len(seen) >= 2:
        velocity = (rows[seen[-1]] - rows[seen[-2]]) / (seen[-1] - seen[-2])
    if len(seen) == 3:
        earlier = (rows[seen[1]] - rows[seen[0]]) / (seen[1] - seen[0])
        change = (velocity - earlier) / ((seen[2] - seen[0]) / 2)
    place, path = rows[-1], []
    for _ in range(steps):
        velocity = velocity + change
        place = place + velocity
        path.append(place)
    return path


def people(past: Windows) -> list[tuple[int, int, list[np.ndarray | None]]]:
    return [
        (w, a, [past.position[w, t, a] if past.present[w, t, a] else None for t in range(past.present.shape[1])])
        for w, a in np.argwhere(past.present[:, -1])
    ]


@pytest.mark.parametrize("holes", [0.0, 0.3, 0.7])
@pytest.mark.parametrize("displacements", [1, 2, 7, 50])
def test_constant_velocity_equals_its_slow_twin(crowd: Maker, displacements: int, holes: float) -> None:
    past = crowd(displacements, holes=holes)
    forecast = ConstantVelocity(displacements).predict(past, 5)
    for w, a, rows in people(past):
        path = [rows[-1] + (k + 1) * slow_velocity(rows, displacements) for k in range(5)]
        np.testing.assert_allclose(forecast.position[w, 0, :, a], path, atol=1e-12)


@pytest.mark.parametrize("holes", [0.0, 0.3, 0.7])
def test_constant_acceleration_equals_its_slow_twin(crowd: Maker, holes: float) -> None:
    past = crowd(1, holes=holes)
    forecast = ConstantAcceleration().predict(past, 5)
    for w, a, rows in people(past):
        np.testing.assert_allclose(forecast.position[w, 0, :, a], slow_acceleration(rows, 5), atol=1e-10)


@pytest.mark.parametrize("anchored", [False, True])
@pytest.mark.parametrize("holes", [0.0, 0.3, 0.7])
def test_least_squares_equals_its_slow_twin(crowd: Maker, holes: float, anchored: bool) -> None:
    past = crowd(1, holes=holes)
    forecast = LeastSquares(anchored).predict(past, 5)
    for w, a, rows in people(past):
        seen = [row for row in range(len(rows)) if rows[row] is not None]
        place = np.array([rows[row] for row in seen])
        if len(seen) == 1:
            path = np.repeat(place, 5, axis=0)
        else:
            slope, start = np.polyfit(seen, place, 1)
            now = place[-1] if anchored else start + 7 * slope
            path = now + np.arange(1, 6)[:, None] * slope
        np.testing.assert_allclose(forecast.position[w, 0, :, a], path, atol=1e-10)


def test_all_displacements_are_the_mean_over_the_track(windows: Maker) -> None:
    path = stream(3, "path").normal(size=(8, 2))
    past = windows(path[None, :, None])
    every = ConstantVelocity(7).predict(past, 3).position[0, 0, :, 0]
    np.testing.assert_allclose(every, path[-1] + np.arange(1, 4)[:, None] * (path[-1] - path[0]) / 7, atol=1e-12)
    assert np.array_equal(ConstantVelocity(10_000).predict(past, 3).position[0, 0, :, 0], every)


@pytest.mark.parametrize("predictor", [ConstantVelocity(), ConstantVelocity(7), LeastSquares(), LeastSquares(True)])
def test_who_walks_straight_and_evenly_goes_on_with_missing_rows_too(windows: Maker, predictor: object) -> None:
    path = 1e4 + np.arange(20.0)[:, None] * [0.5, -0.2]
    past = path[None, :8, None].copy()
    past[0, [0, 3, 4]] = np.nan
    forecast = predictor.predict(windows(past), 12)  # type: ignore[attr-defined]
    np.testing.assert_allclose(forecast.position[0, 0, :, 0], path[8:], atol=1e-9)


def test_two_points_make_a_line(windows: Maker) -> None:
    past = np.full((1, 8, 1, 2), np.nan)
    past[0, 5, 0], past[0, 7, 0] = [1.0, 1.0], [2.0, 3.0]
    for anchored in (False, True):
        forecast = LeastSquares(anchored).predict(windows(past), 2)
        np.testing.assert_allclose(forecast.position[0, 0, :, 0], [[2.5, 4.0], [3.0, 5.0]], atol=1e-12)


def test_a_parabola_is_continued(windows: Maker) -> None:
    time = np.arange(12.0)
    path = np.stack([time, time**2 / 10.0], axis=1)
    forecast = ConstantAcceleration().predict(windows(path[None, :8, None]), 4)
    np.testing.assert_allclose(forecast.position[0, 0, :, 0], path[8:], atol=1e-9)


def test_samples_turn_and_change_speed_as_told(windows: Maker) -> None:
    past = windows([[[[0.0, 0.0]], [[1.0, 0.0]]]])
    forecast = SampledConstantVelocity().predict(past, 2, 20_000, stream(3))
    step = forecast.position[0, :, 0, 0] - [1.0, 0.0]
    length, angle = np.hypot(*step.T), np.arctan2(step[:, 1], step[:, 0])
    assert np.std(angle) == pytest.approx(math.radians(25.0), rel=0.03)
    assert (np.mean(length), np.std(length)) == (pytest.approx(1.0, abs=0.01), pytest.approx(0.3, rel=0.03))
    np.testing.assert_allclose(forecast.position[0, :, 1, 0] - [1.0, 0.0], 2.0 * step, atol=1e-12)


def test_parameters_show_in_the_name() -> None:
    assert ConstantVelocity(2).name == "constant-velocity(displacements=2)"
    assert LeastSquares(anchored=True).name == "least-squares(anchored=True)"
    assert SampledConstantVelocity(speed_sd=0.0).name == "sampled-constant-velocity(speed_sd=0)"


def test_impossible_parameters_are_refused() -> None:
    with pytest.raises(InputError, match="displacements = 0 must be at least 1"):
        ConstantVelocity(0)
    with pytest.raises(InputError, match=r"heading_sd = -0\.1 must be finite and at least 0"):
        SampledConstantVelocity(heading_sd=-0.1)
    with pytest.raises(InputError, match="speed_sd = inf"):
        SampledConstantVelocity(speed_sd=math.inf)


def test_the_speed_factor_is_clipped_at_zero(crowd: Maker) -> None:
    """With a large spread almost half of the factors would be negative: nobody may walk backwards."""
    past = crowd(3, holes=0.0)
    forecast = SampledConstantVelocity(heading_sd=0.0, speed_sd=5.0).predict(past, 3, 200, stream(1))
    straight = ConstantVelocity().predict(past, 1)
    here = past.present[:, -1]
    now = past.position[:, -1]
    step = straight.position[:, 0, 0] - now
    moved = forecast.position[:, :, 0] - now[:, None]
    factor = ((moved * step[:, None]).sum(-1) / np.maximum((step**2).sum(-1), 1e-12)[:, None])[
        np.broadcast_to((here & ((step**2).sum(-1) > 1e-6))[:, None], moved.shape[:-1])
    ]
    assert factor.min() >= -1e-9
    assert 0.3 < np.mean(np.abs(factor) < 1e-9) < 0.55  # P(1 + 5 z < 0) = 0.42
    assert factor.max() > 5.0
