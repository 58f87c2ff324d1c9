"""What range sensors do at their limits, exactly: range, incidence, quantisation, zones."""

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import Bodies, InputError, Pose, Scene, SpatialPose, stream
from crowdbot.sensors import (
    FLOOR,
    NOTHING,
    PROP,
    WALLS,
    DepthCamera,
    Dropout,
    Gaussian,
    Infrared,
    Lidar2D,
    Lidar3D,
    Offset,
    Ultrasound,
)
from crowdbot.sensors.beams import cone_directions
from crowdbot.sensors.range_finders import teardrop

HIGH = SpatialPose.of((0.0, 0.0, 1.0))


def wall(distance, height=3.0):
    """A wall ahead."""
    return Scene.of([[500.0, 0.0]], walls=[[(distance, -90.0), (distance, 90.0)]], wall_height=height)


def one_value(sensor, scene, pose=HIGH, rng=None):
    """The smallest reading of a sensor and what it is of."""
    reading = sensor.read(scene, pose, rng)
    values = reading.depth if isinstance(sensor, DepthCamera) else reading.ranges
    return float(values.min()), int(reading.hit.flat[int(np.argmin(values))])


NARROW = {
    "lidar2d": lambda **f: Lidar2D(rays=1, **f),
    "lidar3d": lambda **f: Lidar3D(elevations=(0.0,), columns=1, azimuth_from=0.0, azimuth_to=1.0, **f),
    "ultrasound": lambda **f: Ultrasound(rays=1, **f),
    "infrared": lambda **f: Infrared(rays=1, **f),
    "depth": lambda **f: DepthCamera(width=1, height=1, **f),
}
every = pytest.mark.parametrize("made", NARROW.values(), ids=list(NARROW))


@every
def test_the_limits_of_range_are_measured_and_the_next_number_is_not(made):
    sensor = made(range_min=1.0, range_max=2.0)
    cases = [
        (1.0, 1.0, WALLS), (2.0, 2.0, WALLS), (math.nextafter(1.0, 0.0), -math.inf, WALLS),
        (math.nextafter(2.0, 3.0), math.inf, NOTHING), (0.0, -math.inf, WALLS),
    ]  # fmt: skip
    for distance, reading, hit in cases:
        assert one_value(sensor, wall(distance)) == (reading, hit)


@every
def test_what_is_met_too_slanted_is_missed_and_hides_what_is_behind(made):
    limit = math.radians(40.0)
    sensor = made(range_min=0.1, range_max=30.0, max_incidence=limit)
    behind = Scene.of([[9.0, 0.0]], radius=1.0, walls=[[(3.0, -90.0), (3.0, 90.0)]])
    for angle, seen in ((limit, True), (limit - 1e-6, True), (limit + 1e-6, False), (-limit - 1e-6, False)):
        value, hit = one_value(sensor, behind, SpatialPose.of((0.0, 0.0, 1.0), yaw=angle))
        assert (math.isfinite(value), hit) == ((True, WALLS) if seen else (False, NOTHING))


@every
def test_readings_are_whole_steps_within_the_limits(made):
    sensor = made(range_min=0.3, range_max=1.1, resolution=0.25)
    for distance, reading in ((0.3, 0.5), (0.62, 0.5), (0.63, 0.75), (1.1, 1.0), (1.12, math.inf)):
        assert one_value(sensor, wall(distance))[0] == reading


@every
def test_noise_decides_with_the_limits_and_dropped_returns_are_nothing(made):
    limits = {"range_min": 0.5, "range_max": 2.0}
    assert one_value(made(**limits, noise=Offset(-0.2)), wall(0.6), rng=stream(0))[0] == -math.inf
    assert one_value(made(**limits, noise=Offset(0.2)), wall(1.9), rng=stream(0))[0] == math.inf
    assert one_value(made(**limits, noise=Offset(-0.2)), wall(2.1), rng=stream(0))[0] == math.inf
    assert one_value(made(**limits, noise=Offset(0.2)), wall(1.0), rng=stream(0))[0] == pytest.approx(1.2)
    for distance in (0.2, 1.0, 5.0):
        lost = one_value(made(**limits, noise=Dropout(1.0)), wall(distance), rng=stream(0))
        assert lost == (math.inf, NOTHING)


