"""Bumper, inertial unit, wheel odometry and the ground truth of people."""

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import Bodies, InputError, Pose, Scene, SpatialPose, stream
from crowdbot.sensors import IMU, Bumper, Dropout, Gaussian, GroundTruthPeople, SensorView, WheelOdometry
from crowdbot.sensors.imu import GRAVITY

EMPTY = Scene.of([[900.0, 900.0]])


def ridden(sensor, poses, dt, rng=None):
    """Every reading along a way."""
    readings, state = [], sensor.begin()
    for k, pose in enumerate(poses):
        reading, state = sensor.measure(SensorView(EMPTY.replace(time=k * dt), pose), state, rng)
        readings.append(reading)
    return readings


def test_bumper_sectors_are_pressed_where_things_touch():
    bumper = Bumper(radius=0.5, sectors=4, first=-math.pi / 4)
    here = Pose.of((1.0, 1.0), math.pi / 2)
    for x, y, sector in ((1.0, 1.75, 0), (0.25, 1.0, 1), (1.0, 0.25, 2), (1.75, 1.0, 3)):
        pressure = bumper.read(Scene.of([[x, y]], radius=0.3), here)
        assert np.flatnonzero(pressure.pressed[0]).tolist() == [sector]
        assert pressure.depth[0, sector] == pytest.approx(0.05)
        assert pressure.hit[0, sector] == 0
    assert bumper.read(Scene.of([[1.0, 1.8]], radius=0.3), here).pressed.any()  # touching is enough
    assert not bumper.read(Scene.of([[1.0, 1.8 + 1e-9]], radius=0.3), here).pressed.any()
    assert bumper.read(Scene.of([[1.0, 1.0]], radius=0.6), here).pressed.all()  # inside a body
    assert not bumper.read(Scene.of([[1.0, 1.7]], radius=0.3).without(0), here).pressed.any()


def test_a_wide_contact_presses_all_sectors_that_it_covers():
    pressure = Bumper(radius=0.5, sectors=12, first=0.0).read(Scene.of([[0.6, 0.0]], radius=0.4), Pose.of((0, 0), 0.0))
    half = math.acos((0.36 + 0.25 - 0.16) / (2 * 0.6 * 0.5))
    covered = [k for k in range(12) if min(k, 12 - k - 1) * math.tau / 12 <= half]
    assert np.flatnonzero(pressure.pressed[0]).tolist() == covered


def test_walls_press_by_how_deep_they_reach():
    scene = Scene.of([[50.0, 0.0]], walls=[[(0.4, -5.0), (0.4, 5.0)]])
    pressure = Bumper(radius=0.5, sectors=8, first=-math.pi / 8).read(scene, Pose.of((0.0, 0.0), 0.0))
    assert pressure.depth[0, 0] == pytest.approx(0.1, abs=1e-4)
    assert pressure.hit[0].tolist() == [-2, -2, -1, -1, -1, -1, -1, -2]
    corner = Scene.of([[50.0, 0.0]], walls=[[(0.45, 0.0), (5.0, 0.0)]])
    pressure = Bumper(radius=0.5, sectors=8, first=-math.pi / 8).read(corner, Pose.of((0.0, 0.0), 0.0))
    assert np.flatnonzero(pressure.pressed[0]).tolist() == [0]
    assert pressure.depth[0, 0] == pytest.approx(0.05)


def test_limbs_press_only_at_the_height_of_the_ring():
    foot = Bodies.of(start=[[0.55, 0.0, 0.05]], end=[[0.55, 0.0, 0.6]], radius=[0.08], owner=[0])
    arm = Bodies.of(start=[[0.3, -0.2, 1.2]], end=[[0.3, 0.2, 1.2]], radius=[0.08], owner=[0])
    bumper = Bumper(radius=0.5, sectors=4, first=-math.pi / 4, low=-0.1, high=0.1)
    low = SpatialPose.of((0.0, 0.0, 0.2))
    assert bumper.read(Scene.of([[0.6, 0.0]], bodies=foot), low).depth[0, 0] == pytest.approx(0.03)
    assert not bumper.read(Scene.of([[0.3, 0.0]], bodies=arm), low).pressed.any()
    assert bumper.read(Scene.of([[0.3, 0.0]], bodies=arm), SpatialPose.of((0, 0, 1.05))).pressed[0, 0]
    leaning = Bodies.of(start=[[0.9, 0.0, 0.0]], end=[[0.1, 0.0, 0.8]], radius=[0.05], owner=[0])
    # its axis is 0.6 m away at 0.3 m, the upper edge of the ring, and 0.57 m with the slope of its surface
    assert bumper.read(Scene.of([[0.6, 0.0]], bodies=leaning), low).depth[0, 0] <= 0.0


