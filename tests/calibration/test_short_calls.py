"""Calls of the simulation are short, so that Ctrl-C is handled soon; the size of a call does not change the fit."""

import numpy as np
import pytest

from crowdbot.calibration import Calibrator, calibrator
from crowdbot.core import stream
from crowdbot.data import Trajectories


@pytest.mark.parametrize("shared", [False, True])
def test_short_calls_give_the_same_fit(shared, monkeypatch):
    people, rows = 5, 30
    rng = stream(4, "plaza")
    angle = rng.uniform(-np.pi, np.pi, people) + np.cumsum(rng.normal(0.0, 0.05, (rows, people)), axis=0)
    step = 0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=2)
    place = rng.uniform(-8.0, 8.0, (people, 2)) + np.cumsum(step, axis=0)
    frame, id = np.indices((rows, people)).reshape(2, -1)
    past, _ = Trajectories(id, frame, *place.reshape(-1, 2).T, row_rate=2.5).windows(observe=4, predict=2)
    scheme = Calibrator("orca", "progressive", "random-search", budget=12, shared=shared, substep=0.4)
    whole = scheme.fit(past)
    monkeypatch.setattr(calibrator, "AGENTS_PER_CALL", 40)
    short = scheme.fit(past)
    np.testing.assert_array_equal(short.values, whole.values)
    np.testing.assert_array_equal(short.cost, whole.cost)
