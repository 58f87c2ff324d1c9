"""Drives that steer or lag, and the dead time of commands."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Pose, Scene, Twist, stream
from crowdbot.models import ORCA
from crowdbot.world import AckermannDrive, CommandDelay, PlanarWorld, Twists, VelocityServo

few = settings(max_examples=60, deadline=None)
finite = st.floats(-1e6, 1e6)
ORIGIN = Pose.of((0.0, 0.0), 0.0)
STILL = Twists.of(Twist(), 1)


def driven(drive, command, dt, steps, pose=ORIGIN, twist=STILL):
    for _ in range(steps):
        pose, twist = drive.step(pose, twist, command, dt)
    return pose, twist


@few
@given(st.lists(st.tuples(finite, finite, finite), min_size=1, max_size=30), st.floats(0.01, 0.5))
def test_a_car_keeps_its_limits(commands, dt):
    drive = AckermannDrive(1.2, 0.7, 0.5, 0.8, 0.4)
    pose, twist, steering = ORIGIN, STILL, 0.0
    for command in commands:
        pose, after = drive.step(pose, twist, Twist(*command), dt)
        assert abs(after.forward[0]) <= 1.2
        assert abs(after.forward[0] - twist.forward[0]) <= 0.7 * dt + 1e-12
        assert abs(after.steering[0]) <= 0.5 + 1e-12
        assert abs(after.steering[0] - steering) <= 0.8 * dt + 1e-12
        assert after.left[0] == 0.0
        assert abs(after.turn[0]) <= abs(after.forward[0]) / drive.turning_radius + 1e-12
        twist, steering = after, float(after.steering[0])


def test_a_car_cannot_turn_on_the_spot():
    pose, twist = driven(AckermannDrive(), Twist(0.0, 2.0), 0.1, 20)
    assert (pose.heading[0], twist.at(0).turn) == (0.0, 0.0)
    assert twist.steering[0] == pytest.approx(0.6)


def test_a_car_goes_round_in_its_smallest_circle():
    drive = AckermannDrive(max_acceleration=1e6, max_steering_rate=1e6)
    radius = drive.turning_radius
    pose, twist = driven(drive, Twist(1.0, 10.0), 2 * math.pi * radius / 100, 100)
    assert twist.at(0).turn == pytest.approx(1.0 / radius)
    assert drive.max_turn_rate == pytest.approx(1.5 / radius)
    np.testing.assert_allclose(pose.position[0], [0.0, 0.0], atol=1e-9)
    half, _ = driven(drive, Twist(1.0, 10.0), math.pi * radius / 100, 100)
    np.testing.assert_allclose(half.position[0], [0.0, 2.0 * radius], atol=1e-9)


@pytest.mark.parametrize("forward", [0.8, -0.8])
def test_a_car_reaches_the_turn_rate_it_is_asked_for_in_both_directions(forward):
    _, twist = driven(AckermannDrive(), Twist(forward, 0.3), 0.05, 100)
    assert twist.at(0) == (pytest.approx(forward), pytest.approx(0.3), 0.0)


def test_wheels_stay_as_they_are_when_nothing_is_asked():
    _, turned = driven(AckermannDrive(), Twist(1.0, 1.0), 0.1, 30)
    _, coasting = AckermannDrive().step(ORIGIN, turned, Twist(), 0.1)
    assert coasting.steering.tolist() == turned.steering.tolist()


def test_a_plain_twist_stands_for_wheels_that_fit_it():
    drive = AckermannDrive()
    _, after = drive.step(ORIGIN, Twists.of(Twist(1.0, 0.4), 1), Twist(1.0, 0.4), 0.1)
    assert after.at(0) == (1.0, pytest.approx(0.4), 0.0)


def test_a_world_keeps_the_steering_between_steps():
    start = Scene.of([[0.0, 0.0]], external=[True])
    world = PlanarWorld(start, ORCA(), {0: AckermannDrive(max_steering_rate=0.5)}, dt=0.1)
    for _ in range(5):
        world.step({0: Twist(0.5, 5.0)})
    assert world.twists[0].steering[0] == pytest.approx(0.25)


@few
@given(st.lists(st.tuples(finite, finite, finite), min_size=1, max_size=30), st.floats(0.01, 0.5), st.booleans())
def test_a_servo_keeps_its_limits(commands, dt, sideways):
    drive = VelocityServo(0.9, 1.7, 0.6, 2.5, 0.2, sideways)
    pose, twist = ORIGIN, STILL
    for command in commands:
        pose, after = drive.step(pose, twist, Twist(*command), dt)
        assert math.hypot(after.forward[0], after.left[0]) <= 0.9 + 1e-9
        change = math.hypot(after.forward[0] - twist.forward[0], after.left[0] - twist.left[0])
        assert change <= 0.6 * dt + 1e-9
        assert abs(after.turn[0]) <= 1.7
        assert abs(after.turn[0] - twist.turn[0]) <= 2.5 * dt + 1e-9
        assert sideways or after.left[0] == 0.0
        twist = after


def test_a_servo_lags_as_its_time_constant_says_however_long_the_steps():
    drive = VelocityServo(max_acceleration=1e6, max_turn_acceleration=1e6, time_constant=0.3, sideways=True)
    for steps in (1, 7, 100):
        _, twist = driven(drive, Twist(0.8, 0.5, 0.4), 0.6 / steps, steps)
        share = 1.0 - math.exp(-2.0)
        np.testing.assert_allclose(twist.at(0), np.array([0.8, 0.5, 0.4]) * share, rtol=1e-9)


def test_a_servo_arrives():
    _, twist = driven(VelocityServo(), Twist(0.5, 0.5), 0.1, 60)
    assert twist.at(0) == Twist(0.5, 0.5, 0.0)
    _, stopped = driven(VelocityServo(), Twist(), 0.1, 60, twist=twist)
    assert stopped.at(0) == Twist()


@pytest.mark.parametrize("drive", [AckermannDrive(), VelocityServo(sideways=True)])
def test_a_batch_gives_the_bytes_of_each_alone(drive):
    rng = stream(3, "drive")
    place, heading = rng.normal(size=(9, 2)), rng.normal(size=9)
    start, command = Twists(*rng.normal(size=(3, 9)) * 0.3), Twists(*rng.normal(size=(3, 9)))
    pose, twist = drive.step(Pose.of(place, heading), start, command, 0.1)
    for e in range(9):
        one, alone = drive.step(Pose.of(place[e], heading[e]), Twists.of(start.at(e), 1), command.at(e), 0.1)
        assert one.position.tobytes() == pose.position[e].tobytes()
        assert alone.at(0) == twist.at(e)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: AckermannDrive(wheelbase=0.0), "AckermannDrive: wheelbase = 0.0 m must be finite and above 0"),
        (lambda: AckermannDrive(max_steering=1.6), "max_steering = 1.6 rad must be above 0 and below pi / 2"),
        (lambda: AckermannDrive(max_speed=math.nan), "max_speed = nan"),
        (lambda: VelocityServo(time_constant=0.0), "VelocityServo: time_constant = 0.0 s must be finite and above 0"),
        (lambda: VelocityServo(max_speed=-1.0), "VelocityServo: max_speed = -1.0"),
        (lambda: CommandDelay(-0.1), "CommandDelay: latency = -0.1 s must be finite and at least 0"),
        (lambda: CommandDelay(0.1).step((), Twist(), Twist(), 0.0), "time step 0.0 s of a drive"),
        (lambda: AckermannDrive().step(ORIGIN, STILL, Twist(math.inf), 0.1), "twist: forward = inf must be finite"),
        (lambda: VelocityServo().step(ORIGIN, STILL, Twist(), math.nan), "time step nan s of a drive"),
    ],
)
def test_wrong_values_are_explained(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize(("latency", "late"), [(0.0, 0), (0.1, 1), (0.25, 3), (0.3, 3)])
def test_commands_arrive_late_in_order_and_none_is_lost(latency, late):
    delay, pending, now = CommandDelay(latency), (), Twist()
    arrived = []
    for k in range(10):
        pending, now = delay.step(pending, now, Twist(float(k + 1)), 0.1)
        arrived.append(now.forward)
    assert arrived == [0.0] * late + [float(k + 1) for k in range(10 - late)]
    assert len(pending) == late
