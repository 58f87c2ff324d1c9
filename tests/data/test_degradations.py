"""Degradations: the contract over all of them, and that each does what it says, in the amount that it says."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest

from crowdbot.core import DataError, InputError, builtin_classes, parameters, stream
from crowdbot.data import Trajectories, degrade, load
from crowdbot.data.degrade import (
    GHOST,
    Chain,
    CorrelatedNoise,
    DegradedTracks,
    EmptyRecordingError,
    FalseTracks,
    GaussianNoise,
    HeavyTails,
    IdentitySwitches,
    LateStart,
    MissingFrames,
    Occlusion,
)
from crowdbot.data.degrade.identity_switches import encounters
from crowdbot.data.degrade.row_ranks import iterate_ranks, row_rank

KINDS = list(builtin_classes(degrade, degrade.Degradation).values())
DETERMINISTIC = (LateStart,)


def _crowd(people=12, rows=40, seed=0, robot=True, dt=0.4):
    """People who wander in a square of 8 m, each there for a while; the last is a robot."""
    rng = stream(seed, "crowd")
    place = rng.uniform(0.0, 8.0, (1, people, 2)) + np.cumsum(rng.normal(0.0, 0.3, (rows, people, 2)), axis=0)
    begin, end = rng.integers(0, rows // 3, people), rng.integers(2 * rows // 3, rows, people)
    begin[-1], end[-1] = 0, rows
    t, a = np.nonzero((np.arange(rows)[:, None] >= begin) & (np.arange(rows)[:, None] < end))
    return Trajectories(
        a + 1,
        10 * t,
        *place[t, a].T,
        row_rate=1.0 / dt,
        name="made",
        robots=frozenset([people]) if robot else frozenset(),
        labels={1: "Biker"},
    )


def _still(people, rows, dt=0.4):
    """People who stand at 0, 0, so that what is seen is the error."""
    t, a = np.divmod(np.arange(people * rows), people)
    return Trajectories(a, t, np.zeros(len(t)), np.zeros(len(t)), row_rate=1.0 / dt)


def _same(one, other):
    return all(np.array_equal(getattr(one.tracks, k), getattr(other.tracks, k)) for k in ("id", "frame", "x", "y"))


def _some(kind):
    """One level that changes the made crowd, below the highest."""
    return kind().at(kind.levels[-2])


@pytest.mark.parametrize("kind", KINDS)
def test_the_seed_decides(kind):
    tracks, one = _crowd(), _some(kind)
    first, again, other = (one.apply(tracks, stream(seed)) for seed in (1, 1, 2))
    assert _same(first, again)
    assert np.array_equal(first.truth, again.truth)
    assert _same(first, other) == (kind in DETERMINISTIC)
    assert not _same(first, DegradedTracks.of(tracks))


@pytest.mark.parametrize("kind", KINDS)
def test_at_level_0_the_recording_comes_back_to_the_last_bit(kind):
    tracks = dataclasses.replace(_crowd(), x=np.where(_crowd().x > 4.0, -0.0, _crowd().x))
    seen = kind().at(0).apply(tracks, stream(3))
    assert seen.tracks is tracks
    assert np.array_equal(seen.truth, tracks.id)


@pytest.mark.parametrize("kind", KINDS)
def test_truth_robots_and_frames_hold(kind):
    tracks = _crowd()
    seen = _some(kind).apply(tracks, stream(1))
    assert len(seen.truth) == len(seen.tracks)
    assert set(seen.truth.tolist()) <= {*tracks.ids.tolist(), GHOST}
    assert set(seen.tracks.frame.tolist()) <= set(tracks.frame.tolist())
    assert (seen.tracks.dt, seen.tracks.frame_step, seen.tracks.robots) == (tracks.dt, 10, tracks.robots)
    robot, clean = seen.tracks.track(12), tracks.track(12)
    assert all(np.array_equal(getattr(robot, k), getattr(clean, k)) for k in ("frame", "x", "y"))
    real = seen.truth != GHOST
    pairs = list(zip(seen.tracks.frame[real].tolist(), seen.truth[real].tolist(), strict=True))
    assert len(set(pairs)) == len(pairs)
    assert set(pairs) <= set(zip(tracks.frame.tolist(), tracks.id.tolist(), strict=True))


@pytest.mark.parametrize("kind", KINDS)
def test_parameters_are_a_table_and_the_level_is_one_of_them(kind):
    rows = parameters(kind)
    assert kind.level in [row.name for row in rows]
    assert all(row.unit and row.source and row.low <= row.default <= row.high for row in rows)
    assert kind.levels[0] == 0
    assert list(kind.levels) == sorted(set(kind.levels))
    assert str(kind()).startswith(f"{kind().name}({rows[0].name}=")


@pytest.mark.parametrize("kind", [MissingFrames, Occlusion, LateStart])
def test_what_a_low_level_loses_a_high_one_loses_too(kind):
    tracks = _crowd()
    seen = [kind().at(level).apply(tracks, stream(4)) for level in kind.levels[:-1]]
    rows = [set(zip(s.tracks.frame.tolist(), s.tracks.id.tolist(), strict=True)) for s in seen]
    assert all(fewer < more for more, fewer in pairwise(rows))


def test_gaussian_noise_has_its_deviation_and_no_memory():
    error = GaussianNoise(0.1).apply(_still(200, 100), stream(0)).tracks.position
    assert error.mean() == pytest.approx(0.0, abs=0.002)
    assert error.std(axis=0) == pytest.approx([0.1, 0.1], rel=0.02)
    by_track = error.reshape(100, 200, 2)
    assert np.corrcoef(by_track[1:].ravel(), by_track[:-1].ravel())[0, 1] == pytest.approx(0.0, abs=0.02)
    assert np.corrcoef(error.T)[0, 1] == pytest.approx(0.0, abs=0.02)


def test_noise_of_twice_the_level_is_twice_the_noise():
    one, two = (GaussianNoise(sd).apply(_still(5, 9), stream(0)).tracks.x for sd in (0.1, 0.2))
    assert two == pytest.approx(2.0 * one)


def test_correlated_noise_has_its_deviation_and_forgets_in_its_time():
    error = CorrelatedNoise(sd=0.2, time=1.5).apply(_still(2000, 21), stream(0)).tracks.position.reshape(21, 2000, 2)
    assert error.std(axis=(1, 2)) == pytest.approx(np.full(21, 0.2), rel=0.06)
    for lag in (1, 3, 8):
        expected = np.exp(-lag * 0.4 / 1.5)
        assert np.mean(error[lag:] * error[:-lag]) / 0.04 == pytest.approx(expected, abs=0.02)


def test_correlated_noise_remembers_over_holes_by_the_time_that_passed():
    tracks = _still(20000, 2)
    holed = dataclasses.replace(tracks, frame=5 * tracks.frame, frame_step=1)
    error = CorrelatedNoise(sd=1.0, time=2.0).apply(holed, stream(0)).tracks.x.reshape(2, -1)
    assert np.mean(error[0] * error[1]) == pytest.approx(np.exp(-5 * 0.4 / 2.0), abs=0.02)
    white = CorrelatedNoise(sd=1.0, time=0.0).apply(tracks, stream(0)).tracks.x.reshape(2, -1)
    assert np.mean(white[0] * white[1]) == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize(("probability", "freedom"), [(1.0, 3.0), (0.1, 1.0)])
def test_heavy_tails_have_the_tail_of_student(probability, freedom):
    seen = HeavyTails(probability, scale=0.3, freedom=freedom).apply(_still(100, 2000), stream(0)).tracks
    away = np.hypot(seen.x, seen.y)
    assert np.mean(away > 0.0) == pytest.approx(probability, rel=0.03)
    for far in (0.3, 1.0, 3.0):
        tail = probability * (1.0 + far**2 / (freedom * 0.3**2)) ** (-freedom / 2.0)
        assert np.mean(away > far) == pytest.approx(tail, rel=0.1)


@pytest.mark.parametrize(("probability", "burst"), [(0.1, 1.0), (0.2, 4.0), (0.6, 2.0)])
def test_missing_frames_have_their_share_and_their_gaps(probability, burst):
    seen = MissingFrames(probability, burst).apply(_still(200, 500), stream(0)).tracks
    there = np.zeros((500, 200), bool)
    there[seen.frame, seen.id] = True
    assert 1.0 - there.mean() == pytest.approx(probability, rel=0.05)
    begins = np.sum(there[:-1] & ~there[1:]) + np.sum(~there[0])
    assert np.sum(~there) / begins == pytest.approx(burst / (1.0 - probability), rel=0.05)


def test_whole_frames_can_be_missing():
    seen = MissingFrames(0.3, of="frame").apply(_still(10, 1000), stream(0)).tracks
    frames, count = np.unique(seen.frame, return_counts=True)
    assert set(count.tolist()) == {10}
    assert len(frames) == pytest.approx(700, rel=0.1)


def test_late_start_drops_the_first_rows_and_short_tracks():
    tracks = Trajectories([1, 1, 1, 1, 2, 2], [0, 1, 5, 6, 0, 1], np.arange(6.0), np.zeros(6), row_rate=2.5)
    seen = LateStart(2).apply(tracks)
    assert seen.tracks.id.tolist() == [1, 1]
    assert seen.tracks.frame.tolist() == [5, 6]
    with pytest.raises(EmptyRecordingError, match="no rows are left"):
        LateStart(4).apply(tracks)


def test_ghosts_are_born_at_their_rate_walk_straight_and_die():
    tracks = _crowd(rows=4000)
    seen = FalseTracks(rate=2.0, life=5.0, speed=0.7).apply(tracks, stream(0))
    ghosts = seen.tracks._where(seen.truth == GHOST)
    assert ghosts.ids.min() == tracks.ids.max() + 1
    seconds = 4000 * 0.4
    assert len(ghosts) * 0.4 / seconds == pytest.approx(2.0 * 5.0, rel=0.05)  # Little's law
    velocity = ghosts.velocities()
    known = ~np.isnan(velocity[:, 0])
    firsts = np.unique(ghosts.id[known], return_index=True)[1]
    assert np.sqrt(np.mean(np.sum(velocity[known][firsts] ** 2, axis=1))) == pytest.approx(0.7, rel=0.05)
    own = velocity[known][ghosts.id[known] == ghosts.id[known][0]]
    assert own == pytest.approx(np.broadcast_to(own[0], own.shape))
    real = seen.tracks._where(seen.truth != GHOST)
    assert np.array_equal(real.x, tracks.x)


def _crossing(rows=9):
    """1 walks along x and 2 against it, 0.4 m beside; 3 is far."""
    t = np.arange(rows)
    return Trajectories(
        np.repeat([1, 2, 3], rows),
        np.tile(t, 3),
        np.concatenate([t - 4.0, 4.0 - t, 0.0 * t]),
        np.repeat([0.0, 0.4, 30.0], rows),
        row_rate=2.5,
    )


def test_switches_swap_for_good_where_two_are_nearest():
    tracks = _crossing()
    assert encounters(tracks, 0.5) == [(4, 1, 2)]
    seen = IdentitySwitches(1.0, distance=0.5).apply(tracks, stream(0))
    assert np.array_equal(seen.tracks.frame, tracks.frame)
    swapped = {(f, i): t for f, i, t in zip(seen.tracks.frame, seen.tracks.id, seen.truth, strict=True)}
    assert all(swapped[f, 1] == (1 if f < 4 else 2) for f in range(9))
    assert all(swapped[f, 2] == (2 if f < 4 else 1) for f in range(9))
    assert all(swapped[f, 3] == 3 for f in range(9))
    one = seen.tracks.track(1)
    assert one.x.tolist() == [-4.0, -3.0, -2.0, -1.0, 0.0, -1.0, -2.0, -3.0, -4.0]


def test_the_share_of_switches_is_their_probability_and_every_row_keeps_its_place(recordings):
    tracks = load(recordings / "eth_ucy_splits" / "all_data" / "students003.txt", fps=25)
    met = encounters(tracks, 0.6)
    slow = _slow_switches(tracks, met, 0.3)
    seen = IdentitySwitches(0.3, distance=0.6).apply(tracks, stream(5))
    assert len(met) > 500
    key = np.lexsort((seen.truth, seen.tracks.frame))
    assert np.array_equal(seen.truth[key], tracks.id)
    assert np.array_equal(seen.tracks.x[key], tracks.x)
    assert seen.tracks.id[key].tolist() == slow
    assert set(encounters(seen.tracks, 0.6)) != set(met)


def _slow_switches(tracks, met, probability):
    """The obvious twin: a dictionary of names that is read row by row."""
    drawn = stream(5).random(len(met))
    names = {id: id for id in tracks.ids.tolist()}
    waiting = [pair for pair, u in zip(met, drawn, strict=True) if u < probability]
    slow_switches = []
    for frame, id in zip(tracks.frame.tolist(), tracks.id.tolist(), strict=True):
        while waiting and waiting[0].frame <= frame:
            _, one, other = waiting.pop(0)
            names[one], names[other] = names[other], names[one]
        slow_switches.append(names[id])
    return slow_switches


def test_encounters_are_stretches_as_a_slow_twin_finds_them():
    tracks = _crowd(seed=3)
    frames = np.unique(tracks.frame)
    slow = []
    for item in range(1, 12):
        for other in range(item + 1, 12):
            stretch = []
            for frame in [*frames, None]:
                here = dict(_at(tracks, frame)) if frame is not None else {}
                away = np.hypot(*(here[item] - here[other])) if item in here and other in here else np.inf
                if away < 1.0:
                    stretch.append((away, int(frame)))
                elif stretch:
                    slow.append((min(stretch)[1], item, other))
                    stretch = []
    assert encounters(tracks, 1.0) == sorted(slow)
    assert len(slow) > 10


def _at(tracks, frame):
    rows = tracks.frame == frame
    return zip(tracks.id[rows].tolist(), tracks.position[rows], strict=True)


def test_a_chain_applies_in_order_and_remembers_the_truth():
    tracks = _crowd()
    chain = Chain((IdentitySwitches(1.0, 1.0), LateStart(3), FalseTracks(1.0), GaussianNoise(0.1)))
    seen = chain.apply(tracks, stream(1))
    assert _same(seen, chain.apply(tracks, stream(1)))
    seeds = stream(1).integers(0, 2**63, size=4)
    by_hand = DegradedTracks.of(tracks)
    for link, seed in zip(chain.links, seeds, strict=True):
        by_hand = link.apply(by_hand, np.random.Generator(np.random.PCG64(int(seed))))
    assert _same(seen, by_hand)
    real = seen.truth != GHOST
    clean = {(f, i): p for f, i, p in zip(tracks.frame, tracks.id, tracks.position, strict=True)}
    away = seen.tracks.position[real] - [
        clean[key] for key in zip(seen.tracks.frame[real], seen.truth[real], strict=True)
    ]
    people = ~np.isin(seen.truth[real], [12])
    assert 0.08 < away[people].std() < 0.12
    assert not away[~people].any()
    assert chain.at(0.5).links[0].probability == 0.5
    assert not chain.neutral
    assert Chain((LateStart(0), GaussianNoise(0.0))).apply(tracks).tracks is tracks


def test_turns_are_the_rows_of_every_track_in_order():
    tracks = _crowd()
    seen = list(iterate_ranks(tracks.id, tracks.frame))
    assert sorted(np.concatenate([rows for rows, _ in seen]).tolist()) == list(range(len(tracks)))
    for turn, (rows, before) in enumerate(seen):
        assert (row_rank(tracks.id, tracks.frame)[rows] == turn).all()
        assert (tracks.id[rows] == tracks.id[before]).all() if turn else len(before) == 0


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: GaussianNoise(-0.1), ("GaussianNoise: sd = -0.1 [m]", "at least 0")),
        (lambda: GaussianNoise(float("nan")), ("sd = nan",)),
        (lambda: GaussianNoise(np.array([0.1, 0.2])), ("gaussian-noise: sd must be one number",)),
        (lambda: MissingFrames(1.5), ("missing-frames: probability = 1.5 must be at most 1",)),
        (lambda: MissingFrames(burst=0.5), ("burst = 0.5", "at least 1,")),
        (lambda: MissingFrames(of="persons"), ("of 'persons' is unknown, did you mean 'person'?",)),
        (lambda: LateStart(2.5), ("late-start: rows = 2.5 must be a whole number",)),
        (lambda: FalseTracks(rate=-1.0), ("rate = -1.0 [1/s]",)),
        (lambda: IdentitySwitches(distance=-1.0), ("distance = -1.0 [m]",)),
        (lambda: HeavyTails(freedom=0.0), ("freedom = 0.0", "at least 0.5")),
        (lambda: Chain(()), ("at least one",)),
    ],
)
def test_wrong_parameters_are_one_sentence(make, words):
    with pytest.raises(InputError) as error:
        make()
    for word in words:
        assert word in str(error.value)
    assert "\n" not in str(error.value)


def test_wrong_recordings_are_one_sentence():
    pixels = dataclasses.replace(_crowd(), units="px")
    with pytest.raises(DataError, match="made is in pixels, gaussian-noise is in metres"):
        GaussianNoise(0.1).apply(pixels)
    assert len(MissingFrames(0.5).apply(pixels).tracks) < len(pixels)
    with pytest.raises(DataError, match="id -1, which is reserved for false tracks"):
        GaussianNoise(0.1).apply(Trajectories([-1], [0], [0.0], [0.0], row_rate=2.5))
    with pytest.raises(DataError, match="1 rows, truth has shape"):
        DegradedTracks(Trajectories([1], [0], [0.0], [0.0], row_rate=2.5), np.zeros(2, np.int64))


def test_labels_and_scenes_of_who_is_gone_are_gone():
    tracks = Trajectories([1, 1, 2], [0, 1, 1], [0.0] * 3, [0.0] * 3, row_rate=2.5, labels={1: "Biker", 2: "Cart"})
    assert LateStart(1).apply(tracks).tracks.labels == {1: "Biker"}
