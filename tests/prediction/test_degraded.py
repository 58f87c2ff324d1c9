"""Predictors on degraded recordings: what they see, whom they are scored against, and who counts."""

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import DataError, InputError, stream
from crowdbot.data import Trajectories
from crowdbot.data.degrade import (
    GHOST,
    Chain,
    DegradedTracks,
    FalseTracks,
    GaussianNoise,
    IdentitySwitches,
    LateStart,
    MissingFrames,
    Occlusion,
)
from crowdbot.evaluation import DegradedTask, score_predictor, sweep_degradations
from crowdbot.prediction import ConstantVelocity, Kalman, SampledConstantVelocity, Simulated, degraded_windows

FIELDS = ("position", "present", "scored", "robot", "id", "frame")


def _line(ids=(1, 2), rows=8, gap=2.0, **more):
    """People side by side who walk along x, 0.5 m a row."""
    t, a = np.divmod(np.arange(rows * len(ids)), len(ids))
    return Trajectories(np.array(ids)[a], t, 0.5 * t, gap * a, row_rate=2.5, name="line", **more)


def _without(tracks, *gone):
    """The recording without the rows (frame, id)."""
    keep = [(f, i) not in gone for f, i in zip(tracks.frame.tolist(), tracks.id.tolist(), strict=True)]
    return DegradedTracks.of(tracks).keep_rows(np.array(keep))


@pytest.mark.parametrize("protocol", ["all", "sgan", "partial", "timesplit"])
def test_what_is_not_degraded_is_seen_as_it_was(recorded, protocol):
    tracks = recorded("crowds_zara01")
    past, future = tracks.windows(8, 12, protocol)
    seen = degraded_windows(past, future, DegradedTracks.of(tracks), carry=2)
    assert seen.asked == seen.predictable == future.scored.sum()
    for clean, again in ((past, seen.past), (future, seen.future)):
        assert all(np.array_equal(getattr(clean, name), getattr(again, name)) for name in FIELDS)


@pytest.mark.parametrize("predictor", [ConstantVelocity(), Simulated(), SampledConstantVelocity()])
def test_the_level_that_changes_nothing_is_evaluate(recorded, predictor):
    tracks = recorded("biwi_hotel")
    clean = score_predictor(predictor, *tracks.windows(), samples=3, seed=4)
    ((score,),) = sweep_degradations(
        [tracks], [GaussianNoise()], [predictor], [0.0], DegradedTask(samples=3, seed=4, draws=2)
    )
    assert (score.score.ade, score.score.fde, score.score.horizon) == (clean.ade, clean.fde, clean.horizon)
    assert (score.coverage, score.asked, score.low, score.high) == (1.0, clean.persons, clean.ade, clean.ade)


def _slow(past, future, degraded, carry):
    """The obvious twin: dictionaries, window by window. Returns for each window {seen id: (rows, truth, scored)}."""
    rows = {}
    for f, i, p, who in zip(
        degraded.tracks.frame, degraded.tracks.id, degraded.tracks.position, degraded.truth, strict=True
    ):
        rows[int(f), int(i)] = (p, int(who))
    slow = []
    for w in range(len(past)):
        frames = past.frame[w].tolist()
        members = {int(past.id[w, a]): a for a in np.flatnonzero(past.present[w, -1])}
        here, taken = {}, set()
        for back in range(carry + 1):
            now = [(i, who) for (f, i), (_, who) in rows.items() if f == frames[-1 - back]]
            new = {
                i: who
                for i, who in now
                if (who in members or (who == GHOST and back == 0)) and i not in here and who not in taken
            }
            here |= new
            taken |= set(new.values()) - {GHOST}
        window = {}
        for i, who in here.items():
            track = [rows.get((f, i), (None,))[0] for f in frames]
            scored = who != GHOST and bool(future.scored[w, members[who]])
            window[i] = (track, members.get(who), scored)
        slow.append(window)
    return slow


