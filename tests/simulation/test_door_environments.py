"""Doors of several environments: each is the same as alone, restarts, states, orders, in both worlds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError, Scene
from crowdbot.models import ORCA
from crowdbot.simulation import (
    DoorOrder,
    EpisodeDigest,
    ParameterOrder,
    Simulation,
    decode_state,
    encode_state,
    read_order,
    restore_state,
    state_of,
    write_order,
)
from crowdbot.trials import Trial, parse_trial
from crowdbot.world import Door, Doors, PlanarWorld, worlds_of

TEXT = """<trial name="d" duration="8" world="{world}">
  <stage walkable="-1,-2 9,-2 9,2 -1,2">
    <wall points="3,-2 3,-0.5"/><wall points="3,0.5 3,2"/><wall points="6,-2 6,-0.5"/><wall points="6,0.5 6,2"/>
    <door name="hall" points="3,-0.5 3,0.5" opening="{opening}"/>
    <door name="exit" points="6,-0.5 6,0.5" kind="sliding"/>
  </stage>
  <routing/>
  <crowd type="orca"/>
  <spawner name="east" count="3" zone="0,-1.5 2,-1.5 2,1.5 0,1.5" goal="7,-1 8,-1 8,1 7,1"/>
  <robot name="bot" x="-0.5" y="0" radius="0.2"><goal x="8" y="0"/><planner/><drive type="differential-drive"/>
    <navigator type="orca"/>
    <sensor name="scan" type="lidar2d" rays="31" rate="10" noise="gaussian(0.01)"/>
  </robot>
  <end collision="false" goal="false"/>
</trial>
"""
WORLDS = ("planar", "physics")


def hall(world: str, opening: str = "approach") -> Trial:
    return parse_trial(TEXT.format(world=world, opening=opening).encode())


def advance(simulation: Simulation, steps: int, first_order: int = 20) -> list[str]:
    """Advance, opening the exit in each environment at its own time by its seed; return a digest for each."""
    episode_digests = [EpisodeDigest() for _ in simulation.seeds]
    for _ in range(steps):
        for e, seed in enumerate(simulation.seeds):
            if simulation.ticks[e] == first_order + 10 * seed:
                order = DoorOrder(door="exit", environment=e)
                order.check(simulation)
                order.apply(simulation)
        simulation.advance()
        assert not simulation.failed.any(), simulation.failures
        for e, digest in enumerate(episode_digests):
            digest.take(simulation.record(e))
    return [digest.hexdigest("") for digest in episode_digests]


def shares(simulation: Simulation) -> list[list[float]]:
    return [own.doors.share.tolist() for own in worlds_of(simulation.world)]


def history(trial: Trial, seeds: list[int], steps: int) -> list[list[Any]]:
    """Return the states of each environment after each step: scene, doors, command and readings."""
    simulation = Simulation(trial, seeds)
    result: list[list[Any]] = [[] for _ in seeds]
    for _ in range(steps):
        advance(simulation, 1)
        for e, own in enumerate(worlds_of(simulation.world)):
            record, scene = simulation.record(e), own.scene
            arrays = (scene.position, scene.velocity, scene.heading, scene.walls.segments(), own.doors.share)
            ranges = [reading.ranges.tobytes() for *_, reading in record.readings]
            result[e].append(([array.tobytes() for array in arrays], simulation.world.twists[3].at(e), ranges))
    return result


@pytest.mark.parametrize("world", WORLDS)
def test_each_environment_is_the_same_as_alone(world: str) -> None:
    trial, steps = hall(world), 60
    together = history(trial, [0, 1, 2], steps)
    doors = [[row[0][-1] for row in rows] for rows in together]
    assert doors[0] != doors[1] != doors[2], "the doors move at different times"
    assert together == [history(trial, [seed], steps)[0] for seed in range(3)]


@pytest.mark.parametrize("world", WORLDS)
def test_environments_are_restarted_one_by_one(world: str) -> None:
    trial, steps = hall(world), 25
    simulation = Simulation(trial, [0, 1, 2])
    advance(simulation, steps)
    opened = shares(simulation)
    simulation.restart([1], [1])
    assert shares(simulation)[1] == [0.0, 0.0]
    assert [shares(simulation)[e] for e in (0, 2)] == [opened[e] for e in (0, 2)]
    again, fresh = advance(simulation, steps), Simulation(trial, [1])
    advance(fresh, steps)
    one, two = worlds_of(simulation.world)[1], worlds_of(fresh.world)[0]
    assert one.scene.position.tobytes() == two.scene.position.tobytes()
    assert shares(simulation)[1] == shares(fresh)[0]
    assert len(again) == 3


@pytest.mark.parametrize("seeds", [[3], [0, 1, 2]], ids=["E=1", "E=3"])
@pytest.mark.parametrize("world", WORLDS)
def test_a_restored_simulation_with_doors_continues_to_the_last_bit(world: str, seeds: Any) -> None:
    trial = hall(world)
    first, second = Simulation(trial, seeds), Simulation(trial, seeds)
    advance(first, 33)
    data = encode_state(state_of(first))
    restore_state(second, decode_state(data))
    assert encode_state(state_of(second)) == data
    assert shares(second) == shares(first) != [[0.0, 0.0]] * len(seeds)
    assert advance(second, 20) == advance(first, 20)
    assert encode_state(state_of(second)) == encode_state(state_of(first))


@pytest.mark.parametrize("world", WORLDS)
def test_selected_environments_share_no_doors(world: str) -> None:
    simulation = Simulation(hall(world), [0, 1])
    advance(simulation, 22)
    before = shares(simulation)
    some = simulation.select([1, 0, 1])
    for _ in range(10):
        some.advance()
    assert shares(simulation) == before
    assert shares(some)[0] == shares(some)[2] != shares(some)[1]


def test_an_order_counts_for_its_environment_and_is_read_as_it_is_written() -> None:
    simulation = Simulation(hall("planar"), [0, 1])
    order = DoorOrder(door="exit", environment=1)
    assert read_order(write_order(order)) == order
    assert write_order(DoorOrder(door="exit", open=False)) == '{"order": "door", "door": "exit", "open": false}'
    order.check(simulation)
    order.apply(simulation)
    for _ in range(30):
        simulation.advance()
    assert [row[1] for row in shares(simulation)] == [0.0, 1.0]
    assert [len(own.scene.walls) for own in worlds_of(simulation.world)] == [16, 14]


@pytest.mark.parametrize(
    ("order", "sentence"),
    [
        (DoorOrder(door="exti"), "there is no door 'exti', did you mean 'exit'"),
        (DoorOrder(door="hall"), "door 'hall' opens by approach"),
        (DoorOrder(door="exit", environment=2), "environment = 2 must be from 0 to 1"),
    ],
)
def test_a_wrong_order_is_refused(order: DoorOrder, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        order.check(Simulation(hall("planar"), [0, 1]))


def test_another_order_leaves_doors_as_they_were_ordered() -> None:
    simulation = Simulation(hall("planar"), [0])
    DoorOrder(door="exit").apply(simulation)
    ParameterOrder(path="crowd.neighbor-distance", value="4").apply(simulation)
    for _ in range(30):
        simulation.advance()
    assert shares(simulation)[0][1] == 1.0


def test_a_planar_world_of_several_environments_takes_no_doors() -> None:
    start = Scene.of(np.zeros((2, 1, 2)))
    with pytest.raises(InputError, match="join several worlds with join_worlds"):
        PlanarWorld(start, ORCA(), {}, 0.1, doors=Doors((Door(name="hall", points="2,-1 2,1"),)))
