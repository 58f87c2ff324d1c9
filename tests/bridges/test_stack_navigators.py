"""Robot software in processes of its own as the navigator of a trial."""

from __future__ import annotations

import dataclasses
import socket
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from crowdbot.bridges import steered_trial
from crowdbot.bridges.stack_link import StackPort, close_stacks
from crowdbot.core import InputError
from crowdbot.evaluation import EvaluationPlan, evaluate, load_evaluation, parse_methods
from crowdbot.navigation import ExternalNavigator, Ros2Navigator, RosbridgeNavigator
from crowdbot.recording import read_episode, record, replay
from crowdbot.simulation import (
    MissedDecisionOrder,
    RunFailureWarning,
    Simulation,
    SimulationRun,
    VelocityOrder,
    simulate,
    simulate_seeds,
)
from crowdbot.trials import load_trial, parse_trial, trial_xml

HERE = Path(__file__).parent
EXAMPLES = HERE.parents[1] / "examples" / "robot_bridge"
CLIENT = f"{sys.executable} {HERE / 'stack_client.py'}"


def driven_trial(navigator, duration=2.0, **changes):
    """Return a trial whose robot a program drives."""
    trial = load_trial("frontal", duration=duration)
    changes = {"control_period": 0.05} | changes
    robot = dataclasses.replace(trial.robots[0], navigator=navigator, **changes)
    return dataclasses.replace(trial, robots=(robot,))


def program(mode, **values):
    return RosbridgeNavigator(command=f"{CLIENT} {{port}} {mode}", **values)


def failed(trial):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RunFailureWarning)
        return simulate(trial, 0)


@pytest.mark.live
def test_a_program_steps_the_run_and_the_replay_needs_none(tmp_path):
    trial = driven_trial(program("answer"))
    done = record(trial, 0, tmp_path)
    assert (done.outcome, done.steps) == ("timeout", 40)
    episode = tmp_path / "episode.mcap"
    assert replay(episode).equal
    orders = read_episode(episode).orders
    assert len(orders) == 40  # one for each control period
    assert simulate(trial, 0).digest == done.digest


@pytest.mark.live
def test_evaluate_scores_a_program_as_it_scores_a_navigator(tmp_path):
    fine, broken = driven_trial(program("answer"), 1.2), driven_trial(program("die"), 1.2)
    plan = EvaluationPlan(
        [fine, dataclasses.replace(broken, name="broken")], parse_methods("own, orca"), seeds=range(2)
    )
    rows = {(cell.trial, cell.method): cell.runs for cell in evaluate(plan, tmp_path).cells}
    assert [row.outcome for row in rows["frontal", "own"]] == ["timeout"] * 2
    assert [row.metrics["error"] for row in rows["broken", "own"]] == [1.0, 1.0]
    assert all("its program has ended (exit status 3): no battery" in row.message for row in rows["broken", "own"])
    assert [row.outcome for row in rows["broken", "orca"]] == ["timeout"] * 2
    more = {*rows["frontal", "own"][0].metrics} - {*rows["frontal", "orca"][0].metrics}
    assert more == {"decision_time", "decision_time_p99", "missed_deadlines"}  # orca has no deadline


@pytest.mark.live
@pytest.mark.parametrize(
    ("mode", "values", "message"),
    [
        ("hang", {"answer": 0.4}, "its program did not answer within 0.4 s"),
        ("leave", {}, "its program has disconnected"),
    ],
)
def test_a_program_that_fails_fails_its_run(mode, values, message):
    episode = failed(driven_trial(program(mode, **values)))
    assert episode.outcome == "error"
    assert message in episode.failure.message
    assert 0.9 <= episode.failure.time <= 1.2


@pytest.mark.live
def test_a_program_that_never_comes_or_does_not_exist():
    episode = failed(driven_trial(RosbridgeNavigator(command="sleep 60", start=0.3)))
    assert "its program did not send a command within 0.3 s" in episode.failure.message
    with pytest.raises(InputError, match="the program './nothing here' cannot be started: No such file"):
        simulate(driven_trial(RosbridgeNavigator(command="./nothing here")), 0)


@pytest.mark.live
def test_a_late_command_misses_the_deadline_and_the_replay_repeats_it(tmp_path):
    trial = driven_trial(program("late"), deadline=0.3)
    record(trial, 0, tmp_path)
    missed = [(time, item) for time, item in read_episode(tmp_path / "episode.mcap").orders if time == 1.0]
    assert [type(item) for _, item in missed] == [MissedDecisionOrder]
    assert replay(tmp_path / "episode.mcap").equal