@pytest.mark.parametrize("carry", [0, 2])
def test_what_is_seen_against_a_slow_twin(recorded, carry):
    tracks = recorded("crowds_zara02")
    tracks = tracks._where(tracks.frame < 1500)
    chain = Chain((MissingFrames(0.3, 2.0), IdentitySwitches(1.0, 1.0), FalseTracks(1.0), GaussianNoise(0.1)))
    degraded = chain.apply(tracks, stream(2))
    past, future = tracks.windows()
    seen = degraded_windows(past, future, degraded, carry)
    slow = _slow(past, future, degraded, carry)
    assert seen.predictable == sum(scored for window in slow for _, _, scored in window.values())
    assert 0.5 * seen.asked < seen.predictable < seen.asked
    carried = 0
    for w, window in enumerate(slow):
        assert seen.past.id[w][seen.past.id[w] >= 0].tolist() == sorted(window)
        for a, i in enumerate(sorted(window)):
            track, member, scored = window[i]
            last = max(t for t, place in enumerate(track) if place is not None)
            carried += last < 7
            for t, place in enumerate(track[: last + 1]):
                assert seen.past.present[w, t, a] == (place is not None)
                assert place is None or np.array_equal(seen.past.position[w, t, a], place)
            assert seen.past.present[w, last:, a].all()
            assert seen.future.scored[w, a] == scored
            if member is not None:
                assert np.array_equal(seen.future.position[w, :, a], future.position[w, :, member])
                assert np.array_equal(seen.future.present[w, :, a], future.present[w, :, member])
            else:
                assert not seen.future.present[w, :, a].any()
    assert (carried > 0) == (carry > 0)
    assert not seen.past.scored.any()


def test_who_is_not_seen_at_the_last_row_is_asked_for_but_not_scored():
    tracks = _line()
    past, future = tracks.windows(4, 4)
    seen = degraded_windows(past, future, _without(tracks, (3, 2)))
    assert (seen.asked, seen.predictable) == (2, 1)
    assert seen.past.id.tolist() == [[1]]
    score = score_predictor(ConstantVelocity(), seen.past, seen.future)
    assert score.persons == 1
    assert score.ade == pytest.approx(0.0)


def test_who_is_carried_walks_on():
    tracks = _line()
    past, future = tracks.windows(4, 4)
    lost = _without(tracks, (2, 2), (3, 2))
    assert degraded_windows(past, future, lost, carry=1).predictable == 1
    seen = degraded_windows(past, future, lost, carry=2)
    assert seen.predictable == 2
    assert seen.past.position[0, :, 1].tolist() == [[0.0, 2.0], [0.5, 2.0], [1.0, 2.0], [1.5, 2.0]]
    once = degraded_windows(past, future, _without(tracks, (0, 2), (2, 2), (3, 2)), carry=2)
    assert once.past.present[0, :, 1].tolist() == [False, True, True, True]
    assert once.past.position[0, -1, 1].tolist() == [0.5, 2.0]


def test_a_switched_track_is_scored_against_who_is_at_its_place_now():
    t = np.arange(8)
    tracks = Trajectories(
        np.repeat([1, 2], 8), np.tile(t, 2), np.tile(0.5 * t, 2), np.concatenate([0.0 * t, 0.3 + 0.0 * t]), 2.5
    )
    names = np.where(tracks.frame >= 3, 3 - tracks.id, tracks.id)
    past, future = tracks.windows(4, 4)
    seen = degraded_windows(past, future, DegradedTracks.of(tracks).relabel(names))
    assert seen.predictable == 2
    assert seen.past.position[0, :, 0, 1].tolist() == [0.0, 0.0, 0.0, 0.3]
    assert seen.future.position[0, :, 0, 1].tolist() == [0.3] * 4
    assert score_predictor(ConstantVelocity(), seen.past, seen.future).ade == pytest.approx(0.3 * 2.5)


def test_ghosts_are_company_that_is_never_scored():
    tracks = _line(rows=20)
    haunted = FalseTracks(rate=5.0, life=8.0).apply(tracks, stream(0))
    past, future = tracks.windows(8, 12)
    seen = degraded_windows(past, future, haunted)
    assert seen.past.id.shape[1] > 2
    assert seen.future.scored.sum() == seen.asked == 2
    assert not seen.future.present[0, :, 2:].any()
    assert score_predictor(Simulated(), seen.past, seen.future).ade != score_predictor(Simulated(), past, future).ade


def test_predictors_do_not_see_the_future(recorded):
    tracks = recorded("crowds_zara01")
    past, future = tracks.windows()
    degraded = Chain((MissingFrames(0.2), GaussianNoise(0.1))).apply(tracks, stream(0))
    last = past.frame[40, -1]
    later = degraded.tracks.frame > last
    moved = dataclasses.replace(degraded.tracks, x=np.where(later, -3.0, degraded.tracks.x))
    one, other = (
        degraded_windows(past[40:41], future[40:41], seen) for seen in (degraded, DegradedTracks(moved, degraded.truth))
    )
    assert all(np.array_equal(getattr(one.past, name), getattr(other.past, name)) for name in FIELDS)


