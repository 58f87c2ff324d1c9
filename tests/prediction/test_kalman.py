"""The Kalman filter against a matrix twin, and its fit against noise that is known."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.data import Windows, load
from crowdbot.prediction import ConstantAcceleration, ConstantVelocity, Kalman, KalmanAcceleration

Maker = Callable[..., Windows]


def slow_filter(
    rows: list[np.ndarray | None], kalman: Kalman | KalmanAcceleration, dt: float
) -> tuple[np.ndarray, float]:
    """Textbook filter of one person, state (x, y, vx, vy[, ax, ay]): the state at the end and the surprise [nat]."""
    state, _, surprise, _, _ = slow_states(rows, kalman, dt)
    return state, surprise


def slow_states(rows: list[np.ndarray | None], kalman: Kalman | KalmanAcceleration, dt: float) -> tuple:
    """The same with the covariance, and the matrices of one row."""
    eye, r = np.eye(2), kalman.measurement**2
    if isinstance(kalman, Kalman):
        step = np.array([[1, dt], [0, 1]])
        push = kalman.acceleration**2 * np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]])
        begin = [r, kalman.speed**2]
    else:
        step = np.array([[1, dt, dt**2 / 2], [0, 1, dt], [0, 0, 1]])
        push = kalman.jerk**2 * np.array(
            [[dt**5 / 20, dt**4 / 8, dt**3 / 6], [dt**4 / 8, dt**3 / 3, dt**2 / 2], [dt**3 / 6, dt**2 / 2, dt]]
        )
        begin = [r, kalman.speed**2, kalman.acceleration**2]
    n = len(begin)
    F, Q, H = np.kron(step, eye), np.kron(push, eye), np.kron(np.eye(n)[:1], eye)
    state, P, negative_log_likelihood = None, None, 0.0
    for row in rows:
        if state is not None:
            state, P = F @ state, F @ P @ F.T + Q
        if row is None:
            continue
        if state is None:
            state, P = np.concatenate([row, np.zeros(2 * n - 2)]), np.kron(np.diag(begin), eye)
            continue
        S = H @ P @ H.T + r * eye
        wrong = row - H @ state
        negative_log_likelihood += 0.5 * (
            wrong @ np.linalg.solve(S, wrong) + math.log(np.linalg.det(2.0 * math.pi * S))
        )
        gain = P @ H.T @ np.linalg.inv(S)
        state, P = state + gain @ wrong, (np.eye(2 * n) - gain @ H) @ P
    return state, P, negative_log_likelihood, F, Q


FILTERS = pytest.mark.parametrize(
    "kalman",
    [Kalman(acceleration=0.5, measurement=0.2, speed=1.2), KalmanAcceleration(0.4, 0.2, 1.2, 0.7)],
    ids=["velocity", "acceleration"],
)


@FILTERS
@pytest.mark.parametrize("holes", [0.0, 0.4, 0.8])
def test_the_filter_equals_its_matrix_twin(crowd: Maker, holes: float, kalman: Kalman | KalmanAcceleration) -> None:
    past = crowd(2, holes=holes)
    forecast = kalman.predict(past, 3)
    negative_log_likelihood, rows_after_first = 0.0, 0
    for w, a in np.argwhere(past.present.any(axis=1)):
        rows = [past.position[w, t, a] if past.present[w, t, a] else None for t in range(8)]
        state, own = slow_filter(rows, kalman, past.dt)
        if not past.robot[w, a]:
            negative_log_likelihood += own
            rows_after_first += sum(row is not None for row in rows) - 1
        if rows[-1] is not None:
            motion = np.zeros((3, 2))
            motion[: len(state) // 2] = state.reshape(-1, 2)
            time = [(k + 1) * past.dt for k in range(3)]
            path = [motion[0] + motion[1] * t + motion[2] * t**2 / 2 for t in time]
            np.testing.assert_allclose(forecast.position[w, 0, :, a], path, atol=1e-9)
    assert kalman.negative_log_likelihood(past) == pytest.approx(negative_log_likelihood / rows_after_first, abs=1e-9)


def walked(windows: Maker, acceleration: float, measurement: float, speed: float, people: int = 4000) -> Windows:
    """People who walk exactly as the filter of constant velocity supposes, in one window."""
    rng = stream(8, "walk")
    dt, T = 0.4, 8
    Q = acceleration**2 * np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]])
    root = np.linalg.cholesky(Q)
    place, velocity = np.zeros((people, 2)), rng.normal(0.0, speed, (people, 2))
    rows = []
    for _ in range(T):
        rows.append(place + rng.normal(0.0, measurement, place.shape))
        kick = rng.normal(size=(people, 2, 2)) @ root.T
        place, velocity = place + velocity * dt + kick[..., 0], velocity + kick[..., 1]
    return windows(np.stack(rows)[None])


def test_the_fit_finds_the_noise_that_was_put_in(windows: Maker) -> None:
    past = walked(windows, acceleration=0.4, measurement=0.06, speed=1.1)
    kalman = Kalman.fit(past)
    assert kalman.acceleration == pytest.approx(0.4, rel=0.05)
    assert kalman.measurement == pytest.approx(0.06, rel=0.05)
    assert kalman.speed == pytest.approx(1.1, rel=0.05)
    assert kalman.negative_log_likelihood(past) <= Kalman(0.4, 0.06, 1.1).negative_log_likelihood(past) + 1e-3


def test_the_fit_of_the_other_filter_finds_its_noise(windows: Maker) -> None:
    rng, dt, people = stream(9, "walk"), 0.4, 1500
    true = KalmanAcceleration(jerk=0.5, measurement=0.05, speed=1.1, acceleration=0.6)
    motion = rng.normal(size=(3, people, 2)) * np.array([0.0, true.speed, true.acceleration])[:, None, None]
    step = np.array([[1, dt, dt**2 / 2], [0, 1, dt], [0, 0, 1]])
    push = np.array([[dt**5 / 20, dt**4 / 8, dt**3 / 6], [dt**4 / 8, dt**3 / 3, dt**2 / 2], [dt**3 / 6, dt**2 / 2, dt]])
    rows = []
    for _ in range(8):
        rows.append(motion[0] + rng.normal(0.0, true.measurement, (people, 2)))
        kick = np.linalg.cholesky(true.jerk**2 * push) @ rng.normal(size=(3, 2 * people))
        motion = np.tensordot(step, motion, 1) + kick.reshape(3, people, 2)
    past = windows(np.stack(rows)[None])
    fitted = KalmanAcceleration.fit(past)
    for name in ("jerk", "measurement", "speed", "acceleration"):
        assert getattr(fitted, name) == pytest.approx(getattr(true, name), rel=0.1), name
    assert fitted.negative_log_likelihood(past) <= true.negative_log_likelihood(past) + 1e-6
    assert fitted.negative_log_likelihood(past) < Kalman.fit(past).negative_log_likelihood(past)


def test_without_noise_the_other_filter_is_constant_acceleration(windows: Maker) -> None:
    time = np.arange(12.0)
    path = np.stack([0.5 * time + 0.03 * time**2, 4.0 - 0.02 * time**2], axis=1)
    past = windows(path[None, :8, None])
    exact = KalmanAcceleration(jerk=1e-4, measurement=1e-4, speed=10.0, acceleration=10.0).predict(past, 4)
    np.testing.assert_allclose(exact.position[0, 0, :, 0], path[8:], atol=1e-3)
    np.testing.assert_allclose(exact.position, ConstantAcceleration().predict(past, 4).position, atol=1e-3)


def test_without_measurement_noise_and_push_it_is_constant_velocity(windows: Maker, crowd: Maker) -> None:
    straight = windows(np.arange(8.0)[None, :, None, None] * np.array([[0.5, 0.1], [-0.3, 0.2]]))
    exact = Kalman(acceleration=1e-4, measurement=1e-4, speed=10.0).predict(straight, 12)
    np.testing.assert_allclose(exact.position, ConstantVelocity().predict(straight, 12).position, atol=1e-4)


def test_a_slower_clock_with_slower_noise_changes_no_place(crowd: Maker) -> None:
    past = crowd(5, holes=0.2)
    slow = dataclasses.replace(past, dt=4.0 * past.dt)
    one = Kalman(0.5, 0.1, 1.0).predict(past, 12)
    other = Kalman(0.5 / 8.0, 0.1, 0.25).predict(slow, 12)  # lengths keep, times grow fourfold: m s^-1.5 and m/s
    np.testing.assert_allclose(other.position, one.position, atol=1e-9)
    one = KalmanAcceleration(0.5, 0.1, 1.0, 0.4).predict(past, 12)
    other = KalmanAcceleration(0.5 / 32.0, 0.1, 0.25, 0.4 / 16.0).predict(slow, 12)  # m s^-2.5
    np.testing.assert_allclose(other.position, one.position, atol=1e-9)


def test_smoothing_helps_where_tracks_are_noisy(recorded: Callable[[str], object]) -> None:
    past, _ = recorded("biwi_hotel").windows(observe=8, predict=12, protocol="all")  # type: ignore[attr-defined]
    fitted = Kalman.fit(past)
    assert 0.015 < fitted.measurement < 0.035
    assert fitted.negative_log_likelihood(past) < Kalman().negative_log_likelihood(past)


@pytest.fixture(scope="module")
def training(recordings: Path) -> list[Windows]:
    """Windows of the six recordings that the documentation names."""
    train = [
        recordings / "eth_ucy_splits" / "train" / f"{name}_train.txt" for name in ("crowds_zara03", "uni_examples")
    ]
    drone = [recordings / "sdd_trajnet" / "Train" / "stanford" / f"hyang_{number}.txt" for number in (4, 5, 6, 7)]
    return [load(file).windows()[0] for file in [*train, *drone]]


def test_the_defaults_are_the_fit_that_the_docs_name(training: list[Windows]) -> None:
    fitted = Kalman.fit(*training)
    assert fitted.acceleration == pytest.approx(Kalman().acceleration, abs=0.002)
    assert fitted.measurement == pytest.approx(Kalman().measurement, abs=0.0005)
    assert fitted.speed == pytest.approx(Kalman().speed, abs=0.002)


def test_the_defaults_of_the_other_filter_are_the_most_likely_ones(training: list[Windows]) -> None:
    best = KalmanAcceleration()
    cost = best.negative_log_likelihood(*training)
    for name in ("jerk", "measurement", "speed"):
        for ratio in (1.03, 1.0 / 1.03):
            other = dataclasses.replace(best, **{name: getattr(best, name) * ratio})
            assert other.negative_log_likelihood(*training) > cost, name
    assert dataclasses.replace(best, acceleration=0.05).negative_log_likelihood(*training) > cost
    assert cost == pytest.approx(-1.374, abs=1e-3)
    assert Kalman().negative_log_likelihood(*training) == pytest.approx(-1.482, abs=1e-3)


def test_impossible_parameters_and_empty_training_data_are_refused(windows: Maker) -> None:
    with pytest.raises(InputError, match="kalman: measurement = 0 must be finite and above 0"):
        Kalman(measurement=0)
    with pytest.raises(InputError, match="kalman-acceleration: jerk = inf must be finite and above 0"):
        KalmanAcceleration(jerk=math.inf)
    with pytest.raises(InputError, match="at least one person who is observed at two rows"):
        Kalman.fit(windows(np.zeros((2, 1, 3, 2))))
    with pytest.raises(InputError, match="at least one person who is observed at two rows"):
        Kalman.fit()


@FILTERS
def test_the_forecast_carries_the_covariance_of_the_matrix_twin(
    crowd: Maker, kalman: Kalman | KalmanAcceleration
) -> None:
    past = crowd(2, holes=0.4)
    covariance = kalman.predict(past, 3).covariance
    assert covariance is not None
    assert covariance.shape == (len(past), 3, past.present.shape[2], 2, 2)
    checked = 0
    for w, a in np.argwhere(past.present[:, -1]):
        rows = [past.position[w, t, a] if past.present[w, t, a] else None for t in range(8)]
        _, P, _, F, Q = slow_states(rows, kalman, past.dt)
        for step in range(3):
            P = F @ P @ F.T + Q
            np.testing.assert_allclose(covariance[w, step, a], P[:2, :2], atol=1e-9)
            checked += 1
    assert checked > 10
    assert not covariance[~np.broadcast_to(past.present[:, None, -1], covariance.shape[:3])].any()


def test_a_robot_with_a_plan_has_no_uncertainty(windows: Maker) -> None:
    track = np.stack([np.arange(8.0), np.zeros(8)], axis=-1)[None, :, None]
    planned = windows(track, robot=True).with_plans({0: [[8.0, 0.0], [9.0, 0.0]]})
    covariance = Kalman().predict(planned, 2).covariance
    assert covariance is not None
    assert not covariance.any()


def test_the_covariance_of_some_windows_goes_with_them(crowd: Maker) -> None:
    forecast = Kalman().predict(crowd(2), 3)
    assert forecast.covariance is not None
    np.testing.assert_array_equal(forecast[1:3].covariance, forecast.covariance[1:3])
    with pytest.raises(InputError, match=r"covariance has shape \[1\], it must be \[4, 3, 7, 2, 2\]"):
        dataclasses.replace(forecast, covariance=np.zeros(1))
