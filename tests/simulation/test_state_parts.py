"""States of simulations with ghosts, avatars, joints, goals and people whom orders have added, in both worlds."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from crowdbot.simulation import (
    AddPersonOrder,
    AvatarOrder,
    EpisodeDigest,
    GoalOrder,
    JointOrder,
    Order,
    RemoveOrder,
    Simulation,
    StateError,
    StateMark,
    decode_state,
    encode_state,
    restore_state,
    state_of,
)
from crowdbot.trials import Trial, parse_trial
from crowdbot.world import Cube, Robot


def lab(world: str) -> Trial:
    """Return a trial with a Pepper, a ghost, an avatar, a group of people around them, and people who enter."""
    return parse_trial(f"""<trial name="lab" duration="4" step="0.05" world="{world}">
      <stage walkable="-6,-4 6,-4 6,4 -6,4"/>
      <crowd type="orca"/>
      <agent x="1.2" y="0.1" goal="-5,0.2"/>
      <agent x="-1" y="2" goal="5,2"/>
      <avatar name="guide" source="external" x="2" y="1" heading="3"/>
      <robot name="pepper" type="pepper" x="0" y="0" default-sensors="false">
        <goal x="3" y="0"/>
        <navigator type="straight"/>
        <sensor name="eyes" type="lidar2d" link="Head" rays="31" rate="20" noise="gaussian(0.01)"/>
      </robot>
      <robot name="shade" type="turtlebot2" x="-0.8" y="0" ghost="true" default-sensors="false">
        <goal x="4" y="0"/>
        <navigator type="straight"/>
        <sensor name="scan" type="lidar2d" rays="31" rate="10" delay="0.1"/>
      </robot>
      <end collision="false" goal="false"/>
    </trial>""")


TRIALS = {world: lab(world) for world in ("planar", "physics")}
SEEDS: list[Any] = [3, [1, 2, 3]]
PLACES = ((1.1, -0.3), (1.3, 0.4), (-3.0, -2.0))


def orders(tick: int, e: int, more: bool) -> list[Order]:
    """Return the orders of a tick in one environment; ``more``: people are added, too."""
    time, found = 0.05 * (tick + 1), list[Order]()
    if tick % 3 != 2:
        found.append(AvatarOrder(avatar="guide", time=time, x=2.0 - 0.7 * time, y=1.0 - 0.5 * time, environment=e))
    if tick == 2 + e:
        found.append(JointOrder(robot="pepper", joint="HeadYaw", position=0.3 + 0.1 * e, environment=e))
    if tick == 4:
        found.append(GoalOrder(robot="pepper", x=2.0, y=1.0 + 0.2 * e, tolerance=0.4, environment=e))
    if more and (tick in (5, 6) or (tick == 7 and e == 1)):
        x, y = PLACES[tick - 5]
        found.append(AddPersonOrder(x=x, y=y, goal_x=-4.0, goal_y=0.0, environment=e))
    if tick == 8:
        found.append(RemoveOrder(person=1, environment=e))
    return found


def advance(simulation: Simulation, steps: int) -> str:
    """Advance with orders, and return the digest of the records of all environments."""
    episode_digest = EpisodeDigest()
    for _ in range(steps):
        for e in range(simulation.count):
            for order in orders(simulation.tick, e, not simulation.world.walls_fixed):
                order.check(simulation)
                order.apply(simulation)
        simulation.advance()
        for e in range(simulation.count):
            episode_digest.take(simulation.record(e))
    return episode_digest.hexdigest("")


def begun(trial: Trial, seeds: Any, steps: int) -> Simulation:
    simulation = Simulation(trial, seeds)
    advance(simulation, steps)
    return simulation


@pytest.mark.parametrize("seeds", SEEDS, ids=["E=1", "E=3"])
@pytest.mark.parametrize("world", TRIALS)
@pytest.mark.parametrize("steps", [3, 12])
def test_a_restored_simulation_continues_to_the_last_bit(world: str, seeds: Any, steps: int) -> None:
    first, second = begun(TRIALS[world], seeds, steps), Simulation(TRIALS[world], seeds)
    data = encode_state(state_of(first))
    restore_state(second, decode_state(data))
    assert encode_state(state_of(second)) == data
    assert advance(second, 8) == advance(first, 8)
    assert encode_state(state_of(second)) == encode_state(state_of(first))


def test_the_state_has_samples_goals_joints_and_moved_sensors() -> None:
    state = state_of(begun(TRIALS["planar"], 3, 12))
    assert len(state["simulation/world/avatars/streams/0/0/time"]) > 4
    assert state["simulation/robots/0/goal"].tolist() == [[2.0, 1.0]]
    assert np.nanmax(state["simulation/robots/0/joints"]) == 0.3
    assert state["simulation/robots/0/sensors/0/moved"].shape == (1, 6)
    stream = f"{RNGS}/_streams/0"
    kind, content = state[f"{stream}/made"]
    assert (state[f"{stream}/seed"], kind, content["bit_generator"]) == (3, "random", "PCG64")


def test_ghosts_have_engine_states_of_their_own() -> None:
    state = state_of(begun(TRIALS["physics"], 3, 12))
    engines = [path for path in state if path.endswith("/engine")]
    assert engines == ["simulation/world/rigid/ghosts/0/value/engine", "simulation/world/rigid/main/engine"]
    assert np.any(state["simulation/world/rigid/people/agent"] >= 0)


def test_people_whom_orders_have_added_to_a_physics_world_have_their_bodies() -> None:
    trial = dataclasses.replace(TRIALS["physics"], avatars=())
    first, second = Simulation(trial, 3), Simulation(trial, 3)
    slots = first.world.rigid.slots  # type: ignore[attr-defined]
    for x, y in PLACES:
        AddPersonOrder(x=x, y=y, goal_x=-4.0, goal_y=0.0).apply(first)
    assert first.world.rigid.slots > slots  # type: ignore[attr-defined]
    for _ in range(6):
        first.advance()
    restore_state(second, decode_state(encode_state(state_of(first))))
    for _ in range(4):
        first.advance()
        second.advance()
    assert encode_state(state_of(second)) == encode_state(state_of(first))
    assert first.world.scene.shape == (1, 2 + 2 + 3)


@pytest.mark.parametrize("world", TRIALS)
@pytest.mark.parametrize("seeds", SEEDS, ids=["E=1", "E=3"])
def test_a_simulation_with_another_structure_has_no_state_and_says_why(world: str, seeds: Any) -> None:
    simulation = begun(TRIALS[world], seeds, 2)
    simulation.world.add_robot(Robot.load("turtlebot2"), -4.0, -3.0)
    with pytest.raises(StateError, match="robots were added or removed while the simulation ran"):
        state_of(simulation)


def test_a_removed_robot_and_changed_props_of_the_physics_world_have_no_state() -> None:
    simulation = begun(TRIALS["physics"], 3, 2)
    name = simulation.world.add_prop(Cube(-4.0, -3.0))
    with pytest.raises(StateError, match="props were added or removed while the simulation ran"):
        state_of(simulation)
    simulation.world.remove_prop(name)
    assert encode_state(state_of(simulation))
    simulation.world.remove_robot(simulation.robots[1].agent)
    with pytest.raises(StateError, match="robots were added or removed"):
        state_of(simulation)


RNGS = "simulation/robots/0/sensors/0/rngs"
CHANGES: dict[str, tuple[Any, str]] = {
    f"{RNGS}/_streams": (StateMark("objects", 2), "has 2 parts, but the trial has 1"),
    f"{RNGS}/_streams/0/made": (StateMark("random", {"state": 3}), "is not the state of a random generator"),
    f"{RNGS}/_streams/0/seed": ("x", "is a str, but the trial has a int"),
    RNGS: (StateMark("plain", []), "is a 'plain', which is unknown"),
    "simulation/world/rigid/ghosts": (StateMark("dict", 0), r"has the parts \[\], but the trial has \[4\]"),
    "simulation/robots": (StateMark("list", 1), "has 1 parts, but the trial has 2"),
    "simulation/world/rigid/main/engine": (np.zeros(3), "has the shape"),
    "simulation/world/avatars/streams/0/0/rows": (np.zeros((2, 3)), "rows must have shape"),
}


@pytest.mark.parametrize("path", CHANGES)
def test_a_state_that_does_not_fit_is_refused_in_a_sentence(path: str) -> None:
    value, sentence = CHANGES[path]
    state = state_of(begun(TRIALS["physics"], 3, 2))
    with pytest.raises(StateError, match=sentence):
        restore_state(Simulation(TRIALS["physics"], 3), state | {path: value})