@every
def test_a_low_wall_is_seen_only_from_below_its_top(made):
    sensor = made(range_min=0.1, range_max=9.0)
    assert one_value(sensor, wall(2.0, height=1.0))[0] == 2.0
    assert one_value(sensor, wall(2.0, height=0.999))[0] == math.inf


def test_a_level_scan_through_space_equals_the_one_from_above():
    rng = stream(4, "scan")
    scene = Scene.of(
        rng.uniform(-6, 6, (2, 20, 2)),
        radius=rng.uniform(0.1, 0.5, (2, 20)),
        walls=[[(-7, -7), (-7, 7), (7, 7), (7, -7)]],
    )
    lidar = Lidar2D(rays=720, range_max=20.0)
    pose = Pose.of(rng.uniform(-3, 3, (2, 2)), [0.4, -2.0])
    above, through = lidar.read(scene, pose), lidar.read(scene, pose.to_spatial(1.0))
    np.testing.assert_allclose(above.ranges, through.ranges, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(above.hit, through.hit)
    np.testing.assert_allclose(above.incidence, through.incidence, rtol=0, atol=1e-6)
    np.testing.assert_allclose(above.points(), through.points()[..., :2], rtol=0, atol=1e-9)
    np.testing.assert_allclose(through.points()[np.isfinite(through.ranges)][:, 2], 1.0)


def test_a_tilted_scan_sees_the_floor_in_a_straight_line():
    pitch, z = math.radians(15.0), 0.5
    lidar = Lidar2D(rays=181, field_of_view=math.pi * 0.6, range_max=30.0)
    scan = lidar.read(Scene.of([[500.0, 0.0]]), SpatialPose.of((1.0, 2.0, z), pitch=pitch, yaw=0.3))
    expected = z / (np.sin(pitch) * np.cos(lidar.angles))
    np.testing.assert_allclose(scan.ranges[0], expected, rtol=0, atol=1e-9)
    assert np.all(scan.hit == FLOOR)
    assert np.allclose(scan.points()[0, :, 2], 0.0, atol=1e-9)
    np.testing.assert_allclose(np.cos(scan.incidence[0]), z / expected, atol=1e-12)


def test_a_scan_at_knee_height_sees_two_legs_and_above_them_the_trunk():
    legs = Bodies.of(
        start=[[2.0, -0.15, 0.1], [2.0, 0.15, 0.1], [2.0, 0.0, 0.9]],
        end=[[2.0, -0.15, 0.8], [2.0, 0.15, 0.8], [2.0, 0.0, 1.4]],
        radius=[0.06, 0.06, 0.18], owner=[0, 0, 0], part=[1, 1, 0], parts=("torso", "leg"),
    )  # fmt: skip
    scene = Scene.of([[2.0, 0.0]], radius=0.3, bodies=legs)
    lidar = Lidar2D(rays=201, field_of_view=0.4)
    knee, chest = (lidar.read(scene, SpatialPose.of((0.0, 0.0, z))) for z in (0.4, 1.2))
    assert (np.diff(np.isfinite(knee.ranges[0]).astype(int)) == 1).sum() == 2
    assert set(knee.part[0].tolist()) == {-1, 1}
    assert (np.diff(np.isfinite(chest.ranges[0]).astype(int)) == 1).sum() == 1
    assert chest.ranges.min() == pytest.approx(1.82, abs=1e-12)
    assert set(chest.hit[0].tolist()) == {-1, 0}
    planar = lidar.read(scene, Pose.of((0.0, 0.0), 0.0))  # at the height of a usual mount
    assert planar.ranges.tobytes() == knee.ranges.tobytes()


def test_rings_of_a_cloud_meet_a_wall_where_they_should():
    lidar = Lidar3D(elevations=(-0.2, 0.0, 0.3), columns=91, azimuth_from=-0.5, azimuth_to=0.5, range_max=50.0)
    cloud = lidar.read(wall(4.0), SpatialPose.of((0.0, 0.0, 1.0)))
    expected = 4.0 / (np.cos(cloud.azimuth) * np.cos(cloud.elevation[:, None]))
    np.testing.assert_allclose(cloud.ranges[0, :2], expected[:2], rtol=0, atol=1e-9)
    over = 1.0 + 4.0 * math.tan(0.3) / np.cos(cloud.azimuth) > 3.0
    np.testing.assert_array_equal(np.isinf(cloud.ranges[0, 2]), over)
    points = cloud.points()
    assert points.shape == (1, 3, 91, 3)
    np.testing.assert_allclose(points[0, 1, :, 0], 4.0, atol=1e-9)


def test_a_cloud_is_told_in_the_sensors_frame():
    lidar = Lidar3D(columns=60)
    pose = SpatialPose.of((3.0, -2.0, 1.0), 0.2, -0.3, 2.0)
    cloud = lidar.read(wall(6.0), pose)
    there = pose.position[0] + cloud.points()[0] @ pose.matrix[0].T
    np.testing.assert_allclose(cloud.points(in_world=True)[0], there, atol=1e-9)
    finite = np.isfinite(there[..., 0])
    on_wall, on_floor = np.abs(there[finite][:, 0] - 6.0) < 1e-6, np.abs(there[finite][:, 2]) < 1e-6
    assert np.all(on_wall | on_floor)


def test_part_of_a_sphere():
    lidar = Lidar3D.sphere((-1.0, 1.0), (-0.5, 0.5), 0.5, range_max=5.0)
    assert lidar.elevations == (-0.5, 0.0, 0.5)
    np.testing.assert_allclose(lidar.azimuth, [-1.0, -0.5, 0.0, 0.5, 1.0])
    assert len(Lidar3D(columns=8).azimuth) == 8
    assert Lidar3D(columns=8).azimuth[-1] == pytest.approx(math.pi - math.pi / 4)
    for values, message in (
        ({"elevations": ()}, "at least one"), ({"elevations": (2.0,)}, "within -pi / 2"),
        ({"azimuth_from": 1.0, "azimuth_to": 0.0}, "in this order"), ({"azimuth_to": 4.0}, "at most 2 pi apart"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=message):
            Lidar3D(**values)


def test_the_teardrop_has_its_shape():
    radius, length = 1.0, 4.5
    u = np.linspace(0.5, 1.0, 501)
    rho = radius * 16.0 / (3.0 * math.sqrt(3.0)) * u * np.sqrt(u * (1.0 - u))
    assert rho.max() == pytest.approx(radius, abs=1e-6)
    assert u[np.argmax(rho)] == pytest.approx(0.75, abs=0.002)
    np.testing.assert_allclose(
        teardrop(np.arctan2(rho, u * length), radius, length), np.hypot(rho, u * length), atol=1e-6
    )
    half = Ultrasound(radius=radius, range_max=length).half_angle
    assert teardrop(np.array([half - 1e-9, half + 1e-6]), radius, length)[1] == 0.0
    t = np.linspace(0.01, math.pi - 0.01, 50)  # as D4.2 and the first simulator write it
    z = 0.5 * length * (1.0 - np.cos(t))
    written = radius * 8.0 / (3.0 * math.sqrt(3.0)) * 0.5 * (1.0 - np.cos(t)) * np.sin(t)
    u = z / length
    np.testing.assert_allclose(written, radius * 16 / (3 * math.sqrt(3)) * u * np.sqrt(u * (1 - u)), atol=1e-12)


@pytest.mark.parametrize("place", [(0.0, 0.0, 5.0), (40.0, -25.0, 6.3)])
@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.4, -0.2, 2.5), (0.0, 0.1, -1.3)])
def test_the_zone_of_ultrasound_is_right_at_any_pose(place, turn):
    """A pin at a point is heard when the point is in the teardrop, wherever the sensor is and looks."""
    sensor = Ultrasound(radius=0.8, range_max=3.0, range_min=0.0, rays=6000)
    pose = SpatialPose.of(place, *turn)
    for ahead, aside, heard in (
        (2.9, 0.0, True), (3.05, 0.0, False), (2.25, 0.74, True), (2.25, 0.9, False),
        (1.5, 0.55, True), (1.5, 0.75, False),
        (2.8, 0.4, True), (2.8, 0.65, False),
    ):  # fmt: skip
        for roll in (0.0, 1.0, 2.5):
            local = np.array([ahead, aside * math.cos(roll), aside * math.sin(roll)])
            point = pose.position[0] + pose.matrix[0] @ local
            pin = Bodies.of(start=[point], end=[point], radius=[0.03], owner=[-1])
            scene = Scene.of([[900.0, 0.0]], bodies=pin)
            echo = sensor.read(scene, pose)
            assert (echo.hit.tolist() == [PROP]) == heard, (ahead, aside, roll)
            if heard:
                assert echo.ranges[0] == pytest.approx(np.linalg.norm(local) - 0.03, abs=0.01)


