"""The depth camera by rays and from images, the lens, the law of stereo noise; timing and presets."""

import math

import numpy as np
import pytest

from crowdbot.core import FreeClock, InputError, Pose, Scene, SpatialPose, UnknownName, from_attributes, stream
from crowdbot.sensors import (
    PRESETS,
    DepthCamera,
    Lens,
    Lidar2D,
    Lidar3D,
    Quantised,
    RGBCamera,
    SensorSchedule,
    distort_image,
    preset,
)
from crowdbot.sensors.lens import pixel_directions, stereo_depth

BENT = (-0.28, 0.09, 0.0008, -0.0004, -0.01)


def room():
    """A wall 4 m ahead and a person before it."""
    return Scene.of([[2.0, 0.3]], radius=0.25, walls=[[(4.0, -30.0), (4.0, 30.0)]])


class Painter:
    """An image source that looks along x at a flat wall with a colour that grows to the right."""

    def render(self, camera, pose):
        lens = camera.lens
        shape = (len(pose.position), lens.height, lens.width)
        column = np.broadcast_to(np.arange(lens.width), shape)
        return {
            "depth": np.full(shape, 3.0),
            "hit": np.full(shape, 7),
            "rgb": np.stack([column, column, column], axis=-1).astype(np.uint8),
        }


def test_depth_is_metric_and_along_the_axis():
    camera = DepthCamera(width=81, height=61, field_of_view=math.radians(70.0))
    image = camera.read(room(), SpatialPose.of((0.0, 0.0, 1.2)))
    assert image.depth.shape == (1, 61, 81)
    on_wall = image.hit[0] == -2
    np.testing.assert_allclose(image.depth[0][on_wall], 4.0, rtol=0, atol=1e-9)
    assert set(np.unique(image.hit).tolist()) == {-3, -2, -1, 0}  # the sky above the wall too
    floor = image.hit[0] == -3
    assert np.all(np.nonzero(floor)[0] > 30)  # below the middle
    np.testing.assert_allclose(image.points(in_world=True)[0][floor][:, 2], 0.0, atol=1e-9)
    person = np.nonzero(image.hit[0] == 0)[1]
    assert person.max() < 40  # he stands to the left
    assert image.visible_agents(1).tolist() == [[True]]


def test_the_lens_bends_and_straightens():
    lens = Lens.of(320, 240, math.radians(80.0), BENT)
    x, y = np.meshgrid(np.linspace(-0.7, 0.7, 15), np.linspace(-0.5, 0.5, 11))
    back = lens.undistort(*lens.distort(x, y))
    np.testing.assert_allclose(back[0], x, atol=1e-9)
    np.testing.assert_allclose(back[1], y, atol=1e-9)
    directions = pixel_directions(Lens.of(3, 3, math.pi / 2))
    np.testing.assert_allclose(np.linalg.norm(directions, axis=-1), 1.0)
    assert directions[1, 0, 1] > 0.0 > directions[1, 2, 1]  # left is +y
    assert directions[0, 1, 2] > 0.0 > directions[2, 1, 2]  # up is +z


def test_images_are_bent_as_rays_are():
    """A bent depth image by rays equals the bent image of a pinhole, away from edges."""
    plain = DepthCamera(width=160, height=120, range_max=50.0)
    bent = DepthCamera(width=160, height=120, range_max=50.0, distortion=BENT)
    pose = SpatialPose.of((0.0, 0.0, 1.2))
    scene = Scene.of([[900.0, 0.0]], walls=[[(4.0, -300.0), (4.0, 300.0)]])
    by_rays, ideal = bent.read(scene, pose), plain.read(scene, pose)
    by_image = distort_image(ideal.depth, bent.lens, fill=np.nan)
    same = np.isclose(by_rays.depth, by_image, atol=0.15) | np.isnan(by_image)
    assert np.mean(same) > 0.97
    colours = RGBCamera(width=50, height=20, field_of_view=1.0).read(scene, pose, renderer=Painter()).rgb
    np.testing.assert_array_equal(colours[0, 5, :, 0], np.arange(50))
    shrunk = RGBCamera(width=50, height=20, field_of_view=1.0, distortion=(0.3, 0.0, 0.0, 0.0, 0.0))
    shrunk = shrunk.read(scene, pose, renderer=Painter()).rgb
    assert shrunk.dtype == np.uint8
    assert shrunk[0, 10, 45, 0] < 45


def test_depth_of_an_image_goes_through_the_same_law():
    pose = SpatialPose.of(np.zeros((2, 3)))
    image = DepthCamera(width=20, height=10, resolution=0.5, range_max=2.0).from_image(Painter(), 1.5, pose)
    assert np.all(image.depth == np.inf)
    assert np.all(image.hit == -1)
    image = DepthCamera(width=20, height=10, resolution=0.4).from_image(Painter(), 1.5, pose)
    np.testing.assert_allclose(image.depth, 3.2)
    assert image.time == 1.5
    assert np.all(image.hit == 7)


