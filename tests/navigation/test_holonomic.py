"""A holonomic drive moves with the velocity that ORCA chooses."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import Pose, Twist, Walls
from crowdbot.navigation import DriveLimits, Observation, ObservationBatch, ORCANavigator, Straight, VisiblePeople
from crowdbot.world import Omnidirectional, Twists

LIMITS = DriveLimits(1.0, 1.5, 1.0, 3.0, holonomic=True)


def seen(**changes):
    known = {"pose": (0.0, 0.0, 0.0), "goal": (0.0, 9.0), "radius": 0.3, "limits": LIMITS, "dt": 0.1}
    return Observation(**(known | changes))


def test_it_moves_sideways_at_once_and_turns_towards_its_motion():
    twist = ORCANavigator().act(seen())
    assert twist.left > 0.9
    assert twist.turn == pytest.approx(1.5)
    plain = ORCANavigator().act(seen(limits=DriveLimits(1.0, 1.5, 1.0, 3.0)))
    assert plain.left == 0.0
    assert plain.turn > 0.5


@settings(max_examples=40, deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.floats(0.1, 1.2))
def test_the_chord_of_the_next_step_is_the_velocity_of_orca(heading, x, y, speed):
    limits = DriveLimits(1.0, 1.5, 1e6, 1e6, holonomic=True)
    person = VisiblePeople(np.array([[1.0, 1.0]]), np.array([[-0.5, -0.4]]), np.array([0.25]))
    navigator, known = (
        ORCANavigator(speed=speed),
        seen(pose=(0.0, 0.0, heading), goal=(x, y), people=person, limits=limits),
    )
    velocity, twist = np.array(navigator.velocity(known)), navigator.act(known)
    assert math.hypot(twist.forward, twist.left) <= min(speed, 1.0) + 1e-9
    assert abs(twist.turn) <= 1.5
    assert math.hypot(*velocity) == pytest.approx(math.hypot(twist.forward, twist.left))
    drive = Omnidirectional(1.0, 1.5, 1e6, 1e6)
    pose, _ = drive.step(Pose.of((0.0, 0.0), heading), Twists.of(Twist(), 1), twist, 0.1)
    np.testing.assert_allclose(pose.position[0], 0.1 * velocity, atol=2e-4)


def test_it_stands_without_turning_at_the_goal():
    assert ORCANavigator().act(seen(goal=(0.0, 0.0))) == Twist(0.0, 0.0, 0.0)


def test_it_passes_a_person_and_a_wall_without_contact():
    drive, navigator = Omnidirectional(1.0, 1.5, 1.0, 3.0), ORCANavigator()
    walls = Walls.of([[(-2.0, -1.0), (12.0, -1.0)]])
    pose, twist, nearest = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), math.inf
    for k in range(140):
        person = np.array([[6.0 - 0.08 * k, 0.1]])
        x, y = pose.position[0].tolist()
        nearest = min(nearest, math.hypot(*(person[0] - (x, y))) - 0.55, y + 1.0 - 0.3)
        people = VisiblePeople(person, np.array([[-0.8, 0.0]]), np.array([0.25]))
        known = seen(
            pose=(x, y, float(pose.heading[0])), twist=twist.at(0), goal=(9.0, 0.0), people=people, walls=walls
        )
        pose, twist = drive.step(pose, twist, navigator.act(known), 0.1)
    assert nearest > 0.0
    assert math.dist(pose.position[0], (9.0, 0.0)) < 0.1


def test_straight_moves_sideways_at_once_and_turns_towards_its_motion():
    twist = Straight().act(seen())
    assert twist.left > 0.9
    assert twist.turn == pytest.approx(1.5)
    assert Straight().act(seen(limits=LIMITS._replace(holonomic=False))).left == 0.0
    assert Straight().act(seen(goal=(0.0, 0.0))) == Twist(0.0, 0.0, 0.0)


@settings(max_examples=40, deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.floats(0.1, 1.2))
def test_straight_moves_to_the_waypoint_at_the_speed_of_other_drives(heading, x, y, speed):
    limits = DriveLimits(1.0, 1.5, 1e6, 1e6, holonomic=True)
    known = seen(pose=(0.0, 0.0, heading), goal=(9.0, 9.0), waypoint=(x, y), limits=limits)
    twist = Straight(speed=speed).act(known)
    size = min(speed, 1.0, known.remaining / 0.5)
    assert math.hypot(twist.forward, twist.left) == pytest.approx(size if math.hypot(x, y) > 1e-9 else 0.0, abs=1e-6)
    drive = Omnidirectional(1.0, 1.5, 1e6, 1e6)
    pose, _ = drive.step(Pose.of((0.0, 0.0), heading), Twists.of(Twist(), 1), twist, 0.1)
    ahead = np.array([x, y]) / max(math.hypot(x, y), 1e-9)
    np.testing.assert_allclose(pose.position[0], 0.1 * size * ahead, atol=2e-4)


def test_a_batch_of_straight_is_equal_to_single_decisions():
    rng = np.random.default_rng(4)
    pose, goal, waypoint = rng.uniform(-5.0, 5.0, (20, 3)), rng.uniform(-5, 5, (20, 2)), rng.uniform(-5, 5, (20, 2))
    batch = ObservationBatch(pose=pose, goal=goal, waypoint=waypoint, radius=np.full(20, 0.3), limits=LIMITS, dt=0.1)
    decisions = Straight(0.8).decide_batch(batch, [None] * 20)
    assert decisions.failures == {}
    for k in range(20):
        assert tuple(decisions.twist[k].tolist()) == tuple(Straight(0.8).act(batch.environment(k)))
