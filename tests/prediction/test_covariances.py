"""Covariances of forecasts: of a mixture of futures, of a tracker, and their calibration."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Trajectories, Windows, resample_rows, slice_rows
from crowdbot.metrics import region_coverage, region_levels
from crowdbot.prediction import AnchorNet, ConstantVelocity, Kalman, Live
from crowdbot.prediction.anchor_net.mixture import EARLY_WIDTH, WIDTH
from crowdbot.prediction.pretrained_weights import find_weights

Maker = Callable[..., Windows]


def test_mixture_of_anchor_net_is_that_of_its_draws(crowd: Maker) -> None:
    past = crowd(seed=3)
    net, here = AnchorNet(contact=0.0), past.present[:, -1]
    forecast = net.predict(past, 12, 20)
    weight, mean, covariance = forecast.mixture()
    np.testing.assert_allclose(weight.sum(axis=1)[here], 1.0)
    middle = net.predict(past, 12).position[:, 0]
    drawn = dataclasses.replace(net, sample="draws").predict(past, 12, 4000, stream(5)).position
    for step in (0, 5, 11):
        width = WIDTH + EARLY_WIDTH / (step + 1.0)
        own = np.einsum("wka,wkaij->waij", weight, covariance[:, :, step]) / width**2  # the draws are not widened
        away = mean[:, :, step] - middle[:, None, step]
        own += np.einsum("wka,wkai,wkaj->waij", weight, away, away)
        far = drawn[:, :, step] - middle[:, None, step]
        found = np.einsum("wkai,wkaj->waij", far, far) / 4000
        np.testing.assert_allclose(own[here], found[here], rtol=0.0, atol=0.12 * found[here].max())
    assert np.all(covariance.swapaxes(1, 3)[:, :, :, 0][~here] == 0.0)


def test_covariance_is_that_of_the_mixture_around_the_single_trajectory(crowd: Maker) -> None:
    past = crowd(seed=3)
    net, here = AnchorNet(contact=0.0), past.present[:, -1]
    alone, forecast = net.predict(past, 12), net.predict(past, 12, 20)
    assert alone.covariance is not None
    weight, mean, covariance = forecast.mixture()
    away = mean - alone.position
    whole = np.einsum("wka,wktaij->wtaij", weight, covariance + away[..., :, None] * away[..., None, :])
    np.testing.assert_allclose(alone.covariance.swapaxes(1, 2)[here], whole.swapaxes(1, 2)[here], atol=1e-9)
    np.testing.assert_array_equal(alone.covariance, forecast.covariance)
    assert alone.mixture().covariance.shape == (len(past), 1, 12, past.present.shape[2], 2, 2)


def test_levels_of_drawn_truths_are_evenly_distributed() -> None:
    rng = stream(1, "levels")
    weight, mean = np.array([0.6, 0.3, 0.1]), np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 9.0]])
    shape = np.array([[[0.5, 0.2], [0.2, 0.3]], np.eye(2), 0.1 * np.eye(2)])
    which = rng.choice(3, 4000, p=weight)
    truth = mean[which] + np.einsum("nij,nj->ni", np.linalg.cholesky(shape)[which], rng.standard_normal((4000, 2)))
    level = region_levels(*(np.broadcast_to(part, (4000, *part.shape)) for part in (weight, mean, shape)), truth)
    for share in (0.2, 0.5, 0.8, 0.95):
        assert np.mean(level <= share) == pytest.approx(share, abs=0.03)
    flat = region_levels(np.ones((1, 1)), np.zeros((1, 1, 2)), np.zeros((1, 1, 2, 2)), np.zeros((1, 2)))
    assert flat.tolist() == [1.0]


@pytest.mark.parametrize("samples", [1, 20])
def test_covariances_turn_with_the_world_and_grow(crowd: Maker, samples: int) -> None:
    past = crowd(seed=4)
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    turned = dataclasses.replace(past, position=past.position @ turn.T)
    one = AnchorNet().predict(past, 20, samples).covariance
    other = AnchorNet().predict(turned, 20, samples).covariance
    assert one is not None
    assert other is not None
    np.testing.assert_allclose(other, turn @ one @ turn.T, atol=1e-9)
    assert np.linalg.eigvalsh(one).min() > -1e-12
    size = np.trace(one, axis1=-2, axis2=-1)[past.present[:, -1][:, None].repeat(20, axis=1)].reshape(-1)
    spread = np.trace(one, axis1=-2, axis2=-1)
    here = past.present[:, -1]
    assert np.all(spread[:, 19][here] > spread[:, 11][here])  # beyond the horizon of the training, too
    assert size.min() > 0.0


def test_people_seen_once_have_an_unknown_velocity(windows: Maker) -> None:
    past = windows(np.array([[[[1.0, 2.0]]]]))
    covariance = AnchorNet().predict(past, 3).covariance
    assert covariance is not None
    filtered = Kalman().predict(past, 3).covariance
    np.testing.assert_array_equal(covariance, filtered)
    assert covariance[0, 2, 0, 0, 0] > 0.9


NOISE = np.array([[[0.04, 0.01], [0.01, 0.02]], [[0.5, 0.0], [0.0, 0.3]]])


def joint_filter(kalman: Kalman, track: np.ndarray, noise: np.ndarray, dt: float, steps: int) -> tuple:
    """Return positions ``[T, 2]`` and covariances ``[T, 2, 2]`` of a textbook filter with the state x, y, vx, vy."""
    drift = np.kron([[1.0, dt], [0.0, 1.0]], np.eye(2))
    push = kalman.acceleration**2 * np.kron([[dt**3 / 3.0, dt**2 / 2.0], [dt**2 / 2.0, dt]], np.eye(2))
    seen = np.eye(2, 4)
    state = np.concatenate([track[0], [0.0, 0.0]])
    spread = np.zeros((4, 4))
    spread[:2, :2], spread[2:, 2:] = noise, kalman.speed**2 * np.eye(2)
    for place in track[1:]:
        state, spread = drift @ state, drift @ spread @ drift.T + push
        gain = spread @ seen.T @ np.linalg.inv(seen @ spread @ seen.T + noise)
        state, spread = state + gain @ (place - seen @ state), spread - gain @ seen @ spread
    found = []
    for _ in range(steps):
        state, spread = drift @ state, drift @ spread @ drift.T + push
        found.append((state[:2], spread[:2, :2]))
    return tuple(np.array(part) for part in zip(*found, strict=True))


def test_the_kalman_filter_trusts_the_covariances_of_the_tracker() -> None:
    rng = stream(2, "tracker")
    tracks = np.stack([[0.5, 0.0], [-0.3, 0.2]])[:, None] * np.arange(6.0)[:, None] + rng.normal(0.0, 0.2, (2, 6, 2))
    live, plain = (Live(Kalman(), dt=0.4) for _ in range(2))
    for row in range(6):
        live.update(["b", "a"], tracks[:, row], covariances=NOISE)
        plain.update(["b", "a"], tracks[:, row])
    forecast, other = live.predict(4), plain.predict(4)
    assert forecast.covariance is not None
    for slot, who in enumerate(live.ids):
        k = ["b", "a"].index(who)
        place, spread = joint_filter(Kalman(), tracks[k], NOISE[k], 0.4, 4)
        np.testing.assert_allclose(forecast.position[0, 0, :, slot], place, atol=1e-9)
        np.testing.assert_allclose(forecast.covariance[0, :, slot], spread, atol=1e-9)
    assert np.abs(forecast.position - other.position).max() > 0.05


def test_frames_without_covariances_have_the_noise_of_the_filter() -> None:
    mixed, plain = (Live(Kalman(measurement=0.2), dt=0.4) for _ in range(2))
    for row in range(6):
        place = [[0.5 * row + 0.1 * (row % 2), 0.0]]
        mixed.update([1], place, covariances=[0.04 * np.eye(2)] if row % 2 else None)
        plain.update([1], place)
    for name in ("position", "covariance"):
        np.testing.assert_allclose(getattr(mixed.predict(4), name), getattr(plain.predict(4), name), atol=1e-12)


def test_interpolated_positions_have_the_covariance_of_the_mean() -> None:
    live = Live(Kalman(), dt=0.4)
    for time, variance in ((0.0, 0.1), (0.3, 0.3), (0.5, 0.5), (0.8, 0.2)):
        live.update([1], [[time, 0.0]], time=time, covariances=[variance * np.eye(2)])
    found = live.past().covariance
    assert found is not None
    np.testing.assert_allclose(found[0, :, 0, 0, 0], [0.1, 0.25 * 0.3 + 0.25 * 0.5, 0.2], atol=1e-12)


def test_covariances_of_uneven_noise_improve_the_forecast() -> None:
    rng = stream(8, "uneven")
    errors = {True: [], False: []}
    for _ in range(30):
        velocity = rng.normal(0.0, 0.8, 2)
        deviation = rng.choice([0.02, 0.4], 8)
        track = 0.4 * np.arange(8.0)[:, None] * velocity + deviation[:, None] * rng.standard_normal((8, 2))
        for told, found in errors.items():
            live = Live(Kalman(), dt=0.4, max_speed=np.inf)
            for place, size in zip(track, deviation, strict=True):
                live.update([1], [place], covariances=[size**2 * np.eye(2)] if told else None)
            found.append(np.linalg.norm(live.predict(12).position[0, 0, -1, 0] - 0.4 * 19 * velocity))
    assert np.mean(errors[True]) < 0.6 * np.mean(errors[False])


def test_anchor_net_reads_covariances_at_any_time_step() -> None:
    forecasts = []
    for dt in (0.4, 0.1):
        live = Live(AnchorNet("open"), dt=dt)
        for row in range(round(2.8 / dt) + 1):
            step = dt * row / 0.4
            noise = (0.02 + 0.01 * (round(step) % 2)) * np.eye(2)
            live.update([1], [[0.5 * step, 0.05 * np.sin(2.0 * step)]], covariances=[noise])
        forecasts.append(live.predict(round(4.8 / dt)).position[0, 0, :, 0][round(0.4 / dt) - 1 :: round(0.4 / dt)])
    np.testing.assert_allclose(*forecasts, atol=0.02)


def test_parts_of_windows_keep_their_covariances(windows: Maker) -> None:
    past = windows(np.zeros((3, 4, 2, 2)))
    noise = np.multiply.outer(np.arange(24.0).reshape(3, 4, 2), np.eye(2))
    past = dataclasses.replace(past, covariance=noise)
    np.testing.assert_array_equal(past[1:].covariance, noise[1:])
    np.testing.assert_array_equal(slice_rows(past, 1, 3).covariance, noise[:, 1:3])
    assert resample_rows(past, 0.2).covariance is None


def test_anchor_net_is_as_unsure_as_the_tracker() -> None:
    sure, unsure, plain = (Live(AnchorNet("open"), dt=0.4) for _ in range(3))
    wave = 0.08 * np.sin(2.0 * np.arange(8.0))
    for row in range(8):
        place = [[0.5 * row, wave[row]], [3.0, 3.0 - 0.4 * row]]
        sure.update([1, 2], place, covariances=np.tile(1e-6 * np.eye(2), (2, 1, 1)))
        unsure.update([1, 2], place, covariances=np.tile(0.04 * np.eye(2), (2, 1, 1)))
        plain.update([1, 2], place)
    one, other = sure.predict(12), unsure.predict(12)
    assert one.covariance is not None
    assert other.covariance is not None
    assert np.all((other.covariance - one.covariance)[0, :, :, [0, 1], [0, 1]] > 0.0399)
    # to a sure tracker the wave is a turn, to an unsure one it is noise
    aside = [np.abs(forecast.position[0, 0, -1, 0, 1]) for forecast in (one, other)]
    assert aside[1] < 0.8 * aside[0]
    assert plain.past().covariance is None


def test_a_hidden_person_keeps_the_last_covariance_and_robots_with_plans_have_none() -> None:
    live = Live(Kalman(), dt=0.4, coast=2.0)
    for row in range(5):
        live.update([1, 9], [[0.4 * row, 0.0], [5.0, 0.0]], robots=[9], covariances=np.tile(0.3 * np.eye(2), (2, 1, 1)))
    live.update([9], [[5.0, 0.0]], robots=[9])
    found = live.predict(3, plans={9: [[5.0, 0.1]] * 3}).covariance
    assert found is not None
    assert np.all(found[0, :, 0, 0, 0] > 0.3)
    assert np.all(found[0, :, 1] == 0.0)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (np.eye(2), r"covariances have shape \[2, 2\], they must be \[1, 2, 2\]"),
        (
            [[[1.0, 2.0], [2.0, 1.0]]],
            r"of 'anna' is not positive semidefinite: \[\[1.0, 2.0\], \[2.0, 1.0\]\]; it must",
        ),
        ([[[1.0, 0.5], [0.0, 1.0]]], r"of 'anna' is not symmetric: \[\[1.0, 0.5\], \[0.0, 1.0\]\]; it must"),
        ([[[np.nan, 0.0], [0.0, 1.0]]], r"of 'anna' is not finite: \[\[nan, 0.0\], \[0.0, 1.0\]\]; it must"),
        ("wide", r"covariances must be numbers \[N, 2, 2\]"),
    ],
    ids=["shape", "negative", "skew", "nan", "text"],
)
def test_impossible_covariances_are_refused_in_a_sentence(wrong: object, says: str) -> None:
    live = Live(Kalman(), dt=0.4)
    with pytest.raises(InputError, match=rf"^live: (covariance )?{says}"):
        live.update(["anna"], [[0.0, 0.0]], covariances=wrong)
    live.update([1], [[0.0, 0.0]])
    assert live.ids.tolist() == [1]


def test_coverage_of_drawn_truths_is_the_asked_share(windows: Maker) -> None:
    rng = stream(0, "coverage")
    shape = np.array([[0.5, 0.2], [0.2, 0.3]])
    truth = rng.multivariate_normal([0.0, 0.0], shape, size=(4000, 3, 1))
    future = windows(truth)
    future = dataclasses.replace(future, scored=future.present[:, 0])
    forecast = Forecast.of(np.zeros((4000, 1, 3, 1, 2)), np.ones((4000, 1), dtype=bool), 0.4, "drawn")
    forecast = dataclasses.replace(forecast, covariance=np.broadcast_to(shape, (4000, 3, 1, 2, 2)))
    for share in (0.5, 0.95):
        np.testing.assert_allclose(region_coverage(forecast, future, share), share, atol=0.03)
    with pytest.raises(InputError, match="mixture: the forecast of drawn has no covariance"):
        region_coverage(dataclasses.replace(forecast, covariance=None), future)
    with pytest.raises(InputError, match="must be between 0 and 1"):
        region_coverage(forecast, future, 95.0)


def test_predictors_without_a_covariance_have_none_in_live() -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    live.update([1], [[0.0, 0.0]], covariances=[np.eye(2)])
    assert live.predict(2).covariance is None


def test_regions_hold_their_share_of_a_data_set_that_no_default_weight_saw(
    recorded: Callable[[str], Trajectories],
) -> None:
    past, future = recorded("biwi_hotel").windows()
    forecast = AnchorNet("open").predict(past[::4], 12, 20)
    held = np.array([region_coverage(forecast, future[::4], share) for share in (0.5, 0.8, 0.95)])
    assert np.all(held[2] > 0.9)
    assert np.all(np.diff(held, axis=0) > 0.0)


def test_the_folder_of_the_weights_says_what_they_learned_from() -> None:
    folder = find_weights("anchor-net", "open").parent
    text = (folder / "README.md").read_text(encoding="utf-8")
    assert "`anchor-net-open.npz`" in text
    assert "train DATA OUT --fold open" in text
    assert (Path(__file__).parents[2] / "studies" / "train_anchor_net.py").is_file()
