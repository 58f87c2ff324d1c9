"""Scores of tracks: against motmetrics and TrackEval, and cases made by hand."""

import json
import math

import numpy as np
import pytest
import tracking_reference

from crowdbot.core import InputError
from crowdbot.metrics import (
    TrackComparison,
    clear_mot,
    count_occlusions,
    gospa,
    hota,
    identity_f1,
    ospa,
    track_latency,
    tracking_scores,
)

ROWS = json.loads(tracking_reference.FILE.read_text(encoding="utf-8"))


@pytest.mark.parametrize("row", ROWS, ids=lambda row: str(row["seed"]))
def test_scores_equal_those_of_motmetrics_and_trackeval(row):
    table = tracking_reference.made_table(row["seed"])
    clear, higher = clear_mot(table), hota(table)
    assert clear.mota == pytest.approx(row["mota"], abs=1e-12)
    assert clear.motp == pytest.approx(row["motp"], abs=1e-12)
    assert (clear.switches, clear.misses, clear.false_tracks) == (
        row["num_switches"], row["num_misses"], row["num_false_positives"],
    )  # fmt: skip
    assert identity_f1(table) == pytest.approx(row["idf1"], abs=1e-12)
    assert tuple(higher) == pytest.approx((row["hota"], row["deta"], row["assa"]), abs=1e-9)


def test_perfect_tracks_have_perfect_scores():
    truth = np.cumsum(np.full((8, 3, 2), 0.1), axis=0) + np.arange(3.0)[None, :, None] * 4.0
    scores = tracking_scores(TrackComparison(truth, truth[:, [2, 0, 1]]), np.arange(8) / 10)
    assert [scores[name] for name in ("mota", "idf1", "hota")] == pytest.approx([1.0, 1.0, 1.0])
    assert [scores[name] for name in ("motp", "ospa", "gospa", "switches", "misses", "latency")] == [0.0] * 6


def test_a_pair_is_kept_while_it_is_within_reach():
    walk = [{0: (0.0, 0.0)}, {0: (0.0, 0.0)}]
    table = TrackComparison.of(walk, [{4: (0.0, 0.0)}, {4: (0.4, 0.0), 5: (0.0, 0.0)}])
    assert clear_mot(table).switches == 0
    assert clear_mot(table, reach=0.3).switches == 1


def test_hidden_people_and_their_tracks_do_not_count():
    people = [{0: (0.0, 0.0), 1: (5.0, 0.0)}] * 3
    tracks = [{7: (0.0, 0.0), 8: (5.1, 0.0)}] * 3
    whole, without = TrackComparison.of(people, tracks), TrackComparison.of(people, tracks, [(), (1,), (1,)])
    assert clear_mot(whole).people == 6
    found = clear_mot(without)
    assert (found.people, found.matches, found.false_tracks, found.mota) == (4, 4, 0, 1.0)
    lost = clear_mot(TrackComparison.of(people, [{7: (0.0, 0.0)}] * 3, [(1,), (1,), (1,)]))
    assert (lost.misses, lost.mota) == (0, 1.0)


def test_a_switch_costs_association_but_not_detection():
    people = [{0: (0.0, 0.0), 1: (3.0, 0.0)}] * 10
    swapped = [{5: (0.0, 0.0), 6: (3.0, 0.0)}] * 5 + [{6: (0.0, 0.0), 5: (3.0, 0.0)}] * 5
    found = hota(TrackComparison.of(people, swapped))
    assert found.detection == pytest.approx(1.0)
    assert found.association == pytest.approx(5.0 / 15.0)
    assert identity_f1(TrackComparison.of(people, swapped)) == pytest.approx(0.5)


