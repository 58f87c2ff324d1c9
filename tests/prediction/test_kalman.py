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
from crowdbot.prediction import ConstantVelocity, Kalman

Maker = Callable[..., Windows]


def slow_filter(rows: list[np.ndarray | None], kalman: Kalman, dt: float) -> tuple[np.ndarray, float]:
    """Textbook filter of one person, state (x, y, vx, vy): the state at the end and the negative log-likelihood."""
    eye = np.eye(2)
    F = np.block([[eye, dt * eye], [0 * eye, eye]])
    Q = kalman.acceleration**2 * np.block([[dt**3 / 3 * eye, dt**2 / 2 * eye], [dt**2 / 2 * eye, dt * eye]])
    H = np.block([eye, 0 * eye])
    R = kalman.measurement**2 * eye
    state, P, surprise = None, None, 0.0
    for row in rows:
        if state is not None:
            state, P = F @ state, F @ P @ F.T + Q
        if row is None:
            continue
        if state is None:
            state, P = np.array([*row, 0.0, 0.0]), np.diag([*np.diag(R), kalman.speed**2, kalman.speed**2])
            continue
        S = H @ P @ H.T + R
        wrong = row - H @ state
        surprise += 0.5 * (wrong @ np.linalg.solve(S, wrong) + math.log(np.linalg.det(2.0 * math.pi * S)))
        gain = P @ H.T @ np.linalg.inv(S)
        state, P = state + gain @ wrong, (np.eye(4) - gain @ H) @ P
    return state, surprise


@pytest.mark.parametrize("holes", [0.0, 0.4])
def test_the_filter_equals_its_matrix_twin(crowd: Maker, holes: float) -> None:
    past = crowd(2, holes=holes)
    kalman = Kalman(acceleration=0.5, measurement=0.2, speed=1.2)
    forecast = kalman.predict(past, 3)
    surprise, rows_after_first = 0.0, 0
    for w, a in np.argwhere(past.present.sum(axis=1) > 1):
        rows = [past.position[w, t, a] if past.present[w, t, a] else None for t in range(8)]
        state, own = slow_filter(rows, kalman, past.dt)
        if not past.robot[w, a]:
            surprise += own
            rows_after_first += sum(row is not None for row in rows) - 1
        if rows[-1] is not None:
            path = [state[:2] + (k + 1) * past.dt * state[2:] for k in range(3)]
            np.testing.assert_allclose(forecast.position[w, 0, :, a], path, atol=1e-9)
    assert kalman.surprise(past) == pytest.approx(surprise / rows_after_first, abs=1e-9)


def walked(windows: Maker, acceleration: float, measurement: float, speed: float, people: int = 4000) -> Windows:
    """People who walk exactly as the filter supposes, in one window."""
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
    assert kalman.surprise(past) <= Kalman(0.4, 0.06, 1.1).surprise(past) + 1e-3


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


def test_smoothing_helps_where_tracks_are_noisy(recorded: Callable[[str], object]) -> None:
    past, _ = recorded("biwi_hotel").windows(observe=8, predict=12, protocol="all")  # type: ignore[attr-defined]
    fitted = Kalman.fit(past)
    assert 0.015 < fitted.measurement < 0.035
    assert fitted.surprise(past) < Kalman().surprise(past)


def test_the_defaults_are_the_fit_that_the_docs_name(recordings: Path) -> None:
    train = [
        recordings / "eth_ucy_splits" / "train" / f"{name}_train.txt" for name in ("crowds_zara03", "uni_examples")
    ]
    drone = [recordings / "sdd_trajnet" / "Train" / "stanford" / f"hyang_{number}.txt" for number in (4, 5, 6, 7)]
    fitted = Kalman.fit(*[load(file, fps=2.5).windows()[0] for file in [*train, *drone]])
    assert fitted.acceleration == pytest.approx(Kalman().acceleration, abs=0.002)
    assert fitted.measurement == pytest.approx(Kalman().measurement, abs=0.0005)
    assert fitted.speed == pytest.approx(Kalman().speed, abs=0.002)


def test_impossible_parameters_and_empty_training_data_are_refused(windows: Maker) -> None:
    with pytest.raises(InputError, match="kalman: measurement = 0 must be finite and above 0"):
        Kalman(measurement=0)
    with pytest.raises(InputError, match="at least one person who is seen at two rows"):
        Kalman.fit(windows(np.zeros((2, 1, 3, 2))))
    with pytest.raises(InputError, match="at least one person who is seen at two rows"):
        Kalman.fit()
