"""Time to collision with the returns of a scan: known contacts, and a disc that is moved in small steps."""

import math

import numpy as np
import pytest

from crowdbot.core import stream
from crowdbot.metrics import scan_time_to_collision


def test_a_return_ahead_is_touched_by_the_edge_of_the_disc():
    assert scan_time_to_collision([[2.3, 0.0]], [0.5, 0.0], 0.3, 5.0) == pytest.approx(4.0)
    assert scan_time_to_collision([[0.0, -1.3]], [0.0, -1.0], 0.3, 5.0) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("points", "time"),
    [
        ([[2.0, 0.31]], 5.0),
        ([[-2.0, 0.0]], 5.0),
        ([[math.nan, math.nan]], 5.0),
        (np.zeros((0, 2)), 5.0),
        ([[9.0, 0.0]], 5.0),
        ([[-0.1, 0.1]], 0.0),
    ],
)
def test_returns_that_are_passed_missing_or_late_count_as_the_limit(points, time):
    assert scan_time_to_collision(points, [1.0, 0.0], 0.3, 5.0) == time


def test_a_robot_that_stands_has_no_time():
    assert math.isnan(scan_time_to_collision([[1.0, 0.0]], [0.01, 0.0], 0.3, 5.0))


def test_a_disc_in_small_steps_needs_the_same_time():
    rng = stream(5)
    points, velocity = rng.uniform(-4.0, 4.0, (40, 12, 2)), rng.uniform(-1.5, 1.5, (40, 2))
    time_to_collision = scan_time_to_collision(points, velocity, 0.4, 3.0)
    steps = np.arange(0.0, 3.0, 1e-3)
    for k in range(40):
        away = np.linalg.norm(points[k][None] - steps[:, None, None] * velocity[k], axis=-1).min(axis=1)
        touched = steps[away <= 0.4]
        assert time_to_collision[k] == pytest.approx(touched[0] if len(touched) else 3.0, abs=2e-3)
