"""Windows: the protocols reproduce the counts and errors of the literature, and nothing of the future leaks."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import DataError, InputError
from crowdbot.data import PROTOCOLS, Trajectories, load

FOLDS = {
    "eth": ("biwi_eth",),
    "hotel": ("biwi_hotel",),
    "univ": ("students001", "students003"),
    "zara1": ("crowds_zara01",),
    "zara2": ("crowds_zara02",),
}
# person-windows, ADE, FDE of constant velocity [m]; the anchors of this project, measured before it was written
GOLDEN = {
    ("all", "eth"): (364, 1.075, 2.282),
    ("all", "hotel"): (1197, 0.319, 0.614),
    ("all", "univ"): (24334, 0.524, 1.165),
    ("all", "zara1"): (2356, 0.427, 0.952),
    ("all", "zara2"): (5910, 0.324, 0.724),
    ("sgan", "eth"): (181, 0.995, 2.234),
    ("sgan", "hotel"): (1053, 0.323, 0.617),
    ("sgan", "univ"): (24334, 0.524, 1.165),
    ("sgan", "zara1"): (2253, 0.431, 0.960),
    ("sgan", "zara2"): (5833, 0.326, 0.728),
    ("partial", "eth"): (2398, 0.585, 1.159),
    ("partial", "hotel"): (3376, 0.278, 0.512),
    ("partial", "univ"): (32183, 0.466, 1.026),
    ("partial", "zara1"): (3821, 0.346, 0.764),
    ("partial", "zara2"): (7888, 0.314, 0.695),
}


def constant_velocity_errors(past, future):
    """Return ADE and FDE [m] of every scored person: the last displacement is kept."""
    last, before = past.position[:, -1], past.position[:, -2]
    steps = np.arange(1, future.position.shape[1] + 1)[None, :, None, None]
    error = np.linalg.norm(last[:, None] + (last - before)[:, None] * steps - future.position, axis=-1)
    error = error.transpose(0, 2, 1)[future.scored]
    present = future.present.transpose(0, 2, 1)[future.scored]
    ade = (error * present).sum(1) / present.sum(1)
    return ade, error[np.arange(len(error)), present.sum(1) - 1]


@pytest.mark.parametrize(("protocol", "fold"), GOLDEN)
def test_counts_and_constant_velocity_on_the_leave_one_out_files(recordings, protocol, fold):
    errors = []
    for name in FOLDS[fold]:
        past, future = load(recordings / f"eth_ucy_splits/all_data/{name}.txt").windows(protocol=protocol)
        errors.append(constant_velocity_errors(past, future))
    ade, fde = (np.concatenate(part) for part in zip(*errors, strict=True))
    count, mean_ade, mean_fde = GOLDEN[protocol, fold]
    assert len(ade) == count
    assert ade.mean() == pytest.approx(mean_ade, abs=0.001)
    assert fde.mean() == pytest.approx(mean_fde, abs=0.001)


@pytest.mark.parametrize(
    ("path", "count", "ade", "fde"),
    [
        ("eth_biwi/seq_eth", 781, 0.678, 1.344),
        ("eth_biwi/seq_hotel", 312, 0.344, 0.657),
        ("ucy/students03", 1744, 0.682, 1.356),
        ("ucy/zara01", 392, 0.449, 0.999),
        ("ucy/zara02", 1311, 0.336, 0.752),
    ],
)
def test_the_authors_files(recordings, path, count, ade, fde):
    tracks = load(recordings / path / "obsmat.txt")
    test, train = (tracks.windows(protocol=name) for name in ("timesplit", "timesplit-train"))
    assert test[1].scored.sum() == count
    assert train[0].frame.max() < test[0].frame[:, -1].min()
    every = tracks.windows(protocol="all")
    assert train[1].scored.sum() + count == every[1].scored.sum()
    errors = constant_velocity_errors(*every)
    assert (errors[0].mean(), errors[1].mean()) == pytest.approx((ade, fde), abs=0.001)


def crowd(seed=0, people=12, frames=40, step=10, holes=True):
    """Return people who come and go, walk about, and are sometimes lost for a frame."""
    rng = np.random.default_rng(seed)
    rows = []
    for person in range(people):
        first = int(rng.integers(0, frames - 2))
        last = int(rng.integers(first + 1, frames))
        place = rng.uniform(-5, 5, 2)
        for k in range(first, last + 1):
            place = place + rng.normal(0.3, 0.2, 2)
            if not (holes and rng.random() < 0.03):
                rows.append((person + 3, k * step, *place))
    id, frame, x, y = zip(*rows, strict=True)
    return Trajectories(id, frame, x, y, row_rate=2.5, frame_step=step, name="crowd")


def slow_windows(tracks, observe, predict, protocol):
    """Return {(last observed frame, id): future places} the obvious way, and {frame: usable ids}."""
    place = {(int(f), int(i)): (x, y) for f, i, x, y in zip(tracks.frame, tracks.id, tracks.x, tracks.y, strict=True)}
    frames = sorted({f for f, _ in place})
    if protocol == "timesplit":
        around = {f: [f + tracks.frame_step * k for k in range(1 - observe, predict + 1)] for f in frames}
    else:
        beyond = [-k for k in range(predict, 0, -1)]
        long = frames + beyond
        around = {f: long[k + 1 - observe : k + predict + 1] for k, f in enumerate(frames) if k >= observe - 1}
    scored, usable = {}, {}
    for f, nearby in around.items():
        seen = [i for i in tracks.ids.tolist() if all((g, i) in place for g in nearby[:observe])]
        future = {}
        for i in seen:
            known = []
            for g in nearby[observe:]:
                if (g, i) not in place:
                    break
                known.append(place[g, i])
            if len(known) >= (2 if protocol == "partial" else predict):
                future[i] = known
        if len(future) >= (2 if protocol == "sgan" else 1):
            scored.update({(f, i): known for i, known in future.items()})
            usable[f] = seen
    if protocol == "timesplit":
        late = sorted(usable)[len(usable) * 4 // 5 :]
        scored = {key: known for key, known in scored.items() if key[0] in late}
        usable = {f: seen for f, seen in usable.items() if f in late}
    return scored, usable


@pytest.mark.parametrize("protocol", ["all", "sgan", "partial", "timesplit"])
@pytest.mark.parametrize("seed", range(6))
def test_windows_are_what_the_obvious_loops_find(protocol, seed):
    tracks = crowd(seed)
    scored, usable = slow_windows(tracks, 4, 5, protocol)
    past, future = tracks.windows(4, 5, protocol=protocol)
    assert past.frame[:, -1].tolist() == sorted(usable)
    for w in range(len(past)):
        frame = int(past.frame[w, -1])
        assert past.id[w][past.present[w, -1]].tolist() == usable[frame]
        assert past.present[w, :, : len(usable[frame])].all()
        for a, person in enumerate(usable[frame]):
            assert future.scored[w, a] == ((frame, person) in scored)
            if future.scored[w, a]:
                known = scored[frame, person][:5]
                assert future.present[w, :, a].sum() == len(known)
                assert future.position[w, : len(known), a].tolist() == [list(place) for place in known]
    assert future.scored.sum() == len(scored)
    assert not past.scored.any()
    assert (past.protocol, past.source, past.dt, past.units) == (protocol, "crowd", 0.4, "m")


def test_padding_is_empty():
    past, future = crowd(1).windows(4, 5)
    nobody = past.id == -1
    assert nobody.any()
    for part in (past, future):
        assert not part.present.transpose(0, 2, 1)[nobody].any()
        assert not part.scored[nobody].any()
        assert not part.position[~part.present].any()


@pytest.mark.parametrize("protocol", [name for name in PROTOCOLS if name != "trajnet++"])  # which needs scenes
@pytest.mark.parametrize("late", ["skip", "extrapolate"])
def test_nothing_of_the_future_is_in_the_past(protocol, late):
    tracks = crowd(2, people=20)
    past, future = tracks.windows(4, 5, protocol=protocol, late=late)
    rng = np.random.default_rng(9)
    for w in range(len(past)):
        after = tracks.frame > past.frame[w, -1]
        place = tracks.position
        place[after] = rng.normal(0.0, 1e3, (int(after.sum()), 2))
        spoilt = Trajectories(
            tracks.id, tracks.frame, place[:, 0], place[:, 1], row_rate=2.5, frame_step=10, name="crowd"
        )
        again, garbage = spoilt.windows(4, 5, protocol=protocol, late=late)
        for field in ("position", "present", "scored", "robot", "id", "frame"):
            assert getattr(again, field)[w].tobytes() == getattr(past, field)[w].tobytes()
        assert garbage.position[w].tobytes() != future.position[w].tobytes()


def test_who_is_company_does_not_depend_on_the_future():
    """People who vanish right after the last observed step stay in the past."""
    id = [1] * 20 + [2] * 8
    frame = [*range(20), *range(8)]
    x = [0.1 * k for k in range(20)] + [5.0] * 8
    past, future = Trajectories(id, frame, x, [0.0] * 28, row_rate=2.5).windows()
    assert past.id.tolist() == [[1, 2]]
    assert future.scored.tolist() == [[True, False]]
    assert not future.present[0, :, 1].any()


def test_latecomers_are_skipped_or_walked_backwards():
    id = [1] * 20 + [2] * 5 + [3] * 1
    frame = [*range(20), *range(5, 10), 7]
    x = [0.0] * 20 + [2.0, 2.5, 3.5, 4.5, 5.5] + [9.0]
    tracks = Trajectories(id, frame, x, [1.0] * 26, row_rate=2.5)
    assert tracks.windows(late="skip")[0].id.tolist() == [[1]]
    past, future = tracks.windows(late="extrapolate")
    assert past.id.tolist() == [[1, 2]]
    assert past.position[0, :, 1, 0].tolist() == [-0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.5]
    assert past.present.all()
    assert future.scored.tolist() == [[True, False]]


def test_only_people_near_a_robot_are_scored():
    id = np.repeat([1, 2, 9], 20)
    frame = np.tile(np.arange(20), 3)
    x = np.concatenate([np.full(20, 1.0), np.full(20, 4.0), np.zeros(20)])
    tracks = Trajectories(id, frame, x, np.zeros(60), row_rate=2.5, robots=frozenset({9}), name="walk")
    past, future = tracks.windows(near=2.0)
    assert future.scored.tolist() == [[True, False, False]]
    assert past.robot.tolist() == [[False, False, True]]
    assert tracks.windows()[1].scored.tolist() == [[True, True, False]]
    assert tracks.windows(protocol="sgan", near=2.0)[1].scored.sum() == 1
    with pytest.raises(DataError, match=r"within 0\.5 m of a robot; the nearest is 1\.00 m away"):
        tracks.windows(near=0.5)
    with pytest.raises(DataError, match="has no robot, which near requires"):
        tracks.only(ids=[1, 2]).windows(near=2.0)
    with pytest.raises(DataError, match="contains only robots, no people to predict"):
        tracks.track(9).windows()


def test_frames_of_a_partial_window_go_on_after_the_end_of_the_file():
    past, future = Trajectories([1] * 10, range(0, 100, 10), range(10), range(10), row_rate=2.5).windows(
        protocol="partial"
    )
    assert past.frame[0].tolist() == list(range(0, 80, 10))
    assert future.frame[0].tolist() == list(range(80, 200, 10))
    assert future.present[0, :, 0].tolist() == [True] * 2 + [False] * 10


def test_a_gap_of_the_whole_file_is_stepped_over_except_by_timesplit():
    frame = [*range(0, 100, 10), *range(200, 300, 10)]
    tracks = Trajectories([1] * 20, frame, np.arange(20.0), np.zeros(20), row_rate=2.5)
    assert len(tracks.windows()[0]) == 1
    with pytest.raises(DataError, match=r"longest of 1 tracks has 10 rows without gaps \(20 with gaps\)"):
        tracks.windows(protocol="timesplit")


def test_the_present_can_be_predicted_without_any_future():
    tracks = crowd(3, people=20, holes=False)
    now = int(tracks.frame[len(tracks) // 2])
    past = tracks.past(4, frame=now, late="skip")
    _, usable = slow_windows(tracks, 4, 1, "all")
    assert past.frame[0].tolist() == [now - 30, now - 20, now - 10, now]
    assert set(usable[now]) <= set(past.id[0].tolist())
    assert len(tracks.past(4)) == 1
    assert not past.scored.any()
    with pytest.raises(DataError, match="crowd has no frame 5; they go from"):
        tracks.past(4, frame=5)
    with pytest.raises(DataError, match="was seen for long enough; 4 rows are asked for"):
        tracks.past(4, frame=int(tracks.frame[0]))


@given(st.integers(0, 50), st.floats(-100, 100), st.floats(-100, 100), st.integers(-500, 500))
@settings(deadline=None, max_examples=20)
def test_shifting_moves_windows_and_changes_nothing_else(seed, dx, dy, later):
    tracks = crowd(seed, people=15)
    moved = Trajectories(
        tracks.id, tracks.frame + later * 10, tracks.x + dx, tracks.y + dy, row_rate=2.5, frame_step=10
    )
    try:
        old = tracks.windows(3, 4)
    except DataError:
        with pytest.raises(DataError):
            moved.windows(3, 4)
        return
    new = moved.windows(3, 4)
    for part, other in zip(old, new, strict=True):
        assert np.array_equal(part.frame + later * 10, other.frame)
        assert np.array_equal(part.present, other.present)
        assert np.array_equal(part.scored, other.scored)
        assert np.allclose(part.position + np.where(part.present[..., None], [dx, dy], 0.0), other.position)


@given(st.integers(0, 50), st.integers(1, 1000))
@settings(deadline=None, max_examples=20)
def test_renumbering_and_shuffling_change_only_the_numbers(seed, offset):
    tracks = crowd(seed, people=15)
    shuffled = np.random.default_rng(seed).permutation(len(tracks))
    renumbered = Trajectories(
        tracks.id[shuffled] + offset,
        tracks.frame[shuffled],
        tracks.x[shuffled],
        tracks.y[shuffled],
        row_rate=2.5,
        frame_step=10,
    )
    past, future = tracks.windows(2, 2, protocol="partial")
    again, later = renumbered.windows(2, 2, protocol="partial")
    assert np.array_equal(past.position, again.position)
    assert np.array_equal(future.position, later.position)
    assert np.array_equal(future.scored, later.scored)
    assert np.array_equal(np.where(past.id < 0, -1, past.id + offset), again.id)


def test_why_no_window_was_found():
    tracks = Trajectories([1] * 7 + [2], [*range(0, 70, 10), 30], range(8), range(8), row_rate=2.5, name="short.txt")
    with pytest.raises(DataError) as error:
        tracks.windows()
    assert str(error.value) == (
        "short.txt: no window of 8 observed and 12 predicted rows was found (protocol all), because the longest of 2"
        " tracks has 7 rows and 20 are needed; a row is 10 frames or 0.4 s, 7 frames hold 1 to 2 tracks each;"
        " ask for fewer rows, or resample to shorter steps"
    )
    with pytest.raises(DataError, match="no window of 8 observed and at least 2 predicted rows"):
        tracks.windows(protocol="partial")
    with pytest.raises(DataError, match="no window has two people who are present at all rows"):
        tracks.windows(2, 2, protocol="sgan")
    with pytest.raises(DataError, match="no window is left for training"):
        tracks.windows(3, 4, protocol="timesplit-train")


def test_wrong_arguments_are_named():
    tracks = crowd(4)
    with pytest.raises(InputError, match="unknown protocol 'sgann', did you mean 'sgan'\\?; known are all, sgan"):
        tracks.windows(protocol="sgann")
    with pytest.raises(InputError, match="unknown late 'skp', did you mean 'skip'"):
        tracks.windows(late="skp")
    with pytest.raises(InputError, match="observe is 0, it is a number of rows"):
        tracks.windows(observe=0)
    with pytest.raises(InputError, match=r"predict is 2\.5, it is a number of rows"):
        tracks.windows(predict=2.5)
    with pytest.raises(InputError, match=r"near is -1\.0 m, it must be above 0"):
        tracks.windows(near=-1.0)


def test_too_many_windows_are_refused_before_memory_runs_out(monkeypatch):
    monkeypatch.setattr("crowdbot.data.protocols.MAX_BYTES", 10_000)
    with pytest.raises(DataError, match=r"windows of 4 \+ 5 rows and up to .* GiB; resample to longer steps"):
        crowd(5).windows(4, 5)
