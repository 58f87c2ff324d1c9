"""Small rules of a run: number of steps, stop, scene at the start, place of an exception, times of its records."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.simulation import (
    EpisodeLog,
    RunFailure,
    Simulation,
    SimulationRun,
    StopRequest,
    apply_overrides,
    run_to_end,
    simulate,
)
from crowdbot.simulation.simulation import SUCCESS
from crowdbot.simulation.world_builder import start_scenes
from crowdbot.trials import PeopleBatch, Trial, parse_trial, place
from space_trials import LEAN
from trial_texts import GOOD

TINY = parse_trial(GOOD)
PERIOD = 2
"""Steps from one record to the next: 0.1 s in steps of 0.05 s."""


def outcome(trial: Trial, ticks: int | None, stop: StopRequest | None = None) -> tuple[str, int]:
    simulation = Simulation(trial, 3)
    return run_to_end(simulation, [], stop or StopRequest(), None, ticks), simulation.tick


def with_goal(trial: Trial, x: float) -> Trial:
    """Return a trial whose robot, at x = -2 m, has its goal at another x [m]."""
    robot = trial.robots[0]
    return dataclasses.replace(trial, robots=[dataclasses.replace(robot, goal=dataclasses.replace(robot.goal, x=x))])


@pytest.mark.parametrize(("ticks", "last"), [(1, 2), (2, 2), (3, 4), (4, 4), (10, 10)])
def test_a_run_is_interrupted_at_the_first_record_after_so_many_steps(ticks: int, last: int) -> None:
    assert outcome(TINY, ticks) == ("interrupted", last)


@pytest.mark.parametrize("ticks", [None, 80, 1000])
def test_a_run_ends_by_itself_before_it_is_interrupted(ticks: int | None) -> None:
    assert outcome(dataclasses.replace(TINY, duration=1.0), None) == ("timeout", 20)
    assert outcome(dataclasses.replace(TINY, duration=1.0), ticks) == ("timeout", 20)


def test_a_stop_is_obeyed_at_the_next_record() -> None:
    stop = StopRequest()
    running = SimulationRun(Simulation(TINY, 3), stop=stop)
    assert running.step() is None
    stop.asked = True
    assert running.step() == "interrupted"
    assert running.simulation.tick == PERIOD
    with pytest.raises(InputError, match=r"the run has ended \(interrupted\) at 0.1 s"):
        running.step()


def test_a_run_that_is_not_stopped_goes_on_for_ever() -> None:
    running = SimulationRun(Simulation(TINY, 3))
    assert [running.step() for _ in range(9)] == [None] * 9
    assert running.outcome is None


def test_the_outcome_of_a_run_cannot_be_given() -> None:
    with pytest.raises(TypeError, match="outcome"):
        SimulationRun(Simulation(TINY, 3), outcome="success")  # type: ignore[call-arg]


@pytest.mark.parametrize(("x", "ended"), [(-2.0, "success"), (3.0, "finished")])
def test_a_robot_with_a_new_goal_has_not_arrived_yet(x: float, ended: str) -> None:
    trial = with_goal(dataclasses.replace(TINY, duration=0.4, end=dataclasses.replace(TINY.end, goal=False)), -2.0)
    simulation = Simulation(trial, 3)
    running = SimulationRun(simulation)
    while running.step() is None and simulation.tick < 2 * PERIOD:
        pass
    assert simulation.event.tolist() == [SUCCESS]
    apply_overrides(simulation, with_goal(trial, x))
    assert run_to_end(simulation, [], StopRequest()) == ended


def test_progress_grows_to_one_and_each_share_is_told_once() -> None:
    told: list[float] = []
    run_to_end(Simulation(TINY, 3), [], StopRequest(), told.append)
    assert told[-1] == 1.0
    shares = np.floor(np.array(told[:-1]) * 100.0 + 1e-9)
    assert np.all(np.diff(shares) > 0.0)
    assert len(told) > 70


def test_people_begin_at_their_speed_towards_their_goals_and_robots_at_rest() -> None:
    people, _ = place(TINY.stage, TINY.spawners, TINY.robots, 3)
    scene = start_scenes(TINY, PeopleBatch.of([people]), np.array([2]), TINY.stage.as_walls())
    count = len(people)
    assert scene.shape == (1, count + 1 + 2)
    assert scene.active[0].tolist() == [True] * (count + 1) + [False, False]
    assert scene.external[0].tolist() == [False] * count + [True, False, False]
    velocity, away = scene.velocity[0, :count], scene.goal[0, :count] - scene.position[0, :count]
    np.testing.assert_allclose(np.linalg.norm(velocity, axis=1), people.speed)
    np.testing.assert_allclose(
        np.arctan2(velocity[:, 1], velocity[:, 0]), np.arctan2(away[:, 1], away[:, 0]), atol=1e-12
    )
    np.testing.assert_allclose(scene.heading[0, :count], np.arctan2(away[:, 1], away[:, 0]), atol=1e-12)
    assert np.all(scene.velocity[0, count:] == 0.0)
    np.testing.assert_allclose(scene.max_speed[0, :count], 1.3 * people.speed)
    assert (scene.position[0, count].tolist(), scene.goal[0, count].tolist()) == ([-2.0, -2.4], [3.0, -2.4])
    assert scene.radius[0, count:].tolist() == [0.3, 0.25, 0.25]
    assert scene.group[0, count:].tolist() == [-1, -1, -1]


def test_a_routed_crowd_sets_off_around_the_wall() -> None:
    text = """<trial name="routed" duration="2" step="0.05">
      <stage walkable="-4,-3 4,-3 4,3 -4,3"><wall points="0,-3 0,2"/></stage>
      <routing radius="0.25"/><crowd type="orca"/>
      <spawner count="1" zone="-3,-1 -2.9,-1 -2.9,-0.9" goal="3,-1 3.1,-1 3.1,-0.9" speed="1.2"/>
    </trial>"""
    scene = Simulation(parse_trial(text), 0).world.scene
    assert np.linalg.norm(scene.velocity[0, 0]) == pytest.approx(1.2)
    ahead = np.array([0.0, 2.0]) - scene.position[0, 0]  # the end of the wall
    turn = np.arctan2(scene.velocity[0, 0, 1], scene.velocity[0, 0, 0]) - np.arctan2(ahead[1], ahead[0])
    assert 0.0 < turn < 0.15
    assert scene.heading[0, 0] == pytest.approx(np.arctan2(scene.velocity[0, 0, 1], scene.velocity[0, 0, 0]))


def test_identities_of_free_places_are_negative_and_different() -> None:
    text = """<trial name="flow" duration="6" step="0.05" capacity="5">
      <stage walkable="-4,-3 4,-3 4,3 -4,3"/><crowd type="orca"/>
      <spawner count="2" zone="-3,-1 -1,-1 -1,1" goal="3,-1 3.5,-1 3.5,1"/>
      <source zone="-3,1 -1,1 -1,2 -3,2" goal="3,-1 3.5,-1 3.5,1" rate="1"/>
    </trial>"""
    assert Simulation(parse_trial(text), 0).world.ids.tolist() == [[0, 1, -1, -2, -3]]


def test_an_episode_begins_and_ends_at_the_times_of_its_records() -> None:
    episode = simulate(dataclasses.replace(TINY, duration=1.0), 3)
    np.testing.assert_allclose(episode.times, np.arange(11) * 0.1, atol=1e-12)
    scan = episode.readings["robot/scan"][0]
    np.testing.assert_allclose(scan.pose.position, [[-1.9, -2.4]])
    assert scan.ranges.shape == (1, 90)
    assert scan.time == 0.0


def test_a_summary_has_the_times_in_seconds() -> None:
    log = EpisodeLog(dataclasses.replace(TINY, duration=1.0), 3)
    simulation = Simulation(dataclasses.replace(TINY, duration=1.0), 3)
    ended = run_to_end(simulation, [log], StopRequest())
    summary = log.summary(ended, simulation.tick)
    assert (summary.begin, summary.end, summary.steps, summary.agents) == (0.0, 1.0, 20, 5)


def fail(depth: int) -> None:
    if depth:
        fail(depth - 1)
    raise ValueError("no way\n ahead")


def failure(folder: Path | None) -> RunFailure:
    try:
        fail(2)
    except ValueError as error:
        return RunFailure.of(error, 1.5, folder)
    raise AssertionError


def test_the_place_of_an_exception_is_the_innermost_line_of_the_user() -> None:
    line = fail.__code__.co_firstlineno + 3
    found = failure(None)
    assert found.place == f"test_run_parts.py:{line}"
    assert found.message == "ValueError: no way ahead"
    assert str(found) == f"ValueError: no way ahead (test_run_parts.py:{line}) at 1.5 s"
    assert failure(Path(__file__).parents[1]).place == f"simulation/test_run_parts.py:{line}"
    assert failure(Path(__file__).parent / "elsewhere").place == f"test_run_parts.py:{line}"
    assert RunFailure.of(ValueError("x"), 0.0).place == "unknown"


def test_a_failure_inside_a_library_is_placed_in_the_user_s_line() -> None:
    line = test_a_failure_inside_a_library_is_placed_in_the_user_s_line.__code__.co_firstlineno + 3
    try:
        np.stack([])
    except ValueError as error:
        found = RunFailure.of(error, 0.0)
    assert found.place == f"test_run_parts.py:{line}"


def test_an_episode_keeps_contacts_forces_and_collisions() -> None:
    text = LEAN.replace(
        '<agent x="6" y="4" goal="1,4" body="woman-36" outfit="3"/>', '<agent x="3" y="2.2" heading="0"/>'
    )
    trial = parse_trial(text.replace('seed="4"', 'seed="4" world="physics"').replace('duration="1"', 'duration="3"'))
    episode = simulate(trial, 4)
    robot = trial.people
    assert {contact.robot for _, contact in episode.contacts} == {robot}
    assert all(contact.clearance < 0.0 for _, contact in episode.contacts)
    assert min(time for time, _ in episode.contacts) == min(time for time, _ in episode.forces)
    assert all(event.first == ("robot", robot) for event in episode.collisions)
    assert episode.metrics["collision"] == 1.0
    plain = simulate(parse_trial(LEAN), 4)
    assert (plain.forces, plain.collisions) == ((), ())
