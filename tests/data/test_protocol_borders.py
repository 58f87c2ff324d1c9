"""Both sides of every border of the protocols: rows observed and predicted, people per window, distance, splits."""

import numpy as np
import pytest

from crowdbot.core import DataError, InputError
from crowdbot.data import PROTOCOLS, Trajectories

ORDINARY = [name for name in PROTOCOLS if not name.startswith(("timesplit", "trajnet"))]


def tracks_of(*lengths, begins=None, **fields):
    """Return tracks that walk east at 1 m per row, one per length, side by side at 1 m, at 2.5 rows per second."""
    begins = begins or [0] * len(lengths)
    rows = [(n + 1, 10 * (b + k), float(k), float(n)) for n, (m, b) in enumerate(zip(lengths, begins, strict=True))
            for k in range(m)]  # fmt: skip
    id, frame, x, y = zip(*rows, strict=True)
    return Trajectories(id, frame, x, y, row_rate=2.5, frame_step=10, **fields)


@pytest.mark.parametrize("protocol", ["all", "sgan"])
def test_a_window_needs_all_rows(protocol):
    assert len(tracks_of(20, 20).windows(8, 12, protocol)[0]) == 1
    assert len(tracks_of(21, 21).windows(8, 12, protocol)[0]) == 2
    with pytest.raises(DataError, match=r"the longest of 2 tracks has 19 rows and 20 are needed"):
        tracks_of(19, 19).windows(8, 12, protocol)


def test_partial_needs_two_future_rows():
    assert len(tracks_of(10).windows(8, 12, "partial")[0]) == 1
    with pytest.raises(DataError, match="8 observed and at least 2 predicted rows"):
        tracks_of(9).windows(8, 12, "partial")
    past, future = tracks_of(12).windows(8, 12, "partial")
    assert future.present[:, :, 0].sum(axis=1).tolist() == [4, 3, 2]
    assert len(past) == 3
    assert len(tracks_of(9).windows(8, 1, "partial")[0]) == 1  # one row asked for: one is enough


def test_sgan_needs_two_people_at_the_same_window():
    with pytest.raises(DataError, match="no window has two people who are present at all rows"):
        tracks_of(20).windows(8, 12, "sgan")
    with pytest.raises(DataError, match="no window has two people who are present at all rows"):
        tracks_of(20, 20, begins=[0, 1]).windows(8, 12, "sgan")
    past, future = tracks_of(21, 20, begins=[0, 1]).windows(8, 12, "sgan")
    assert (len(past), future.scored.sum()) == (1, 2)
    assert tracks_of(21, 20, begins=[0, 1]).windows(8, 12, "all")[1].scored.sum() == 3


def test_robots_do_not_make_a_second_person():
    with pytest.raises(DataError, match="no window has two people"):
        tracks_of(20, 20, robots=frozenset({2})).windows(8, 12, "sgan")


@pytest.mark.parametrize(("windows", "late"), [(1, 1), (2, 1), (4, 1), (5, 1), (9, 2), (10, 2), (11, 3)])
def test_timesplit_takes_the_last_fifth_of_the_windows(windows, late):
    tracks = tracks_of(19 + windows)
    every = tracks.windows(8, 12, "all")[0].frame
    assert len(every) == windows
    assert tracks.windows(8, 12, "timesplit")[0].frame.tolist() == every[windows - late :].tolist()
    if windows == late:
        with pytest.raises(DataError, match="it has a single window, which belongs to the last fifth"):
            tracks.windows(8, 12, "timesplit-train")
    else:
        assert tracks.windows(8, 12, "timesplit-train")[0].frame.tolist() == every[: windows - late].tolist()


@pytest.mark.parametrize("protocol", ORDINARY)
def test_near_includes_its_border(protocol):
    tracks = tracks_of(20, 20, 20, robots=frozenset({1}))
    assert tracks.windows(8, 12, protocol, near=2.0)[1].scored[0].tolist() == [False, True, True]
    assert tracks.windows(8, 12, protocol, near=np.nextafter(2.0, 0.0))[1].scored[0].tolist() == [False, True, False]
    assert tracks.windows(8, 12, protocol, near=1.0)[1].scored[0].tolist() == [False, True, False]
    with pytest.raises(DataError, match=r"within 0\.999 m of a robot; the nearest is 1\.00 m away"):
        tracks.windows(8, 12, protocol, near=0.999)


