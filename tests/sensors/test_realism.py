"""Pulsed scanners and exposed cameras: without effects equal to the plain ones, and each effect alone."""

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import InputError, Pose, Scene, SpatialPose, stream
from crowdbot.sensors import (
    ExposedCamera,
    Gaussian,
    Lidar2D,
    PulsedLidar2D,
    RGBCamera,
    SensorView,
    check_sensor,
)

HERE = Pose.of((0.0, 0.0), 0.0)
WALL = [[(-4.0, -9.0), (-4.0, 9.0)], [(5.0, -9.0), (5.0, 9.0)]]
SCENE = Scene.of([[3.0, 0.0], [0.0, 2.0]], [[0.0, 1.0], [0.0, 0.0]], radius=0.3, walls=WALL)


def ranges(scene=SCENE, rng=None, pose=HERE, **effects):
    return PulsedLidar2D(rays=360, **effects).read(scene, pose, rng).ranges[0]


def test_without_effects_it_is_the_plain_scanner():
    plain, pulsed = (kind(rays=360).read(SCENE, Pose.of((0.1, 0.3), 0.2)) for kind in (Lidar2D, PulsedLidar2D))
    there = np.isfinite(plain.ranges)
    assert np.array_equal(there, np.isfinite(pulsed.ranges))
    assert pulsed.ranges[there] == pytest.approx(plain.ranges[there], abs=1e-9)
    assert np.array_equal(pulsed.hit, plain.hit)
    assert (pulsed.beam_time == 0.0).all()


def test_all_effects_keep_the_contract():
    check_sensor(
        PulsedLidar2D(
            rays=36, scan_time=0.1, beam_width=0.02, echoes=2, range_10=5.0, false_returns=0.1, glass=(1,),
            black_clothes=0.3, noise=Gaussian(0.01),
        )
    )  # fmt: skip
    check_sensor(ExposedCamera(width=12, height=9, exposure=0.02, readout=0.03, full_well=5e3, read_noise=1.0))


def test_a_rolling_scan_sees_people_where_they_were():
    """A person who walks across is seen later by later beams."""
    scene = Scene.of([[3.0, 0.0]], [[0.0, 2.0]], radius=0.3)
    lidar = PulsedLidar2D(rays=720, scan_time=0.2)
    scan = lidar.read(scene, HERE)
    ends = scan.points()[0][scan.hit[0] == 0]
    assert ends[:, 1].mean() == pytest.approx(-0.2, abs=0.03)  # half a scan before: 0.1 s of 2 m/s
    assert scan.beam_time[0] == pytest.approx(-0.2, abs=1e-3)
    assert np.diff(scan.beam_time) == pytest.approx(0.2 / 720)


def test_a_turning_scanner_shears_a_rolling_scan():
    lidar, scene = PulsedLidar2D(rays=360, scan_time=0.1), Scene.of([[60.0, 0.0]], walls=WALL)
    first, second = (SensorView(scene.replace(time=t), Pose.of((0.0, 0.0), t)) for t in (0.0, 0.1))
    state = lidar.measure(first, lidar.begin())[1]
    seen = lidar.measure(second, state)[0]
    straight = lidar.read(scene.replace(time=0.1), Pose.of((0.0, 0.0), 0.1)).points()[0]
    turned = seen.points()[0]
    assert np.abs(straight[np.isfinite(straight[:, 0]), 0] - 5.0).min() < 1e-9
    early = np.isfinite(turned[:, 0]) & (turned[:, 0] > 0.0) & (turned[:, 1] < -3.0)
    assert np.abs(turned[early, 0] - 5.0).max() > 0.1


def test_a_wide_beam_mixes_the_ranges_at_an_edge():
    scene = Scene.of([[3.0, 0.0]], radius=0.3, walls=[[(3.2, -9.0), (3.2, 9.0)]])
    sharp, wide = ranges(scene), ranges(scene, beam_width=0.03, pulse_length=0.6)
    at_edge = np.isfinite(sharp) & np.isfinite(wide) & (wide > 2.9) & (wide < 3.2)
    assert np.abs(wide[at_edge] - sharp[at_edge]).max() > 0.02
    assert wide[180] == pytest.approx(sharp[180], abs=0.01)


def test_echoes_have_both_surfaces_of_an_edge():
    lidar = PulsedLidar2D(rays=360, beam_width=0.02, echoes=2)
    scan = lidar.read(SCENE, HERE)
    both = np.isfinite(scan.echoes[0, :, 1])
    assert both.any()
    assert (scan.echoes[0, both, 1] - scan.echoes[0, both, 0] > 0.3).all()
    last = dataclasses.replace(lidar, report="last").read(SCENE, HERE)
    first = dataclasses.replace(lidar, report="first").read(SCENE, HERE)
    assert (last.ranges[0, both] - first.ranges[0, both] > 0.3).all()
    assert np.array_equal(np.isfinite(last.ranges), np.isfinite(first.ranges))