def test_ultrasound_returns_the_nearest_of_several():
    scene = Scene.of([[2.0, 0.0], [1.2, 0.3], [-1.0, 0.0]], radius=0.2)
    echo = Ultrasound(rays=2000).read(scene, SpatialPose.of((0.0, 0.0, 1.0)))
    # the surface nearest to the sensor lies towards the middle of the disc, inside the zone
    assert echo.hit.tolist() == [1]
    assert echo.ranges[0] == pytest.approx(math.hypot(1.2, 0.3) - 0.2, abs=0.01)
    assert np.linalg.norm(echo.direction) == pytest.approx(1.0)


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (1.0, -0.4, 2.0), (0.0, -1.2, -0.7)])
def test_the_cone_of_infrared_turns_with_the_sensor(turn):
    sensor = Infrared(dispersion=math.radians(4.0), rays=500, range_max=3.0)
    pose = SpatialPose.of((7.0, 3.0, 5.0), *turn)
    for angle, seen in ((0.0, True), (3.7, True), (4.6, False)):
        for roll in np.linspace(0.0, 5.0, 5):
            a = math.radians(angle)
            local = 2.0 * np.array([math.cos(a), math.sin(a) * math.cos(roll), math.sin(a) * math.sin(roll)])
            point = pose.position[0] + pose.matrix[0] @ local
            scene = Scene.of([[900.0, 0.0]], bodies=Bodies.of(start=[point], end=[point], radius=[0.01], owner=[-1]))
            assert (sensor.read(scene, pose).hit.tolist() == [PROP]) == seen


