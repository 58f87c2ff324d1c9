"""Goals: where observed people are taken to be walking."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from crowdbot import models
from crowdbot.core import InputError, find_class, from_attributes
from crowdbot.data import Windows, slice_rows
from crowdbot.models import CurrentDirection, Goal, GroundTruth


def windows(position, present=None, dt=0.4, number=0):
    position = np.asarray(position, dtype=np.float64)
    W, T, A = position.shape[:3]
    return Windows(
        position=position,
        present=np.ones((W, T, A), dtype=bool) if present is None else np.asarray(present),
        scored=np.zeros((W, A), dtype=bool),
        robot=np.zeros((W, A), dtype=bool),
        id=np.arange(number, number + W * A).reshape(W, A),
        frame=np.arange(W * T).reshape(W, T),
        dt=dt,
        protocol="all",
        source="test",
    )


def walk():
    """Return one window of three people: one speeds up, one comes late, one has gone."""
    place = np.zeros((1, 4, 3, 2))
    place[0, :, 0, 0] = [0.0, 0.2, 0.6, 1.2]
    place[0, :, 1] = [[0, 0], [0, 0], [5.0, 1.0], [5.0, 1.4]]
    place[0, :, 2] = [[3, 3], [3, 4], [3, 5], [0, 0]]
    present = np.ones((1, 4, 3), dtype=bool)
    present[0, :2, 1] = False
    present[0, 3, 2] = False
    return windows(place, present)


def test_the_last_displacement_goes_on():
    goal = CurrentDirection().resolve(walk())
    assert goal.shape == (1, 3, 2)
    assert goal[0, 0] == pytest.approx([1.2 + 20.0 * 0.6 / 0.4, 0.0])
    assert goal[0, 1] == pytest.approx([5.0, 1.4 + 20.0])
    assert goal[0, 2] == pytest.approx([0.0, 0.0])


@pytest.mark.parametrize(("steps", "speed"), [(1, 1.5), (2, 1.25), (3, 1.0), (99, 1.0)])
def test_the_velocity_is_averaged_over_the_last_steps(steps, speed):
    goal = CurrentDirection(steps=steps, horizon=10.0).resolve(walk())
    assert goal[0, 0] == pytest.approx([1.2 + 10.0 * speed, 0.0])
    assert goal[0, 1] == pytest.approx([5.0, 1.4 + 10.0])  # seen for one step only


def test_a_gap_ends_the_average():
    past = walk()
    past.present[0, 1, 0] = False
    assert CurrentDirection(steps=3, horizon=10.0).resolve(past)[0, 0] == pytest.approx([1.2 + 15.0, 0.0])
    past.present[0, 2, 0] = False
    assert CurrentDirection(steps=3).resolve(past)[0, 0] == pytest.approx([1.2, 0.0])


def test_one_observed_step_is_enough():
    assert CurrentDirection().resolve(windows(np.ones((2, 1, 3, 2)))).tolist() == np.ones((2, 3, 2)).tolist()


def test_the_ground_truth_is_the_last_place_seen():
    place = np.arange(12.0).reshape(1, 2, 3, 2)
    present = np.array([[[True, True, True], [True, False, True]]])
    future = windows(place, present)
    goal = GroundTruth(walk(), future).resolve(walk())
    assert goal[0].tolist() == [[6.0, 7.0], [2.0, 3.0], [0.0, 0.0]]
    nobody = dataclasses.replace(future, present=np.zeros((1, 2, 3), dtype=bool))
    assert GroundTruth(walk(), nobody).resolve(walk())[0].tolist() == [[1.2, 0.0], [5.0, 1.4], [0.0, 0.0]]


def test_only_the_ground_truth_knows_the_future():
    assert GroundTruth.knows_future
    assert not CurrentDirection.knows_future
    assert not Goal.knows_future


def test_the_ground_truth_of_some_windows_and_of_their_first_rows():
    past = windows(np.arange(48.0).reshape(2, 4, 3, 2))
    past = dataclasses.replace(past, frame=np.array([[0, 10, 20, 30], [10, 20, 30, 40]]))
    future = dataclasses.replace(windows(np.arange(24.0).reshape(2, 2, 3, 2)), id=past.id)
    truth = GroundTruth(past, future)
    for window in (0, 1):
        for row in (2, 4):
            some = slice_rows(past[window : window + 1], 0, row)
            assert np.array_equal(truth.resolve(some)[0], future.position[window, -1])


def test_the_ground_truth_of_other_people():
    future = windows(np.zeros((1, 2, 3, 2)), number=7)
    with pytest.raises(InputError, match="must come from one call"):
        GroundTruth(walk(), future)
    with pytest.raises(InputError, match=r"people \[1, 3\] and the future \[2, 3\]"):
        GroundTruth(walk(), windows(np.zeros((2, 2, 3, 2))))
    with pytest.raises(InputError, match="window 0 of .* is not one of the 1 windows with a known future"):
        GroundTruth(walk(), walk()).resolve(future)


@pytest.mark.parametrize("steps", [0, -3])
def test_bad_steps(steps):
    with pytest.raises(InputError, match=f"steps {steps} is not allowed"):
        CurrentDirection(steps=steps)


@pytest.mark.parametrize("horizon", [0.0, -1.0, np.nan, np.inf])
def test_bad_horizon(horizon):
    with pytest.raises(InputError, match="horizon = "):
        CurrentDirection(horizon=horizon)


def test_goals_come_from_text():
    kind = find_class("current-direction", models, Goal)
    assert from_attributes(kind, {"steps": "3", "horizon": "8"}) == CurrentDirection(steps=3, horizon=8.0)


def test_nothing_given_is_changed():
    past = walk()
    before = past.position.copy()
    CurrentDirection(steps=3).resolve(past)
    GroundTruth(past, past).resolve(past)
    assert np.array_equal(past.position, before)