def test_errors_rise_with_noise_and_the_filter_stands_it_best(recorded):
    predictors = [ConstantVelocity(), Kalman(), Simulated()]
    levels = list(
        sweep_degradations(
            [recorded("crowds_zara01")], [GaussianNoise()], predictors, task=DegradedTask(seed=1, draws=2)
        )
    )
    ade = np.array([[score.score.ade for score in scores] for scores in levels])
    assert (np.diff(ade, axis=0) > 0.0).all()
    assert ade[0] == pytest.approx([0.427, 0.443, 0.427], abs=1e-3)
    assert (ade[2:, 1] < ade[2:, 0]).all()
    assert all(score.low <= score.score.ade <= score.high for scores in levels for score in scores)
    assert [scores[0].level for scores in levels] == list(GaussianNoise.levels)


def test_a_sweep_repeats_and_tells_how_far_it_is(recorded):
    told = []
    tracks = recorded("biwi_hotel")
    task = DegradedTask(seed=3, draws=2)
    parts = ([IdentitySwitches(), LateStart()], [ConstantVelocity()])
    one = list(sweep_degradations([tracks], *parts, task=task, progress=lambda *what: told.append(what)))
    two = list(sweep_degradations([tracks], *parts, task=task))
    assert [[s.score.ade for s in scores] for scores in one] == [[s.score.ade for s in scores] for scores in two]
    assert told[0] == ("identity-switches", 0.0)
    assert told[-1] == ("late-start", 1.0)
    other = list(sweep_degradations([tracks], *parts, task=DegradedTask(seed=4, draws=2)))
    assert one[2][0].score.ade != other[2][0].score.ade


def test_two_recordings_count_together(recorded):
    hotel, zara = recorded("biwi_hotel"), recorded("crowds_zara01")
    ((both,),) = sweep_degradations(
        [hotel, zara], [MissingFrames()], [ConstantVelocity()], [0.3], DegradedTask(draws=2)
    )
    alone = [
        next(sweep_degradations([item], [MissingFrames()], [ConstantVelocity()], [0.3], DegradedTask(draws=2)))[0]
        for item in (hotel, zara)
    ]
    assert both.asked == sum(item.asked for item in alone)
    assert both.score.persons == sum(item.score.persons for item in alone)
    mean = sum(item.score.ade * item.score.persons for item in alone) / both.score.persons
    assert both.score.ade == pytest.approx(mean)
    assert both.coverage == pytest.approx(0.7, abs=0.03)
    assert both.score.source == "biwi_hotel.txt + crowds_zara01.txt"


def test_only_every_such_window_is_predicted(recorded):
    hotel = recorded("biwi_hotel")
    ((some,),) = sweep_degradations([hotel], [MissingFrames()], [ConstantVelocity()], [0.0], DegradedTask(every=7))
    past, future = hotel.windows()
    alone = score_predictor(ConstantVelocity(), past[::7], future[::7])
    assert some.asked == some.score.persons == alone.persons < future.scored.sum() / 5
    assert some.score.ade == alone.ade


def test_nobody_to_predict_is_a_coverage_of_none(recorded):
    tracks = _line(rows=20)
    for degradation, level in ((MissingFrames(), 1.0), (Occlusion(eye=(500.0, 0.0)), 1.0), (LateStart(), 9)):
        ((score,),) = sweep_degradations([tracks], [degradation], [ConstantVelocity()], [level])
        assert score.score is None
        assert score.coverage == 0.0
        assert score.asked == 2
        assert math.isnan(score.low)
        assert score.as_dict()["score"] is None


def test_wrong_sweeps_are_one_sentence():
    tracks = _line(rows=20)
    with pytest.raises(InputError, match=r"GaussianNoise: sd = -0\.1"):
        next(sweep_degradations([tracks], [GaussianNoise()], [ConstantVelocity()], [-0.1]))
    with pytest.raises(DataError, match="line has no robot as a viewpoint"):
        next(sweep_degradations([tracks], [GaussianNoise(), Occlusion()], [ConstantVelocity()]))
    with pytest.raises(InputError, match="carry = -1"):
        DegradedTask(carry=-1)
    with pytest.raises(InputError, match="draws = 0 must be at least 1"):
        DegradedTask(draws=0)