def test_contacts_of_a_world_have_their_sector():
    bumper = Bumper(radius=0.5, sectors=4, first=-math.pi / 4)
    pose = Pose.of([[1.0, 0.0]], math.pi / 2)
    assert bumper.sector([[[1.0, 0.5], [0.5, 0.0], [1.0, -0.5], [1.5, 0.0]]], pose).tolist() == [[0, 1, 2, 3]]


def test_a_unit_at_rest_feels_gravity_in_its_own_frame():
    for roll, pitch in ((0.0, 0.0), (0.3, 0.0), (0.0, -0.4), (math.pi, 0.0)):
        pose = SpatialPose.of((1.0, 2.0, 0.5), roll, pitch, 1.2)
        last = ridden(IMU(), [pose] * 4, 0.01)[-1]
        expected = GRAVITY * np.array(
            [-math.sin(pitch), math.cos(pitch) * math.sin(roll), math.cos(pitch) * math.cos(roll)]
        )
        np.testing.assert_allclose(last.acceleration[0], expected, atol=1e-9)
        np.testing.assert_allclose(last.turn_rate, 0.0, atol=1e-9)


def test_circles_and_speeding_up_are_felt():
    dt, radius, rate = 1e-3, 2.0, 0.8
    angle = rate * dt * np.arange(6)
    poses = [Pose.of((radius * math.sin(a), radius * (1 - math.cos(a))), a) for a in angle]
    last = ridden(IMU(), poses, dt)[-1]
    np.testing.assert_allclose(last.acceleration[0], [0.0, radius * rate**2, GRAVITY], atol=2e-3)
    np.testing.assert_allclose(last.turn_rate[0], [0.0, 0.0, rate], atol=1e-9)
    faster = [Pose.of((0.5 * 1.5 * (k * dt) ** 2, 0.0), 0.0) for k in range(5)]
    np.testing.assert_allclose(ridden(IMU(), faster, dt)[-1].acceleration[0], [1.5, 0.0, GRAVITY], atol=1e-6)
    tumbling = [SpatialPose.of((0, 0, 0), roll=0.7 * dt * k) for k in range(3)]
    np.testing.assert_allclose(ridden(IMU(), tumbling, dt)[-1].turn_rate[0], [0.7, 0.0, 0.0], atol=1e-9)


def test_the_first_readings_do_not_take_motion_for_a_jerk():
    steady = [Pose.of((2.0 * 0.01 * k, 0.0), 0.0) for k in range(4)]
    for reading in ridden(IMU(), steady, 0.01):
        np.testing.assert_allclose(reading.acceleration[0], [0.0, 0.0, GRAVITY], atol=1e-9)


def test_white_noise_and_walk_have_their_densities():
    unit = IMU(acceleration_noise=0.02, turn_noise=0.003, acceleration_walk=0.05, turn_walk=0.01)
    still = Pose.of(np.zeros((3000, 2)), 0.0)
    scene = Scene.of(np.full((3000, 1, 2), 900.0))
    first, state = unit.measure(SensorView(scene, still), unit.begin(), stream(1))
    assert np.all(first.acceleration_bias == 0.0)
    second, state = unit.measure(SensorView(scene.replace(time=0.25), still), state, stream(2))
    error = 4 / math.sqrt(2 * 9000)
    white = second.acceleration - second.acceleration_bias - [0.0, 0.0, GRAVITY]
    assert white.std() == pytest.approx(0.02 / 0.5, rel=error)
    assert (second.turn_rate - second.turn_bias).std() == pytest.approx(0.003 / 0.5, rel=error)
    assert second.acceleration_bias.std() == pytest.approx(0.05 * 0.5, rel=error)
    assert second.turn_bias.std() == pytest.approx(0.01 * 0.5, rel=error)
    third, _ = unit.measure(SensorView(scene.replace(time=1.0), still), state, stream(3))
    assert third.acceleration_bias.std() == pytest.approx(0.05, rel=error)  # 1 s after the beginning
    offset = IMU(acceleration_offset=0.1).read(scene, still, stream(4))
    assert offset.acceleration_bias.std() == pytest.approx(0.1, rel=error)