def test_dark_surfaces_and_grazing_beams_are_lost_at_a_distance():
    scene = Scene.of([[4.0, 0.0]], radius=0.3)
    assert np.isfinite(ranges(scene, range_10=5.0)[180])
    assert np.isinf(ranges(scene, range_10=5.0, black_clothes=1.0)[180])
    near = Scene.of([[2.0, 0.0]], radius=0.3)
    assert np.isfinite(ranges(near, range_10=5.0, black_clothes=1.0)[180])
    wall = ranges(Scene.of([[60.0, 0.0]], walls=WALL), range_10=4.0)
    assert np.isfinite(wall[180])
    assert np.isfinite(wall).sum() < np.isfinite(ranges(Scene.of([[60.0, 0.0]], walls=WALL))).sum()


def test_intensity_falls_with_the_square_of_the_distance():
    power = [
        float(PulsedLidar2D(rays=360).read(Scene.of([[x, 0.0]], radius=0.3), HERE).intensity[0, 180])
        for x in (2.3, 4.3)
    ]
    assert power[0] / power[1] == pytest.approx(4.0, rel=1e-6)


def test_beams_pass_glass_except_along_its_normal():
    behind = Scene.of([[60.0, 0.0]], walls=[[(3.0, -5.0), (3.0, 5.0)], [(6.0, -9.0), (6.0, 9.0)]])
    plain, glass = ranges(behind), ranges(behind, glass=(0, 1))
    assert glass[180] == pytest.approx(plain[180]) == pytest.approx(3.0)
    assert glass[210] == pytest.approx(6.0 / math.cos(math.radians(30.0)))
    assert plain[210] == pytest.approx(3.0 / math.cos(math.radians(30.0)))


def test_false_returns_have_their_probability_and_are_nearer():
    true, false = ranges(), ranges(rng=stream(1), false_returns=0.2)
    changed = false != true
    assert 0.05 < changed.mean() < 0.2
    assert (false[changed] < true[changed]).all()
    scan = PulsedLidar2D(rays=360, false_returns=0.2).read(SCENE, HERE, stream(1))
    assert (scan.hit[0][changed] == -1).all()
    with pytest.raises(InputError, match="false returns need a random generator"):
        ranges(false_returns=0.2)


@pytest.mark.parametrize(
    ("effects", "text"),
    [
        ({"scan_time": -0.1}, "scan_time = -0.1 s"),
        ({"report": "middle"}, "report = 'middle' must be one of first, strongest, last"),
        ({"echoes": 9}, "echoes = 9"),
        ({"glass": (0.5,)}, "whole numbers from 0"),
        ({"skins": True, "scan_time": 0.1}, "skins need scan_time = 0"),
    ],
)
def test_wrong_effects_are_rejected(effects, text):
    with pytest.raises(InputError, match=text):
        PulsedLidar2D(**effects)


CAMERA = {"width": 64, "height": 48}
LOOK = SpatialPose.of((0.0, 0.0, 1.0))
WALKER = Scene.of([[3.0, 0.0]], [[0.0, 3.0]], radius=0.3)


def test_without_effects_it_is_the_plain_camera():
    plain, exposed = (kind(**CAMERA).read(WALKER, LOOK).rgb for kind in (RGBCamera, ExposedCamera))
    assert np.array_equal(plain, exposed)


def test_exposure_blurs_people_who_move():
    sharp, blurred = (ExposedCamera(**CAMERA, exposure=t).read(WALKER, LOOK).rgb[0, 24, :, 2] for t in (0.0, 0.1))
    assert np.abs(np.diff(blurred.astype(int))).max() < np.abs(np.diff(sharp.astype(int))).max()
    still = WALKER.replace(velocity=np.zeros((1, 1, 2)))
    assert np.array_equal(ExposedCamera(**CAMERA, exposure=0.1).read(still, LOOK).rgb,
                          ExposedCamera(**CAMERA).read(still, LOOK).rgb)  # fmt: skip


def test_a_rolling_shutter_shears_people_who_move():
    image = ExposedCamera(**CAMERA, readout=0.2).read(WALKER, LOOK).rgb[0].astype(int)
    still = ExposedCamera(**CAMERA).read(WALKER, LOOK).rgb[0].astype(int)
    person = np.abs(still - still[24, 0]).sum(axis=-1) > 60
    assert person[24].any()
    middle = [np.flatnonzero(np.abs(image[row] - image[row, 0]).sum(axis=-1) > 60).mean() for row in (18, 30)]
    assert middle[0] > middle[1] + 2.0  # the person walks to the left; early rows see the person further right


def test_noise_of_light_grows_with_the_light():
    rng = stream(4)
    camera = ExposedCamera(**CAMERA, full_well=2000.0)
    noisy = camera.read(WALKER, LOOK, rng).rgb.astype(int) - ExposedCamera(**CAMERA).read(WALKER, LOOK).rgb.astype(int)
    assert 2.0 < noisy.std() < 9.0
    with pytest.raises(InputError, match="noise needs a random generator"):
        camera.read(WALKER, LOOK)
