"""Covariances of forecasts: of a mixture of futures, of a tracker, and their calibration."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Trajectories, Windows
from crowdbot.metrics import ellipse_coverage
from crowdbot.prediction import AnchorNet, ConstantVelocity, Kalman, Live
from crowdbot.prediction.anchor_net.mixture import FILTERED, WIDENED
from crowdbot.prediction.pretrained_weights import find_weights

Maker = Callable[..., Windows]


def test_covariance_of_anchor_net_is_that_of_its_draws(crowd: Maker) -> None:
    past = crowd(seed=3)
    net = AnchorNet(contact=0.0)
    whole, filtered = net.predict(past, 12).covariance, Kalman().predict(past, 12).covariance
    assert whole is not None
    assert filtered is not None
    own = (whole - FILTERED * filtered) / WIDENED
    middle = net.predict(past, 12).position[:, 0]
    drawn = dataclasses.replace(net, sample="draws").predict(past, 12, 4000, stream(5)).position
    away = drawn - middle[:, None]
    found = np.einsum("wktai,wktaj->wtaij", away, away) / 4000
    here = past.present[:, -1]
    for step in (0, 5, 11):
        np.testing.assert_allclose(
            own[:, step][here], found[:, step][here], rtol=0.0, atol=0.12 * found[:, step][here].max()
        )
    assert np.all(own[:, :, ~here.all(axis=0)][:, :, 0][~here[:, ~here.all(axis=0)][:, 0]] == 0.0)


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


def test_the_tracker_adds_its_own_covariance() -> None:
    noise = [[[0.04, 0.01], [0.01, 0.02]], [[0.5, 0.0], [0.0, 0.5]]]
    plain, noisy = (Live(Kalman(), dt=0.4) for _ in range(2))
    for row in range(5):
        place = [[0.5 * row, 0.0], [4.0, 1.0]]
        plain.update(["b", "a"], place)
        noisy.update(["b", "a"], place, covariances=noise)
    one, other = plain.predict(4).covariance, noisy.predict(4).covariance
    assert one is not None
    assert other is not None
    order = [noise[["b", "a"].index(who)] for who in noisy.ids]
    np.testing.assert_allclose(other - one, np.broadcast_to(order, one.shape), atol=1e-12)
    np.testing.assert_array_equal(plain.predict(4).position, noisy.predict(4).position)


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
    "wrong",
    [np.eye(2), [[[1.0, 2.0], [2.0, 1.0]]], [[[1.0, 0.5], [0.0, 1.0]]], [[[np.nan, 0.0], [0.0, 1.0]]], "wide"],
    ids=["shape", "negative", "skew", "nan", "text"],
)
def test_impossible_covariances_are_refused_in_a_sentence(wrong: object) -> None:
    live = Live(Kalman(), dt=0.4)
    with pytest.raises(InputError, match=r"^live: covariance"):
        live.update([1], [[0.0, 0.0]], covariances=wrong)
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
        np.testing.assert_allclose(ellipse_coverage(forecast, future, share), share, atol=0.03)
    with pytest.raises(InputError, match="no covariance"):
        ellipse_coverage(dataclasses.replace(forecast, covariance=None), future)
    with pytest.raises(InputError, match="must be between 0 and 1"):
        ellipse_coverage(forecast, future, 95.0)


def test_predictors_without_a_covariance_have_none_in_live() -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    live.update([1], [[0.0, 0.0]], covariances=[np.eye(2)])
    assert live.predict(2).covariance is None


def test_the_ellipse_holds_most_people_of_a_data_set_that_no_default_weight_saw(
    recorded: Callable[[str], Trajectories],
) -> None:
    past, future = recorded("biwi_hotel").windows()
    held = ellipse_coverage(AnchorNet("open").predict(past, 12), future)
    assert np.all(held > 0.9)
    assert held[0] < 0.99


def test_the_folder_of_the_weights_says_what_they_learned_from() -> None:
    folder = find_weights("anchor-net", "open").parent
    text = (folder / "README.md").read_text(encoding="utf-8")
    assert "`anchor-net-open.npz`" in text
    assert "train DATA OUT --fold open" in text
    assert (Path(__file__).parents[2] / "studies" / "train_anchor_net.py").is_file()
