"""Wheel odometry from the angles of wheels: geometry, calibration errors, encoder counts and slip."""

from __future__ import annotations

import math

import numpy as np
import pytest

from crowdbot.core import InputError, Pose, Scene, stream
from crowdbot.sensors import (
    Gaussian,
    SensorView,
    WheelGeometry,
    WheelOdometry,
    WheelRotation,
    along_arc,
    arc_between,
    put_state_rows,
    take_state_rows,
)

EMPTY = Scene.of(np.zeros((1, 0, 2)))
TWO = WheelGeometry.differential(track=0.4, radius=0.1)
HERE = Pose.of((0.0, 0.0), 0.0)


def drive(odometry, geometry, angles, steering=None, poses=None, rng=None, dt=0.1):
    """Measure a list of wheel angles, and return the last reading."""
    state, reading = odometry.begin(), None
    for k, row in enumerate(angles):
        angle = None if row is None else np.atleast_2d(np.asarray(row, dtype=np.float64))
        turned = None if steering is None else np.atleast_2d(np.asarray(steering[k], dtype=np.float64))
        pose = HERE if poses is None else poses[k]
        count = 1 if angle is None else len(angle)
        scene = Scene.of(np.zeros((count, 0, 2)), time=dt * k)
        pose = Pose.of(np.repeat(pose.position, count, axis=0), np.repeat(pose.heading, count))
        view = SensorView(scene, pose, wheels=WheelRotation(geometry, angle, turned))
        reading, state = odometry.measure(view, state, rng)
    return reading


def test_wheels_that_turn_move_the_estimate_and_not_the_truth():
    straight = drive(WheelOdometry(), TWO, [[0.0, 0.0], [10.0, 10.0]])
    assert straight.estimate.position[0].tolist() == pytest.approx([1.0, 0.0])
    assert straight.pose.position[0].tolist() == [0.0, 0.0]
    assert straight.twist[0].tolist() == pytest.approx([10.0, 0.0, 0.0])
    spin = drive(WheelOdometry(), TWO, [[0.0, 0.0], [-2.0, 2.0]])
    assert spin.estimate.heading[0] == pytest.approx(1.0)
    assert spin.estimate.position[0].tolist() == pytest.approx([0.0, 0.0], abs=1e-12)
    assert spin.travelled[0].tolist() == pytest.approx([-0.2, 0.2, 0.0])


def test_wheels_that_roll_give_the_numbers_of_the_plane():
    rng = np.random.default_rng(3)
    poses, angles, angle, pose = [HERE], [np.zeros(2)], np.zeros(2), HERE
    for _ in range(40):
        forward, turn = rng.uniform(-0.1, 0.3), rng.uniform(-0.4, 0.4)
        angle = angle + TWO.rolling @ np.array([forward, turn, 0.0])
        middle, chord = float(pose.heading[0]) + 0.5 * turn, forward * np.sinc(turn / math.tau)
        step = np.array([[chord * math.cos(middle), chord * math.sin(middle)]])
        pose = Pose(pose.position + step, pose.heading + turn)
        poses.append(pose)
        angles.append(angle)
    for errors in ({}, {"left_scale": 1.02, "track_scale": 0.97}, {"wheel_radius": 0.11, "track": 0.36}):
        odometry = WheelOdometry(**errors)
        flat, real = (drive(odometry, TWO, rows, poses=poses) for rows in ([None] * len(poses), angles))
        assert real.estimate.position == pytest.approx(flat.estimate.position, abs=1e-9)
        assert real.estimate.heading == pytest.approx(flat.estimate.heading, abs=1e-9)
        assert real.travelled == pytest.approx(flat.travelled, abs=1e-9)
    assert drive(WheelOdometry(), TWO, angles).estimate.position == pytest.approx(pose.position, abs=1e-9)


@pytest.mark.parametrize("angles", [[[0.0, 0.0], [10.0, 10.0]], [None, None]], ids=["encoders", "rolling"])
def test_wrong_radii_and_tracks_show(angles):
    poses = [HERE, Pose.of((1.0, 0.0), 0.0)]
    larger = drive(WheelOdometry(wheel_radius=0.11), TWO, angles, poses=poses)
    assert larger.estimate.position[0].tolist() == pytest.approx([1.1, 0.0])
    uneven = drive(WheelOdometry(right_scale=1.01), TWO, angles, poses=poses)
    assert uneven.estimate.heading[0] == pytest.approx((1.0 / 1.01 - 1.0) / 0.4)
    turning = [None, None] if angles[0] is None else [[0.0, 0.0], [-2.0, 2.0]]
    for errors in ({"track": 0.5}, {"track_scale": 0.8}):
        narrow = drive(WheelOdometry(**errors), TWO, turning, poses=[HERE, Pose.of((0.0, 0.0), 1.0)])
        assert narrow.estimate.heading[0] == pytest.approx(0.8)


