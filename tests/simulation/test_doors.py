"""Doors: leaves in both worlds, schedules, approach, orders, pushes, paths, copies and replay."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError, Scene, Walls
from crowdbot.recording import record, replay
from crowdbot.simulation import ParameterOrder, Simulation
from crowdbot.trials import Trial, load_trial, parse_trial
from crowdbot.world import Door, Doors, Router

TEXT = """<trial name="d" duration="{duration}" world="{world}">
  <stage walkable="-1,-2 9,-2 9,2 -1,2">
    <wall points="3,-2 3,-0.5"/><wall points="3,0.5 3,2"/>
    <door name="hall" points="3,-0.5 3,0.5" {door}/>
  </stage>
  <routing/>
  <crowd type="orca"/>
  <agent name="p" x="0" y="0.3" goal="8,0"/>
  {robot}
</trial>
"""
ROBOT = (
    '<robot name="bot" x="1" y="-0.8" radius="0.2"><goal x="6" y="0"/><planner/><drive type="differential-drive"/>'
    '<navigator type="straight"/></robot>'
)


def _trial(door: str, world: str = "planar", duration: float = 6.0, robot: str = "") -> Trial:
    return parse_trial(TEXT.format(door=door, world=world, duration=duration, robot=robot).encode())


def _run(simulation: Simulation, seconds: float) -> np.ndarray:
    places = []
    for _ in range(round(seconds / simulation.trial.step)):
        simulation.advance()
        assert simulation.failures[0] is None
        places.append(simulation.world.scene.position[0, 0].copy())
    return np.array(places)


@pytest.mark.parametrize("world", ["planar", "physics"])
def test_a_scheduled_door_blocks_people_until_it_opens(world: str) -> None:
    simulation = Simulation(_trial('opening="schedule" times="3.5"', world))
    places = _run(simulation, 6.0)
    assert places[:68, 0].max() < 3.0
    assert places[-1, 0] > 3.2


@pytest.mark.parametrize("kind", ["hinged", "sliding"])
def test_a_door_opens_when_somebody_comes(kind: str) -> None:
    simulation = Simulation(_trial(f'opening="approach" kind="{kind}" hold="0.5"'))
    places = _run(simulation, 4.0)
    assert places[-1, 0] > 3.8
    _run(simulation, 2.0)
    world = simulation.world
    assert world.doors.share.tolist() == [0.0]  # type: ignore[attr-defined]


def test_an_order_opens_a_door() -> None:
    simulation = Simulation(_trial(""))
    assert _run(simulation, 3.0)[:, 0].max() < 3.0
    order = ParameterOrder(path="stage.door[hall].open", value="true")
    order.check(simulation)
    order.apply(simulation)
    assert _run(simulation, 3.0)[-1, 0] > 3.2


def test_other_values_of_doors_cannot_change() -> None:
    simulation = Simulation(_trial(""))
    with pytest.raises(InputError, match="only open can change"):
        ParameterOrder(path="stage.door[hall].duration", value="3").check(simulation)
    simulation = Simulation(_trial('opening="approach"'))
    with pytest.raises(InputError, match="opens by approach"):
        ParameterOrder(path="stage.door[hall].open", value="true").check(simulation)


def test_a_robot_with_a_planner_waits_for_the_door() -> None:
    simulation = Simulation(_trial('opening="schedule" times="2"', robot=ROBOT, duration=9.0))
    _run(simulation, 1.9)
    assert simulation.world.scene.position[0, 1].tolist() == pytest.approx([1.0, -0.8], abs=0.05)
    _run(simulation, 6.0)
    assert simulation.world.scene.position[0, 1, 0] > 3.3


def test_people_push_a_swing_door_in_the_physics_world() -> None:
    simulation = Simulation(_trial('opening="push" closer="5"', "physics"))
    widest = 0.0
    for _ in range(100):
        simulation.advance()
        assert simulation.failures[0] is None
        widest = max(widest, abs(float(simulation.world.doors.share[0])))  # type: ignore[attr-defined]
    assert simulation.world.scene.position[0, 0, 0] > 3.3
    assert widest > 0.3


def test_sensors_see_the_leaf_where_it_is() -> None:
    simulation = Simulation(_trial('opening="schedule" times="0.05" kind="sliding"', "physics"))
    _run(simulation, 0.1)
    first = simulation.world.body_scene().bodies
    _run(simulation, 1.5)
    second = simulation.world.body_scene().bodies
    assert first is not None
    assert second is not None
    assert second.box_centre[0, -1, 1] - first.box_centre[0, -1, 1] < -0.8


def test_a_door_waits_for_people_in_its_way() -> None:
    doors = Doors((Door(name="hall", points="0,0 1,0", duration=0.5, open=True),))
    doors.wanted["hall"] = False
    standing = Scene.of([[0.6, 0.1]])
    for k in range(20):
        doors.advance(standing, 0.1 * k, 0.1)
    assert doors.share[0] > 0.3
    for k in range(20):
        doors.advance(standing.replace(active=[[False]]), 2.0 + 0.1 * k, 0.1)
    assert doors.share.tolist() == [0.0]


def test_paths_avoid_closed_doors_and_return_when_they_open() -> None:
    walls = Walls.of([[(3.0, -2.0), (3.0, -0.5)], [(3.0, 0.5), (3.0, 2.0)], [(-1.0, -2.0), (9.0, -2.0)]])
    base = Router.of(walls, 0.25)
    doors = Doors((Door(name="hall", points="3,-0.5 3,0.5"),))
    closed = doors.router(base).towards([0.0, 0.0], [8.0, 0.0])
    doors.wanted["hall"] = True
    for k in range(25):
        doors.advance(Scene.of([[0.0, 0.0]]), 0.05 * k, 0.05)
    assert doors.router(base).towards([0.0, 0.0], [8.0, 0.0])[0] > 2.0
    assert closed[1] > 2.0


@pytest.mark.parametrize("world", ["planar", "physics"])
def test_an_episode_with_doors_is_replayed_to_the_byte(world: str, tmp_path: Path) -> None:
    trial = _trial('opening="approach"', world, duration=6.0, robot=ROBOT)
    record(trial, out=tmp_path / "a")
    again = replay(tmp_path / "a" / "episode.mcap")
    assert again.replayed == again.recorded
    assert load_trial("frontal").stage.doors == ()


def test_a_selected_simulation_has_doors_of_its_own() -> None:
    simulation = Simulation(_trial('opening="approach"'))
    _run(simulation, 1.0)
    other = simulation.select([0])
    _run(other, 2.0)
    assert simulation.world.doors.share.tolist() == [0.0]  # type: ignore[attr-defined]
    assert other.world.doors.share[0] > 0.5  # type: ignore[attr-defined]
    assert np.array_equal(_run(simulation, 2.0)[-1], other.world.scene.position[0, 0])
