"""On a local Ray cluster, with a worker killed half way, the table is the same as in one process."""

import json
import os
import subprocess
import sys
import tempfile

import pytest

from crowdbot.evaluation import EvaluationPlan, evaluate, load_evaluation, parse_methods
from crowdbot.trials import load_trial

pytestmark = pytest.mark.live

FATAL = """
import os, signal
from pathlib import Path
from dataclasses import dataclass
from crowdbot.core import Twist
from crowdbot.navigation import Navigator


@dataclass(frozen=True)
class Fatal(Navigator):
    def act(self, observation):
        marker = Path(__file__).with_name("died")
        if observation.time > 0.5 and not marker.exists():
            marker.write_text(str(os.getpid()))
            os.kill(os.getpid(), signal.SIGKILL)
        return Twist(0.5)
"""
PROGRAM = """
import importlib, json, os
from pathlib import Path
from crowdbot.core import CrowdbotError, InputError, each
from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
from crowdbot.trials import load_trial


def refuse(number):
    raise InputError(f"{number} is refused")


def die(number):
    os._exit(1)


def message(function, kind):
    try:
        list(each(function, [1], 2, "auto"))
    except kind as error:
        return str(error)


if __name__ == "__main__":
    import ray

    ray.init(address="local", num_cpus=2, include_dashboard=False, log_to_driver=False)
    importlib.import_module("crowdbot.evaluation.runner").PARALLEL_BATCH = 2
    plan = EvaluationPlan([load_trial("frontal", duration=1.5)], parse_methods("fatal.py:Fatal"), seeds=range(4))
    evaluate(plan, workers=2, cluster="auto").save(Path("cluster.json"))
    found = {"messages": [message(refuse, InputError), message(die, CrowdbotError)], "stays": ray.is_initialized()}
    ray.shutdown()
    found["local"] = sorted(each(abs, [-3, 4], 2, "local"))
    found["ended"] = not ray.is_initialized()
    with open("found.json", "w") as file:
        json.dump(found, file)
"""


def test_a_worker_of_a_cluster_that_dies_does_not_change_the_table(tmp_path, monkeypatch):
    (tmp_path / "fatal.py").write_text(FATAL)
    # a socket of Ray has at most 107 characters in its path, and the tests of another process may have a cluster, too
    with tempfile.TemporaryDirectory(prefix="ray-", dir="/tmp", ignore_cleanup_errors=True) as place:
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM], cwd=tmp_path, env=os.environ | {"RAY_TMPDIR": place}, check=False,
            capture_output=True, text=True, timeout=500,
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    monkeypatch.chdir(tmp_path)
    assert (tmp_path / "died").read_text() != str(os.getpid())
    plan = EvaluationPlan([load_trial("frontal", duration=1.5)], parse_methods("fatal.py:Fatal"), seeds=range(4))
    alone = evaluate(plan)
    there = load_evaluation(tmp_path / "cluster.json")
    assert [repr(cell.runs) for cell in there.cells] == [repr(cell.runs) for cell in alone.cells]
    assert not there.failures
    document = json.loads((tmp_path / "found.json").read_text())
    assert document["messages"][0] == "1 is refused"
    assert document["messages"][1].startswith("a job was lost on the cluster in 3 attempts: ")
    assert document["stays"]
    assert document["ended"]
    assert document["local"] == [[0, 3], [1, 4]]