def test_near_is_judged_at_the_last_observed_row_to_the_nearest_robot():
    rows = [(1, 10 * k, float(k), 0.0) for k in range(20)]  # passes robot 8 at row 7 and robot 9 at row 15
    rows += [(8, 10 * k, 7.0, 0.5) for k in range(20)] + [(9, 10 * k, 15.0, 0.5) for k in range(20)]
    tracks = Trajectories(*zip(*rows, strict=True), row_rate=2.5, robots=frozenset({8, 9}))
    assert tracks.windows(8, 12, near=0.5)[1].scored[0].tolist() == [True, False, False]
    only_later = tracks.only(ids=[1, 9])
    with pytest.raises(DataError, match=r"the nearest is 8\.02 m away"):
        only_later.windows(8, 12, near=8.0)
    assert only_later.windows(8, 12, near=8.02)[1].scored.sum() == 1
    apart = Trajectories([1] * 20 + [9], [*range(20), 30], [0.0] * 21, [0.0] * 21, row_rate=2.5, robots=frozenset({9}))
    with pytest.raises(DataError, match="no robot is present at these times"):
        apart.windows(8, 12, near=5.0)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan])
def test_near_is_above_zero(value):
    with pytest.raises(InputError, match="must be above 0"):
        tracks_of(20, 20, robots=frozenset({1})).windows(8, 12, near=value)


@pytest.mark.parametrize("rows", [0, -1, 1.5, "8"])
def test_rows_are_whole_numbers_from_one(rows):
    with pytest.raises(InputError, match="windows: observe is"):
        tracks_of(20).windows(rows, 12)
    with pytest.raises(InputError, match="windows: predict is"):
        tracks_of(20).windows(8, rows)
    assert len(tracks_of(2).windows(1, 1)[0]) == 1


@pytest.mark.parametrize(("begin", "kept"), [(0, True), (1, True), (6, True), (7, False), (8, False)])
def test_latecomers_need_two_observed_rows(begin, kept):
    tracks = tracks_of(20, 20 - begin, begins=[0, begin])
    past = tracks.windows(8, 12, late="extrapolate")[0]
    assert (2 in past.id[0].tolist()) is kept
    assert (2 in tracks.windows(8, 12, late="skip")[0].id[0].tolist()) is (begin == 0)
    if kept:
        assert past.position[0, :, 1, 0].tolist() == [float(k - begin) for k in range(8)]


def test_past_needs_enough_rows_at_the_frame():
    tracks = tracks_of(9)
    assert tracks.past(8, late="skip").frame[0].tolist() == [10, 20, 30, 40, 50, 60, 70, 80]
    assert tracks.past(8, frame=70, late="skip").frame[0, -1] == 70
    with pytest.raises(DataError, match="nobody at frame 60 was seen for long enough; 8 rows"):
        tracks.past(8, frame=60, late="skip")
    for frame in (75, 90):
        with pytest.raises(DataError, match=f"has no frame {frame}; they go from 0 to 80"):
            tracks.past(8, frame=frame)


def test_frames_without_people_are_stepped_over_except_by_timesplit():
    rows = [*range(10), *range(15, 25)]
    gap = Trajectories([1] * 20, [10 * k for k in rows], rows, [0.0] * 20, row_rate=2.5, frame_step=10)
    past, future = gap.windows(8, 12, "all")
    assert [*past.frame[0].tolist(), *future.frame[0].tolist()] == [10 * k for k in rows]
    with pytest.raises(DataError, match=r"the longest of 1 tracks has 10 rows without gaps \(20 with gaps\)"):
        gap.windows(8, 12, "timesplit")
    assert len(gap.windows(4, 6, "timesplit")[0]) == 1
