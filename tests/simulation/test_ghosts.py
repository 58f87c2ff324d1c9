"""Ghosts: robots that drive and sense, but are absent to everybody else."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from crowdbot.core import Twist
from crowdbot.metrics import CONTACT_METRICS
from crowdbot.navigation import Navigator, Observation
from crowdbot.sensors import Scan
from crowdbot.simulation import Simulation, apply_overrides, simulate
from crowdbot.simulation.termination import goal_zones
from crowdbot.simulation.world_template import WorldTemplate
from crowdbot.trials import Planner, Trial, builtin_trials, expand_sweeps, load_trial, parse_trial, trial_xml
from crowdbot.world import PhysicsWorld, PlanarWorld, SceneCamera
from samples import sample
from space_trials import LEAN, room
from trial_schema import valid
from trial_texts import FLOW, GOOD

SECONDS = 2.0
PHYSICS_SECONDS = 0.6
NAMES = [name for name in sorted(builtin_trials()) if load_trial(name).robots]
KEPT = ["bottleneck", "challenge-both-50", "circle-crossing", "one-way-with", "two-crowds", "frontal"]


@dataclasses.dataclass(frozen=True)
class Still(Navigator):
    """A navigator that never drives."""

    def act(self, observation: Observation) -> Twist:
        return Twist()


@dataclasses.dataclass(frozen=True)
class Reckless(Navigator):
    """A navigator that drives into everything."""

    def act(self, observation: Observation) -> Twist:
        return Twist(1.0)


def planar(name: str) -> Trial:
    trial = load_trial(name)
    first = expand_sweeps(trial)[0] if trial.sweeps else trial
    return dataclasses.replace(first, world="planar")


def with_robots(trial: Trial, **changes: Any) -> Trial:
    return dataclasses.replace(trial, robots=tuple(dataclasses.replace(robot, **changes) for robot in trial.robots))


def positions(simulation: Simulation, seconds: float, robots: int) -> np.ndarray:
    """Return the positions of people [T, A, 2], NaN for absent ones; the robots are left out."""
    trial, found = simulation.trial, []
    for _ in range(round(seconds / trial.step)):
        simulation.advance()
        scene = simulation.world.scene
        place = np.where(scene.active[0][:, None], scene.position[0], np.nan)
        found.append(np.delete(place, range(trial.people, trial.people + robots), axis=0))
    return np.array(found)


def without_robots(trial: Trial) -> Simulation:
    """Return the simulation of a trial without its robots, with everybody at the same place and with the same id."""
    empty = dataclasses.replace(trial, robots=())
    people = WorldTemplate(trial).begin([0])[1]
    simulation = Simulation(empty, 0)
    simulation.world, simulation.people = WorldTemplate(empty).build_alone(people, 0)[0], people
    simulation._ways_out = goal_zones(people)
    simulation._set_around()
    simulation.world._traffic.following += len(trial.robots)
    return simulation


@pytest.mark.parametrize("name", sample(NAMES, KEPT))
def test_a_ghost_disturbs_nobody(name: str) -> None:
    trial = planar(name)
    count = len(trial.robots)
    ghost = with_robots(trial, ghost=True)
    driving = positions(Simulation(ghost, 0), SECONDS, count)
    reckless = positions(Simulation(with_robots(ghost, navigator=Reckless()), 0), SECONDS, count)
    still = positions(Simulation(with_robots(ghost, navigator=Still()), 0), SECONDS, count)
    absent = positions(without_robots(trial), SECONDS, 0)
    for other in (driving, reckless, absent):
        np.testing.assert_array_equal(other, still)
    assert len(still) == round(SECONDS / trial.step)


@pytest.mark.parametrize("name", sample(NAMES, KEPT))
def test_the_paired_run_starts_with_everybody_at_the_same_place(name: str) -> None:
    trial = planar(name)
    robot, ghost = Simulation(trial, 3), Simulation(with_robots(trial, ghost=True), 3)
    np.testing.assert_array_equal(robot.world.scene.position, ghost.world.scene.position)
    np.testing.assert_array_equal(robot.world.scene.velocity, ghost.world.scene.velocity)
    assert ghost.world.scene.active[0, trial.people]


def ghosts_of(simulation: Simulation) -> Any:
    assert isinstance(simulation.world, PlanarWorld)
    return simulation.world.ghosts


def facing(ghost: bool, **more: Any) -> Trial:
    """Return a trial with a second robot right in front of the first, which may be a ghost."""
    text = GOOD.replace(
        "  <end",
        '  <robot name="other" x="0" y="-2.4" radius="0.3"><goal x="-4" y="-2.4"/>'
        '<drive type="differential-drive"/><navigator type="orca"/>'
        '<sensor name="scan" type="lidar2d" rays="90"/></robot>\n  <end',
    )
    trial = parse_trial(text)
    first = dataclasses.replace(trial.robots[0], ghost=ghost, **more)
    other = dataclasses.replace(trial.robots[1], navigator=Still())
    return dataclasses.replace(trial, robots=(first, other), spawners=())


def hits(simulation: Simulation, robot: str) -> Any:
    """Return the indices that the latest scan of a robot hits."""
    scan = simulation.observation(robot).scan
    assert isinstance(scan, Scan)
    return scan.hit


def test_sensors_and_navigators_of_others_miss_a_ghost() -> None:
    seen, missed = Simulation(facing(False), 0), Simulation(facing(True), 0)
    for simulation in (seen, missed):
        simulation.begin()
    first = seen.trial.people
    for simulation, there in ((seen, True), (missed, False)):
        hit = hits(simulation, "other")
        assert (first in hit) is there
        assert (first in simulation.observation("other").people.ids) is there
        own = simulation.observation("robot")
        assert first + 1 in own.people.ids
        assert first + 1 in hits(simulation, "robot")


def test_sensors_in_space_miss_a_ghost() -> None:
    for ghost in (False, True):
        trial = facing(ghost)
        robots = tuple(
            dataclasses.replace(robot, sensors=tuple(dataclasses.replace(mount, pitch=0.05) for mount in robot.sensors))
            for robot in trial.robots
        )
        simulation = Simulation(dataclasses.replace(trial, robots=robots), 0)
        simulation.begin()
        assert (trial.people in hits(simulation, "other")) is not ghost
        assert trial.people + 1 in hits(simulation, "robot")


def test_a_ghost_has_no_contacts_and_no_collision() -> None:
    trial = facing(False, navigator=Reckless())
    ghost = facing(True, navigator=Reckless())
    with_end = [dataclasses.replace(item, end=dataclasses.replace(item.end, collision=True)) for item in (trial, ghost)]
    collided, passed = (simulate(item, 0) for item in with_end)
    assert collided.outcome == "collision"
    assert passed.outcome == "timeout"
    simulation = Simulation(ghost, 0)
    simulation.world.scene = simulation.world.scene.replace(
        position=np.where(np.arange(2)[:, None] == 0, [[0.0, 2.9]], simulation.world.scene.position[0])[None]
    )
    simulation.advance()
    assert simulation.contacts() == ()
    assert np.isinf(simulation.world.wall_clearance(0)).all()


def test_environments_with_a_ghost_are_their_single_runs() -> None:
    trial = with_robots(dataclasses.replace(parse_trial(FLOW), duration=2.0), ghost=True)
    many, singles = Simulation(trial, range(3)), [Simulation(trial, seed) for seed in range(3)]
    for _ in range(40):
        many.advance()
        for single in singles:
            single.advance()
    for e, single in enumerate(singles):
        np.testing.assert_array_equal(
            many.world.environment_scene(e).position, single.world.environment_scene(0).position
        )
        np.testing.assert_array_equal(many.world.environment_scene(e).active, single.world.environment_scene(0).active)
    again = many.select([2, 0])
    again.restart([1], [1])
    for _ in range(3):
        again.advance()
        singles[2].advance()
    np.testing.assert_array_equal(
        again.world.environment_scene(0).position, singles[2].world.environment_scene(0).position
    )
    assert ghosts_of(again) == ghosts_of(many)


def test_a_robot_becomes_a_ghost_in_a_branch() -> None:
    trial = facing(False, navigator=Reckless())
    simulation = Simulation(trial, 0)
    simulation.advance()
    apply_overrides(simulation, with_robots(trial, ghost=True))
    assert ghosts_of(simulation) == [0, 1]
    assert not simulation.world.plane_scene().active.any()
    assert simulation.world.scene.active.all()
    apply_overrides(simulation, trial)
    assert simulation.world.plane_scene().active.all()


def with_bodies(trial: Trial) -> Trial:
    return dataclasses.replace(trial, world="physics")


@pytest.mark.parametrize("name", sample(NAMES, KEPT))
def test_a_ghost_with_a_body_disturbs_nobody(name: str) -> None:
    trial = with_bodies(planar(name))
    count = len(trial.robots)
    ghost = with_robots(trial, ghost=True)
    driving = positions(Simulation(ghost, 0), PHYSICS_SECONDS, count)
    reckless = positions(Simulation(with_robots(ghost, navigator=Reckless()), 0), PHYSICS_SECONDS, count)
    still = positions(Simulation(with_robots(ghost, navigator=Still()), 0), PHYSICS_SECONDS, count)
    absent = positions(without_robots(trial), PHYSICS_SECONDS, 0)
    for other in (driving, reckless, absent):
        np.testing.assert_array_equal(other, still)
    assert len(still) == round(PHYSICS_SECONDS / trial.step)


def everything(simulation: Simulation, robot: int) -> list[np.ndarray]:
    """Return the state of people, props and other robots in the physics world."""
    world = simulation.world
    assert isinstance(world, PhysicsWorld)
    scene = np.delete(world.scene.position[0], robot, axis=0)
    others = [body.joints() for agent, body in sorted(world.robot_bodies.items()) if agent != robot]
    joints = np.array([value for found in others for value in found.values()]).ravel()
    return [scene, world.people.ends, world.data.qpos.copy(), world.data.qvel.copy(), joints]


def test_people_props_and_robots_do_not_notice_a_ghost_with_a_body() -> None:
    """A ghost drives through people, a box that moves and another robot; all of them move as if it stood."""
    trial = parse_trial(room("physics", LEAN))
    second = dataclasses.replace(trial.robots[0], name="second", x=2.0, y=4.0)
    spec = dataclasses.replace(second, ghost=True, navigator=Reckless(), heading=-0.6)
    trial = dataclasses.replace(trial, robots=(trial.robots[0], spec), duration=4.0)
    agent = trial.people + 1
    runs = [Simulation(trial, 3), Simulation(with_second(trial, Still()), 3)]
    for k in range(60):
        for run in runs:
            run.advance()
        for item, two in zip(*(everything(run, agent) for run in runs), strict=True):
            np.testing.assert_array_equal(item, two, err_msg=str(k))
    moved = runs[0].world.scene.position[0, agent] - runs[1].world.scene.position[0, agent]
    assert np.hypot(*moved) > 0.8


def with_second(trial: Trial, navigator: Navigator) -> Trial:
    return dataclasses.replace(
        trial, robots=(trial.robots[0], dataclasses.replace(trial.robots[1], navigator=navigator))
    )


def test_a_ghost_with_a_body_stops_at_a_wall_without_a_contact() -> None:
    trial = with_robots(parse_trial(room("physics", LEAN)), ghost=True, navigator=Reckless(), x=10.5, y=0.8)
    simulation = Simulation(dataclasses.replace(trial, duration=5.0), 3)
    for _ in range(100):
        simulation.advance()
        assert simulation.contacts() == ()
        assert np.isinf(simulation.world.wall_clearance(trial.people)).all()
    assert simulation.world.scene.position[0, trial.people, 0] == pytest.approx(12.0 - trial.robots[0].radius, abs=0.05)


def test_sensors_and_navigators_miss_a_ghost_with_a_body() -> None:
    seen, missed = Simulation(with_bodies(facing(False)), 0), Simulation(with_bodies(facing(True)), 0)
    first = seen.trial.people
    for simulation, there in ((seen, True), (missed, False)):
        simulation.begin()
        assert (first in hits(simulation, "other")) is there
        assert (first in simulation.observation("other").people.ids) is there
        assert first + 1 in simulation.observation("robot").people.ids
        assert first + 1 in hits(simulation, "robot")


def test_environments_with_bodies_and_a_ghost_are_their_single_runs() -> None:
    trial = with_bodies(with_robots(dataclasses.replace(parse_trial(FLOW), duration=2.0), ghost=True))
    many, singles = Simulation(trial, range(2)), [Simulation(trial, seed) for seed in range(2)]
    for _ in range(8):
        for item in (many, *singles):
            item.advance()
    again = many.select([1, 0])
    for item in (again, *singles):
        item.advance()
    for e, single in enumerate(reversed(singles)):
        np.testing.assert_array_equal(
            again.world.environment_scene(e).position, single.world.environment_scene(0).position
        )


def test_a_robot_with_a_body_becomes_a_ghost_in_a_branch() -> None:
    trial = with_bodies(facing(False, navigator=Reckless()))
    simulation = Simulation(trial, 0)
    for _ in range(10):
        simulation.advance()
    world: Any = simulation.world
    before = [(body.pose.position.copy(), body.joints()) for body in world.robot_bodies.values()]
    apply_overrides(simulation, with_robots(trial, ghost=True))
    assert sorted(world.rigid.ghosts) == [0, 1]
    after = [(body.pose.position.copy(), body.joints()) for body in world.robot_bodies.values()]
    for (place, joints), (other, same) in zip(before, after, strict=True):
        np.testing.assert_array_equal(place, other)
        assert joints == same
    assert not world.plane_scene().active.any()
    simulation.advance()
    apply_overrides(simulation, trial)
    assert (world.rigid.ghosts, world.plane_scene().active.all()) == ({}, True)
    simulation.advance()


def test_values_are_set_by_path_and_written() -> None:
    values: dict[str, Any] = {
        "robot/ghost": True,
        "robot/planner/margin": 0.2,
        "robot/deadline": 0.5,
        "robot/tracks": 2.0,
    }
    trial = load_trial("frontal", **values)
    robot = trial.robots[0]
    assert (robot.ghost, robot.planner, robot.deadline, robot.tracks) == (True, Planner(0.2), 0.5, 2.0)
    assert parse_trial(trial_xml(trial)) == trial
    assert valid(trial_xml(trial))


def two_robots(**changes: Any) -> Trial:
    """Return a trial with a robot and a ghost that never moves."""
    trial = load_trial("frontal", duration=30.0)
    robot = dataclasses.replace(trial.robots[0], **changes)
    still = dataclasses.replace(robot, name="other", y=robot.y + 3.0, ghost=True, navigator=Still())
    return dataclasses.replace(trial, robots=(robot, still))


def test_the_end_does_not_wait_for_ghosts() -> None:
    both, alone = simulate(two_robots(), 0), simulate(load_trial("frontal", duration=30.0), 0)
    assert (both.outcome, both.steps) == (alone.outcome, alone.steps)
    assert both.outcome == "success"


def test_a_run_with_only_ghosts_ends_at_their_arrival() -> None:
    trial = with_robots(load_trial("frontal", duration=30.0), ghost=True)
    assert simulate(trial, 0).outcome == "success"


def test_a_ghost_has_no_contact_metrics() -> None:
    trial = load_trial("frontal", navigator="straight", duration=15.0)
    ghost = simulate(with_robots(trial, ghost=True), 0)
    assert ghost.metrics["min_clearance"] < 0.0  # it passes through a person, which is not a contact
    assert ghost.metrics["collision"] == 0.0
    assert not set(CONTACT_METRICS) & set(ghost.metrics)
    assert set(CONTACT_METRICS) < set(simulate(trial, 0).metrics)


def test_a_ghost_does_not_change_the_metrics_of_a_robot() -> None:
    both, alone = simulate(two_robots(), 0), simulate(load_trial("frontal", duration=30.0), 0)
    own = {name: value for name, value in both.metrics.items() if not name.startswith("other.")}
    own |= {name: alone.metrics[name] for name in ("success", "collision", "timeout", "time_to_goal")}
    assert repr(own) == repr(dict(alone.metrics))


def test_films_show_a_ghost_with_a_body_and_cameras_of_robots_do_not() -> None:
    world: Any = Simulation(with_bodies(facing(True)), 0).world
    ghost = 0
    x, y = world.pose(ghost).position[0].tolist()
    camera = SceneCamera((x - 1.5, y, 2.0), (x, y, 0.2), width=64, height=48)
    film = world.renderer.images(camera, rgb=False, segmentation=True).segmentation
    seen = world.environment_renderer(0).images(camera, rgb=False, segmentation=True).segmentation
    assert ghost in film
    assert ghost not in seen
