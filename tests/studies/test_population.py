"""Fit of people to recordings: experiments, errors of tracks, values of crowds, searches and reports."""

from __future__ import annotations

import json

import numpy as np
import pytest

from crowdbot.core import DataError, InputError
from crowdbot.models import ORCA, People
from people import crowd_values
from people.crowd_values import CrowdValues
from people.experiments import read_experiments
from people.fit import BOX, Candidate, PopulationFit, set_of
from people.report import fit_report, fold_rows, pareto_set, profile_sets
from people.track_errors import measure_tracks
from predict_people import compare_predictions

CITR_HEAD = "id,frame,label,x_est,y_est,vx_est,vy_est"
MIDDLE = {name: 0.5 * (low + high) for name, (low, high) in BOX.items()}


def write_street(path, people=4, rows=40):
    """Write people who walk straight and apart, as in the annotations of ETH: frame id x z y vx vz vy."""
    path.parent.mkdir(parents=True)
    lines = []
    for k in range(rows):
        lines += [f"{6 * k} {a} {0.4 * 1.2 * k} 0 {3.0 * a} 1.2 0 0" for a in range(people)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_cart(folder, rows=140):
    """Write two people and a cart beside them, as in CITR."""
    folder.mkdir(parents=True)
    walk = [f"{a},{k},ped,{1.3 * k / 29.97},{4.0 * a},1.3,0" for k in range(rows) for a in range(2)]
    cart = [f"0,{k},veh,{2.0 * k / 29.97},-5.0,0,2.0" for k in range(rows)]
    for name, lines in (("traj_ped", walk), ("traj_veh", cart)):
        (folder / f"run_01_{name}_filtered.csv").write_text("\n".join([CITR_HEAD, *lines]) + "\n", encoding="utf-8")


@pytest.fixture
def recordings(tmp_path):
    write_street(tmp_path / "eth_biwi/seq_eth/obsmat.txt")
    write_cart(tmp_path / "citr/vci_back")
    return tmp_path


def test_experiments_are_read_by_name_with_a_cart_that_keeps_its_path(recordings):
    street, cart = read_experiments(recordings, windows=3)
    assert (street.name, street.kind, street.fold) == ("seq_eth", "street", 0)
    past, future = street.parts[0]
    assert (past.position.shape, future.position.shape) == ((3, 8, 4, 2), (3, 12, 4, 2))
    other = read_experiments(recordings, windows=3, first=2)[0].parts[0][0]
    assert np.array_equal(other.frame, past.frame + 12)
    assert (cart.name, cart.kind, cart.fold) == ("citr vci_back", "cart", 1)
    past, future = cart.parts[0]
    assert past.robot.sum(axis=1).tolist() == [1] * len(past)
    robot = past.robot[0]
    assert np.array_equal(past.plan[0, :, robot], future.position[0, :, robot])
    assert np.all(np.isnan(past.plan[0, :, ~robot]))
    with pytest.raises(DataError, match="contains none of the recordings"):
        read_experiments(recordings / "citr")


def test_people_who_walk_straight_and_apart_are_predicted_exactly(recordings):
    for experiment in read_experiments(recordings, windows=2):
        tracks = measure_tracks(ORCA(), [{}], experiment)
        assert tracks.early.shape == tracks.mean.shape == (1, len(tracks.person))
        assert tracks.mean.max() < 1e-6
        assert np.array_equal(tracks.ttc[0], tracks.ttc_real)


def test_parameter_sets_do_not_influence_each_other(recordings):
    experiment = read_experiments(recordings, windows=2)[1]
    sets = [{"strength": 2.0}, {"strength": 9.0}]
    both = measure_tracks(People(), sets, experiment)
    alone = [measure_tracks(People(), [set_], experiment) for set_ in sets]
    assert np.array_equal(both.mean, np.concatenate([item.mean for item in alone]))


def test_values_of_crowds_are_those_of_each_set_alone(monkeypatch):
    monkeypatch.setattr(crowd_values, "SECONDS", 1.0)
    monkeypatch.setattr(crowd_values, "LAST", 0.6)
    monkeypatch.setattr(crowd_values, "POOR", -1.0)  # no doors
    sets = [{"headway_time_gap": 1.0}, {"headway_time_gap": 2.0}]
    both = crowd_values.measure_crowds(People(), sets)
    assert both == [crowd_values.measure_crowds(People(), [set_])[0] for set_ in sets]
    assert both[0].single_file != both[1].single_file
    assert both[0].stuck == 1.0


def test_the_penalty_counts_what_is_outside_the_limits():
    good = CrowdValues(0.05, 0.1, 1.9, 0.5, (30.0, 0.0), 45.0, 0.0)
    assert good.penalty == 0.0
    for change in ({"flow": 1.5}, {"flow": 2.3}, {"queues": (30.0, 9.0)}, {"queues": (2.0, 0.0)}, {"stuck": 0.2}):
        assert good._replace(**change).penalty > 0.0
    assert good._replace(corner=60.0, single_file=0.3).penalty > good._replace(corner=60.0).penalty


class MadeFit(PopulationFit):
    """A fit whose errors are made: the cost has its minimum at a range of 0.05 m; other values do not matter."""

    calls = 0

    def measure(self, rows):
        MadeFit.calls += len(rows)
        result = []
        for row in rows:
            error = 1.0 + 100.0 * (row["range"] - 0.05) ** 2
            tracks = {e.name: (error, error + 0.01 * k, 0.1) for k, e in enumerate(self.experiments)}
            result.append(Candidate(row, tracks, CrowdValues(0.05, 0.1, 1.9, 0.5, (30.0, 0.0), 45.0, 0.0)))
        return result


def test_a_search_finds_the_minimum_and_continues(recordings, tmp_path):
    experiments, state = read_experiments(recordings, windows=1), tmp_path / "state.jsonl"
    MadeFit.calls = 0
    first = MadeFit(People(), experiments, state).search("one", [MIDDLE], 60, 0.2)
    assert first.values["range"] == pytest.approx(0.05, abs=0.01)
    assert MadeFit.calls == len(state.read_text().splitlines()) == 59  # the start is the mean of the first generation
    kept = state.read_text().splitlines()[:30]
    state.write_text("\n".join(kept) + "\n")
    again = MadeFit(People(), experiments, state).search("one", [MIDDLE], 60, 0.2)
    assert again == first
    assert MadeFit.calls == 59 + 29
    assert all(set(json.loads(line)["values"]) == set(BOX) for line in kept)
    with pytest.raises(InputError, match="needs a budget above it, not 1"):
        MadeFit(People(), experiments, state).search("one", [MIDDLE], 1, 0.2)


def test_the_report_tells_what_is_identified(recordings, tmp_path):
    fit = MadeFit(People(), read_experiments(recordings, windows=1), tmp_path / "state.jsonl")
    best = fit.search("one", [MIDDLE], 80, 0.2)
    profiles = {set_.name: set_ for set_ in profile_sets(fit, best)}
    low, high = profiles["range"].interval
    assert low <= best.values["range"] <= high
    assert profiles["range"].identified == "yes"
    assert min(profiles["strength"].above) == 0.0
    assert pareto_set(fit.candidates(), fit.experiments)[0] is best
    rows = fold_rows(fit, fit.evaluate("before", [MIDDLE])[0])
    assert [fold for fold, *_ in rows] == [0, 1]
    text = fit_report(fit, best)
    assert "| range |" in text
    assert "seq_eth" in text


def test_models_are_compared_on_the_same_people(recordings):
    experiments = read_experiments(recordings, windows=2)
    table = compare_predictions({"orca": ORCA(), "people": People()}, experiments)
    assert table.names == ("orca", "people", "constant velocity")
    assert table.errors.shape == (3, 2, 3)
    assert table.by_kind().shape == (3, 2, 3)
    text = table.markdown("orca")
    assert "| model | street | cart |" in text
    assert "| constant velocity |" in text


def test_the_time_gap_is_the_follow_gap_and_the_anticipation():
    found = set_of(MIDDLE)
    assert found["headway_time_gap"] == pytest.approx(MIDDLE["follow_gap"] + MIDDLE["headway_anticipation"])
    assert set(found) == {*BOX, "headway_time_gap"} - {"follow_gap"}