@pytest.mark.parametrize("z", [0.5, 2.0, 6.0])
def test_stereo_noise_grows_with_the_square_of_depth(z):
    focal, baseline, sd = 424.0, 0.05, 0.08
    found = stereo_depth(np.full((1, 100_000), z), focal, baseline, sd, 0.0, stream(1))
    expected = z**2 * sd / (focal * baseline)
    assert found.std() == pytest.approx(expected, rel=0.02)
    assert found.mean() == pytest.approx(z + expected**2 / z, abs=5 * expected / math.sqrt(100_000))
    step = 1 / 32
    exact = stereo_depth(np.linspace(z, 1.01 * z, 2000)[None], focal, baseline, 0.0, step, None)
    disparity = focal * baseline / exact
    np.testing.assert_allclose(disparity / step, np.round(disparity / step), atol=1e-6)
    assert np.abs(exact - np.linspace(z, 1.01 * z, 2000)).max() <= 1.03 * z**2 * 0.5 * step / (focal * baseline)


def test_stereo_sees_nothing_at_infinity_and_keeps_what_is_too_near():
    assert stereo_depth(np.array([[np.inf, 1e9]]), 400.0, 0.05, 0.0, 1.0, None).tolist() == [[np.inf, np.inf]]
    camera = DepthCamera(width=8, height=6, baseline=0.05, disparity_noise=0.1, range_min=0.5)
    near = camera.read(Scene.of([[0.0, 0.0]], radius=0.5), Pose.of((0.0, 0.0), 0.0), stream(0))
    assert np.all(near.depth == -np.inf)
    with pytest.raises(InputError, match="need a baseline above 0"):
        DepthCamera(disparity_noise=0.1)
    with pytest.raises(InputError, match="width = 0"):
        DepthCamera(width=0)
    with pytest.raises(InputError, match="field_of_view = 3.5 rad"):
        DepthCamera(field_of_view=3.5)
    with pytest.raises(InputError, match="five finite numbers"):
        DepthCamera(distortion=(0.1, 0.2))


def test_rate_and_delay_are_whole_ticks():
    plan = SensorSchedule.of(Lidar2D(rate=4.0, delay=0.3), FreeClock(0.05))
    assert (plan.ticks.every, plan.late) == (5, 6)
    assert [tick for tick in range(16) if plan.measures(tick)] == [0, 5, 10, 15]
    assert [plan.arrives(tick) for tick in (0, 5)] == [6, 11]
    with pytest.raises(InputError, match=r"Lidar2D: rate 30.0 Hz, delay 0.0 s: period 0.0333333 s is shorter than"):
        SensorSchedule.of(Lidar2D(rate=30.0), FreeClock(0.05))


@pytest.mark.parametrize("name", PRESETS)
def test_presets_measure_and_say_where_their_numbers_are_from(name):
    product = PRESETS[name]
    assert product.sensor.noises == ()
    changed = {
        field
        for field in type(product.sensor).__dataclass_fields__
        if getattr(product.sensor, field) != getattr(type(product.sensor)(), field)
    }
    assert changed <= set(product.sources)
    assert set(product.sources) <= set(type(product.sensor).__dataclass_fields__)
    assert not all(source.startswith("assumed: ") for source in product.sources.values())
    scene = Scene.of([[1.4, 0.0]], walls=[[(4.0, -9.0), (4.0, 9.0)]])
    reading = preset(name, noisy=True).read(scene, Pose.of((0.0, 0.0), 0.0).to_spatial(1.0), stream(0))
    values = reading.depth if name == "realsense-d435" else reading.ranges
    assert np.isfinite(values).any()


def test_known_numbers_of_products():
    scanner = preset("hokuyo-utm-30lx")
    assert math.degrees(scanner.step) == pytest.approx(0.25)
    assert math.degrees(preset("hokuyo-urg-04lx").field_of_view) == pytest.approx(239.41, abs=0.01)
    assert math.degrees(preset("sick-tim571").step) == pytest.approx(1 / 3)
    assert math.degrees(preset("rplidar-a2").step) == pytest.approx(0.45)
    puck = preset("velodyne-vlp-16")
    assert isinstance(puck, Lidar3D)
    assert np.degrees(puck.elevations).round(6).tolist() == list(range(-15, 16, 2))
    assert math.degrees(preset("pepper-sonar").half_angle) == pytest.approx(30.0, abs=1e-6)
    with pytest.raises(UnknownName, match="velodyne-vlp-16"):
        preset("velodyne-vlp16")


def test_sensors_are_read_from_text():
    assert from_attributes(Lidar3D, {"elevations": "-0.1 0.1", "columns": "8"}).elevations == (-0.1, 0.1)
    assert from_attributes(DepthCamera, {"distortion": "0.1 0 0 0 0"}).lens.distortion[0] == 0.1
    assert from_attributes(Lidar2D, {"noise": "quantised(0.1)", "delay": "0.1"}) == Lidar2D(
        noise=Quantised(0.1), delay=0.1
    )
