"""Drives of skid-steer, mecanum, omni-wheel, tricycle and legged bases: kinematics and limits."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Pose, Twist, builtin_classes, stream
from crowdbot.world import (
    AckermannDrive,
    Drive,
    LeggedDrive,
    MecanumDrive,
    OmniWheelDrive,
    SkidSteerDrive,
    SteeredTwists,
    TricycleDrive,
    Twists,
    Wheel,
)

few = settings(max_examples=60, deadline=None)
finite = st.floats(-1e6, 1e6)
small = st.floats(-3.0, 3.0)
ORIGIN = Pose.of((0.0, 0.0), 0.0)
STILL = Twists.of(Twist(), 1)
WHEELED = (
    SkidSteerDrive(0.9, 1.7, 0.6, 2.5, 0.1, 9.0, 0.4, 0.3),
    MecanumDrive(0.9, 1.7, 0.6, 2.5, 0.1, 9.0, 0.4, 0.3),
    OmniWheelDrive(0.9, 1.7, 0.6, 2.5, 0.1, 9.0, 3, 0.2, 0.5),
    OmniWheelDrive(0.9, 1.7, 0.6, 2.5, 0.1, 9.0, 4, 0.25),
)


def driven(drive, command, dt, steps, pose=ORIGIN, twist=STILL):
    for _ in range(steps):
        pose, twist = drive.step(pose, twist, command, dt)
    return pose, twist


@few
@given(st.sampled_from(WHEELED), small, small, small)
def test_wheel_speeds_give_back_the_twist(drive, forward, turn, left):
    twist = Twist(forward, turn, left if drive.sideways else 0.0)
    found = drive.twist_of(drive.wheel_speeds(twist))
    np.testing.assert_allclose(found, twist, atol=1e-9)


@few
@given(st.sampled_from(WHEELED), st.lists(st.tuples(finite, finite, finite), min_size=1, max_size=30),
       st.floats(0.01, 0.5))  # fmt: skip
def test_all_limits_hold_on_the_way(drive, commands, dt):
    pose, twist = ORIGIN, STILL
    for command in commands:
        pose, after = drive.step(pose, twist, Twist(*command), dt)
        side, before = (after.left[0], twist.left[0]) if drive.sideways else (0.0, 0.0)  # else it slides
        assert math.hypot(after.forward[0], side) <= 0.9 + 1e-9
        assert abs(after.turn[0]) <= 1.7 + 1e-9
        assert np.abs(drive.wheel_speeds(after.at(0))).max() <= 9.0 + 1e-6
        assert math.hypot(after.forward[0] - twist.forward[0], side - before) <= 0.6 * dt + 1e-9
        assert abs(after.turn[0] - twist.turn[0]) <= 2.5 * dt + 1e-9
        assert drive.sideways or abs(after.left[0]) < 0.5 * 1.7 + 0.9
        twist = after


@pytest.mark.parametrize("drive", WHEELED)
def test_a_command_inside_the_limits_is_reached_exactly(drive):
    command = Twist(0.3, 0.4, 0.1 if drive.sideways else 0.0)
    _, twist = driven(drive, command, 0.1, 40)
    found = twist.at(0)
    assert (found.forward, found.turn) == (command.forward, command.turn)
    assert found.left == command.left if drive.sideways else -0.02 < found.left < 0.0  # slides outwards


def test_a_skid_steer_base_slides_by_the_balance_of_its_forces():
    drive = SkidSteerDrive(track=0.57, wheelbase=0.51, max_turn_rate=2.0)
    sides = drive.slide(Twists.of(Twist(0.0, 1.0), 1), Twists.of(Twist(0.0, 1.0), 1), 0.05)[0]
    assert sides == pytest.approx([-0.5 * 0.57 * drive.slip_factor, 0.5 * 0.57 * drive.slip_factor, 0.0], rel=0.02)
    slow, fast = (driven(drive, Twist(v, 1.5), 0.05, 80)[1].left[0] for v in (0.4, 0.9))
    assert fast < slow < 0.0
    mirror = driven(drive, Twist(0.9, -1.5), 0.05, 80)[1].left[0]
    assert mirror == pytest.approx(-fast, abs=1e-9)


def test_a_load_beside_the_middle_moves_the_centre_of_turning():
    drive = SkidSteerDrive(track=0.57, wheelbase=0.51, center_y=-0.07)
    turning = Twists.of(Twist(0.0, 1.0), 1)
    left, right, _ = drive.slide(turning, turning, 0.05)[0]
    assert right + left < -0.1  # the lighter left wheels slide more
    assert right - left > 0.57 * drive.slip_factor


def test_speed_and_turn_rate_are_limited_together_by_friction():
    drive = SkidSteerDrive(max_speed=3.0, max_turn_rate=4.0, friction=0.5, max_wheel_speed=500.0)
    twist = driven(drive, Twist(3.0, 4.0), 0.05, 200)[1].at(0)
    assert twist.forward * twist.turn == pytest.approx(drive.curve_share * 0.5 * 9.81)
    assert 0.2 < drive.curve_share < 0.4
    assert twist.turn / twist.forward == pytest.approx(4.0 / 3.0)


@pytest.mark.parametrize("x", [-0.03, 0.0, 0.03])
def test_all_tyres_slide_sideways_in_the_fastest_curve(x):
    limits = {"max_speed": 3.0, "max_turn_rate": 3.0, "max_wheel_speed": 500.0}
    drive = SkidSteerDrive(center_x=x, track=0.4, wheelbase=0.4, **limits)
    twist = driven(drive, Twist(3.0, 2.0), 0.05, 300)[1].at(0)
    slips = [twist.left + twist.turn * place for place in (-0.2, 0.2)]
    assert min(abs(slip) for slip in slips) == pytest.approx(0.3 * 0.2 * twist.turn, rel=0.05)
    assert slips[0] < 0.0 < slips[1]


@pytest.mark.parametrize("drive", WHEELED)
def test_a_command_beyond_the_wheels_keeps_its_curve(drive):
    _, twist = driven(drive, Twist(0.9, 1.7), 0.1, 60)
    assert np.abs(drive.wheel_speeds(twist.at(0))).max() == pytest.approx(9.0)
    assert twist.turn[0] / twist.forward[0] == pytest.approx(1.7 / 0.9)


def test_the_slip_factor_of_real_robots():
    jackal, husky = SkidSteerDrive(track=0.37559, wheelbase=0.262), SkidSteerDrive(track=0.5708, wheelbase=0.512)
    assert jackal.slip_factor == pytest.approx(1.5, rel=0.02)  # wheel_separation_multiplier of jackal_control
    assert husky.slip_factor == pytest.approx(1.875, rel=0.05)  # that of husky_control
    assert SkidSteerDrive(slip=1.3).slip_factor == 1.3


def test_mecanum_wheels_contradict_each_other_in_one_direction():
    drive = MecanumDrive()
    assert drive.twist_of(np.array([1.0, 1.0, -1.0, -1.0])) == pytest.approx((0.0, 0.0, 0.0))
    with pytest.raises(InputError, match=r"wheel speeds of shape \[3\] must be one for each of the 4 wheels"):
        drive.twist_of(np.zeros(3))


@few
@given(st.lists(st.tuples(finite, finite, finite), min_size=1, max_size=30), st.floats(0.01, 0.5))
def test_a_tricycle_keeps_its_limits(commands, dt):
    drive = TricycleDrive(1.2, 0.7, 1.1, 0.8, 0.4)
    pose, twist, steering, speed = ORIGIN, STILL, 0.0, 0.0
    for command in commands:
        pose, after = drive.step(pose, twist, Twist(*command), dt)
        rolling = float(drive.rolling(after, after.steering)[0])
        assert abs(rolling) <= 1.2 + 1e-9
        assert abs(rolling - speed) <= 0.7 * dt + 1e-9
        assert abs(after.steering[0]) <= 1.1 + 1e-12
        assert abs(after.steering[0] - steering) <= 0.8 * dt + 1e-12
        assert after.left[0] == 0.0
        twist, steering, speed = after, float(after.steering[0]), rolling


@few
@given(st.floats(-1.5, 1.5), st.floats(-1.0, 1.0).filter(lambda v: abs(v) > 1e-3))
def test_steering_and_rolling_give_back_the_motion(steering, speed):
    for drive in (TricycleDrive(max_steering=1.55), AckermannDrive(max_steering=1.55)):
        way = drive.motion(steering)
        twist = SteeredTwists(
            *(np.array([part * speed]) for part in (way.forward, way.turn, 0.0)), np.array([steering])
        )
        assert float(drive.rolling(twist, twist.steering)[0]) == pytest.approx(speed)


@pytest.mark.parametrize("command", [Twist(0.5, 0.4), Twist(-0.5, 0.4), Twist(-0.3, -0.6), Twist(0.4, 0.0)])
def test_a_tricycle_reaches_what_it_is_asked_for(command):
    _, twist = driven(TricycleDrive(), command, 0.05, 100)
    assert twist.at(0) == pytest.approx(command, abs=1e-9)


@pytest.mark.parametrize("turn", [0.8, -0.8])
def test_a_tricycle_turns_on_the_spot_only_with_a_wheel_across(turn):
    _, twist = driven(TricycleDrive(max_steering=math.pi / 2), Twist(0.0, turn), 0.05, 100)
    assert twist.at(0) == pytest.approx((0.0, turn, 0.0), abs=1e-9)
    _, twist = driven(TricycleDrive(max_steering=1.0), Twist(0.0, turn), 0.05, 100)
    assert twist.at(0) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert TricycleDrive(max_steering=math.pi / 2).turning_radius == 0.0


@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_a_tricycle_stays_in_its_place_until_its_wheel_is_across(turn):
    drive, pose, twist = TricycleDrive(max_steering=math.pi / 2), ORIGIN, STILL
    for _ in range(60):
        pose, twist = drive.step(pose, twist, Twist(0.0, turn), 0.05)
        assert abs(twist.forward[0]) < 1e-12
    assert twist.turn[0] == pytest.approx(turn)
    assert np.abs(pose.position).max() < 1e-12


@few
@given(st.floats(-1.0, 1.0), st.floats(-2.0, 2.0), st.floats(-1.1, 1.1))
def test_a_tricycle_that_steers_moves_ahead_no_faster_than_asked(forward, turn, steering):
    drive, pose = TricycleDrive(max_acceleration=9.0), ORIGIN
    twist = SteeredTwists(*(np.zeros(1) for _ in range(3)), np.array([steering]))
    for _ in range(60):
        pose, twist = drive.step(pose, twist, Twist(forward, turn), 0.05)
        assert abs(twist.forward[0]) <= abs(forward) + 1e-9


def test_a_tricycle_keeps_its_forward_speed_in_a_curve_that_is_too_tight():
    drive = TricycleDrive(max_steering=0.5)
    _, twist = driven(drive, Twist(0.3, 5.0), 0.05, 100)
    assert twist.at(0) == pytest.approx((0.3, 0.3 / drive.turning_radius, 0.0))


@few
@given(st.lists(st.tuples(finite, finite, finite), min_size=1, max_size=20), st.floats(0.01, 0.5))
def test_a_legged_base_stays_in_its_ellipse(commands, dt):
    drive, pose, twist = LeggedDrive(1.2, 0.4, 1.0, 0.8, 2.0), ORIGIN, STILL
    for command in commands:
        pose, after = drive.step(pose, twist, Twist(*command), dt)
        assert math.hypot(after.forward[0] / 1.2, after.left[0] / 0.4) <= 1.0 + 1e-9
        assert abs(after.turn[0]) <= 1.0 + 1e-9
        twist = after


@pytest.mark.parametrize("drive", [*WHEELED, TricycleDrive(), LeggedDrive()])
def test_a_batch_equals_each_environment(drive):
    rng = stream(5, "base-drives")
    place, heading = rng.normal(size=(9, 2)), rng.normal(size=9)
    start, command = Twists(*rng.normal(size=(3, 9)) * 0.2), Twists(*rng.normal(size=(3, 9)))
    pose, twist = drive.step(Pose.of(place, heading), start, command, 0.1)
    for e in range(9):
        one, alone = drive.step(Pose.of(place[e], heading[e]), Twists.of(start.at(e), 1), command.at(e), 0.1)
        assert one.position.tobytes() == pose.position[e].tobytes()
        assert alone.at(0) == twist.at(e)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: SkidSteerDrive(slip=0.5), "SkidSteerDrive: slip = 0.5 must be finite and at least 1"),
        (lambda: SkidSteerDrive(center_y=0.3), "SkidSteerDrive: center_y = 0.3 m must be at least -0.2 m and at most"),
        (lambda: SkidSteerDrive(track=0.0), "SkidSteerDrive: track = 0.0 m must be finite and above 0"),
        (lambda: MecanumDrive(wheel_radius=math.nan), "MecanumDrive: wheel_radius = nan m"),
        (lambda: MecanumDrive(max_wheel_speed=-1.0), "MecanumDrive: max_wheel_speed = -1.0 rad/s"),
        (lambda: OmniWheelDrive(wheels=2), "OmniWheelDrive: wheels = 2 must be"),
        (lambda: TricycleDrive(max_steering=1.6), "max_steering = 1.6 rad must be above 0 and at most pi / 2"),
        (lambda: LeggedDrive(max_speed=0.4, max_side_speed=0.5), "LeggedDrive: max_side_speed = 0.5 m/s must be"),
        (lambda: MecanumDrive().step(ORIGIN, STILL, Twist(), 0.0), "time step 0.0 s of a drive"),
        (lambda: SkidSteerDrive().step(ORIGIN, STILL, Twist(math.nan), 0.1), "twist: forward = nan must be finite"),
        (lambda: Wheel("a", 0.1, rollers=1.5), "rollers = 1.5 rad of 'a' must be at most 1.4"),
    ],
)
def test_wrong_values_are_explained(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_all_drives_are_listed():
    import crowdbot.world as room

    names = builtin_classes(room, Drive)
    expected = {"skid-steer-drive", "mecanum-drive", "omni-wheel-drive", "tricycle-drive", "legged-drive"}
    assert expected <= set(names)
    assert "wheeled-drive" not in names
