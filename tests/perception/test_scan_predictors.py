"""Predictors of scans: the contract over all built-in ones, and scenes whose future is known."""

import dataclasses
import math

import numpy as np
import pytest

from crowdbot import perception
from crowdbot.core import InputError, Pose, Scene, builtin_classes, stream
from crowdbot.metrics import OccupancyGrid, range_error
from crowdbot.perception import MovedScan, ScanForecast, ScanPredictor, TrackedScene, continue_motion
from crowdbot.sensors import Gaussian, Lidar2D, Lidar3D

PREDICTORS = builtin_classes(perception, ScanPredictor)
LIDAR = Lidar2D(rays=720, range_max=20.0)
ROOM = [[(-6.0, -6.0), (-6.0, 6.0), (6.0, 6.0), (6.0, -6.0)]]
AHEAD = np.array([0.1, 0.5, 1.0])


def scan_of(place, time, pose, noise=()):
    scene = Scene.of(place, radius=0.25, walls=ROOM).replace(time=time)
    return dataclasses.replace(LIDAR, noise=noise).read(scene, pose, stream(round(time * 10)))


def walk(time):
    """Return two people who cross before the scanner."""
    return [[2.0, -2.0 + 1.2 * time], [3.0 - 0.8 * time, 2.0]]


def robot(time):
    return Pose.of((-1.0 + 0.4 * time, 0.2), 0.1 * time)


def past(people=walk, pose=robot, noise=()):
    return [scan_of(people(0.1 * k), 0.1 * k, pose(0.1 * k), noise) for k in range(16)]


def future(people=walk, pose=robot):
    return np.stack([scan_of(people(1.5 + ahead), 1.5 + ahead, pose(1.5 + ahead)).ranges[0] for ahead in AHEAD])


def poses(pose=robot):
    known = [pose(1.5 + ahead) for ahead in AHEAD]
    return Pose(np.concatenate([item.position for item in known]), np.concatenate([item.heading for item in known]))


@pytest.mark.parametrize("kind", PREDICTORS.values(), ids=PREDICTORS)
class TestContract:
    def test_shapes_and_weights(self, kind):
        forecast = kind().predict(past(), AHEAD, samples=4)
        assert forecast.ranges.shape == (len(forecast.weight), 3, 720)
        assert forecast.weight.sum() == pytest.approx(1.0)
        assert (forecast.ranges > 0.0).all()
        assert forecast.occupancy().shape == (3, 64, 64)

    def test_a_scene_at_rest_stays(self, kind):
        still = past(lambda _: walk(0.0), lambda _: robot(0.0))
        forecast = kind().predict(still, AHEAD)
        truth = future(lambda _: walk(0.0), lambda _: robot(0.0))
        assert range_error(truth, forecast.ranges[0], 10.0).max() < 0.05

    def test_ground_truth_and_the_scans_are_left_alone(self, kind):
        scans = past()
        before = [scan.ranges.copy() for scan in scans]
        blind = [
            dataclasses.replace(scan, hit=np.full_like(scan.hit, -1), part=np.full_like(scan.part, -1))
            for scan in scans
        ]
        one, other = kind().predict(scans, AHEAD), kind().predict(blind, AHEAD)
        assert np.array_equal(one.ranges, other.ranges)
        assert all(np.array_equal(scan.ranges, kept) for scan, kept in zip(scans, before, strict=True))

    def test_a_stored_state_gives_the_same_forecast(self, kind):
        predictor, scans = kind(), past()
        state = predictor.begin()
        for scan in scans[:10]:
            state = predictor.update(scan, state)
        kept = state
        for scan in past(lambda time: [[4.0, time]])[10:]:
            state = predictor.update(scan, state)
        for scan in scans[10:]:
            kept = predictor.update(scan, kept)
        whole = predictor.predict(scans, AHEAD)
        assert np.array_equal(predictor.forecast(kept, AHEAD).ranges, whole.ranges)

    def test_wrong_input_is_rejected(self, kind):
        with pytest.raises(InputError, match="at least one scan"):
            kind().predict([], AHEAD)
        with pytest.raises(InputError, match="times ahead must be above 0"):
            kind().predict(past()[:2], [0.0])
        with pytest.raises(InputError, match="3 poses for 1 times"):
            kind().predict(past()[:2], [0.5], poses())
        cloud = Lidar3D(columns=90).read(Scene.of([[2.0, 0.0]]), Pose.of((0.0, 0.0), 0.0).to_spatial(0.6))
        with pytest.raises(InputError, match="must be a Scan of one environment"):
            kind().predict([cloud], AHEAD)


def test_a_moving_sensor_sees_the_surfaces_that_it_will_see():
    still = past(lambda _: walk(0.0))
    truth = future(lambda _: walk(0.0))
    moved = MovedScan().predict(still, AHEAD, poses()).ranges[0]
    assert range_error(truth, moved, 10.0).max() < 0.12
    unmoved = np.repeat(still[-1].ranges, 3, axis=0)
    assert range_error(truth, moved, 10.0)[-1] < 0.5 * range_error(truth, unmoved, 10.0)[-1]


def test_people_walk_on_in_the_future_scans():
    scans, truth = past(noise=(Gaussian(0.01),)), future()
    errors = {
        kind: range_error(truth, kind().predict(scans, AHEAD, poses()).ranges[0], 10.0)
        for kind in (MovedScan, TrackedScene)
    }
    assert (errors[TrackedScene][1:] < 0.5 * errors[MovedScan][1:]).all()
    assert errors[TrackedScene][-1] < 0.15


def test_surfaces_behind_people_are_remembered():
    """A person walks away from in front of a wall that earlier scans have seen."""
    scans, truth = past(pose=lambda _: robot(0.0)), future(pose=lambda _: robot(0.0))
    known, forgotten = (
        range_error(truth, TrackedScene(memory=memory).predict(scans, AHEAD).ranges[0], 10.0)[-1] for memory in (16, 1)
    )
    assert known < forgotten


def test_samples_differ_and_repeat():
    scans = past(noise=(Gaussian(0.02),))
    one, other = (TrackedScene().predict(scans, AHEAD, samples=5, rng=stream(3)).ranges for _ in range(2))
    assert np.array_equal(one, other)
    assert not np.array_equal(one[1], one[2])
    assert np.array_equal(one[0], TrackedScene().predict(scans, AHEAD).ranges[0])


def test_a_sensor_on_an_arc_stays_on_it():
    def arc(time):
        return Pose.of((2.0 * math.sin(0.5 * time), 2.0 - 2.0 * math.cos(0.5 * time)), 0.5 * time)

    ahead = continue_motion(past(pose=arc), AHEAD)
    assert ahead.position == pytest.approx(poses(arc).position, abs=1e-9)
    assert ahead.heading == pytest.approx(poses(arc).heading, abs=1e-9)


def test_occupancy_is_the_share_of_the_futures():
    ranges = np.array([[[1.05]], [[2.05]]])
    forecast = ScanForecast(np.ones(1), Pose.of((0.0, 0.0), 0.0), np.zeros(1), ranges, np.array([0.25, 0.75]))
    grid = OccupancyGrid(dilation=0)
    assert forecast.occupancy(grid)[0, 10, 32] == 0.25
    assert forecast.occupancy(grid)[0, 20, 32] == 0.75
    assert forecast.occupancy(grid).sum() == 1.0
    with pytest.raises(InputError, match="ranges have shape"):
        ScanForecast(np.ones(2), Pose.of((0.0, 0.0), 0.0), np.zeros(1), ranges, np.array([0.25, 0.75]))