def test_encoders_count_whole_ticks_and_lose_nothing():
    odometry = WheelOdometry(ticks_per_turn=100)
    last = drive(odometry, TWO, [[0.01 * k, 0.005 * k] for k in range(2001)])
    assert last.ticks[0].tolist() == [round(20.0 / (math.tau / 100)), round(10.0 / (math.tau / 100)), 0]
    assert last.travelled[0, :2] == pytest.approx(last.ticks[0, :2] * math.tau * 0.1 / 100)
    assert last.estimate.heading[0] == pytest.approx(-1.0 / 0.4, abs=2 * math.tau * 0.1 / 100 / 0.4)


def test_random_slip_grows_with_the_root_of_the_distance():
    count = 3000
    angles = [np.full((count, 2), 0.5 * k) for k in range(21)]
    last = drive(WheelOdometry(slip=0.02), TWO, angles, rng=stream(1))
    off = last.travelled[:, :2] - 1.0
    assert off.std() == pytest.approx(0.02, rel=0.05)
    assert abs(off.mean()) < 4 * 0.02 / math.sqrt(2 * count)


@pytest.mark.parametrize("encoders", [False, True])
def test_the_covariance_is_that_of_many_runs(encoders):
    count = 4000
    odometry = WheelOdometry(slip=0.03, noise=Gaussian(0.1))
    pose, angle, state, rng = HERE, np.zeros(2), odometry.begin(), stream(1)
    for k in range(41):  # 2 m along an S
        here = Pose(np.repeat(pose.position, count, axis=0), np.repeat(pose.heading, count))
        wheels = WheelRotation(TWO, np.tile(angle, (count, 1))) if encoders else None
        scene = Scene.of(np.zeros((count, 0, 2)), time=0.1 * k)
        last, state = odometry.measure(SensorView(scene, here, wheels=wheels), state, rng)
        turn = 0.05 if k < 20 else -0.03
        pose = along_arc(pose, np.array([0.05]), np.zeros(1), np.array([turn]))
        angle = angle + (0.05 + np.array([-0.2, 0.2]) * turn) / 0.1
    ends = np.column_stack([last.estimate.position, last.estimate.heading])
    largest = np.sqrt(np.outer(*[np.diag(np.cov(ends.T))] * 2))
    np.testing.assert_array_less(np.abs(last.covariance.mean(axis=0) - np.cov(ends.T)) / largest, 0.1)
    np.testing.assert_allclose(last.twist_covariance.mean(axis=0), np.cov(last.twist.T), atol=0.004)


def test_without_random_errors_the_covariance_is_zero():
    last = drive(WheelOdometry(left_scale=1.02), TWO, [[0.0, 0.0], [1.0, 1.3]])
    assert not last.covariance.any()
    assert not last.twist_covariance.any()


def test_four_wheels_are_averaged_and_a_wide_track_is_a_parameter():
    row = np.array([[1.0, -0.2, 0.0], [1.0, -0.2, 0.0], [1.0, 0.2, 0.0], [1.0, 0.2, 0.0]]) / 0.1
    place = np.array([[0.3, 0.2], [-0.3, 0.2], [0.3, -0.2], [-0.3, -0.2]])
    skid = WheelGeometry(("a", "b", "c", "d"), ("",) * 4, place, np.full(4, 0.1), row)
    last = drive(WheelOdometry(), skid, [np.zeros(4), [-1.9, -2.1, 2.1, 1.9]])
    assert last.estimate.heading[0] == pytest.approx(1.0)
    assert last.travelled[0].tolist() == pytest.approx([-0.2, 0.2, 0.0])
    wide = drive(WheelOdometry(track=0.8), skid, [np.zeros(4), [-2.0, -2.0, 2.0, 2.0]])
    assert wide.estimate.heading[0] == pytest.approx(0.5)


