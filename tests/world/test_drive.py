"""Drives: exact arcs, limits that are never exceeded, batches."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Pose, Scene, Twist, stream, wrap_angle
from crowdbot.models import ORCA
from crowdbot.world import DifferentialDrive, Omnidirectional, PlanarWorld, Twists, integrate_twist

few = settings(max_examples=60, deadline=None)
finite = st.floats(-1e6, 1e6)
speeds = st.floats(-3.0, 3.0)
FREE = {"max_speed": 10.0, "max_turn_rate": 10.0, "max_acceleration": 1e6, "max_turn_acceleration": 1e6}


def arc_by_many_steps(place, heading, forward, turn, left, dt, parts=20_000):
    """The slow twin: the same way in many small straight steps (midpoint rule)."""
    h = dt / parts
    angle = heading + turn * h * (np.arange(parts) + 0.5)
    x = place[0] + np.sum(np.cos(angle) * forward - np.sin(angle) * left) * h
    y = place[1] + np.sum(np.sin(angle) * forward + np.cos(angle) * left) * h
    return x, y, heading + turn * dt


@few
@given(speeds, speeds, speeds, st.floats(-3.0, 3.0), st.floats(0.01, 3.0))
def test_the_arc_is_what_many_small_steps_give(forward, turn, left, heading, dt):
    after = integrate_twist(Pose.of((1.0, -2.0), heading), Twists.of(Twist(forward, turn, left), 1), dt)
    x, y, angle = arc_by_many_steps((1.0, -2.0), heading, forward, turn, left, dt)
    np.testing.assert_allclose(after.position[0], [x, y], rtol=0, atol=1e-6)
    assert abs(wrap_angle(float(after.heading[0]) - angle)) < 1e-9
    assert -math.pi <= after.heading[0] <= math.pi


def test_circles_close():
    pose, twist = Pose.of((0.3, 0.4), 0.7), Twists.of(Twist(1.2, 0.8), 1)
    for _ in range(10):
        pose = integrate_twist(pose, twist, 2 * math.pi / 0.8 / 10)
    np.testing.assert_allclose(pose.position[0], [0.3, 0.4], atol=1e-12)
    assert pose.heading[0] == pytest.approx(0.7, abs=1e-12)


def test_an_arc_in_one_step_or_in_many_is_the_same():
    start, twist = Pose.of((0.0, 0.0), 0.1), Twists.of(Twist(0.9, 1.3), 1)
    pose = start
    for _ in range(100):
        pose = integrate_twist(pose, twist, 0.01)
    np.testing.assert_allclose(pose.position, integrate_twist(start, twist, 1.0).position, atol=1e-12)


@pytest.mark.parametrize("turn", [0.0, 1e-12, 1e-8, 1e-5, 3e-4, -3e-4])
def test_nearly_straight_is_smooth(turn):
    after = integrate_twist(Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(1.0, turn), 1), 1.0)
    exact = (
        (math.sin(turn) / turn, (1.0 - math.cos(turn)) / turn) if abs(turn) > 1e-4 else (1.0 - turn**2 / 6, turn / 2)
    )
    np.testing.assert_allclose(after.position[0], exact, rtol=0, atol=1e-11)


@few
@given(st.lists(st.tuples(finite, finite, finite), min_size=1, max_size=30), st.floats(0.01, 0.5))
def test_a_differential_drive_keeps_its_limits(commands, dt):
    drive = DifferentialDrive(max_speed=0.9, max_turn_rate=1.7, max_acceleration=0.6, max_turn_acceleration=2.5)
    pose, twist = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1)
    for command in commands:
        after, changed = drive.step(pose, twist, Twist(*command), dt)
        assert abs(changed.forward[0]) <= 0.9
        assert abs(changed.turn[0]) <= 1.7
        assert changed.left[0] == 0.0
        assert abs(changed.forward[0] - twist.forward[0]) <= 0.6 * dt + 1e-12
        assert abs(changed.turn[0] - twist.turn[0]) <= 2.5 * dt + 1e-12
        assert math.dist(after.position[0], pose.position[0]) <= 0.9 * dt + 1e-12
        pose, twist = after, changed


@few
@given(st.lists(st.tuples(finite, finite, finite), min_size=1, max_size=30), st.floats(0.01, 0.5))
def test_an_omnidirectional_drive_keeps_its_limits(commands, dt):
    drive = Omnidirectional(max_speed=0.9, max_turn_rate=1.7, max_acceleration=0.6, max_turn_acceleration=2.5)
    pose, twist = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1)
    for command in commands:
        pose, changed = drive.step(pose, twist, Twist(*command), dt)
        assert math.hypot(changed.forward[0], changed.left[0]) <= 0.9 + 1e-12
        change = math.hypot(changed.forward[0] - twist.forward[0], changed.left[0] - twist.left[0])
        assert change <= 0.6 * dt + 1e-9
        assert abs(changed.turn[0]) <= 1.7
        twist = changed


@pytest.mark.parametrize("kind", [DifferentialDrive, Omnidirectional])
def test_what_is_within_the_limits_is_followed_exactly(kind):
    _, twist = kind(**FREE).step(Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), Twist(0.7, -0.3), 0.1)
    assert twist.at(0) == Twist(0.7, -0.3, 0.0)


def test_only_wheels_that_roll_sideways_go_sideways():
    start, still = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1)
    fixed, _ = DifferentialDrive(**FREE).step(start, still, Twist(0.0, 0.0, left=1.0), 0.5)
    rolling, _ = Omnidirectional(**FREE).step(start, still, Twist(0.0, 0.0, left=1.0), 0.5)
    assert fixed.position.tolist() == [[0.0, 0.0]]
    assert rolling.position.tolist() == [[0.0, 0.5]]


@pytest.mark.parametrize("kind", [DifferentialDrive, Omnidirectional])
def test_a_batch_gives_the_bytes_of_each_alone(kind):
    rng = stream(3, "drive")
    place, heading, asked = rng.normal(size=(9, 2)), rng.normal(size=9), rng.normal(size=(3, 9))
    start, command = Twists(*rng.normal(size=(3, 9)) * 0.3), Twists(*asked)
    pose, twist = kind().step(Pose.of(place, heading), start, command, 0.1)
    for e in range(9):
        one, alone = kind().step(Pose.of(place[e], heading[e]), Twists.of(start.at(e), 1), command.at(e), 0.1)
        assert one.position.tobytes() == pose.position[e].tobytes()
        assert one.heading.tobytes() == pose.heading[e].tobytes()
        assert alone.at(0) == twist.at(e)


def test_velocity_in_the_world():
    twist = Twists.of(Twist(2.0, 0.0, 1.0), 1)
    np.testing.assert_allclose(twist.velocity(np.array([math.pi / 2])), [[-1.0, 2.0]], atol=1e-15)


def test_the_input_is_left_alone():
    pose, twist = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(0.5, 0.5), 1)
    DifferentialDrive().step(pose, twist, Twist(1.0, 1.0), 0.1)
    assert pose.position.tolist() == [[0.0, 0.0]]
    assert twist.at(0) == Twist(0.5, 0.5, 0.0)


@pytest.mark.parametrize("kind", [DifferentialDrive, Omnidirectional])
@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"max_speed": -1.0}, "max_speed = -1.0 m/s must be finite and above 0"),
        ({"max_turn_rate": 0.0}, "max_turn_rate = 0.0"),
        ({"max_acceleration": math.nan}, "max_acceleration = nan"),
        ({"max_turn_acceleration": math.inf}, "max_turn_acceleration = inf"),
    ],
)
def test_wrong_limits_are_explained(kind, values, message):
    with pytest.raises(InputError, match=f"{kind.__name__}: {message}"):
        kind(**values)


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (Twist(math.nan, 0.0), "twist: forward = nan must be finite"),
        (Twist(0.0, math.inf), "twist: turn = inf must be finite"),
        (Twists(np.zeros(3), np.zeros(3), np.zeros(3)), "forward has shape \\[3\\], it must be one number or \\[2\\]"),
    ],
)
def test_wrong_commands_are_explained(command, message):
    pose, still = Pose.of(np.zeros((2, 2)), 0.0), Twists.of(Twist(), 2)
    with pytest.raises(InputError, match=message):
        DifferentialDrive().step(pose, still, command, 0.1)


def test_time_must_go_on():
    with pytest.raises(InputError, match="time step 0.0 s of a drive must be finite and above 0"):
        DifferentialDrive().step(Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), Twist(), 0.0)


def test_omnidirectional_limits_speed_and_acceleration_as_vectors():
    """The diagonal of two commands at their limits is limited to the speed, not to its components."""
    drive = Omnidirectional(max_speed=1.0, max_acceleration=100.0)
    pose, twist = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1)
    _, fast = drive.step(pose, twist, Twist(1.0, 0.0, left=1.0), 0.1)
    assert (fast.forward[0], fast.left[0]) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))
    _, fast = drive.step(pose, twist, Twist(6.0, 0.0, left=-8.0), 0.1)
    assert (fast.forward[0], fast.left[0]) == pytest.approx((0.6, -0.8))
    slow = Omnidirectional(max_speed=1.0, max_acceleration=2.0)
    _, pushed = slow.step(pose, twist, Twist(0.6, 0.0, left=0.8), 0.1)
    assert (pushed.forward[0], pushed.left[0]) == pytest.approx((0.12, 0.16))
    _, turned = slow.step(pose, Twists.of(Twist(0.6, 0.0, left=0.8), 1), Twist(0.6, 0.0, left=-0.8), 0.1)
    assert (turned.forward[0], turned.left[0]) == pytest.approx((0.6, 0.6))


@few
@given(speeds, speeds, speeds, speeds, st.floats(0.2, 5.0), st.floats(0.005, 0.1))
def test_the_lateral_acceleration_is_kept_once_it_is_reached(forward, turn, start, turning, most, dt):
    """Whatever is asked for, speed times turn rate falls below the limit, and stays there."""
    drive = DifferentialDrive(
        max_speed=2.0, max_turn_rate=3.0, max_acceleration=2.0, max_turn_acceleration=6.0, max_lateral_acceleration=most
    )
    pose, twist = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(start / 3.0, turning / 3.0), 1)
    for _ in range(math.ceil(1.5 / dt) + 1):
        pose, twist = drive.step(pose, twist, Twist(forward, turn), dt)
    assert abs(twist.forward[0] * twist.turn[0]) <= most + 1e-9
    goal = np.clip(forward, -2.0, 2.0)
    assert twist.forward[0] == pytest.approx(goal, abs=1e-9)  # the speed is not reduced
    free = np.clip(turn, -3.0, 3.0)
    if abs(goal * free) < most:
        assert twist.turn[0] == pytest.approx(free, abs=1e-9)


def test_without_a_limit_of_lateral_acceleration_nothing_changes():
    free, wide = DifferentialDrive(**FREE), DifferentialDrive(**FREE, max_lateral_acceleration=1e300)
    pose, twist = Pose.of((0.0, 0.0), 0.3), Twists.of(Twist(1.0, 2.0), 1)
    one, other = (drive.step(pose, twist, Twist(9.0, -9.0), 0.1) for drive in (free, wide))
    assert one[0].position.tobytes() == other[0].position.tobytes()
    assert one[1].turn[0] == other[1].turn[0] == -9.0
    with pytest.raises(InputError, match=r"max_lateral_acceleration = 0.0 m/s2 must be above 0"):
        DifferentialDrive(max_lateral_acceleration=0.0)
    with pytest.raises(InputError, match="max_lateral_acceleration = nan m/s2 must be above 0"):
        DifferentialDrive(max_lateral_acceleration=math.nan)


@pytest.mark.parametrize("kind", [DifferentialDrive, Omnidirectional])
def test_a_world_moves_robots_by_the_step_of_their_drive(kind):
    class Own(kind):
        def step(self, pose, twist, command, dt):
            calls.append(len(pose.heading))
            return super().step(pose, twist, command, dt)

    calls, rng = [], np.random.default_rng(2)
    start = Scene.of(
        rng.uniform(-9.0, 9.0, (3, 2, 2)), heading=rng.uniform(-3.0, 3.0, (3, 2)), external=True,
        active=[[True, True], [False, True], [True, True]],
    )  # fmt: skip
    one, two = (PlanarWorld(start, ORCA(), {1: drive(), 0: drive()}, 0.1) for drive in (kind, Own))
    for _ in range(20):
        commands = {robot: Twists(*rng.uniform(-2.0, 2.0, (3, 3))) for robot in range(2)}
        here, there = one.step(commands), two.step(commands)
        for name in ("position", "velocity", "heading"):
            np.testing.assert_array_equal(getattr(here, name), getattr(there, name))
    np.testing.assert_array_equal(here.position[1, 0], start.position[1, 0])
    assert calls == [3] * 40
