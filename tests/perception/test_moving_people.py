"""Tracker of moving people: furniture is no person, people who stop stay, the grid follows the scanner."""

import math

import numpy as np
import pytest

from crowdbot.core import InputError, Pose, Scene, tree
from crowdbot.perception import (
    Coverage,
    Detections,
    GlobalNearestNeighbor,
    JointProbabilisticDataAssociation,
    LidarClusters,
    MovingPeople,
)
from crowdbot.perception.moving_people import CELL, SIDE, count_beams
from crowdbot.sensors import Lidar2D

LIDAR = Lidar2D(rays=720)
PILLARS = [[2.0, 0.5], [3.0, -2.0], [-1.5, 1.0], [0.5, 3.5]]


def follow(tracker, person, scans, pose=lambda k: Pose.of((0.0, 0.0), 0.0), pillars=PILLARS):
    """Return the tracks of each scan of pillars and of a person, whose position in scan k is ``person(k)``."""
    state, result = tracker.begin(), []
    for k in range(scans):
        scene = Scene.of([*pillars, person(k)], radius=0.12).replace(time=0.1 * k)
        tracks, state = tracker.update(LidarClusters().detect(LIDAR.read(scene, pose(k))), 0.1 * k, state)
        result.append(tracks)
    return result


def crossing(k):
    return [4.0 - 0.1 * k, 2.0]


def test_furniture_is_no_person():
    plain = follow(GlobalNearestNeighbor(), crossing, 50)
    moving = follow(MovingPeople(), crossing, 50)
    assert len(plain[-1]) == 5
    assert moving[-1].position == pytest.approx(np.array([crossing(49)]), abs=0.1)
    assert max(map(len, moving)) == 1


def test_furniture_is_no_person_beside_a_moving_scanner():
    tracks = follow(MovingPeople(), crossing, 50, lambda k: Pose.of((0.03 * k, -0.01 * k), 0.02 * k))
    assert tracks[-1].position == pytest.approx(np.array([crossing(49)]), abs=0.1)
    assert max(map(len, tracks)) == 1


def test_a_wall_along_the_way_of_the_scanner_is_no_person():
    wall = [[(-2.0, 1.0), (40.0, 1.0)]]
    tracker, lidar = MovingPeople(), Lidar2D(rays=360)
    state, most = tracker.begin(), 0
    for k in range(60):
        scene = Scene.of([[90.0, 0.0]], walls=wall).replace(time=0.1 * k)
        found = LidarClusters().detect(lidar.read(scene, Pose.of((0.06 * k, 0.0), 0.0)))
        tracks, state = tracker.update(found, 0.1 * k, state)
        most = max(most, len(tracks))
    assert most == 0


def test_what_stands_in_free_space_is_followed_only_after_it_walked():
    """A chair that is put down is lost as soon as the ground under it is known to be occupied; a person is not."""
    chair = follow(MovingPeople(), lambda k: [90.0, 0.0] if k < 25 else [4.0, 2.0], 90)
    assert max(map(len, chair)) == 1
    assert len(chair[-1]) == 0
    held = follow(MovingPeople(walk=0.0), lambda k: [90.0, 0.0] if k < 25 else [4.0, 2.0], 90)
    assert len(held[-1]) == 1


def test_confirmed_people_are_those_who_were_seen_to_walk():
    plain, confirmed = (follow(MovingPeople(confirm=value), crossing, 50) for value in (0.0, 1.0))
    first = next(k for k, tracks in enumerate(plain) if len(tracks))
    shown = next(k for k, tracks in enumerate(confirmed) if len(tracks))
    assert 8 <= shown - first <= 14  # 1 m at 1 m/s and 10 scans a second
    assert np.array_equal(plain[-1].ids, confirmed[-1].ids)
    assert np.array_equal(plain[-1].position, confirmed[-1].position)


def test_a_person_who_stops_is_still_followed():
    tracks = follow(MovingPeople(), lambda k: crossing(min(k, 30)), 90)
    assert tracks[-1].position == pytest.approx(np.array([crossing(30)]), abs=0.1)
    assert set(tracks[-1].ids) == set(tracks[35].ids)