@pytest.mark.live
def test_evaluate_tells_compute_times_and_missed_deadlines_of_programs_and_navigators(tmp_path):
    trial = driven_trial(program("late"), 1.5, deadline=0.3)
    result = evaluate(EvaluationPlan([trial], parse_methods("own, orca"), seeds=[0]), tmp_path)
    result.save(tmp_path / "result.json")
    own, orca = (cell.runs[0].metrics for cell in result.cells)
    assert own["missed_deadlines"] == pytest.approx(1 / 29)  # of 30 decisions, the first of which is not measured
    assert 0.0 < own["decision_time"] < 0.3 < own["decision_time_p99"]
    assert (orca["missed_deadlines"], orca["decision_time"] > 0.0) == (0.0, True)
    stored = load_evaluation(tmp_path / "result.json").cells[0].runs[0].metrics
    assert {name: stored[name] for name in stored if "deci" in name or "missed" in name} == {
        name: own[name] for name in own if "deci" in name or "missed" in name
    }


@pytest.mark.live
def test_a_program_has_no_power_over_the_trial():
    episode = simulate(driven_trial(program("cheat"), 1.0), 0)
    assert (episode.outcome, episode.failure) == ("timeout", None)
    assert {type(order) for _, order in episode.orders} == {VelocityOrder}
    trial = load_trial("frontal")
    honest, all_of_it = StackPort(trial, [], ["robot"]).interface, StackPort(trial, [], ["robot"], truth=True).interface
    names = {output.name for output in honest.outputs}
    assert {"/clock", "/tf", "/map", "/robot/scan", "/robot/odom", "/robot/goal"} <= names
    assert not names & {"/people", "/robot/ground_truth/odom", "/robot/scan/reading", "/crowdbot/contacts"}
    assert {"/people", "/robot/ground_truth/odom"} <= {output.name for output in all_of_it.outputs}


@pytest.mark.live
def test_a_program_that_connects_by_itself_stays_for_several_runs():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    code = f"until {CLIENT} {port} answer; do sleep 0.1; done"
    client = subprocess.Popen(["sh", "-c", code], stderr=subprocess.DEVNULL)
    try:
        trial = driven_trial(RosbridgeNavigator(port=port), 1.0)
        first, second = simulate_seeds(trial, [0, 0])
    finally:
        close_stacks()
        client.wait(20)
    assert first.digest == second.digest
    assert first.failure is None


@pytest.mark.live
def test_the_reference_node_is_scored_over_rosbridge():
    command = f"{sys.executable} {EXAMPLES / 'navigate_rosbridge.py'} --port {{port}}"
    episode = simulate(driven_trial(RosbridgeNavigator(command=command), 3.0, control_period=0.1), 0)
    assert (episode.outcome, episode.failure) == ("timeout", None)
    assert abs(episode.position[-1, episode.robots[0], 0] - episode.position[0, episode.robots[0], 0]) > 0.8


@pytest.mark.live
def test_the_reference_node_is_scored_over_ros2(monkeypatch, tmp_path):
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path))
    command = f"{sys.executable} {EXAMPLES / 'navigate_ros2.py'}"
    episode = simulate(driven_trial(Ros2Navigator(command=command), 3.0, control_period=0.1), 0)
    assert (episode.outcome, episode.failure) == ("timeout", None)
    assert abs(episode.position[-1, episode.robots[0], 0] - episode.position[0, episode.robots[0], 0]) > 0.8


def test_it_is_written_in_trials_and_bridges_take_its_robots():
    trial = driven_trial(program("answer", answer=2.0), deadline=0.1)
    again = parse_trial(trial_xml(trial))
    assert again.robots == trial.robots
    assert steered_trial(trial).robots[0].navigator == ExternalNavigator(timeout=0.5)
    two = Simulation(trial, [0, 1])
    with pytest.raises(InputError, match="drives one environment, not 2"):
        SimulationRun(two)


@pytest.mark.parametrize(
    ("kind", "values", "message"),
    [
        (RosbridgeNavigator, {"port": 70000}, "port = 70000 must be from 0 to 65535"),
        (Ros2Navigator, {"domain": 233}, "domain = 233 must be from 0 to 232"),
        (Ros2Navigator, {"answer": 0.0}, "answer"),
        (RosbridgeNavigator, {"start": -1.0}, "start"),
    ],
)
def test_bad_values(kind, values, message):
    with pytest.raises(InputError, match=message):
        kind(**values)
