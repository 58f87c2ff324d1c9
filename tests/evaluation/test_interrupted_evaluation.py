"""Evaluations that are killed at random moments, and workers that die, end with the same table."""

import importlib
import random
import signal
import subprocess
import sys
import time

import pytest

from crowdbot.evaluation import EvaluationPlan, evaluate, load_evaluation, parse_methods
from crowdbot.trials import load_trial

PROGRAM = """
import importlib, sys
from pathlib import Path
from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
from crowdbot.trials import load_trial
importlib.import_module("crowdbot.evaluation.runner").CHUNK = 1
plan = EvaluationPlan([load_trial("circle-crossing", duration=3.0)], parse_methods("straight, orca"), seeds=range(10))
evaluate(plan, Path(sys.argv[1]) / "parts").save(Path(sys.argv[1]) / "result.json")
"""
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


@pytest.mark.sweep
def test_an_evaluation_that_is_killed_20_times_ends_with_the_same_table(tmp_path):
    rng = random.Random(17)
    command = [sys.executable, "-c", PROGRAM, str(tmp_path)]
    kills = 0
    while kills < 20 and not (tmp_path / "result.json").exists():
        process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        begin, before = time.monotonic(), len(list(tmp_path.glob("parts/*.json")))
        # a run without a new part is killed only after one, so that all 20 kills hit different moments of the work
        while len(list(tmp_path.glob("parts/*.json"))) == before and time.monotonic() - begin < 120:
            if process.poll() is not None or rng.random() < 0.002:
                break
            time.sleep(0.01)
        time.sleep(rng.uniform(0.0, 0.05))
        if process.poll() is None:
            process.send_signal(signal.SIGKILL)
            kills += 1
        process.wait()
    assert subprocess.run(command, check=False).returncode == 0
    assert kills >= 10
    plan = EvaluationPlan(
        [load_trial("circle-crossing", duration=3.0)], parse_methods("straight, orca"), seeds=range(10)
    )
    whole = evaluate(plan)
    again = load_evaluation(tmp_path / "result.json")
    assert plain(cells_of(again)) == plain(cells_of(whole))
    for one, other in zip(again.cells, whole.cells, strict=True):
        for row, wanted in zip(one.runs, other.runs, strict=True):
            assert dict(row.metrics) == pytest.approx(dict(wanted.metrics), nan_ok=True, rel=0.0, abs=0.0)


@pytest.mark.sweep
def test_a_worker_that_dies_does_not_change_the_table(tmp_path, monkeypatch):
    monkeypatch.setattr(importlib.import_module("crowdbot.evaluation.runner"), "CHUNK", 2)
    (tmp_path / "fatal.py").write_text(FATAL)
    monkeypatch.chdir(tmp_path)
    plan = EvaluationPlan([load_trial("frontal", duration=2.0)], parse_methods("fatal.py:Fatal, orca"), seeds=range(6))
    found = evaluate(plan, workers=2)
    assert (tmp_path / "died").exists()
    alone = evaluate(plan)
    assert plain(cells_of(found)) == plain(cells_of(alone))
    assert not found.failures