def test_the_unit_saturates_and_loses_readings():
    spin = [Pose.of((0.0, 0.0), 0.5 * k) for k in range(3)]
    assert ridden(IMU(max_turn_rate=2.0, max_acceleration=5.0), spin, 0.1)[-1].turn_rate[0, 2] == 2.0
    assert ridden(IMU(max_acceleration=5.0), spin, 0.1)[-1].acceleration[0, 2] == 5.0
    assert np.isnan(IMU(noise=Dropout(1.0)).read(EMPTY, spin[0], stream(0)).acceleration).all()


@pytest.mark.parametrize("kind", [IMU, WheelOdometry])
def test_time_must_go_on(kind):
    view = SensorView(EMPTY, Pose.of((0.0, 0.0), 0.0))
    _, state = kind().measure(view, kind().begin())
    with pytest.raises(InputError, match="previous measurement is at 0.0 s and this one at 0.0 s; time must increase"):
        kind().measure(view, state)
    two = SensorView(Scene.of(np.zeros((2, 1, 2)), time=1.0), Pose.of(np.zeros((2, 2)), 0.0))
    with pytest.raises(InputError, match="the state has 1 environments, but the view has 2"):
        kind().measure(two, state)


def winding(count, dt=0.1):
    """Poses along arcs of steady forward speed and turn rate."""
    x, y, heading, poses = 0.5, -0.3, 0.7, []
    for k in range(count):
        poses.append(Pose.of((x, y), heading))
        forward, turn = 0.6 + 0.2 * math.sin(k), 0.8 * math.cos(0.3 * k)
        middle, chord = heading + 0.5 * turn * dt, forward * dt * np.sinc(turn * dt / math.tau)
        x, y, heading = x + chord * math.cos(middle), y + chord * math.sin(middle), heading + turn * dt
    return poses


def test_wheels_without_errors_follow_the_truth():
    readings = ridden(WheelOdometry(), winding(60), 0.1)
    for reading in readings:
        np.testing.assert_allclose(reading.estimate.position, reading.pose.position, atol=1e-12)
        np.testing.assert_allclose(reading.estimate.heading, reading.pose.heading, atol=1e-12)
    assert readings[8].twist[0, 0] == pytest.approx(0.6 + 0.2 * math.sin(7), abs=1e-9)
    assert readings[8].twist[0, 1] == pytest.approx(0.8 * math.cos(2.1), abs=1e-9)


def test_wrong_wheels_drift_as_they_should():
    straight = [Pose.of((0.1 * k, 0.0), 0.0) for k in range(101)]
    longer = ridden(WheelOdometry(left_scale=1.02, right_scale=1.02), straight, 0.1)[-1].estimate
    assert longer.position[0].tolist() == pytest.approx([10.0 / 1.02, 0.0], abs=1e-9)
    uneven = ridden(WheelOdometry(track=0.5, right_scale=1.01), straight, 0.1)[-1].estimate
    assert uneven.heading[0] == pytest.approx((10.0 / 1.01 - 10.0) / 0.5, abs=1e-9)
    turning = [Pose.of((0.0, 0.0), 0.05 * k) for k in range(101)]
    wide = ridden(WheelOdometry(track_scale=1.1), turning, 0.1)[-1].estimate
    assert wide.heading[0] == pytest.approx(5.0 * 1.1, abs=1e-9)