def test_a_cone_is_covered_evenly():
    directions = cone_directions(0.5, 20_000)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1.0)
    off = np.arccos(np.clip(directions[:, 0], -1, 1))
    assert off.max() == pytest.approx(0.5, abs=1e-9)
    for angle in (0.1, 0.25, 0.4):
        assert np.mean(off < angle) == pytest.approx((1 - math.cos(angle)) / (1 - math.cos(0.5)), abs=2e-3)
    assert np.abs(directions[:, 1:].mean(axis=0)).max() < 1e-3


def test_dropped_returns_come_at_their_rate():
    lidar = Lidar2D(rays=20_000, range_max=50.0, noise=Dropout(0.1))
    scan = lidar.read(
        Scene.of([[900.0, 0.0]], walls=[[(-4, -4), (-4, 4), (4, 4), (4, -4)]]), Pose.of((0, 0), 0), stream(1)
    )
    assert np.mean(np.isinf(scan.ranges)) == pytest.approx(0.1, abs=4 * math.sqrt(0.09 / 20_000))
    assert np.all((scan.hit == NOTHING) == np.isinf(scan.ranges))


def test_noise_is_off_by_default():
    for kind in (Lidar2D, Lidar3D, Ultrasound, Infrared, DepthCamera):
        assert kind().noises == ()
        assert dataclasses.replace(kind(), noise=Gaussian(0.1)).noises == (Gaussian(0.1),)