def test_a_steered_wheel_gives_the_turn():
    place, ahead = np.array([[1.0, 0.0]]), np.array([[5.0, 0.0, 0.0]])
    tricycle = WheelGeometry(("front",), ("fork",), place, np.array([0.2]), ahead)
    straight = drive(WheelOdometry(), tricycle, [[0.0], [5.0]], steering=[[0.0], [0.0]])
    assert straight.estimate.position[0].tolist() == pytest.approx([1.0, 0.0])
    turn = math.pi / 6
    bent = drive(WheelOdometry(), tricycle, [[0.0], [5.0]], steering=[[turn], [turn]])
    assert bent.twist[0].tolist() == pytest.approx([10 * math.cos(turn), 10 * math.sin(turn), 0.0])
    across = drive(WheelOdometry(), tricycle, [[0.0], [5.0]], steering=[[math.pi / 2]] * 2)
    assert across.twist[0].tolist() == pytest.approx([0.0, 10.0, 0.0], abs=1e-9)


def test_omnidirectional_wheels_give_sideways_motion():
    ways = np.radians([60.0, 180.0, 300.0])
    rows = np.stack([-np.sin(ways), np.full(3, 0.2), np.cos(ways)], axis=1) / 0.05
    place = 0.2 * np.stack([np.cos(ways), np.sin(ways)], axis=1)
    omni = WheelGeometry(("a", "b", "c"), ("",) * 3, place, np.full(3, 0.05), rows, sideways=True)
    last = drive(WheelOdometry(holonomic=True), omni, [np.zeros(3), rows @ [0.1, 0.0, 0.3]])
    assert last.estimate.position[0].tolist() == pytest.approx([0.1, 0.3])
    plain = drive(WheelOdometry(), omni, [np.zeros(3), rows @ [0.1, 0.0, 0.3]])
    assert plain.estimate.position[0].tolist() == pytest.approx([0.1, 0.0])


def test_an_axle_behind_the_middle_moves_the_middle_sideways():
    place = np.array([[-0.3, 0.2], [-0.3, -0.2]])
    behind = WheelGeometry(("a", "b"), ("", ""), place, np.full(2, 0.1), TWO.rolling, -0.3)
    last = drive(WheelOdometry(), behind, [[0.0, 0.0], [-0.2, 0.2]])
    assert last.twist[0].tolist() == pytest.approx([0.0, 1.0, 0.3])


def test_environments_measure_together_and_alone():
    geometry, odometry = TWO, WheelOdometry(ticks_per_turn=500)
    angles = np.array([[1.0, 2.0], [3.0, -1.0], [0.5, 0.5]])
    pose = Pose.of(np.zeros((3, 2)), 0.0)
    begin = SensorView(Scene.of(np.zeros((3, 0, 2))), pose, wheels=WheelRotation(geometry, np.zeros((3, 2))))
    later = SensorView(Scene.of(np.zeros((3, 0, 2)), time=0.5), pose, wheels=WheelRotation(geometry, angles))
    _, state = odometry.measure(begin, odometry.begin())
    whole, after = odometry.measure(later, state)
    part, some = odometry.measure(later.select([2, 0]), take_state_rows(state, [2, 0]))
    assert part.estimate.position.tolist() == whole.estimate.position[[2, 0]].tolist()
    assert part.ticks.tolist() == whole.ticks[[2, 0]].tolist()
    joined = put_state_rows(state, [2, 0], some, 3)
    assert joined.angle.tolist() == [[1.0, 2.0], [0.0, 0.0], [0.5, 0.5]]
    assert after.angle.tolist() == angles.tolist()


def test_encoders_that_appear_begin_at_their_angle():
    odometry = WheelOdometry()
    _, state = odometry.measure(SensorView(EMPTY, HERE), odometry.begin())
    wheels = WheelRotation(TWO, np.array([[50.0, 50.0]]))
    later, state = odometry.measure(SensorView(EMPTY.replace(time=0.1), HERE, wheels=wheels), state)
    assert later.estimate.position[0].tolist() == [0.0, 0.0]
    wheels = WheelRotation(TWO, np.array([[51.0, 51.0]]))
    later, _ = odometry.measure(SensorView(EMPTY.replace(time=0.2), HERE, wheels=wheels), state)
    assert later.estimate.position[0, 0] == pytest.approx(0.1)


def test_a_geometry_has_a_row_for_each_wheel():
    with pytest.raises(InputError, match=r"2 wheels need a position, a radius and a row of rolling each"):
        WheelGeometry(("a", "b"), ("", ""), np.zeros((2, 2)), np.ones(1), np.zeros((2, 3)))
    with pytest.raises(InputError, match=r"wheel_radius = -1.0 m must be"):
        WheelOdometry(wheel_radius=-1.0)


def test_arcs_are_exact():
    forward, left, turn = arc_between(HERE, Pose.of((2.0, 2.0), math.pi / 2))
    assert (forward[0], left[0], turn[0]) == pytest.approx((math.pi, 0.0, math.pi / 2), abs=1e-12)
