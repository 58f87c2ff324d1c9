"""Evaluations that are killed at random moments, and workers that die, end with the same table."""

import importlib

import pytest

from crowdbot.evaluation import EvaluationPlan, evaluate, load_evaluation, parse_methods
from crowdbot.trials import load_trial
from killed_runs import FEW, MANY, run_killed

FATAL = """
import os, signal
from dataclasses import dataclass
from pathlib import Path
from crowdbot.core import Twist
from crowdbot.navigation import Navigator


@dataclass(frozen=True)
class Fatal(Navigator):
    def act(self, observation):
        marker = Path(__file__).with_name("died")
        if observation.time > 0.5 and not marker.exists():
            marker.write_text("once")
            os.kill(os.getpid(), signal.SIGKILL)
        return Twist(0.5)
"""


def cells_of(result):
    return [(cell.trial, cell.method, cell.runs) for cell in result.cells]


def plain(cells):
    return repr(
        [(trial, method, [(row.seed, row.outcome, row.digest) for row in runs]) for trial, method, runs in cells]
    )


@pytest.mark.live
@pytest.mark.parametrize(
    "kills", [FEW, pytest.param(8, marks=pytest.mark.sweep), pytest.param(MANY, marks=pytest.mark.soak)]
)
def test_a_killed_evaluation_ends_with_the_same_table(tmp_path, kills):
    words = ["evaluate", "circle-crossing", "--navigators", "straight, orca", "--set", "duration=3"]
    run_killed(tmp_path, [*words, "--seeds", "0:70", "--worst", "1"], kills, seed=kills)
    whole, killed = (load_evaluation(tmp_path / name / "result.json") for name in ("whole", "killed"))
    assert [len(cell.runs) for cell in whole.cells] == [70, 70]
    assert repr(killed.cells) == repr(whole.cells)
    report = (tmp_path / "whole" / "report.html").read_text(encoding="utf-8")
    assert (tmp_path / "killed" / "report.html").read_text(encoding="utf-8") == report


@pytest.mark.sweep
def test_a_worker_that_dies_does_not_change_the_table(tmp_path, monkeypatch):
    monkeypatch.setattr(importlib.import_module("crowdbot.evaluation.runner"), "PARALLEL_BATCH", 2)
    (tmp_path / "fatal.py").write_text(FATAL)
    monkeypatch.chdir(tmp_path)
    plan = EvaluationPlan([load_trial("frontal", duration=2.0)], parse_methods("fatal.py:Fatal, orca"), seeds=range(6))
    found = evaluate(plan, workers=2)
    assert (tmp_path / "died").exists()
    alone = evaluate(plan)
    assert plain(cells_of(found)) == plain(cells_of(alone))
    assert not found.failures
