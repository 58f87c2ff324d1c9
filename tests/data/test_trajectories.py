"""Trajectories: what is refused, and what every change of a recording leaves as it was."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import DataError, InputError
from crowdbot.data import Trajectories


def walk(**changes):
    """Return two people: one walks along x at 1 m/s for 8 rows, one along y at 2 m/s for 5."""
    id = [1] * 8 + [2] * 5
    frame = [*range(0, 80, 10), *range(20, 70, 10)]
    x = [0.4 * k for k in range(8)] + [3.0] * 5
    y = [0.0] * 8 + [0.8 * k for k in range(5)]
    return Trajectories(**{"id": id, "frame": frame, "x": x, "y": y, "row_rate": 2.5, "name": "walk", **changes})


def test_rows_are_sorted_and_cannot_be_written_to():
    tracks = walk()
    assert tracks.frame.tolist() == sorted(tracks.frame.tolist())
    assert tracks.id[tracks.frame == 30].tolist() == [1, 2]
    assert (tracks.id.dtype, tracks.frame.dtype, tracks.x.dtype) == (np.int64, np.int64, np.float64)
    with pytest.raises(ValueError, match="read-only"):
        tracks.x[0] = 1.0
    assert repr(tracks) == "<Trajectories walk: 13 rows of 2 people, dt 0.4 s>"
    assert "1 people and 1 robots" in repr(walk(robots=frozenset({2})))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"id": [], "frame": [], "x": [], "y": []}, "walk has no rows"),
        ({"x": [np.nan] + [0.0] * 12}, "walk row 1: x is nan for frame 0, id 1; coordinates must be finite"),
        ({"y": [0.0] * 12 + [np.inf]}, "walk row 13: y is inf for frame 60, id 2"),
        ({"frame": [0] * 13}, "walk row 2: frame 0, id 1 is a duplicate"),
        ({"frame": [0.5] + [1.0] * 12}, r"walk row 1: frame is 0\.5, it must be a whole number"),
        ({"id": [np.nan] + [1.0] * 12}, "walk row 1: id is nan, it must be a whole number"),
        ({"id": [1e300] + [1.0] * 12}, r"walk row 1: id is 1e\+300, it must be a whole number"),
        ({"x": [0.0] * 12}, "walk: columns differ in shape"),
        ({"row_rate": 0.0}, r"walk: row_rate is 0\.0, it must be above 0"),
        ({"row_rate": np.nan}, "walk: row_rate is nan, it must be above 0"),
        ({"units": "cm"}, "walk: unknown units 'cm'"),
    ],
)
def test_what_cannot_be_is_refused_with_its_place(changes, message):
    with pytest.raises(DataError, match=message):
        walk(**changes)


def test_time_and_velocity():
    tracks = walk()
    assert tracks.time[-1] == pytest.approx(2.8)
    velocity = tracks.velocities()
    assert velocity[tracks.id == 1][1:] == pytest.approx(np.tile([1.0, 0.0], (7, 1)))
    assert velocity[tracks.id == 2][1:] == pytest.approx(np.tile([0.0, 2.0], (4, 1)))
    assert np.isnan(velocity[[0, 2 + 1]]).all()
    summary = tracks.summary()
    assert summary["mean_speed"] == pytest.approx((7 * 1.0 + 4 * 2.0) / 11)
    assert (summary["rows"], summary["tracks"], summary["frames"], summary["longest_run"]) == (13, 2, 8, 8)
    assert (summary["max_per_frame"], summary["seconds"]) == (2, pytest.approx(2.8))


def test_velocity_does_not_know_the_future():
    tracks = walk()
    moved = walk(x=[*tracks.track(1).x[:5], *[99.0] * 3, *tracks.track(2).x])
    early = tracks.frame <= 40
    assert moved.velocities()[early].tobytes() == tracks.velocities()[early].tobytes()


def test_velocity_over_a_hole_takes_the_time_of_the_hole():
    tracks = Trajectories([1, 1, 1, 1], [0, 10, 20, 50], [0.0, 1.0, 2.0, 5.0], [0.0] * 4, row_rate=1.0)
    assert tracks.velocities()[1:, 0].tolist() == [1.0, 1.0, 1.0]


def test_table():
    table = walk().to_frame()
    assert list(table.columns) == ["id", "frame", "time", "x", "y"]
    assert len(table) == 13
    table.loc[0, "x"] = 5.0
    assert walk().x[0] == 0.0


def test_tracks_by_id_and_label():
    tracks = walk(labels={1: "Pedestrian", 2: "Biker"}, robots=frozenset({2}))
    one = tracks.track(1)
    assert (set(one.id), one.labels, one.robots) == ({1}, {1: "Pedestrian"}, frozenset())
    assert len(tracks.only("Biker", "Pedestrian")) == 13
    with pytest.raises(DataError, match="walk has no track of id 7; ids go from 1 to 2"):
        tracks.track(7)
    with pytest.raises(DataError, match="no track labelled"):
        tracks.only()


def test_split_by_time():
    first, rest = walk().split(0.5)
    assert first.frame.max() < rest.frame.min()
    assert len(first) + len(rest) == 13
    assert first.frame.max() == 30


def test_split_by_person():
    first, rest = walk(robots=frozenset()).split(0.5, by="person")
    assert (set(first.id), set(rest.id)) == ({1}, {2})
    with_robot = Trajectories([1, 2, 3], [0, 1, 2], [0.0] * 3, [0.0] * 3, row_rate=1.0, robots=frozenset({3}))
    parts = with_robot.split(0.5, by="person")
    assert [set(part.id) for part in parts] == [{1, 3}, {2, 3}]


def test_split_refuses_what_makes_no_sense():
    with pytest.raises(InputError, match=r"fraction 1\.0 must be above 0 and below 1"):
        walk().split(1.0)
    with pytest.raises(InputError, match="by 'tme', did you mean 'time'"):
        walk().split(0.5, by="tme")
    with pytest.raises(DataError, match="leaves one part empty"):
        walk().track(1).split(0.2, by="person")


def test_metres_by_scale_and_homography():
    pixels = walk(units="px", walls=(np.array([[0.0, 0.0], [10.0, 0.0]]),))
    scaled = pixels.metres(0.5)
    assert scaled.units == "m"
    assert scaled.x.tolist() == (pixels.x * 0.5).tolist()
    assert scaled.walls[0].tolist() == [[0.0, 0.0], [5.0, 0.0]]
    turn = np.array([[0.0, -1.0, 4.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]])
    turned = walk(units="px", homography=turn).metres()
    assert turned.x == pytest.approx((4.0 - pixels.y) / 2.0)
    assert turned.y == pytest.approx(pixels.x / 2.0)


@pytest.mark.parametrize(
    "transform", [0.0, np.nan, np.eye(2), np.zeros((3, 3)), [[1, 0, 0], [0, 1, 0], [0, 0, np.inf]]]
)
def test_metres_refuses_what_is_no_transform(transform):
    with pytest.raises(DataError, match="must be a scale above 0 or an invertible 3 x 3 matrix"):
        walk(units="px").metres(transform)


def test_metres_refuses_metres_and_points_at_infinity():
    with pytest.raises(DataError, match="walk is already in metres"):
        walk().metres(0.1)
    with pytest.raises(DataError, match="is inf|is nan"):
        walk(units="px").metres([[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 0.0, 0.0]])


def test_resample_keeps_rows_that_lie_on_the_steps():
    tracks = walk()
    assert tracks.resample(0.4).x.tolist() == tracks.x.tolist()
    assert tracks.resample(0.4).frame.tolist() == tracks.frame.tolist()
    half = tracks.resample(0.8)
    assert (half.frame_step, half.dt) == (20, 0.8)
    assert half.track(1).x.tolist() == tracks.track(1).x[::2].tolist()
    assert half.track(2).frame.tolist() == [20, 40, 60]


def test_resample_interpolates_inside_and_never_beyond():
    tracks = walk().resample(0.1)
    assert tracks.track(1).x == pytest.approx(0.1 * np.arange(29))
    assert tracks.track(2).time[0] == 0.0
    assert len(tracks.track(2)) == 17
    odd = walk().resample(0.3)
    assert (odd.frame_step, odd.frame[0]) == (1, 0)
    assert odd.track(2).y.min() >= 0.0
    assert odd.track(2).y.max() <= 3.2


def test_resample_does_not_bridge_long_holes():
    tracks = Trajectories([1] * 6, [0, 1, 2, 10, 11, 12], range(6), range(6), row_rate=10.0)
    assert tracks.resample(0.05).time.tolist() == pytest.approx([0.0, 0.05, 0.1, 0.15, 0.2, 1.0, 1.05, 1.1, 1.15, 1.2])
    assert len(tracks.resample(0.05, gap=1.0)) == 25
    with pytest.raises(InputError, match=r"dt 0\.0 s must be above 0"):
        tracks.resample(0.0)
    with pytest.raises(InputError, match=r"gap -1\.0 s must be above 0"):
        tracks.resample(0.1, gap=-1.0)
    with pytest.raises(DataError, match="give more than 20000000 rows; use a longer step"):
        tracks.resample(1e-9)


def test_resample_forgets_who_fell_between_the_steps():
    tracks = Trajectories(
        [1, 1, 2], [0, 10, 3], [0.0] * 3, [0.0] * 3, row_rate=10.0, robots=frozenset({2}), labels={1: "a", 2: "b"}
    )
    new = tracks.resample(1.0)
    assert (set(new.id), new.robots, new.labels) == ({1}, frozenset(), {1: "a"})


@given(st.integers(0, 1000), st.sampled_from([0.1, 0.4, 0.37, 1.0]))
@settings(deadline=None, max_examples=30)
def test_resampling_a_straight_walk_gives_the_same_walk(seed, dt):
    rng = np.random.default_rng(seed)
    speed, begin = rng.normal(size=2), int(rng.integers(0, 50))
    frame = np.arange(begin, begin + 60)
    tracks = Trajectories(
        np.repeat([1, 2], 60),
        np.concatenate([frame, frame + 7]),
        np.tile(speed[0] * frame, 2),
        np.tile(speed[1] * frame, 2),
        row_rate=10.0,
    )
    new = tracks.resample(dt)
    since = new.time * 10.0 + begin
    own = new.id == 1
    assert new.x[own] == pytest.approx(speed[0] * since[own])
    assert new.y[~own] == pytest.approx(speed[1] * (since[~own] - 7))
    assert new.dt == pytest.approx(dt)
