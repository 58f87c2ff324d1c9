"""The goal of a robot changes while it runs."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.metrics import navigation_metrics
from crowdbot.recording import branch, open_run, replay
from crowdbot.simulation import (
    EpisodeLog,
    GoalOrder,
    ParameterOrder,
    Simulation,
    SimulationRun,
    apply_overrides,
    read_order,
    simulate,
    write_order,
)
from crowdbot.trials import Trial, parse_trial
from space_trials import LEAN, WORLDS, room

HALL = """<trial name="hall" duration="30" step="0.1">
  <stage walkable="0,0 12,0 12,8 0,8"><wall points="6,3 6,8"/><wall points="9,1 11,1 11,3 9,3 9,1"/></stage>
  <crowd type="orca"/>
  <robot x="2" y="6" radius="0.3">
    <goal x="4" y="6"/>
    <planner margin="0.1"/>
    <drive type="differential-drive"/>
    <navigator type="orca"/>
  </robot>
  <end goal="false"/>
</trial>
"""


def hall(**changes: Any) -> Trial:
    trial = parse_trial(HALL)
    return dataclasses.replace(trial, **changes)


def test_an_order_is_written_and_read() -> None:
    order = GoalOrder(robot="puck", x=2.5, y=1, tolerance=0.5)
    assert write_order(order) == '{"order": "goal", "robot": "puck", "x": 2.5, "y": 1, "tolerance": 0.5}'
    assert read_order(write_order(order)) == order


def test_an_arrived_robot_drives_around_the_wall_to_its_new_goal() -> None:
    run = SimulationRun(Simulation(hall(), 0))
    while not run.simulation.robots[0].arrived[0]:
        run.step()
    assert run.simulation.event[0] == 2
    run.step([GoalOrder(robot="robot", x=8.0, y=6.0)])
    assert not run.simulation.robots[0].arrived[0]
    assert run.simulation.event[0] == 0
    observation = run.simulation.observation("robot")
    assert observation.goal == (8.0, 6.0)
    assert observation.waypoint != observation.goal
    while not run.simulation.robots[0].arrived[0]:
        run.step()
    assert math.dist(run.simulation.world.scene.position[0, 0], (8.0, 6.0)) < 0.3
    assert run.simulation.event[0] == 2


def test_the_run_ends_at_the_goal_in_force() -> None:
    trial = parse_trial(HALL.replace('<end goal="false"/>', ""))
    run = SimulationRun(Simulation(trial, 0))
    run.step([GoalOrder(robot="robot", x=2.0, y=2.0, tolerance=1.0)])
    while run.outcome is None:
        run.step()
    assert run.outcome == "success"
    away = math.dist(run.simulation.world.scene.position[0, 0], (2.0, 2.0))
    assert 0.8 < away < 1.0


def test_metrics_describe_the_goal_in_force() -> None:
    trial = parse_trial(HALL.replace('<end goal="false"/>', ""))
    log = EpisodeLog(trial, 0)
    run = SimulationRun(Simulation(trial, 0), [log])
    run.step([GoalOrder(robot="robot", x=2.0, y=2.0, tolerance=1.0)])
    run.advance()
    episode = log.episode("success", run.simulation.tick)
    assert episode.metrics["success"] == 1.0
    wanted = navigation_metrics(
        episode.times, episode.position, episode.velocity, episode.radius, episode.active, 0, np.array([2.0, 2.0]), 1.0,
        heading=episode.heading[:, 0], walls=trial.stage.as_walls().segments(),
    )  # fmt: skip
    for name in ("goal_progress", "time_to_goal", "path_length", "duration"):
        assert episode.metrics[name] == wanted[name]
    assert simulate(trial, 0).metrics["goal_progress"] != episode.metrics["goal_progress"]


@pytest.mark.parametrize("world", WORLDS)
def test_goals_of_environments_are_independent(world: str) -> None:
    trial = parse_trial(room(world, LEAN))
    goals = [(9.0, 4.0), None, (2.0, 5.0)]
    many = Simulation(trial, [3, 4, 5])
    run = SimulationRun(many)
    run.step()
    run.step([GoalOrder(robot="puck", x=g[0], y=g[1], environment=e) for e, g in enumerate(goals) if g])
    for _ in range(12):
        run.step()
    for e, goal in enumerate(goals):
        alone = SimulationRun(Simulation(trial, 3 + e))
        alone.step()
        alone.step([] if goal is None else [GoalOrder(robot="puck", x=goal[0], y=goal[1])])
        for _ in range(12):
            alone.step()
        one, other = run.simulation.record(e), alone.simulation.record()
        np.testing.assert_array_equal(one.scene.position, other.scene.position)
        np.testing.assert_array_equal(one.commands, other.commands)
        assert one.scene.goal[0, trial.people].tolist() == list(goal or trial.robots[0].goal.position)


def test_copies_keep_goals_and_restarts_have_those_of_the_trial() -> None:
    run = SimulationRun(Simulation(hall(), [0, 1]))
    run.step([GoalOrder(robot="robot", x=8.0, y=6.0, tolerance=0.7, environment=1)])
    some = run.simulation.select([1, 0, 1])
    assert some.robots[0].goal.tolist() == [[8.0, 6.0], [4.0, 6.0], [8.0, 6.0]]
    some.restart([0], [5])
    some.advance()
    assert some.robots[0].goal.tolist() == [[4.0, 6.0], [4.0, 6.0], [8.0, 6.0]]
    assert some.robots[0].tolerance.tolist() == [0.3, 0.3, 0.7]
    assert some.observation("robot", 0).goal == (4.0, 6.0)


@pytest.mark.parametrize("world", WORLDS)
def test_a_run_with_goal_orders_replays_and_can_be_branched(world: str, tmp_path: Path) -> None:
    file = tmp_path / "episode.mcap"
    with open_run(parse_trial(room(world, LEAN)), 3, out=file) as running:
        while running.outcome is None:
            tick = running.simulation.tick
            running.step([GoalOrder(robot="puck", x=2.0, y=1 + 0.2 * tick)] if tick in (4, 10) else [])
    told = replay(file)
    assert told.equal
    assert branch(file, at=0.28).digest == told.recorded
    assert branch(file, at=0.28, orders=False).digest != told.recorded
    changed = branch(file, at=0.6, changes={"robot.drive.max-speed": 0.4}, out=tmp_path / "slow")
    assert replay(tmp_path / "slow" / "episode.mcap").replayed == changed.digest


def test_a_changed_trial_keeps_the_goal_unless_its_own_goal_changes() -> None:
    run = SimulationRun(Simulation(hall(), 0))
    run.step([GoalOrder(robot="robot", x=8.0, y=6.0)])
    apply_overrides(run.simulation, dataclasses.replace(run.simulation.trial, heading_jitter=0.1))
    assert run.simulation.observation("robot").goal == (8.0, 6.0)
    run.step([ParameterOrder(path="robot.goal.x", value="3")])
    assert run.simulation.observation("robot").goal == (3.0, 6.0)
    assert run.simulation.robots[0].goal.tolist() == [[3.0, 6.0]]


@pytest.mark.parametrize(
    ("order", "sentence"),
    [
        ({"robot": "hal", "x": 1, "y": 1}, "there is no robot 'hal'; the trial has robot"),
        ({"x": 14, "y": 1}, "GoalOrder: robot 'robot' would have its goal at 14,1 outside the walkable area"),
        ({"x": 6, "y": 5, "tolerance": 0.1}, "would have its goal 0.00 m from a wall, and its radius is 0.3 m"),
        ({"x": 10, "y": 2}, "GoalOrder: robot 'robot' has no path to 10,2: "),
        ({"x": 1, "y": 1, "environment": 2}, "environment = 2 must be from 0 to 0"),
    ],
)
def test_an_impossible_goal_is_refused_and_changes_nothing(order: dict[str, Any], sentence: str) -> None:
    run = SimulationRun(Simulation(hall(), 0))
    with pytest.raises(InputError, match=sentence):
        run.step([GoalOrder(**{"robot": "robot", **order})])
    assert run.simulation.tick == 0
    assert run.simulation.robots[0].goal.tolist() == [[4.0, 6.0]]


@given(x=st.floats(), y=st.floats(), tolerance=st.floats())
def test_values_are_checked(x: float, y: float, tolerance: float) -> None:
    fine = abs(x) <= 1e6 and abs(y) <= 1e6 and 0.0 < tolerance < math.inf
    try:
        order = GoalOrder(robot="robot", x=x, y=y, tolerance=tolerance)
    except InputError as error:
        refused, order = str(error), None
    if fine:
        assert order is not None
        assert read_order(write_order(order)) == order
    else:
        assert "must be finite" in refused


@settings(max_examples=20, deadline=None)
@given(goals=st.lists(st.tuples(st.integers(0, 10), st.floats(-1, 13), st.floats(-1, 9)), max_size=6))
def test_any_sequence_of_goals_is_refused_or_repeats(goals: list[tuple[int, float, float]]) -> None:
    taken: dict[int, list[GoalOrder]] = {tick: [] for tick in range(12)}
    run, again = (SimulationRun(Simulation(hall(), 0)) for _ in range(2))
    for tick in range(12):
        for order in (GoalOrder(robot="robot", x=x, y=y) for k, x, y in goals if k == tick):
            refused = ""
            try:
                order.check(run.simulation)
            except InputError as error:
                refused = str(error)
            assert not refused or "GoalOrder: robot 'robot'" in refused
            taken[tick] += [] if refused else [order]
        run.step(taken[tick])
        again.step(taken[tick])
    places = [item.simulation.world.scene.position[0, 0] for item in (run, again)]
    assert np.all(np.isfinite(places))
    np.testing.assert_array_equal(*places)
    latest = [order for tick in sorted(taken) for order in taken[tick]]
    assert run.simulation.robots[0].goal[0].tolist() == ([latest[-1].x, latest[-1].y] if latest else [4.0, 6.0])
