"""Metrics of logs in evaluations: paired runs, ghosts, physics, families."""

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.evaluation import EvaluationPlan, episode_log, episode_metrics, evaluate, families_of, parse_methods
from crowdbot.metrics import metric_table
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial


def test_paired_runs_give_the_effect_and_the_chaos_floor():
    trial = load_trial("crossing-flows", duration=6.0)
    plan = EvaluationPlan([trial], parse_methods("orca"), seeds=range(2), families=("crowd-disturbance", "empty-scene"))
    (cell,) = evaluate(plan).cells
    assert (cell.values("crowd_disturbance") > 10 * cell.values("chaos_floor")).all()
    assert (cell.values("neighbors") > 0).all()
    assert (cell.values("relative_jerk") > 0).all()
    ghost = dataclasses.replace(trial, robots=(dataclasses.replace(trial.robots[0], ghost=True),))
    plan = EvaluationPlan([ghost], seeds=[0], families=("crowd-disturbance",))
    assert evaluate(plan).cells[0].values("crowd_disturbance").tolist() == [0.0]


def test_a_ghost_has_no_metrics_of_contacts():
    trial = load_trial("frontal", duration=8.0)
    ghost = dataclasses.replace(trial, robots=(dataclasses.replace(trial.robots[0], ghost=True),))
    found = episode_metrics(simulate(ghost, 0))
    assert not [name for name in found if "collision" in name or name.startswith(("severity", "contact_"))]
    assert found["max_fear"] > 0.0


def test_every_metric_of_a_run_is_in_the_table():
    episode = simulate(load_trial("frontal", duration=8.0, world="physics"), 0)
    found = dict(episode.metrics) | episode_metrics(episode)
    table = metric_table()
    unknown = {name for name in found if name not in table and not name.startswith("impact_severity_")}
    assert not unknown
    assert found["head_impacts"] == 0.0


def test_the_shortest_path_goes_through_the_door():
    episode = simulate(load_trial("bottleneck", duration=1.0), 0)
    log = episode_log(episode)
    assert log.path is not None
    length = np.hypot(*np.diff(log.path, axis=0).T).sum()
    assert length >= math.dist(log.path[0], log.goal) - 1e-9
    assert episode_metrics(episode)["shortest_length"] == pytest.approx(length - log.tolerance)


def test_families_are_named_by_their_metrics():
    assert families_of(["success", "relative_time", "chaos_floor"]) == ("empty-scene", "crowd-disturbance")
    with pytest.raises(InputError, match="no family of metrics 'comfrot', did you mean 'comfort'"):
        EvaluationPlan([load_trial("frontal")], families=("comfrot",))
