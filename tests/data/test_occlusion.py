"""Occlusion: who is hidden from an eye, on scenes made by hand and against an obvious twin made of shapes."""

import dataclasses

import numpy as np
import pytest
from shapely.geometry import LineString, Point

from crowdbot.core import DataError, InputError, Walls, stream
from crowdbot.data import Trajectories
from crowdbot.data.degrade import FalseTracks, Occlusion
from crowdbot.data.degrade.occlusion import occlusion_mask

NOWALLS = np.zeros((0, 4))


def _hidden(*place, eye=(0.0, 0.0), radius=0.25, reach=100.0, walls=NOWALLS):
    there = np.array(place, dtype=float)
    return occlusion_mask(np.array(eye), there, there, radius, reach, walls).tolist()


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ([(1, 0), (2, 0)], [False, True]),
        ([(2, 0), (1, 0)], [True, False]),
        ([(1, 0), (-2, 0)], [False, False]),
        ([(1, 0.3), (2, 0)], [False, False]),
        ([(1, 0.24), (2, 0)], [False, True]),
        ([(0.1, 0), (5, 0.5), (0.5, 5), (-5, 0.5)], [False, True, True, False]),
        ([(0, 0), (1, 0)], [False, False]),
        ([(1, 0), (1, 0)], [False, False]),
        ([(3, 3)], [False]),
    ],
    ids=["behind", "in-front", "opposite", "beside", "half", "round-the-eye", "at-the-eye", "one-place",
         "alone"],
)  # fmt: skip
def test_bodies(place, expected):
    assert _hidden(*place) == expected


def test_walls_and_reach():
    wall = Walls.of([[(1.0, -1.0), (1.0, 1.0)]]).segments()
    assert _hidden((2, 0), (0.5, 0), (2, 3), (-2, 0), walls=wall) == [True, False, False, False]
    corner = Walls.of([[(1.0, -1.0), (2.0, -1.0), (2.0, 1.0), (1.0, 1.0)]]).segments()
    assert _hidden((3, 0), (3, 3), (3, 2.9), walls=corner) == [True, True, True]
    assert _hidden((3, 3.1), walls=corner) == [False]
    assert _hidden((3, 0), (4.9, 0.9), (5.1, 0), radius=0.0, reach=5.0) == [False, False, True]


def _slow(eye, place, radius, reach, walls):
    """Shapes: the line of sight against discs and walls, one by one."""
    slow = []
    for number, target in enumerate(place):
        sight = LineString([eye, target])
        lost = sight.length > reach
        for other, centre in enumerate(place):
            nearer = np.hypot(*(centre - eye)) < np.hypot(*(target - eye))
            ahead = np.dot(centre - eye, target - eye) > 0.0
            if other != number and nearer and ahead:
                along = LineString([eye, eye + 100.0 * (target - eye)])  # a body beside the person still hides
                lost |= along.distance(Point(centre)) < radius
        lost |= any(sight.intersects(LineString([wall[:2], wall[2:]])) for wall in walls)
        slow.append(bool(lost))
    return slow


@pytest.mark.parametrize("seed", range(20))
def test_scenes_by_chance_against_shapes(seed):
    rng = stream(seed, "scene")
    place = rng.uniform(-6.0, 6.0, (25, 2))
    eye = rng.uniform(-3.0, 3.0, 2)
    walls = rng.uniform(-6.0, 6.0, (4, 4))
    fast = occlusion_mask(eye, place, place, 0.3, 6.0, walls).tolist()
    assert fast == _slow(eye, place, 0.3, 6.0, walls)
    assert True in fast
    assert False in fast


def _row(**more):
    """The robot 9 drives along x from 0; 1 stands before 2, 3 is beside; robot and people for three frames."""
    frame = np.repeat([0, 1, 2], 4)
    x = [[5.0, 8.0, 5.0, k] for k in (0.0, 1.0, 2.0)]
    y = [[0.0, 0.0, 3.0, 0.0]] * 3
    return Trajectories([1, 2, 3, 9] * 3, frame, np.ravel(x), np.ravel(y), row_rate=2.5, name="row", **more)


def _seen(degraded):
    return {frame: degraded.tracks.id[degraded.tracks.frame == frame].tolist() for frame in (0, 1, 2)}


def test_the_robot_of_the_recording_looks():
    tracks = _row(robots=frozenset([9]))
    assert _seen(Occlusion().apply(tracks)) == {0: [1, 3, 9], 1: [1, 3, 9], 2: [1, 3, 9]}
    assert _seen(Occlusion(reach=5.5).apply(tracks)) == {0: [1, 9], 1: [1, 3, 9], 2: [1, 3, 9]}
    thin = Occlusion(radius=0.0).apply(dataclasses.replace(tracks, walls=(np.array([[4.0, 1.0], [4.0, 3.0]]),)))
    assert _seen(thin) == {0: [1, 2, 9], 1: [1, 2, 9], 2: [1, 2, 9]}


def test_a_point_and_a_person_look():
    tracks = _row()
    assert _seen(Occlusion(eye=(8.0, 5.0)).apply(tracks)) == {0: [1, 2, 3], 1: [1, 2, 3], 2: [1, 2, 3, 9]}
    assert _seen(Occlusion(eye=(20.0, 0.0), reach=30.0).apply(tracks)) == {0: [2, 3], 1: [2, 3], 2: [2, 3]}
    short = tracks._where((tracks.id != 2) | (tracks.frame == 1))
    assert _seen(Occlusion(eye=2).apply(short)) == {0: [], 1: [1, 2, 3], 2: []}


def test_a_share_of_the_hidden_is_lost():
    rows = 4000
    tracks = Trajectories(
        np.tile([1, 2], rows), np.repeat(np.arange(rows), 2), np.tile([1.0, 2.0], rows), np.zeros(2 * rows), 2.5
    )
    seen = Occlusion(probability=0.3, eye=(0.0, 0.0)).apply(tracks, stream(0)).tracks
    assert np.sum(seen.id == 1) == rows
    assert np.sum(seen.id == 2) == pytest.approx(0.7 * rows, rel=0.03)


def test_ghosts_hide_nobody_and_are_not_hidden():
    tracks = _row(robots=frozenset([9]))
    haunted = FalseTracks(rate=40.0).apply(tracks, stream(0))
    seen = Occlusion().apply(haunted)
    assert np.sum(seen.truth == -1) == np.sum(haunted.truth == -1) > 20
    assert {1, 3, 9} == set(seen.truth[seen.truth != -1].tolist())


def test_nobody_to_look_is_one_sentence():
    with pytest.raises(DataError, match="occlusion: row has no robot as a viewpoint; set eye to a point"):
        Occlusion().apply(_row())
    with pytest.raises(DataError, match="row has the robots 2, 9; set eye to the id of one of them"):
        Occlusion().apply(_row(robots=frozenset([2, 9])))
    with pytest.raises(DataError, match="eye = 77, but row has no track of this id; ids go from 1 to 9"):
        Occlusion(eye=77).apply(_row())
    for eye in ((1.0,), (1.0, float("inf"))):
        with pytest.raises(InputError, match="must be a point x, y"):
            Occlusion(eye=eye)
    assert Occlusion(probability=0.0).apply(_row()).tracks.id.tolist() == _row().id.tolist()
