"""`make flaky` runs tests in random orders and names those whose outcome differs."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import flaky  # noqa: E402
import shuffle  # noqa: E402

NAMES = [
    f"tests/{file}.py::{test}" for file in "abcd" for test in ("One::x", "One::y", "test_z[1]", "test_z[2]", "test_w")
]


def groups(names):
    """Return the runs of equal neighbours."""
    return [name for k, name in enumerate(names) if k == 0 or names[k - 1] != name]


@pytest.mark.parametrize("seed", ["0", "1", "2"])
def test_an_order_keeps_files_and_classes_together(seed):
    found = shuffle.order(NAMES, seed)
    assert sorted(found) == sorted(NAMES)
    assert found == shuffle.order(NAMES[::-1], seed)
    assert len(groups([name.split("::")[0] for name in found])) == 4
    assert len(groups(["::".join(name.split("[")[0].split("::")[:2]) for name in found])) == 12


def test_seeds_give_other_orders():
    found = [shuffle.order(NAMES, str(seed)) for seed in range(20)]
    assert len({tuple(names) for names in found}) == 20
    assert len({names[0].split("::")[0] for names in found}) == 4


def test_the_worst_phase_is_the_outcome_of_a_test():
    lines = [["a", "begun"], ["a", "passed"], ["b", "begun"], ["b", "passed"], ["b", "error"], ["c", "begun"]]
    text = "\n".join(json.dumps(line) for line in lines)
    assert shuffle.outcomes(text) == {"a": "passed", "b": "error", "c": "begun"}


def result(name, status=0, **found):
    return flaky.Result(flaky.Run(name, 1), found, status)


def test_tests_with_other_outcomes_are_found():
    results = [
        result("order 1", a="passed", b="passed", c="failed"),
        result("busy", 1, a="passed", b="failed", c="failed"),
    ]
    assert flaky.differences(results) == {"b": {"order 1": "passed", "busy": "failed"}}


def test_a_run_that_died_blames_the_test_that_had_begun_and_no_other():
    results = [result("order 1", a="passed", b="passed", c="passed"), result("cold", -9, a="passed", b="begun")]
    assert flaky.differences(results) == {"b": {"order 1": "passed", "cold": "begun"}}
    results[1].status = flaky.INTERRUPTED
    assert flaky.differences(results) == {}


def test_a_test_that_one_order_does_not_have_differs():
    results = [result("order 1", a="passed", b="passed"), result("order 2", a="passed")]
    assert flaky.differences(results) == {"b": {"order 1": "passed", "order 2": "absent"}}


def test_runs_are_of_every_kind_and_repeat_with_the_seed():
    runs = flaky.plan_runs(3, 5)
    assert [run.name for run in runs] == ["order 1", "order 2", "order 3", "busy", "cold"]
    assert [run.name for run in runs if run.busy] == ["busy"]
    assert [run.name for run in runs if run.cold] == ["cold"]
    assert runs == flaky.plan_runs(3, 5)
    assert len({run.seed for run in runs + flaky.plan_runs(3, 6)}) == 10
    assert flaky.plan_runs(3, 5, ["busy"]) == [*runs[:3], runs[4]]


@pytest.fixture
def start(monkeypatch):
    """Return a function that runs the tool on results in place of runs; it returns the exit status and the names."""

    def begin(words, *results):
        waiting, seen = list(results), []

        def perform(run, words):
            seen.append(run.name)
            found, status = waiting.pop(0) if waiting else ({"a": "passed"}, 0)
            return flaky.Result(run, found, status)

        monkeypatch.setattr(flaky, "perform", perform)
        return flaky.main(words), seen

    return begin


def test_the_run_fails_if_a_test_differs_and_says_how_to_repeat_it(start, capsys):
    status, seen = start(["tests/house", "--seed", "3"], ({"a": "failed"}, 1))
    assert (status, len(seen)) == (1, 5)
    printed = capsys.readouterr().out
    seed = flaky.plan_runs(3, 3)[0].seed
    assert (
        "flaky: a: failed in order 1, passed in order 2, passed in order 3, passed in busy, passed in cold" in printed
    )
    assert f"to repeat order 1: SHUFFLE={seed} PYTHONHASHSEED={seed} PYTHONPATH=tools python -m pytest" in printed
    assert "to repeat order 2" not in printed
    assert printed.endswith("flaky: 1 tests did not have the same outcome in all runs\n")


def test_equal_outcomes_pass_and_constant_failures_are_counted(start, capsys):
    failed = [({"a": "passed", "b": "failed"}, 1)] * 5
    assert start(["tests/house"], *failed)[0] == 0
    assert "flaky: 1 tests failed in every run, such as b" in capsys.readouterr().out


def test_a_run_that_died_fails(start, capsys):
    assert start(["tests/house"], ({"a": "passed"}, 3))[0] == 1
    assert "1 passed; it ended early, exit status 3" in capsys.readouterr().out


def test_an_interruption_reports_what_is_known(start, capsys):
    status, seen = start(["tests/house"], ({"a": "passed"}, 0), ({"a": "failed"}, flaky.INTERRUPTED))
    assert (status, len(seen)) == (130, 2)
    printed = capsys.readouterr().out
    assert "flaky: a: passed in order 1, failed in order 2" in printed
    assert printed.endswith("flaky: interrupted\n")


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["tests/nothing"], "there is no tests/nothing"),
        (["--runs", "-1"], "--runs is -1"),
        (["--runs", "1", "--without", "busy", "cold"], "there is nothing to compare"),
    ],
)
def test_wrong_options_are_refused(start, capsys, words, reason):
    with pytest.raises(SystemExit):
        start(words)
    assert reason in capsys.readouterr().err


SAMPLES = """
import pytest
made = []
@pytest.fixture(scope="module")
def car():
    made.append(1)
def test_one(car): assert made == [1]
def test_two(car): assert made == [1]
def test_wrong(): assert False
@pytest.fixture
def broken(): raise ValueError
def test_broken(broken): pass
"""


@pytest.mark.program
def test_the_plugin_shuffles_and_notes_outcomes(tmp_path):
    for name in ("test_a.py", "test_b.py"):
        (tmp_path / name).write_text(SAMPLES)
    command = [sys.executable, "-m", "pytest", "-v", "-p", "no:cacheprovider", "-p", "shuffle", "."]
    orders = set()
    for seed in ("1", "2", "3"):
        out = tmp_path / f"out-{seed}"
        environment = os.environ | {"PYTHONPATH": str(ROOT / "tools"), "SHUFFLE": seed, "SHUFFLE_OUT": str(out)}
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env=environment)
        assert f"order of the tests: SHUFFLE={seed}" in done.stdout
        outcomes = shuffle.outcomes(out.read_text())
        assert [outcomes[f"test_a.py::test_{name}"] for name in ("one", "two", "wrong", "broken")] == [
            "passed", "passed", "failed", "error",
        ]  # fmt: skip
        assert list(outcomes) == shuffle.order(list(outcomes), seed)
        orders.add(tuple(outcomes))
    assert len(orders) == 3
