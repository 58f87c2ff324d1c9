"""Forecasts from samples of the past of tracked people."""

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.data import Windows
from crowdbot.perception import predict_uncertain
from crowdbot.prediction import ConstantVelocity


def window(robot=False):
    place = np.array([[[[0.0, 0.0]], [[0.4, 0.0]], [[0.8, 0.0]]]])
    here = np.ones((1, 3, 1), dtype=bool)
    return Windows(place, here, ~here[:, 0], np.full((1, 1), robot), np.array([[7]]), np.arange(3)[None], 0.4, "a", "b")


def test_the_spread_of_the_forecast_is_that_of_the_track():
    """With constant velocity the covariance at time t ahead is P_xx + 2 t P_xv + t^2 P_vv."""
    covariance = np.zeros((1, 4, 4))
    covariance[0, 0, 0], covariance[0, 2, 2], covariance[0, 0, 2] = 0.04, 0.01, 0.01
    covariance[0, 2, 0] = 0.01
    forecast = predict_uncertain(ConstantVelocity(), window(), covariance, 5, 4000, stream(2))
    ahead = 0.4 * np.arange(1, 6)
    expected = 0.04 + 2.0 * ahead * 0.01 + ahead**2 * 0.01
    assert forecast.position[0, :, :, 0, 0].var(axis=0) == pytest.approx(expected, rel=0.1)
    assert forecast.position[0, :, :, 0, 1].std() == pytest.approx(0.0, abs=1e-9)


def test_the_first_sample_is_the_forecast_of_the_track_itself():
    plain = ConstantVelocity().predict(window(), 3).position[0, 0]
    found = predict_uncertain(ConstantVelocity(), window(), 0.04 * np.eye(4)[None], 3, 6)
    assert found.position[0, 0] == pytest.approx(plain)
    assert found.weight.sum() == pytest.approx(1.0)
    known = predict_uncertain(ConstantVelocity(), window(), np.zeros((1, 4, 4)), 3, 6).position[0]
    assert known == pytest.approx(np.repeat(plain[None], 6, axis=0))


def test_wrong_shapes_are_rejected():
    with pytest.raises(
        InputError, match=r"1 windows and covariances of shape \[2, 4, 4\]; they must be 1 and \[1, 4, 4\]"
    ):
        predict_uncertain(ConstantVelocity(), window(), np.zeros((2, 4, 4)), 3)
