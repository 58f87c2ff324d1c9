"""The evaluation tells the planning navigators from those that ignore or underrate people."""

import pytest

from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
from crowdbot.simulation import simulate_seeds
from crowdbot.trials import load_trial
from samples import sizes

CROSSING = load_trial("circle-crossing")


@pytest.mark.parametrize("seeds", sizes(6, 12))
def test_mpc_succeeds_where_straight_and_orca_fail(seeds):
    plan = EvaluationPlan([CROSSING], parse_methods("straight, orca, mpc"), seeds=range(seeds))
    straight, orca, mpc = evaluate(plan).cells
    assert sum(mpc.values("success")) == seeds
    assert sum(mpc.values("success")) > sum(orca.values("success")) > sum(straight.values("success"))


@pytest.mark.parametrize("name", ["social-force", "potential-field", "dynamic-window"])
def test_the_others_run_and_do_better_than_straight(name):
    plan = EvaluationPlan([CROSSING], parse_methods(name), seeds=range(4))
    (cell,) = evaluate(plan).cells
    assert sum(cell.values("success")) >= 1
    assert cell.estimate("error-rate").value == 0.0


def test_mpc_moves_a_holonomic_robot_through_the_circle():
    settings = {"robot/holonomic": True, "robot/drive/type": "omnidirectional", "robot/navigator/type": "mpc"}
    episodes = simulate_seeds(load_trial("circle-crossing", **settings), range(3))
    assert [episode.metrics["success"] for episode in episodes] == [1.0] * 3


def test_runs_of_mpc_are_equal_in_batches_and_alone():
    trial = load_trial("circle-crossing", **{"robot/navigator/type": "mpc"})
    together = simulate_seeds(trial, range(2))
    (alone,) = simulate_seeds(trial, range(1, 2))
    assert together[1].digest == alone.digest
