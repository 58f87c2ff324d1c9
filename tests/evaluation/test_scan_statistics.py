"""Statistics of scans: known numbers of returns, hidden people, legs, point clouds, and the command."""

import json
import math

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import InputError, Pose, Scene
from crowdbot.evaluation import scan_statistics
from crowdbot.sensors import Lidar2D, Lidar3D

HERE = Pose.of((0.0, 0.0), 0.0)
LIDAR = Lidar2D(rays=1440, range_max=30.0)


def bands_of(people, discs=None, radius=0.25, lidar=LIDAR, pose=HERE):
    scan = lidar.read(Scene.of(people if discs is None else discs, radius=radius), pose)
    bands, missing = scan_statistics([(scan, np.array(people, dtype=float))])
    return {band.near: band for band in bands}, missing


@pytest.mark.parametrize("distance", [1.0, 3.0, 7.0, 12.0])
def test_returns_are_the_width_of_the_body_over_the_step_of_the_beams(distance):
    turn = 2.0 * math.pi / 1440
    bands, missing = bands_of([[distance * math.cos(2.5), distance * math.sin(2.5)]], pose=Pose.of((0.0, 0.0), -0.7))
    (seen,) = [band for band in bands.values() if band.people]
    expected = 2.0 * math.asin(0.25 / distance) / turn
    assert seen.returns == pytest.approx(expected, abs=1.0)
    assert (seen.unseen, seen.apart) == (0.0, 0.0)
    assert missing == pytest.approx(1.0 - seen.returns / 1440)


def test_who_stands_behind_another_is_left_out():
    bands, _ = bands_of([[2.5, 0.0], [5.0, 0.0]])
    assert bands[2.0].people == 1
    assert bands[4.0].people == 0
    assert math.isnan(bands[4.0].returns)


def test_legs_are_two_clusters_unless_one_hides_the_other():
    bands, _ = bands_of([[3.0, 0.0]], [[3.0, 0.15], [3.0, -0.15]], radius=0.06)
    assert bands[2.0].apart == 1.0
    assert bands[2.0].width == pytest.approx(0.12, abs=0.02)
    bands, _ = bands_of([[3.0, 0.0]], [[2.8, 0.0], [3.2, 0.0]], radius=0.06)
    assert bands[2.0].apart == 0.0


def test_people_without_returns_and_outside_the_field_of_view():
    bands, missing = bands_of([[3.0, 0.0], [-3.0, 0.0]], [[9.0, 9.0]], lidar=Lidar2D(rays=180, field_of_view=2.0))
    assert (bands[2.0].people, bands[2.0].unseen) == (1, 1.0)
    assert missing > 0.9


def test_points_of_a_cloud_are_counted():
    scene = Scene.of([[3.0, 0.0]], radius=0.25)
    cloud = Lidar3D(columns=900).read(scene, HERE.to_spatial(0.8))
    bands, _ = scan_statistics([(cloud, np.array([[3.0, 0.0]]))])
    seen = bands[1]
    assert seen.people == 1
    assert 50 < seen.returns <= np.isfinite(cloud.ranges).sum()
    assert math.isnan(seen.apart)


def test_wrong_readings_are_one_sentence():
    with pytest.raises(InputError, match="there are no scans"):
        scan_statistics([])
    with pytest.raises(InputError, match="statistics are of laser scanners, not of int"):
        scan_statistics([(3, np.zeros((0, 2)))])


def test_the_command_prints_bands_of_a_trial(capsys):
    words = ["track", "crossing-flows", "--duration", "1", "--statistics"]
    assert main([*words, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    returns = [one["returns"] for one in document["bands"] if one["people"]]
    assert returns == sorted(returns, reverse=True)
    assert main(words) == 0
    assert "returns a person" in capsys.readouterr().out
