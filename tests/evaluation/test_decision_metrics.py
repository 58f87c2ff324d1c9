"""Compute times and missed deadlines of decisions in an evaluation."""

import dataclasses
import math

import pytest

from crowdbot.cli import main
from crowdbot.evaluation.run_metrics import decision_metrics
from crowdbot.metrics import metric_families
from crowdbot.navigation import ProcessNavigator
from crowdbot.simulation import simulate, simulate_seeds
from crowdbot.trials import load_trial

SLOW = """import time
from crowdbot import Twist
from crowdbot.navigation import Navigator


class Slow(Navigator):
    def act(self, observation):
        time.sleep(0.02)
        return Twist(0.2)
"""


def driven(navigator=None, **changes):
    """Return a trial whose first robot is changed."""
    trial = load_trial("frontal", duration=1.0)
    changes |= {} if navigator is None else {"navigator": navigator}
    return dataclasses.replace(trial, robots=(dataclasses.replace(trial.robots[0], **changes),))


@pytest.mark.parametrize(("deadline", "missed"), [(1e-9, 1.0), (60.0, 0.0)])
def test_decisions_of_a_navigator_with_a_deadline_are_measured(deadline, missed):
    trial = driven(deadline=deadline)
    episodes = simulate_seeds(trial, [0, 1, 2])
    decisions = round(trial.duration / trial.robots[0].control_period)
    for episode in episodes:
        found = decision_metrics(episode)
        assert found["missed_deadlines"] == missed
        assert 0.0 < found["decision_time"] <= found["decision_time_p99"] < 60.0
        assert abs(len(episode.decision_times["robot"]) - decisions) <= 1


@pytest.mark.live
def test_a_navigator_in_a_process_is_measured_without_a_deadline(tmp_path):
    file = tmp_path / "slow.py"
    file.write_text(SLOW)
    navigator = ProcessNavigator(address=f"{file}:Slow", sandbox=False)
    found = decision_metrics(simulate(driven(navigator), 0))
    assert found["decision_time"] >= 0.02
    assert math.isnan(found["missed_deadlines"])
    found = decision_metrics(simulate(driven(navigator, deadline=0.01), 0))
    assert found["missed_deadlines"] == 1.0


def test_others_are_not_measured_and_the_table_says_what_is():
    assert decision_metrics(simulate(driven(), 0)) == {}
    known = {row.name for row in metric_families()["decisions"]}
    assert set(decision_metrics(simulate(driven(deadline=1.0), 0))) == known


def test_the_table_of_evaluate_has_the_columns(capsys):
    words = ["evaluate", "frontal", "--set", "duration=1", "--navigators", "orca", "--seeds", "0:2"]
    assert main([*words, "--set", "robot/deadline=5"]) == 0
    told = capsys.readouterr().out
    assert "deadlines" in told  # the second line of a narrow column
    assert "decision-" in told
    assert main(words) == 0
    assert "deadlines" not in capsys.readouterr().out