def test_ospa_and_gospa_of_missing_and_false_tracks():
    table = TrackComparison.of([{0: (0, 0)}, {0: (0, 0)}, {}, {}], [{}, {3: (0.3, 0.4)}, {3: (0, 0)}, {}])
    assert ospa(table).tolist() == pytest.approx([1.0, 0.5, 1.0, 0.0])
    assert gospa(table).tolist() == pytest.approx([math.sqrt(0.5), 0.5, math.sqrt(0.5), 0.0])
    assert ospa(table, cutoff=0.4).tolist() == pytest.approx([0.4, 0.4, 0.4, 0.0])


def test_latency_counts_from_the_first_sight():
    people = [{0: (0, 0), 1: (9, 9)}, {0: (0, 0)}, {0: (0, 0)}]
    table = TrackComparison.of(people, [{}, {}, {2: (0, 0)}], [(0,), (), ()])
    assert track_latency(table, [0.0, 0.5, 1.0]).tolist() == [0.5, math.inf]


def test_no_people_have_no_accuracy():
    table = TrackComparison(np.zeros((3, 0, 2)), np.zeros((3, 0, 2)))
    found = tracking_scores(table, [0.0, 0.1, 0.2])
    assert math.isnan(found["mota"])
    assert math.isnan(found["hota"])
    assert found["ospa"] == 0.0


def test_wrong_tables_are_rejected():
    with pytest.raises(InputError, match=r"estimate has shape \[2, 1, 2\], it must be \[3, people, 2\]"):
        TrackComparison(np.zeros((3, 1, 2)), np.zeros((2, 1, 2)))
    with pytest.raises(InputError, match="1 instants of people, 2 of tracks"):
        TrackComparison.of([{}], [{}, {}])
    with pytest.raises(InputError, match=r"hidden has shape \[3, 2\]"):
        TrackComparison(np.zeros((3, 1, 2)), np.zeros((3, 1, 2)), np.zeros((3, 2), dtype=bool))


def hidden_table(after):
    """Return a person tracked as 5, hidden for 0.4 s, and then tracked as ``after``."""
    rows = [{5: (0.0, 0.0)}] * 3 + [{}] * 4 + [after] * 3
    hidden = [[]] * 3 + [[0]] * 4 + [[]] * 3
    return TrackComparison.of([{0: (0.0, 0.0)}] * 10, rows, hidden)


@pytest.mark.parametrize(("after", "kept"), [({5: (0.1, 0.0)}, 1), ({6: (0.1, 0.0)}, 0), ({}, 0)])
def test_an_occlusion_keeps_the_identity_or_not(after, kept):
    found = count_occlusions(hidden_table(after), 0.1 * np.arange(10))
    assert (found.total, found.kept, found.people.tolist()) == (1, kept, [True])


def test_short_occlusions_and_people_who_were_never_tracked_do_not_count():
    assert count_occlusions(hidden_table({5: (0.0, 0.0)}), 0.05 * np.arange(10), least=0.3).total == 0
    nobody = TrackComparison.of([{0: (0, 0)}] * 9, [{}] * 9, [[]] * 3 + [[0]] * 4 + [[]] * 2)
    assert count_occlusions(nobody, 0.1 * np.arange(9)).total == 0
    to_the_end = TrackComparison.of([{0: (0, 0)}] * 9, [{5: (0, 0)}] * 9, [[]] * 3 + [[0]] * 6)
    assert count_occlusions(to_the_end, 0.1 * np.arange(9)).total == 0


def test_a_subset_has_the_tracks_of_its_people_only():
    table = TrackComparison.of([{0: (0, 0), 1: (5, 0)}] * 2, [{3: (0.1, 0), 4: (5, 0.1), 5: (9, 9)}] * 2)
    people = np.array([[True, False]] * 2)
    part = table.subset(people, np.zeros((2, 3), dtype=bool), 0.5)
    scores = tracking_scores(part, [0.0, 0.1])
    assert scores["mota"] == 1.0
    other = tracking_scores(table.subset(~people, np.ones((2, 3), dtype=bool), 0.5), [0.0, 0.1])
    assert other["false_tracks"] == 1.0
    assert other["misses"] == 0.0
