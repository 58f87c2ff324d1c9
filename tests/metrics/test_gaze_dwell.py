"""The share of time that a person looks at a robot: logs with known answers, and properties."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.metrics import gaze_dwell

ROBOT = {"radius": 0.3, "height": 1.2}


def looks(angles, step=0.1, away=4.0, **options):
    """Return the dwell of a person at the origin whose head has these angles [rad] to a robot straight ahead."""
    angles = np.asarray(angles, dtype=np.float64)
    count = len(angles)
    eye = np.tile([0.0, 0.0, 1.6], (count, 1))
    view = np.stack([np.cos(angles), np.sin(angles), np.zeros(count)], axis=1)
    return gaze_dwell(np.arange(count) * step, eye, view, np.tile([away, 0.0], (count, 1)), **(ROBOT | options))


def test_a_log_made_by_hand_has_the_share_and_the_glances_written_in_it():
    angles = [0.0] * 3 + [1.0] * 4 + [0.1] * 2 + [-2.0] * 2  # 10 intervals of 0.1 s: 3 at it, 4 off, 2 at it, 1 off
    found = looks(angles)
    assert found.share == found.visible_share == pytest.approx(0.5)
    assert (found.glances, found.known) == (2, pytest.approx(1.0))
    assert found.mean_glance == pytest.approx(0.25)


@pytest.mark.parametrize(("half_angle", "away"), [(math.radians(3), 2.0), (math.radians(15), 6.0), (0.5, 1.0)])
def test_the_edge_of_the_cone_is_half_the_angle_and_the_size_of_the_robot(half_angle, away):
    # the view is level with the top of the robot, so the angle is that seen from above
    options = {"half_angle": half_angle, "away": away, "height": 1.6}
    edge = half_angle + math.asin(ROBOT["radius"] / away)
    assert looks([edge - 1e-6] * 3, **options).share == 1.0
    assert looks([edge + 1e-6] * 3, **options).share == 0.0


def test_a_low_robot_is_below_a_level_view():
    assert looks([0.0] * 3, away=1.0, height=0.2, half_angle=math.radians(15), radius=0.1).share == 0.0
    assert looks([0.0] * 3, away=1.0, height=1.6, half_angle=math.radians(15), radius=0.1).share == 1.0


def test_walls_and_people_hide_the_robot():
    wall = np.array([[2.0, -1.0], [2.0, 1.0]])
    found = looks([0.0] * 11, walls=[wall])
    assert (found.share, found.visible_share, found.glances) == (1.0, 0.0, 0)
    assert looks([0.0] * 11, walls=[wall + [0.0, 5.0]]).visible_share == 1.0
    people = np.full((11, 2, 2), np.nan)
    people[4:7, 1] = [2.0, 0.1]  # somebody passes for 0.3 s
    hidden = looks([0.0] * 11, people=people)
    assert hidden.visible_share == pytest.approx(0.7)
    assert hidden.glances == 2
    assert looks([0.0] * 11, people=people, people_height=1.0).visible_share == 1.0  # seen over a child
    assert looks([0.0] * 11, people=people - [3.0, 0.0]).visible_share == 1.0  # behind the person who looks
    assert looks([0.0] * 11, people=people + [3.0, 0.0]).visible_share == 1.0  # behind the robot


def test_unknown_rows_and_gaps_do_not_count():
    time = np.array([0.0, 0.1, 0.2, 5.2, 5.3])
    eye, target = np.tile([0.0, 0.0, 1.6], (5, 1)), np.tile([4.0, 0.0], (5, 1))
    view = np.tile([1.0, 0.0, 0.0], (5, 1))
    view[1] = np.nan
    found = gaze_dwell(time, eye, view, target, **ROBOT)
    assert found.known == pytest.approx(0.1 + 0.5 + 0.1)  # the gap of 5 s counts for 0.5 s
    assert (found.share, found.glances) == (1.0, 3)
    nothing = gaze_dwell(time, eye, np.full((5, 3), np.nan), target, **ROBOT)
    assert math.isnan(nothing.share)
    assert nothing.known == 0.0


@given(seed=st.integers(0, 1000), turn=st.floats(-3.0, 3.0), x=st.floats(-50.0, 50.0), y=st.floats(-50.0, 50.0))
def test_turning_and_shifting_everything_changes_nothing_and_hiding_only_takes_away(seed, turn, x, y):
    rng = np.random.default_rng(seed)
    count = 40
    time = np.cumsum(rng.uniform(0.05, 0.3, count))
    eye = np.column_stack([rng.normal(0.0, 0.5, (count, 2)), np.full(count, 1.6)])
    target, view = rng.normal(3.0, 0.5, (count, 2)), rng.normal([1.0, 1.0, -0.2], 0.4, (count, 3))
    people, wall = rng.normal(1.5, 1.0, (count, 3, 2)), rng.normal(1.5, 1.0, (4, 2))
    cos, sin = math.cos(turn), math.sin(turn)
    matrix, shift = np.array([[cos, -sin], [sin, cos]]), np.array([x, y])

    def move(points):
        return points @ matrix.T + shift

    def lift(points, by):
        return np.column_stack([by(points[:, :2]), points[:, 2]])

    one = gaze_dwell(time, eye, view, target, walls=[wall], people=people, **ROBOT)
    other = gaze_dwell(
        time + 7.0, lift(eye, move), lift(view, lambda p: p @ matrix.T), move(target),
        walls=[move(wall)], people=move(people), **ROBOT,
    )  # fmt: skip
    np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9)
    assert one.visible_share <= one.share
    wide = gaze_dwell(time, eye, view, target, half_angle=math.radians(40), **ROBOT)
    assert wide.share >= one.share
    assert gaze_dwell(time, eye, view, target, half_angle=math.pi, **ROBOT).share == 1.0


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"half_angle": 4.0}, "half_angle"),
        ({"radius": -1.0}, "radius"),
        ({"walls": [[1.0, 2.0]]}, "a wall has the shape"),
        ({"people": np.zeros((2, 1, 2))}, "people have the shape"),
    ],
)
def test_bad_input_is_refused(changes, said):
    with pytest.raises(InputError, match=said):
        looks([0.0] * 3, **changes)
    with pytest.raises(InputError, match=r"\[T\], \[T, 3\]"):
        gaze_dwell([0.0, 1.0], [[0.0, 0.0, 1.6]], [[1.0, 0.0, 0.0]], [[1.0, 0.0]], **ROBOT)
    with pytest.raises(InputError, match="ascend"):
        looks([0.0] * 3, step=0.0)
