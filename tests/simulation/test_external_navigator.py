"""A robot with an external navigator follows orders, and stops if they fail to come."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, TrialError, Twist
from crowdbot.navigation import ExternalNavigator, check_navigator
from crowdbot.recording import branch, open_run, record, replay
from crowdbot.simulation import Simulation, UncommandedRobotWarning, VelocityOrder, simulate, simulate_seeds
from crowdbot.trials import Trial, parse_trial, trial_xml
from space_trials import LEAN, WORLDS, room
from trial_schema import valid


def outside(world: str = "planar", timeout: float = 0.12, more: str = "", **changes: str) -> Trial:
    """Return a trial with a step of 0.04 s whose robot waits for orders."""
    text = room(world, LEAN, **changes).replace(
        '<navigator type="straight"/>', f'<navigator type="external" timeout="{timeout}"/>{more}'
    )
    assert valid(text)
    return parse_trial(text)


class Sender:
    """Sends a velocity at some ticks, a different one in each environment."""

    def __init__(self, ticks: Any) -> None:
        self.ticks = set(ticks)

    def orders(self, simulation: Simulation) -> list[VelocityOrder]:
        if simulation.tick not in self.ticks:
            return []
        return [
            VelocityOrder(robot="puck", forward=0.3 + 0.1 * simulation.seeds[e], environment=e)
            for e in range(simulation.count)
        ]


def drive(trial: Trial, seeds: Any, ticks: set[int], steps: int) -> list[tuple[list[Any], list[Any]]]:
    """Return command and place of the robot in each environment after each step."""
    simulation, sender = Simulation(trial, seeds), Sender(ticks)
    simulation.begin()
    result = []
    for _ in range(steps):
        for order in sender.orders(simulation):
            order.apply(simulation)
        simulation.advance()
        robot = simulation.robots[0]
        result.append((robot.command[:, 0].tolist(), simulation.world.pose(robot.agent).position.tolist()))
    return result


def test_the_trial_can_be_read_written_and_checked() -> None:
    trial = outside()
    assert trial.robots[0].navigator == ExternalNavigator(0.12)
    assert parse_trial(trial_xml(trial)) == trial
    check_navigator(ExternalNavigator())


@pytest.mark.parametrize("world", WORLDS)
def test_it_stands_until_the_first_order_and_stops_at_the_timeout(world: str) -> None:
    rows = drive(outside(world), [1], {4, 6, 12}, 20)
    commands = [commands[0] for commands, _ in rows]
    moving = [tick for tick, value in enumerate(commands, start=1) if value > 0.0]
    # the step that an order at tick k begins ends at k + 1; at k + 3 the order is 0.12 s old
    assert moving == [5, 6, 7, 8, 13, 14]
    assert rows[0][1][0][0] == pytest.approx(2.0, abs=1e-3)
    assert rows[-1][1][0][0] > rows[4][1][0][0] + 0.01


@settings(max_examples=15, deadline=None)
@given(ticks=st.sets(st.integers(0, 24), max_size=12), timeout=st.sampled_from([0.01, 0.04, 0.1, 0.3, 5.0]))
def test_the_command_at_each_tick_follows_from_the_age_of_the_latest_order(ticks: set[int], timeout: float) -> None:
    rows = drive(outside(timeout=timeout), [1], ticks, 25)
    for tick, (commands, _) in enumerate(rows, start=1):
        latest = max((k for k in ticks if k < tick), default=None)
        fresh = latest is not None and (tick - latest) * 40_000_000 < round(timeout * 1e9)
        assert commands[0] == (0.4 if fresh else 0.0)


@pytest.mark.parametrize("world", WORLDS)
def test_environments_are_independent(world: str) -> None:
    trial, ticks = outside(world), {2, 4, 9}
    many = drive(trial, [0, 1, 2], ticks, 14)
    for e in range(3):
        alone = drive(trial, [e], ticks, 14)
        assert [(commands[e], place[e]) for commands, place in many] == [(c[0], p[0]) for c, p in alone]


def test_copies_and_restarts_keep_the_age_of_the_order() -> None:
    simulation = Simulation(outside(), [1, 2])
    simulation.begin()
    for _ in range(3):
        simulation.advance()
    simulation.command("puck", Twist(0.4), 1)
    simulation.advance()
    some = simulation.select([1, 0])
    assert some.robots[0].ordered.tolist() == [3, -1]
    some.advance()
    assert some.robots[0].command[:, 0].tolist() == [0.4, 0.0]
    some.restart([0], [7])
    assert some.robots[0].ordered.tolist() == [-1, -1]
    simulation.advance()
    simulation.advance()
    assert simulation.robots[0].command[:, 0].tolist() == [0.0, 0.0]


@pytest.mark.parametrize("world", WORLDS)
def test_a_run_commanded_from_outside_replays_and_can_be_branched(world: str, tmp_path: Path) -> None:
    trial = outside(world)
    with open_run(trial, 3, out=tmp_path / "first", sources=[Sender({1, 2, 5, 11})]) as running:
        running.advance()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert replay(tmp_path / "first" / "episode.mcap").equal
        same = branch(tmp_path / "first" / "episode.mcap", at=0.24)
    slow = branch(tmp_path / "first" / "episode.mcap", at=0.24, changes={"robot.navigator.timeout": 0.2})
    assert same.digest == replay(tmp_path / "first" / "episode.mcap").recorded
    assert slow.digest != same.digest
    stood = branch(tmp_path / "first" / "episode.mcap", at=0.24, orders=False)
    assert stood.digest != same.digest


def test_a_run_without_a_source_says_that_the_robot_stands(tmp_path: Path) -> None:
    trial = outside()
    said = r"trial 'room': robot 'puck' stands still, since the navigator is external and this run has no source"
    with pytest.warns(UncommandedRobotWarning, match=said):
        episode = simulate(trial)
    assert np.all(episode.commands == 0.0)
    with pytest.warns(UncommandedRobotWarning, match=said) as told:
        simulate_seeds(trial, [1, 2])
    assert len(told) == 1
    with pytest.warns(UncommandedRobotWarning, match=said):
        record(trial, out=tmp_path)


def test_the_program_outside_gets_waypoints_and_tracks() -> None:
    text = room("planar", LEAN).replace(
        '<navigator type="straight"/>', '<navigator type="external"/><planner margin="0.05"/>'
    )
    trial = parse_trial(
        text.replace('name="puck"', 'name="puck" tracks="0.4"').replace(
            'control-period="0.04"', 'control-period="0.08"'
        )
    )
    simulation = Simulation(trial, [1])
    simulation.begin()
    for _ in range(8):
        simulation.advance()
    observation = simulation.observation("puck")
    assert observation.tracks is not None
    assert np.diff(observation.tracks.times).tolist() == pytest.approx([0.08] * 4)
    assert np.isfinite(simulation.robots[0].path[0]).any()


def test_messages_name_what_is_wrong() -> None:
    with pytest.raises(InputError, match="timeout = 0.0 s must be finite and above 0 s"):
        ExternalNavigator(0.0)
    with pytest.raises(TrialError, match=r"<navigator> .*timeout"):
        outside(timeout=-1.0)
    with pytest.raises(TrialError, match='has a deadline in addition to <navigator type="external"/>'):
        parse_trial(trial_xml(outside()).replace('name="puck"', 'name="puck" deadline="0.1"'))
    with pytest.raises(TrialError, match=r"exernal.*did you mean 'external'"):
        parse_trial(trial_xml(outside()).replace('"external"', '"exernal"'))
