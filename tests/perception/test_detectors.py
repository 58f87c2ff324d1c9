"""Detectors: the contract over all built-in ones, and people in scans whose places are known."""

import math

import numpy as np
import pytest

from crowdbot import perception
from crowdbot.core import InputError, Pose, Scene, builtin_classes, stream
from crowdbot.perception import CloudClusters, Coverage, Detections, LidarClusters
from crowdbot.sensors import Gaussian, Lidar2D, Lidar3D, PointCloud, Scan

SENSORS = {Scan: Lidar2D(rays=720), PointCloud: Lidar3D(columns=900)}
DETECTORS = {
    name: kind
    for name, kind in builtin_classes(perception, perception.Detector).items()
    if kind.reads[0] in SENSORS and kind is not perception.ScanNetwork
}
PLACES = [[2.0, 0.5], [-3.0, 1.0], [0.5, -4.0], [4.0, -3.0]]


def reading_of(detector, position, walls=(), heading=0.4, time=0.5, noise=()):
    import dataclasses

    sensor = dataclasses.replace(SENSORS[detector.reads[0]], noise=noise)
    scene = Scene.of(position, radius=0.25, walls=walls).replace(time=time)
    pose = Pose.of((0.1, -0.2), heading)
    return sensor.read(scene, pose.to_spatial(0.6) if sensor.spatial else pose, stream(3))


def errors(found, places):
    away = np.hypot(*np.moveaxis(found.position[:, None] - np.array(places)[None], -1, 0))
    return away.min(axis=0)


@pytest.mark.parametrize("kind", DETECTORS.values(), ids=DETECTORS)
class TestContract:
    def test_all_people_are_found_at_their_places(self, kind):
        found = kind().detect(reading_of(kind(), PLACES))
        assert len(found) == len(PLACES)
        assert errors(found, PLACES).max() < 0.08
        assert found.time == 0.5
        assert (found.points > 0).all()

    def test_the_same_reading_gives_the_same_detections_and_is_not_changed(self, kind):
        reading = reading_of(kind(), PLACES)
        before = reading.ranges.copy()
        one, other = kind().detect(reading), kind().detect(reading)
        assert np.array_equal(one.position, other.position)
        assert np.array_equal(reading.ranges, before)

    def test_ground_truth_is_not_used(self, kind):
        import dataclasses

        reading = reading_of(kind(), PLACES)
        blind = dataclasses.replace(reading, hit=np.full_like(reading.hit, -1), part=np.full_like(reading.part, -1))
        assert np.array_equal(kind().detect(reading).position, kind().detect(blind).position)

    def test_an_empty_reading_has_no_detections(self, kind):
        found = kind().detect(reading_of(kind(), np.full((1, 2), 60.0)))
        assert found.position.shape == (0, 2)

    def test_walls_of_the_map_are_no_people(self, kind):
        walls = [[(-6.0, 2.0), (-1.5, 2.0)], [(3.0, 1.5), (3.0, 1.9)]]
        reading = reading_of(kind(), PLACES, walls)
        scene = Scene.of(PLACES, walls=walls)
        found = kind().detect(reading, scene.walls)
        assert len(found) == len(PLACES)
        assert errors(found, PLACES).max() < 0.08

    def test_a_hidden_person_is_outside_the_coverage(self, kind):
        found = kind().detect(reading_of(kind(), [[2.0, -0.2], [5.0, -0.2]]))
        assert len(found) == 1
        assert found.coverage.visible([[2.0, -0.2], [5.0, -0.2], [0.0, 3.0]]).tolist() == [1.0, 0.0, 1.0]

    def test_other_readings_and_several_environments_are_rejected(self, kind):
        other = next(item for item in SENSORS if item not in kind.reads)
        reading = reading_of(next(d() for d in DETECTORS.values() if other in d.reads), PLACES)
        with pytest.raises(InputError, match=f"the reading is a {other.__name__}, it must be a"):
            kind().detect(reading)
        scene = Scene.of([PLACES, PLACES], radius=0.25)
        pose = Pose.of([[0.0, 0.0]] * 2, 0.0)
        sensor = SENSORS[kind.reads[0]]
        both = sensor.read(scene, pose.to_spatial(0.6) if sensor.spatial else pose)
        with pytest.raises(InputError, match="has 2 environments"):
            kind().detect(both)


def test_people_side_by_side_are_two():
    places = [[3.0, 0.26], [3.0, -0.26]]
    found = LidarClusters().detect(reading_of(LidarClusters(), places, noise=(Gaussian(0.01),)))
    assert len(found) == 2
    assert errors(found, places).max() < 0.15


def test_a_person_in_part_behind_another_is_found_with_larger_covariance():
    places = [[2.0, -0.2], [4.0, 0.35]]
    found = LidarClusters().detect(reading_of(LidarClusters(), places))
    far = int(np.argmax(found.position[:, 0]))
    assert errors(found, places).max() < 0.15
    assert found.covariance[far, 0, 0] > found.covariance[1 - far, 0, 0]


def test_two_legs_are_one_person():
    lidar = Lidar2D(rays=1080)
    legs = Scene.of([[2.0, 0.1], [2.2, -0.15], [4.0, 2.0]], radius=0.06)
    found = LidarClusters().detect(lidar.read(legs, Pose.of((0.0, 0.0), 0.0)))
    assert len(found) == 2
    assert errors(found, [[2.1, -0.025], [4.0, 2.0]]).max() < 0.1


def test_a_cluster_across_the_first_beam_is_whole():
    found = LidarClusters().detect(reading_of(LidarClusters(), [[-2.0, -0.2]], heading=0.0))
    assert len(found) == 1
    assert errors(found, [[-2.0, -0.2]]).max() < 0.03


def test_a_flat_wall_is_no_person_without_a_map():
    found = LidarClusters().detect(reading_of(LidarClusters(), [[9.0, 9.0]], [[(2.0, -0.4), (2.0, 0.4)]]))
    assert len(found) == 0


def test_coverage_outside_the_field_of_view_is_nothing():
    view = Coverage(np.zeros(2), -0.5, 0.01, np.full(101, 8.0))
    assert view.visible([[3.0, 0.0], [-3.0, 0.0], [0.0, 3.0], [0.05, 0.0]]).tolist() == [1.0, 0.0, 0.0, 1.0]


def test_wrong_values_are_rejected():
    with pytest.raises(InputError, match=r"min_width = 2.0 m must be at most max_width = 1.0 m"):
        LidarClusters(min_width=2.0)
    with pytest.raises(InputError, match="too small for max_range"):
        CloudClusters(cell=0.001)
    with pytest.raises(InputError, match=r"position has a number that is not finite"):
        Detections.of(0.0, [[math.nan, 0.0]], 0.1)
    with pytest.raises(InputError, match=r"covariance has shape \[2, 2\], it must be \[1, 2, 2\]"):
        Detections(0.0, np.zeros((1, 2)), np.eye(2), np.ones(1, dtype=np.int64))
