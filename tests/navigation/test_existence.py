"""Navigators weigh the costs of people by the probability that they exist."""

from __future__ import annotations

import math

import numpy as np
import pytest

from crowdbot.core import Twist
from crowdbot.navigation import (
    AgentsInView,
    DriveLimits,
    MPCNavigator,
    Navigator,
    Observation,
    ObservationBatch,
    TimeElasticBandNavigator,
    VisiblePeople,
)

LIMITS = DriveLimits(1.0, 1.5, 1.0, 3.0)
NAVIGATORS = (MPCNavigator(), TimeElasticBandNavigator())


def meeting(existence: float | None, x: float = 0.0, y: float = 0.0, heading: float = 0.0) -> Observation:
    """Return the observation of a robot that drives towards somebody who stands in its way."""
    share = {} if existence is None else {"existence": np.array([existence])}
    person = VisiblePeople(np.array([[3.0, 0.05]]), np.zeros((1, 2)), np.array([0.25]), np.array([4]), **share)
    return Observation(
        pose=(x, y, heading), goal=(8.0, 0.0), radius=0.3, limits=LIMITS, dt=0.1, twist=Twist(0.8, 0.0), people=person
    )


def drive(navigator: Navigator, existence: float) -> tuple[float, float]:
    """Return the smallest distance [m] of the centres, and the time [s] to a goal 5 m behind the person."""
    x = y = heading = 0.0
    nearest = math.inf
    for step in range(150):
        twist = navigator.act(meeting(existence, x, y, heading))
        assert isinstance(twist, Twist)
        heading += 0.1 * twist.turn
        x, y = x + 0.1 * twist.forward * math.cos(heading), y + 0.1 * twist.forward * math.sin(heading)
        nearest = min(nearest, math.hypot(x - 3.0, y - 0.05))
        if math.hypot(x - 8.0, y) < 0.3:
            return nearest, 0.1 * step
    return nearest, math.inf


@pytest.mark.parametrize("navigator", NAVIGATORS, ids=lambda one: type(one).__name__)
def test_people_exist_surely_if_nothing_is_said(navigator: Navigator) -> None:
    assert navigator.act(meeting(None)) == navigator.act(meeting(1.0))


@pytest.mark.parametrize("navigator", NAVIGATORS, ids=lambda one: type(one).__name__)
def test_robots_keep_less_distance_to_tracks_that_hardly_exist(navigator: Navigator) -> None:
    sure, doubtful = (drive(navigator, existence) for existence in (1.0, 0.05))
    assert doubtful[0] < sure[0] - 0.01
    assert doubtful[1] <= sure[1]
    assert math.isfinite(sure[1])


def test_mpc_does_not_stop_before_somebody_who_hardly_exists() -> None:
    assert drive(NAVIGATORS[0], 0.2)[1] < 8.5


def test_existence_reaches_each_environment_of_a_batch() -> None:
    people = AgentsInView(
        np.zeros((2, 2, 2)), np.zeros((2, 2, 2)), np.full((2, 2), 0.25), np.array([[True, False], [True, True]]),
        np.array([[3, 4], [3, 4]]), np.array([[0.4, 1.0], [0.6, 0.9]]),
    )  # fmt: skip
    batch = ObservationBatch(
        pose=np.zeros((2, 3)), goal=np.ones((2, 2)), radius=np.full(2, 0.3), limits=LIMITS, dt=0.1, people=people
    )
    assert batch.environment(0).people.existence.tolist() == [0.4]
    assert batch.environment(1).people.existence.tolist() == [0.6, 0.9]
    assert AgentsInView.none(2).existence.shape == (2, 0)
