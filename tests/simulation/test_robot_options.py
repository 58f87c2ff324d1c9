"""Path planners, tracks, deadlines and holonomic drives of robots in a trial."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError, TrialError, Twist
from crowdbot.navigation import Action, Navigator, Observation
from crowdbot.prediction import ConstantVelocity
from crowdbot.simulation import RecordedDecisions, Simulation, apply_overrides, simulate
from crowdbot.trials import Planner, Trial, check_trial, parse_trial, trial_xml
from space_trials import LEAN, WORLDS, room
from trial_schema import valid

ROOM = """<trial name="rooms" duration="40" step="0.05">
  <stage>
    <wall points="0,0 0,10 4,10 4,4 10,4 10,0 0,0"/>
    <wall points="0,5 1.4,5"/>
    <wall points="2.6,5 4,5"/>
  </stage>
  <crowd type="orca"/>
  <agent x="9" y="3" goal="8,3"/>
  <robot x="9" y="1.5" radius="0.3">
    <goal x="2" y="9"/>
    <planner margin="0.1"/>
    <drive type="differential-drive"/>
    <navigator type="orca"/>
    <sensor name="people" type="ground-truth-people"/>
  </robot>
</trial>
"""
STRAIGHT = ROOM.replace('<navigator type="orca"/>', '<navigator type="straight"/>')
OMNI = ROOM.replace("differential-drive", "omnidirectional").replace("<robot ", '<robot holonomic="true" ')


def with_robot(trial: Trial, **changes: Any) -> Trial:
    return dataclasses.replace(trial, robots=(dataclasses.replace(trial.robots[0], **changes),))


TEXTS = {
    "orca": ROOM,
    "straight": STRAIGHT,
    "holonomic": OMNI,
    "both": OMNI.replace('"orca"/>\n    <s', '"straight"/>\n    <s'),
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_a_robot_with_a_planner_reaches_the_other_room(text: str) -> None:
    assert valid(text)
    trial = parse_trial(text)
    check_trial(trial)
    assert parse_trial(trial_xml(trial)) == trial
    assert simulate(trial, 0).outcome == "success"


def test_without_a_planner_it_drives_into_the_wall() -> None:
    trial = with_robot(parse_trial(STRAIGHT), planner=None)
    assert simulate(trial, 0).outcome == "collision"
    assert "planner" not in trial_xml(trial)


def test_the_waypoint_is_the_next_corner_and_reading_it_changes_nothing() -> None:
    simulation = Simulation(parse_trial(ROOM), 0)
    simulation.begin()
    before = simulation.robots[0].path.copy()
    first = simulation.observation("robot")
    assert first.waypoint != first.goal
    assert simulation.observation("robot").waypoint == first.waypoint
    np.testing.assert_array_equal(simulation.robots[0].path, before)


def state(simulation: Simulation) -> tuple[Any, ...]:
    robot = simulation.robots[0]
    tracks = [(track.times.tolist(), track.ids.tolist(), track.position.tolist()) for track in robot.tracks]
    return simulation.world.scene.position.tolist(), robot.command.tolist(), robot.path.tolist(), str(tracks)


def test_paths_and_tracks_of_environments_are_independent() -> None:
    trial = with_robot(parse_trial(ROOM), tracks=0.5)
    whole, alone = Simulation(trial, [0, 1, 2]), Simulation(trial, 1)
    for _ in range(90):
        whole.advance()
        alone.advance()
    assert whole.robots[0].path[1].tolist() == alone.robots[0].path[0].tolist()
    some = whole.select([2, 1, 1])
    some.restart([0], [7])
    assert state(some.select([1])) == state(alone)
    fresh = Simulation(trial, 7)
    fresh.begin()
    assert state(some.select([0])) == state(fresh)
    for _ in range(60):
        some.advance()
        alone.advance()
        fresh.advance()
    assert state(some.select([2])) == state(alone)
    assert state(some.select([0])) == state(fresh)
    whole.put([0], some.select([0]))
    assert state(whole.select([0])) == state(fresh)


@pytest.mark.parametrize("world", WORLDS)
def test_environments_with_bodies_plan_and_remember_alone(world: str) -> None:
    trial = with_robot(parse_trial(room(world, LEAN)), planner=Planner(0.05), tracks=0.4, holonomic=False)
    many, singles = Simulation(trial, [3, 4]), [Simulation(trial, seed) for seed in (3, 4)]
    for _ in range(8):
        many.advance()
        for single in singles:
            single.advance()
    for e, single in enumerate(singles):
        assert state(many.select([e]))[1:] == state(single)[1:]
    observation = many.observation("puck", 1)
    assert observation.waypoint != observation.goal
    assert observation.tracks is not None


def test_equal_walls_share_one_planner() -> None:
    one, two = (Simulation(parse_trial(ROOM), 0).robots[0].planner for _ in range(2))
    assert one is two
    other = Simulation(with_robot(parse_trial(ROOM), planner=Planner(0.2)), 0).robots[0].planner
    assert other is not one
    assert other.margin == 0.2


def test_a_robot_without_a_path_is_reported() -> None:
    blocked = ROOM.replace("0,5 1.4,5", "0,5 3,5")
    with pytest.raises(TrialError, match=r'<robot> has <planner margin="0.1"/> but no path to its goal: .*; take a'):
        parse_trial(blocked)
    trial = parse_trial(ROOM)
    simulation = Simulation(trial, [0, 1])
    simulation.advance()
    scene = simulation.world.scene
    position = scene.position.copy()
    position[1, trial.people] = [30.0, 30.0]
    simulation.world.scene = scene.replace(position=position)
    for _ in range(2):
        simulation.advance()
    assert simulation.failures[0] is None
    assert "no path" in str(simulation.failures[1])


def test_a_planner_changes_in_a_branch() -> None:
    trial = parse_trial(ROOM)
    simulation = Simulation(trial, 0)
    simulation.advance()
    path = simulation.robots[0].path.copy()
    apply_overrides(simulation, dataclasses.replace(trial, robot_margin=0.3))
    np.testing.assert_array_equal(simulation.robots[0].path, path)
    changed = with_robot(trial, planner=Planner(0.2), tracks=1.0, deadline=0.5)
    apply_overrides(simulation, dataclasses.replace(changed, robot_margin=0.3))
    robot = simulation.robots[0]
    assert np.isnan(robot.path).all()
    assert robot.planner.margin == 0.2
    assert [track.length for track in robot.tracks] == [11]
    simulation.advance()


def test_a_holonomic_robot_needs_a_drive_that_moves_sideways() -> None:
    simulation = Simulation(parse_trial(OMNI), 0)
    simulation.begin()
    assert simulation.observation("robot").limits.holonomic
    assert simulation.robots[0].command[0, 2] != 0.0
    with pytest.raises(TrialError, match='has holonomic="true" but its drive cannot move sideways'):
        parse_trial(ROOM.replace("<robot ", '<robot holonomic="true" '))
    servo = OMNI.replace('type="omnidirectional"', 'type="velocity-servo" sideways="true"')
    assert parse_trial(servo).robots[0].holonomic


@dataclasses.dataclass(frozen=True)
class Forecaster(Navigator):
    """Drives only if nobody is expected near the robot in one second."""

    def act(self, observation: Observation) -> Twist:
        assert observation.tracks is not None
        if len(observation.people) == 0:
            return observation.towards_goal(0.5)
        future = observation.forecast(ConstantVelocity(), 1.0).position[..., -1, :]
        near = np.hypot(*np.moveaxis(future - observation.position, -1, 0)).min()
        return observation.towards_goal(min(0.5, float(near) / 10.0))


def test_a_navigator_forecasts_from_tracks() -> None:
    trial = with_robot(parse_trial(STRAIGHT), navigator=Forecaster(), tracks=1.0)
    many, singles = Simulation(trial, range(3)), [Simulation(trial, seed) for seed in range(3)]
    for _ in range(60):
        many.advance()
        for single in singles:
            single.advance()
    assert many.failures == [None] * 3
    for e, single in enumerate(singles):
        assert state(many.select([e])) == state(single)
    tracks = many.observation("robot", 2).tracks
    assert tracks is not None
    assert len(tracks.times) == 11
    assert tracks.times[-1] == pytest.approx(3.0)
    assert many.observation("robot", 2).tracks.times.tolist() == tracks.times.tolist()
    assert Simulation(with_robot(trial, tracks=None), 0).observation("robot").tracks is None


@dataclasses.dataclass(frozen=True)
class Slower(Navigator):
    """Commands its number of decisions."""

    def begin(self, observation: Observation) -> int:
        return 0

    def act(self, observation: Observation, memory: int) -> Any:
        return Action(Twist(0.01 * (memory + 1))), memory + 1


def clock(durations: dict[int, float]) -> Any:
    """Return a clock on which decision n takes ``durations[n]`` seconds, otherwise none."""
    calls = iter(range(10_000))
    now = [0.0]

    def read() -> float:
        call = next(calls)
        now[0] += durations.get(call // 2, 0.0) if call % 2 else 0.0
        return now[0]

    return read


def test_a_missed_decision_keeps_the_previous_command_and_is_replayed_without_a_clock() -> None:
    trial = with_robot(parse_trial(STRAIGHT), navigator=Slower(), deadline=0.05)
    live = Simulation(trial, 0)
    robot = live.robots[0]
    robot.timer.clock = clock({1: 0.2, 3: 0.05, 4: 0.051})
    commands, missed = [], []
    live.begin()
    for _ in range(13):
        commands.append(robot.command[0, 0])
        if live.ticks[0] == robot.timer.missed[0]:
            missed.append(int(live.ticks[0]))
        live.advance()
    assert missed == [2, 8]
    assert np.round(commands[::2], 3).tolist() == [0.01, 0.01, 0.03, 0.04, 0.04, 0.06, 0.07]

    def refuse() -> float:
        raise AssertionError("a replay reads a clock")

    again = Simulation(trial, 0)
    again.robots[0].timer.clock = refuse
    again.robots[0].timer.replay(0, RecordedDecisions(frozenset(missed)))
    again.begin()
    for _ in range(13):
        again.advance()
    assert state(again) == state(live)
    assert again.robots[0].timer.missed.tolist() == live.robots[0].timer.missed.tolist()
    copied = again.select([0, 0])
    copied.advance()
    assert copied.robots[0].timer.recorded.tolist() == [RecordedDecisions(frozenset({2, 8}))] * 2


def test_a_deadline_that_is_kept_changes_nothing() -> None:
    trial = dataclasses.replace(parse_trial(ROOM), duration=3.0)
    assert simulate(with_robot(trial, deadline=100.0), 0).digest == simulate(trial, 0).digest


def test_values_out_of_range_are_refused() -> None:
    robot = parse_trial(ROOM).robots[0]
    for name, value in (("deadline", 0.0), ("tracks", -1.0)):
        with pytest.raises(InputError, match=f'{name}="{value}" must be above 0 s'):
            dataclasses.replace(robot, **{name: value})
    with pytest.raises(InputError, match='margin="-0.1" must be at least 0 m'):
        Planner(-0.1)


def test_memories_of_navigators_are_copied_with_their_copier() -> None:
    trial = with_robot(parse_trial(STRAIGHT), navigator=Slower())
    simulation = Simulation(trial, 0)
    simulation.begin()
    simulation.robots[0].memories[0] = (row for row in "ab")
    with pytest.raises(InputError, match="navigator Slower: memory is a generator, which cannot be copied"):
        simulation.select([0])
