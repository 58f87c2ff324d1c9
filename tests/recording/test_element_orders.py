"""Robots, props and walls that orders add and remove while a trial runs: recorded, replayed, branched."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.recording import branch, open_run, read_episode, replay
from crowdbot.simulation import (
    AddElementOrder,
    EpisodeLog,
    ParameterOrder,
    RemoveElementOrder,
    Simulation,
    SimulationRun,
    VelocityOrder,
)
from crowdbot.trials import Trial, apply_values, load_trial, parse_trial
from trial_texts import GOOD

WORLDS = ("planar", "physics")
SECOND = (
    '<robot name="second" {} x="-3" y="-1"><goal x="3" y="-1"/>{}<navigator type="orca"/>'
    '<sensor name="scan" type="lidar2d" rays="24"/></robot>'
)
ROBOTS = {
    "planar": SECOND.format("", '<drive type="differential-drive"/>'),
    "physics": SECOND.format('type="turtlebot2" sensor-rates="nearest"', ""),
}
BOX = '<cube x="0" y="1" size="0.4" fixed="true"/>'


def corridor(world: str) -> Trial:
    values: dict[str, Any] = {"world": world, "end/goal": False, "end/collision": False}
    return load_trial("frontal", duration=2.0, **values)


def steer(world: str) -> dict[int, list[Any]]:
    return {
        8: [AddElementOrder(xml=ROBOTS[world])],
        12: [AddElementOrder(xml=BOX, parent="stage"), VelocityOrder(robot="second", forward=0.2)],
        20: [RemoveElementOrder(path="stage/cube")],
        28: [RemoveElementOrder(path="robot[robot]")],
    }


@pytest.mark.parametrize("world", WORLDS)
def test_robots_and_props_come_and_go_in_a_recorded_run(world: str, tmp_path: Path) -> None:
    orders, log = steer(world), EpisodeLog(corridor(world), 1)
    with open_run(corridor(world), 1, out=tmp_path / "a.mcap", sinks=[log]) as running:
        while running.outcome is None:
            running.step(orders.get(running.simulation.tick, ()))
    simulation = running.simulation
    assert [control.robot.name for control in simulation.robots] == ["second"]
    assert [control.robot.name for control in simulation.former_robots] == ["robot"]
    episode = read_episode(tmp_path / "a.mcap")
    live = log.episode(str(running.outcome), simulation.tick)
    first, second = episode.robots
    assert (first, live.robots) == (1, episode.robots)
    there = episode.active[:, [first, second]]
    times = episode.times
    assert np.array_equal(there[:, 1], times >= 0.4 - 1e-9)
    assert np.array_equal(there[:, 0], times < 1.4 - 1e-9)
    moved = episode.position[-1, second] - (-3.0, -1.0)
    assert np.hypot(*moved) > 0.1
    assert np.array_equal(np.isnan(episode.commands[:, :, 0]), ~there)
    assert len(episode.readings["second/scan"]) > 5
    assert np.allclose(live.position[live.active], episode.position[episode.active])
    assert live.metrics == pytest.approx(dict(episode.metrics), nan_ok=True)
    assert replay(tmp_path / "a.mcap").equal
    for at in (0.5, 1.0, 1.7):
        again = branch(tmp_path / "a.mcap", at=at, out=tmp_path / f"b{at}.mcap")
        assert again.digest == episode.digest
        assert replay(tmp_path / f"b{at}.mcap").equal


@pytest.mark.parametrize("world", WORLDS)
def test_the_crowd_reacts_to_an_added_robot_and_forgets_a_removed_one(world: str) -> None:
    robot = ROBOTS[world].replace('x="-3" y="-1"', 'x="3.2" y="0"')
    alone, met, gone = (Simulation(corridor(world), 1) for _ in range(3))
    AddElementOrder(xml=robot).apply(met)
    AddElementOrder(xml=robot).apply(gone)
    RemoveElementOrder(path="robot[second]").apply(gone)
    for _ in range(30):
        for simulation in (alone, met, gone):
            simulation.advance()
    person = [simulation.world.scene.position[0, 0] for simulation in (alone, met, gone)]
    assert np.array_equal(person[0], person[2])
    assert np.abs(person[0] - person[1]).max() > 0.01


def test_a_wall_comes_and_goes_in_the_physics_world(tmp_path: Path) -> None:
    orders = {
        6: [AddElementOrder(xml='<wall points="-3.9,-1.5 -3.9,1.5"/>', parent="stage")],
        30: [RemoveElementOrder(path="stage/wall[3]")],
    }
    trial, forces = apply_values(corridor("physics"), {"robot/navigator/type": "straight"}), []
    with open_run(trial, 1, out=tmp_path / "a.mcap") as running:
        while running.outcome is None:
            running.step(orders.get(running.simulation.tick, ()))
            forces += [(running.simulation.tick, item) for item in running.simulation.world.forces_of(0)]
            if running.simulation.tick == 30:
                assert running.simulation.world.scene.position[0, 1, 0] < -3.9 - 0.25
    assert any(item.second.kind == "wall" and 6 < tick <= 31 for tick, item in forces)
    assert running.simulation.world.scene.position[0, 1, 0] > -4.15
    assert running.simulation.trial == trial
    assert replay(tmp_path / "a.mcap").equal
    whole = read_episode(tmp_path / "a.mcap")
    for at in (0.6, 1.8):
        assert branch(tmp_path / "a.mcap", at=at).digest == whole.digest


def test_an_added_wall_stops_people_and_the_scan_sees_it() -> None:
    trial = dataclasses.replace(corridor("planar"), duration=6.0)
    simulation = Simulation(trial, 1)
    AddElementOrder(xml='<wall points="1,-1.5 1,1.5"/>', parent="stage").apply(simulation)
    for _ in range(100):
        simulation.advance()
    assert simulation.world.scene.position[0, 0, 0] > 1.0
    RemoveElementOrder(path="stage/wall[3]").apply(simulation)
    assert simulation.trial == trial


def test_a_branch_keeps_what_orders_have_changed(tmp_path: Path) -> None:
    orders = {4: [ParameterOrder(path="robot/drive/max-speed", value="0.1")]}
    with open_run(corridor("planar"), 1, out=tmp_path / "a.mcap") as running:
        while running.outcome is None:
            running.step(orders.get(running.simulation.tick, ()))
    whole = read_episode(tmp_path / "a.mcap")
    assert branch(tmp_path / "a.mcap", at=1.0).digest == whole.digest
    other = branch(tmp_path / "a.mcap", at=1.0, changes={"crowd/headway-time-gap": 1.2}, out=tmp_path / "b.mcap")
    assert other.trial.robots[0].drive.max_speed == 0.1
    assert replay(tmp_path / "b.mcap").equal


@pytest.mark.parametrize(
    ("order", "sentence"),
    [
        (AddElementOrder(xml=ROBOTS["planar"].replace("second", "robot")), "robot"),
        (
            AddElementOrder(xml=ROBOTS["planar"].replace('x="-3" y="-1"', 'x="-4.5" y="0.2"')),
            "starts 0.20 m from robot",
        ),
        (AddElementOrder(xml="<crowd type='boids'/>"), "crowd"),
        (AddElementOrder(xml='<spawner count="1" zone="0,0 1,0 1,1" goal="2,2 3,2 3,3"/>'), "spawners cannot change"),
        (RemoveElementOrder(path="robot[hal]"), "no <robot> has the name 'hal'"),
        (RemoveElementOrder(path="spawner"), "spawners cannot change"),
    ],
)
def test_impossible_orders_are_explained(order: Any, sentence: str) -> None:
    simulation = Simulation(corridor("planar"), 1)
    with pytest.raises(InputError, match=sentence):
        order.check(simulation)


def test_the_floor_of_the_physics_world_and_many_environments_cannot_change() -> None:
    wall = AddElementOrder(xml='<wall points="1,-1 1,1"/>', parent="stage")
    with pytest.raises(InputError, match="only walls, obstacles and props can change while it runs"):
        ParameterOrder(path="stage/friction", value="0.5").check(Simulation(corridor("physics"), 1))
    with pytest.raises(InputError, match="use a simulation of one environment"):
        wall.check(Simulation(corridor("planar"), [1, 2]))


def test_a_name_is_used_once_and_a_changed_run_does_not_restart() -> None:
    simulation = Simulation(parse_trial(GOOD), 1)
    order = AddElementOrder(xml=ROBOTS["planar"].replace('y="-1"', 'y="2"'))
    order.check(simulation)
    order.apply(simulation)
    RemoveElementOrder(path="robot[second]").apply(simulation)
    with pytest.raises(InputError, match="'second' was removed from this run; give the new one another name"):
        order.check(simulation)
    with pytest.raises(InputError, match="robots were added or removed"):
        simulation.restart([0], [2])


@pytest.mark.parametrize("world", WORLDS)
def test_a_snapshot_of_a_changed_run_continues_alike(world: str) -> None:
    running = SimulationRun(Simulation(corridor(world), 1))
    orders = steer(world)
    for _ in range(16):
        running.step(orders.get(running.simulation.tick, ()))
    kept = running.snapshot()
    ends = []
    for _ in range(2):
        for _ in range(16):
            running.step(orders.get(running.simulation.tick, ()))
        ends.append(running.simulation.world.scene.digest())
        running.restore(kept)
    assert ends[0] == ends[1]


def test_a_robot_that_sees_bodies_is_refused_in_a_run_without_bodies():
    simulation = Simulation(corridor("planar"), 0)
    order = AddElementOrder(
        xml='<robot name="second" type="turtlebot2" sensor-rates="nearest" x="-3" y="-1"><goal x="3" y="-1"/>'
        '<navigator type="orca"/></robot>'
    )
    with pytest.raises(
        InputError, match=r'sees the bodies of people, and this run has none; run the trial with bodies="l'
    ):
        order.check(simulation)