def test_a_person_who_stands_is_found_after_the_first_steps():
    tracks = follow(MovingPeople(), lambda k: crossing(max(0, k - 30)), 60)
    assert max(map(len, tracks[:30])) == 0
    assert tracks[-1].position == pytest.approx(np.array([crossing(29)]), abs=0.1)


def test_the_grid_follows_the_scanner():
    def person(k):
        return [0.5 * k + 3.0, 3.0 - 0.1 * (k - 50)]

    def pose(k):
        return Pose.of((0.5 * k, 0.0), 0.0)

    pillars = [[x, y] for x in np.arange(0.0, 50.0, 2.5) for y in (-3.0, 4.5)]
    tracks = follow(MovingPeople(tracker=GlobalNearestNeighbor(speed=5.0)), person, 80, pose, pillars)
    assert tracks[-1].position == pytest.approx(np.array([person(79)]), abs=0.15)
    far = follow(MovingPeople(), crossing, 45, lambda k: Pose.of((0.0 if k < 20 else 1e5, 0.0), 0.0))
    assert len(far[-1]) == 0


def test_detections_without_a_coverage_all_count():
    plain, moving = JointProbabilisticDataAssociation(), MovingPeople(tracker=JointProbabilisticDataAssociation())
    one, other = plain.begin(), moving.begin()
    for k in range(10):
        found = Detections.of(0.1 * k, [[0.1 * k, 0.0], [3.0, 0.0]], 0.05)
        expected, one = plain.update(found, 0.1 * k, one)
        tracks, other = moving.update(found, 0.1 * k, other)
    assert len(tracks) == 2
    assert np.array_equal(tracks.position, expected.position)


def test_an_update_leaves_its_state_as_it_was():
    tracker = MovingPeople()
    state = tracker.begin()
    for k in range(30):
        scene = Scene.of([*PILLARS, crossing(k)], radius=0.12).replace(time=0.1 * k)
        found = LidarClusters().detect(LIDAR.read(scene, Pose.of((0.0, 0.0), 0.0)))
        before = state
        first, state = tracker.update(found, 0.1 * k, before)
        again, _ = tracker.update(found, 0.1 * k, before)
        assert np.array_equal(first.position, again.position)
    np.testing.assert_equal(tree.flatten(tree.unflatten(tree.flatten(state))), tree.flatten(state))


def test_beams_pass_cells_and_end_in_one():
    passed, met = np.zeros((SIDE, SIDE)), np.zeros((SIDE, SIDE))
    middle = 0.5 * CELL * SIDE + 0.5 * CELL
    count_beams(passed, met, np.array([middle, middle]), 0.0, 0.5 * math.pi, np.array([1.0, 0.0, 2.0, 3.0]))
    at = SIDE // 2
    assert np.argwhere(met).tolist() == [[at - 20, at], [at + 10, at]]
    assert passed[at : at + 9, at].tolist() == [1.0] * 9
    assert passed[at + 10 :, at].sum() == 0.0
    assert passed[at, at + 1 :].sum() == 0.0
    assert passed[at, at - 18 : at].tolist() == [1.0] * 18
    assert passed[at, : at - 18].sum() == 0.0  # no farther than the neighbour, whose beam ends after 2 m


def test_time_and_fields_are_checked():
    tracker = MovingPeople()
    coverage = Coverage(np.zeros(2), 0.0, 0.1, np.full(10, 3.0))
    _, state = tracker.update(Detections.of(1.0, [], 0.05, coverage), 1.0, tracker.begin())
    with pytest.raises(InputError, match=r"time = 0.5 s must be finite and not before"):
        tracker.update(Detections.of(0.5, [], 0.05, coverage), 0.5, state)
    wrong = {
        "lag": -1.0,
        "memory": 0.0,
        "scans": 0.0,
        "occupied": 1.5,
        "share": 0.0,
        "hold": -0.1,
        "walk": -1.0,
        "confirm": -1.0,
    }
    for field, value in wrong.items():
        with pytest.raises(InputError, match=f"MovingPeople: {field} = "):
            MovingPeople(**{field: value})
    with pytest.raises(InputError, match="tracker = MovingPeople must be another tracker"):
        MovingPeople(tracker=MovingPeople())