def test_slip_grows_with_the_root_of_the_way():
    many = np.zeros((4000, 2))
    scene = Scene.of(np.full((4000, 1, 2), 900.0))
    wheels = WheelOdometry(track=0.5, slip=0.02)
    state = wheels.begin()
    for k in range(26):
        place = many + [0.2 * k, 0.0]
        view = SensorView(scene.replace(time=0.1 * k), Pose.of(place, 0.0))
        last, state = wheels.measure(view, state, stream(5, k))
    off = last.travelled[:, :2] - 5.0
    assert abs(off.mean()) < 4 * 0.02 * math.sqrt(5.0) / math.sqrt(8000)
    assert off.std() == pytest.approx(0.02 * math.sqrt(5.0), rel=0.04)
    assert last.estimate.heading.std() == pytest.approx(0.02 * math.sqrt(10.0) / 0.5, rel=0.05)


def test_ticks_count_whole_and_lose_nothing():
    wheels = WheelOdometry(ticks_per_turn=100, wheel_radius=0.1)
    straight = [Pose.of((0.001 * k, 0.0), 0.0) for k in range(1001)]
    last = ridden(wheels, straight, 0.01)[-1]
    assert last.ticks[0].tolist() == [round(1.0 / wheels.tick)] * 2 + [0]
    assert abs(last.estimate.position[0, 0] - 1.0) <= 0.5 * wheels.tick + 1e-9


def test_only_holonomic_wheels_measure_going_sideways():
    aside = [Pose.of((0.0, 0.1 * k), 0.0) for k in range(6)]
    assert ridden(WheelOdometry(), aside, 0.1)[-1].estimate.position[0].tolist() == [0.0, 0.0]
    assert ridden(WheelOdometry(holonomic=True), aside, 0.1)[-1].estimate.position[0, 1] == pytest.approx(0.5)
    shown = ridden(WheelOdometry(noise=Gaussian(0.1)), aside, 0.1, stream(0))[-1]
    assert shown.estimate.position[0].tolist() == [0.0, 0.0]
    assert np.any(shown.twist != 0.0)


def test_people_are_told_in_the_sensors_frame():
    scene = Scene.of(
        [[3.0, 1.0], [1.0, 5.0], [-2.0, 1.0]], [[0.0, 1.0], [1.0, 0.0], [0.0, 0.0]], heading=[1.5, 0.0, 0.0]
    )
    told = GroundTruthPeople(visible_only=False).read(scene, Pose.of((1.0, 1.0), math.pi / 2))
    np.testing.assert_allclose(told.position[0], [[0.0, -2.0], [4.0, 0.0], [0.0, 3.0]], atol=1e-12)
    np.testing.assert_allclose(told.velocity[0], [[1.0, 0.0], [0.0, -1.0], [0.0, 0.0]], atol=1e-12)
    assert told.heading[0, 0] == pytest.approx(1.5 - math.pi / 2)
    assert told.ids() == [0, 1, 2]


def test_the_hidden_are_told_of_only_when_asked_for():
    scene = Scene.of([[2.0, 0.0], [4.0, 0.0], [0.0, 3.0], [0.0, -3.0]], radius=0.3, walls=[[(-2.0, 1.0), (2.0, 1.0)]])
    here = Pose.of((0.0, 0.0), 0.0)
    assert GroundTruthPeople().read(scene, here).ids() == [0, 3]
    assert GroundTruthPeople(visible_only=False).read(scene, here).ids() == [0, 1, 2, 3]
    assert GroundTruthPeople(visible_only=False, field_of_view=1.0).read(scene, here).ids() == [0, 1]
    assert GroundTruthPeople(visible_only=False, range_max=2.0).read(scene, here).ids() == [0]
    assert GroundTruthPeople().read(scene.without(0), here).ids() == [1, 3]
    told = GroundTruthPeople().read(scene, here)
    assert np.isnan(told.position[0, [1, 2]]).all()
    assert np.isnan(told.radius[0, 1])
    lost = dataclasses.replace(GroundTruthPeople(), noise=Dropout(1.0)).read(scene, here, stream(0))
    assert lost.ids() == []
