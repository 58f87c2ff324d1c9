"""The benchmark of simulations of many environments: ``crowdbot bench environments``."""

from __future__ import annotations

import json
import math
import sys
import time
from typing import Any

import numpy as np
import pytest

from crowdbot.benchmark import BenchmarkSizes, measure_environments
from crowdbot.benchmark.environments.crossing import advance_work, crossing_trial, reset_work
from crowdbot.benchmark.environments.peers import IrSimPeer, NavgroundPeer
from crowdbot.benchmark.environments.report import count_calls, planar_trials
from crowdbot.benchmark.environments.work_rate import TimedWork, rates
from crowdbot.cli import main
from crowdbot.core import InputError, MissingExtra
from crowdbot.simulation import Simulation

ROWS = [
    "steps-10", "steps-10-scan", "steps-50", "steps-10-single", "steps-10-scan-single", "reset-single", "reset-batch",
    "episodes",
]  # fmt: skip
INSTALL = "pip install 'crowdbot[peers]'"


@pytest.fixture
def no_peers(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("navground", "navground.core", "navground.sim", "irsim", "pyrvo"):
        monkeypatch.setitem(sys.modules, module, None)


@pytest.mark.usefixtures("no_peers")
def test_the_command_prints_our_rows_without_the_peers(capsys, tmp_path):
    out = tmp_path / "environments.json"
    assert main(["bench", "environments", "--quick", "--repeats", "1", "--json", "--out", str(out)]) == 0
    printed = capsys.readouterr()
    document = json.loads(printed.out)
    assert json.loads(out.read_text()) == document
    assert f"crowdbot: the comparison with navground needs the extra [peers]: {INSTALL}" in printed.err
    assert f"crowdbot: the comparison with ir-sim needs the extra [peers]: {INSTALL}" in printed.err
    assert set(document["missing"]) == {"navground", "ir-sim"}
    assert document["versions"] == {}
    assert [row["name"] for row in document["rows"]] == ROWS
    for row in document["rows"]:
        assert row["peers"] == []
        assert row["protocol"]
        assert all(value > 0.0 and math.isfinite(value) for value in row["rate"].values())
        assert math.isclose(row["cpu_milliseconds_per_unit"] * row["rate"]["per_cpu_second"], 1e3)
    assert "CPU seconds" in document["protocol"]
    assert "setprofile" in document["calls"]["protocol"]
    assert [row["environments"] for row in document["calls"]["rows"]] == [1, 4]
    assert all(row["python_calls"] > 0 for row in document["calls"]["rows"])
    assert len(document["trials"]["rows"]) == 2
    assert all(row["reason"] == "" and row["ratio"] > 0.0 for row in document["trials"]["rows"])
    assert all(row["agents"] > 0 and row["batch"]["per_second"] > 0.0 for row in document["trials"]["rows"])


@pytest.mark.usefixtures("no_peers")
def test_the_command_prints_tables(capsys, monkeypatch):
    report = measure_environments(BenchmarkSizes.quick())
    monkeypatch.setattr("crowdbot.benchmark.measure_environments", lambda sizes, progress: report)
    assert main(["bench", "environments", "--quick"]) == 0
    printed = capsys.readouterr().out
    assert "steps-10-scan: Simulation.advance" in printed
    assert "calls per step" in printed
    assert "load average before and after" in printed


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["environments", "orca-1000"], "measured alone"),
        (["environments", "--data", "x.txt"], "measured alone"),
        (["environments", "--repeats", "0"], "repeats 0 is below 1"),
        (["orca-1000", "--quick"], "--quick belongs to crowdbot bench environments"),
    ],
)
def test_wrong_options(capsys, words, message):
    assert main(["bench", *words]) == 2
    assert message in capsys.readouterr().err


def test_sizes_are_at_least_one():
    with pytest.raises(InputError, match="peer worlds 0 is below 1"):
        BenchmarkSizes(peer_worlds=0)


@pytest.mark.live
def test_a_rate_is_amount_by_time_and_prepare_is_not_timed():
    work = TimedWork(3.0, lambda: time.sleep(0.2), lambda state: time.sleep(0.02))
    rate = rates({"sleep": work}, repeats=3)["sleep"]
    assert 10.0 < rate.per_second <= 150.0
    assert rate.per_cpu_second > rate.per_second  # a process that sleeps uses no CPU time


def test_works_alternate_after_a_warm_up():
    order: list[str] = []
    works = {name: TimedWork(1.0, lambda: None, lambda state, name=name: order.append(name)) for name in "ab"}
    rates(works, repeats=2)
    assert order == ["a", "b"] * 3
    order.clear()
    rates(works, repeats=1, warm_up=False)
    assert order == ["a", "b"]


@pytest.mark.parametrize("beams", [0, 180])
def test_the_robot_observes_and_decides_in_every_step(beams):
    simulation = Simulation(crossing_trial(10, beams), range(2))
    for _ in range(3):
        simulation.advance()
        assert len(simulation.new_readings(1)) == 1
        assert simulation.observation("robot", 1).people.position.shape[0] > 0


def test_the_steps_begin_at_the_start_each_time():
    work = advance_work(crossing_trial(10, 0), 3, 2)
    assert work.amount == 6
    first = work.prepare()
    work.work(first)
    place = first.world.scene.position.copy()
    again = work.prepare()
    assert again.ticks.tolist() == [0, 0, 0]
    work.work(again)
    assert np.array_equal(again.world.scene.position, place)


@pytest.mark.parametrize(("together", "amount"), [(1, 3), (3, 3)])
def test_resets_restart_environments(together, amount):
    work = reset_work(crossing_trial(10, 0), 3, together)
    assert work.amount == amount
    simulation = work.prepare()
    work.work(simulation)
    assert simulation.ticks.tolist() == [0, 0, 0]
    assert simulation.seeds == [3, 4, 5]


def test_calls_are_counted_and_the_profile_is_restored():
    class Still:
        def advance(self) -> None:
            len("two")
            self.rest()

        def rest(self) -> None:
            pass

    simulation: Any = Still()
    assert count_calls(simulation, 4) == (2.0, 1.0)
    assert sys.getprofile() is None


def test_planar_trials_have_no_sweeps():
    trials = dict(planar_trials())
    assert "circle-crossing" in trials
    assert all(trial.world == "planar" and not trial.sweeps for trial in trials.values())


@pytest.mark.parametrize("kind", [NavgroundPeer, IrSimPeer])
@pytest.mark.usefixtures("no_peers")
def test_a_missing_peer_names_the_extra(kind):
    with pytest.raises(MissingExtra, match=r"the comparison with [a-z-]+ needs the extra \[peers\]"):
        kind()
