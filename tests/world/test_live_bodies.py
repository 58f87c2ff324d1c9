"""Robots, props and people are added to and removed from a running physics world."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from physics_worlds import crowded

from crowdbot.core import InputError, Scene, Twist, Walls
from crowdbot.models import ORCA
from crowdbot.world import (
    Cube,
    PhysicsStage,
    PhysicsWorld,
    PlanarWorld,
    Robot,
    Table,
    add_person,
    join_worlds,
    move_agent,
    put_environments,
    remove_person,
    select_environments,
    step_environments,
)
from crowdbot.world.physics.world import MORE

BOT, CHAIR = Robot.load("turtlebot2"), Robot.load("wheelchair")
COUNT = 12
STAGE = PhysicsStage(props=(Cube(1.2, 0.0, size=0.3, mass=2.0), Table(-4.0, 4.5)))
WALL = Walls.of([[(-8.0, -8.0), (8.0, -8.0)]])


def hall(seed: int = 0, steps: int = 8, **options: Any) -> PhysicsWorld:
    """Return a world of 12 people, a robot that drives into a box, and a wall, after some steps."""
    scene = crowded(COUNT, BOT, seed).replace(walls=WALL)
    world = PhysicsWorld(scene, ORCA(), {COUNT: BOT}, 0.05, seed, **({"stage": STAGE} | options))
    drive(world, steps)
    return world


def drive(world: Any, steps: int, **more: Any) -> None:
    for _ in range(steps):
        world.step({COUNT: Twist(0.5, 0.1), **{int(agent): twist for agent, twist in more.items()}})


def state(world: PhysicsWorld, agents: int = COUNT + 1) -> dict[str, Any]:
    """Return the state of the first agents, of the props and of the engine, by name."""
    model, data, found = world.engine_model, world.data, {}
    for k in range(model.njnt):
        joint = model.joint(k)
        for part in ("qpos", "qvel", "qacc_warmstart", "qfrc_applied"):
            found[joint.name, part] = np.copy(getattr(data.joint(joint.name), part))
    for k in range(model.nbody):
        name = model.body(k).name
        found[name, "place"] = np.concatenate([data.xpos[k], data.xmat[k], data.cvel[k]])
    for k in range(model.nu):
        found[model.actuator(k).name, "ctrl"] = np.copy(data.ctrl[k])
    scene = world.scene
    for name in ("position", "velocity", "heading", "active", "goal", "radius"):
        found["scene", name] = getattr(scene, name)[0, :agents].copy()
    first = np.isin(world.people.agents, np.arange(agents))
    found["people", "ends"], found["people", "phase"] = world.people.ends[first], world.people.state.phase[first]
    found["robot", "frames"] = np.stack(list(world.robot_body(COUNT).frames().values()))
    return found


def assert_kept(before: dict[str, Any], after: dict[str, Any], removed: str = "") -> None:
    gone = {key for key in before.keys() - after.keys() if not (removed and key[0].startswith(removed))}
    assert not gone
    for key in before.keys() & after.keys():
        np.testing.assert_array_equal(before[key], after[key], err_msg=str(key))


def test_a_new_robot_changes_nothing_and_drives() -> None:
    world, alone = hall(), hall()
    before = state(world)
    agent = world.add_robot(CHAIR, 3.0, -6.0, 0.5)
    assert agent == COUNT + 1
    assert_kept(before, state(world))
    assert world.robot_body(agent).tilt < 0.05
    drive(world, 2, **{str(agent): Twist(0.4)})
    drive(alone, 2)
    for key, value in state(alone).items():  # far away, the new robot is felt by no more than rounding
        np.testing.assert_allclose(state(world)[key], value, atol=1e-6, err_msg=str(key))
    drive(world, 10, **{str(agent): Twist(0.4)})
    assert 0.05 < np.hypot(*(world.pose(agent).position[0] - (3.0, -6.0))) < 0.3
    assert world.twists[agent].forward[0] == pytest.approx(0.4, abs=0.1)


def test_removing_a_robot_returns_to_the_same_engine_model() -> None:
    world, alone = hall(), hall()
    agent = world.add_robot(BOT, 3.0, -6.0)
    before = state(world)
    world.remove_robot(agent)
    assert_kept(before, state(world), f"robot{agent}/")
    assert world.engine_model is alone.engine_model
    assert not world.scene.active[0, agent]
    for _ in range(6):
        drive(world, 1)
        drive(alone, 1)
        assert_kept(state(alone), state(world))
    with pytest.raises(InputError, match=rf"agent {agent} is not a robot that is present; present are \[{COUNT}\]"):
        world.remove_robot(agent)


def test_the_first_robot_can_go_and_its_command_is_ignored() -> None:
    world = hall()
    world.remove_robot(COUNT)
    place = world.scene.position[0, COUNT].copy()
    world.step({COUNT: Twist(1.0)})
    world.step({})
    np.testing.assert_array_equal(world.scene.position[0, COUNT], place)
    assert (world.robot_bodies, world.contacts, bool(world.scene.active[0, COUNT])) == ({}, (), False)
    assert not any(name.startswith("robot") for name in (world.engine_model.body(k).name for k in range(5)))
    other = hall()
    remove_person(other, COUNT)
    assert other.robot_bodies == {}


def test_people_walk_as_in_the_plane_after_all_robots_left() -> None:
    world = hall(stage=PhysicsStage(), steps=0)
    flat = PlanarWorld(world.scene, ORCA(), {COUNT: BOT.drive}, 0.05)
    world.remove_robot(COUNT)
    flat.remove_robot(COUNT)
    for _ in range(20):
        np.testing.assert_array_equal(world.step({}).position[0, :COUNT], flat.step({}).position[0, :COUNT])


def test_a_new_robot_pushes_people_and_is_seen() -> None:
    scene = Scene.of([[0.0, 0.0]], preferred_speed=0.0, max_speed=0.0)
    world = PhysicsWorld(scene, ORCA(), {}, 0.05)
    world.step({})
    agent = world.add_robot(CHAIR, -1.5, 0.0)
    pushed = 0.0
    for _ in range(60):
        world.step({agent: Twist(1.0)})
        pushed = max(pushed, sum(force.force for force in world.forces))
    assert pushed > 10.0
    assert world.scene.position[0, 0, 0] > 0.1
    assert agent in set(world.bodies().box_owner.tolist()) | set(world.bodies().owner.tolist())
    assert world.ids[0, agent] == 1


def test_a_ghost_can_come_and_go() -> None:
    world, alone = hall(), hall()
    agent = world.add_robot(CHAIR, 2.0, 0.2, np.pi, ghost=True)
    for _ in range(15):
        drive(world, 1, **{str(agent): Twist(0.6)})
        drive(alone, 1)
        assert_kept(state(alone), state(world))
    assert np.hypot(*(world.pose(agent).position[0] - (2.0, 0.2))) > 0.1
    assert not world.plane_scene().active[0, agent]
    world.remove_robot(agent)
    drive(world, 1)
    assert not world.scene.active[0, agent]


def test_props_come_and_go() -> None:
    world, alone = hall(), hall()
    before = state(world)
    name = world.add_prop(Cube(6.0, 6.0, size=0.5), "box")
    fixed = world.add_prop(Table(-6.0, -6.0))
    assert (name, fixed) == ("box", "prop3")
    assert_kept(before, state(world))
    assert world.prop(2)[2, 3] == pytest.approx(0.25, abs=1e-3)
    assert len(world.plane_scene().walls) == len(alone.plane_scene().walls) + 8
    drive(world, 2)
    drive(alone, 2)
    for key, value in state(alone).items():
        np.testing.assert_allclose(state(world)[key], value, atol=1e-6, err_msg=str(key))
    with pytest.raises(InputError, match="there is already a prop 'box'"):
        world.add_prop(Cube(0.0, 5.0), "box")
    with pytest.raises(InputError, match="there is no prop 'bok'; did you mean 'box'|there is no prop 'bok'"):
        world.remove_prop("bok")
    world.remove_prop("box")
    with pytest.raises(InputError, match="there is no prop 2"):
        world.prop(2)
    world.remove_prop("prop3")
    assert world.stage == alone.stage
    assert world.engine_model is alone.engine_model
    world.remove_prop("prop0")
    drive(world, 3)
    assert [type(prop).__name__ for prop in world.stage.props] == ["AbsentProp", "Table"]
    assert len(world.plane_scene().walls) == len(alone.plane_scene().walls) - 4


def test_a_new_prop_is_pushed_by_a_robot() -> None:
    world = hall(stage=PhysicsStage())
    x, y = world.pose(COUNT).position[0].tolist()
    heading = float(world.pose(COUNT).heading[0])
    world.add_prop(Cube(x + 0.5 * np.cos(heading), y + 0.5 * np.sin(heading), size=0.3, mass=1.0))
    first = world.prop(0)[:2, 3].copy()
    drive(world, 30)
    assert np.hypot(*(world.prop(0)[:2, 3] - first)) > 0.1
    assert world.contact_events


def test_a_person_beyond_the_bodies_gets_one() -> None:
    scene = Scene.of([[0.0, 0.0], [0.0, 3.0]], goal=[[0.0, 0.0], [0.0, 9.0]], external=[True, False])
    world = PhysicsWorld(scene, ORCA(), {0: BOT}, 0.05)
    for _ in range(5):
        world.step({0: Twist(0.2)})
    bodies = [*world.people.people.persons], world.people.ends.copy()
    place, joints = world.scene.position[0].copy(), world.robot_body(0).joints()
    qpos = {world.engine_model.joint(k).name: world.data.qpos[k] for k in range(1)}
    ids = [add_person(world, (0.6 + 0.1 * k, -0.7 * k), (-9.0, 0.0), 1.0, 0.25) for k in range(6)]
    assert ids == list(range(2, 8))
    assert world.people.people.persons[0] is bodies[0][0]
    np.testing.assert_array_equal(world.people.ends[0], bodies[1][0])
    np.testing.assert_array_equal(world.scene.position[0, :2], place)
    assert world.robot_body(0).joints() == joints
    assert qpos["robot0/base"] == world.data.qpos[0]
    assert world.rigid.slots >= 7
    for _ in range(12):
        world.step({0: Twist(0.2)})
    assert world.skipped_people == 0
    assert np.count_nonzero(world._people_bodies.agent >= 0) >= 2
    assert any(contact_event.second.kind == "person" for contact_event in world.contact_events)
    assert world.limbs().radius.shape == (1, 7 * 17)
    assert world.body_scene().bodies is not None


def test_growing_the_crowd_leaves_everybody_alone_to_the_last_bit() -> None:
    world, alone = hall(), hall()
    before = state(world)
    add_person(world, (40.0, 40.0), (50.0, 50.0), 1.0, 0.25)
    assert world.rigid.slots == COUNT + MORE
    assert_kept(before, state(world))
    for _ in range(10):
        drive(world, 1)
        drive(alone, 1)
        for name in ("position", "velocity"):
            np.testing.assert_allclose(
                getattr(world.scene, name)[0, : COUNT + 1], getattr(alone.scene, name)[0], atol=1e-6
            )


def batch(count: int = 3) -> Any:
    return join_worlds([hall(seed, 2) for seed in range(count)])


def test_robots_of_single_environments() -> None:
    world = batch()
    agent = world.add_robot(CHAIR, 3.0, -6.0, environments=[1])
    assert world.scene.active[:, agent].tolist() == [False, True, False]
    alone = hall(1, 2)
    assert alone.add_robot(CHAIR, 3.0, -6.0) == agent
    reference = hall(0, 2)
    commands = {COUNT: Twist(0.5, 0.1), agent: Twist(0.3)}
    for _ in range(4):
        world, errors = step_environments(world, commands)
        assert errors == {}
        alone.step(commands)
        drive(reference, 1)
    np.testing.assert_array_equal(world.environment_scene(1).position, alone.scene.position)
    np.testing.assert_array_equal(world.environment_scene(0).position[:, : COUNT + 1], reference.scene.position)
    assert world.twists[agent].forward[[0, 2]].tolist() == [0.0, 0.0]
    world.remove_robot(agent)
    assert not world.scene.active[:, agent].any()


def test_a_robot_is_moved_in_one_environment() -> None:
    world = batch()
    places = world.scene.position[:, COUNT].tolist()
    move_agent(world, COUNT, 6.0, 6.0, 0.5, 1)
    places[1] = [6.0, 6.0]
    assert world.scene.position[:, COUNT].tolist() == places
    assert world.scene.heading[1, COUNT] == 0.5
    assert world.twists[COUNT].forward[1] == 0.0
    world.step({COUNT: Twist()})
    np.testing.assert_allclose(world.scene.position[1, COUNT], [6.0, 6.0], atol=0.01)


def test_copies_and_new_environments_work_after_changes() -> None:
    world: Any = batch()
    agent = world.add_robot(CHAIR, 3.0, -6.0)
    world.add_prop(Cube(6.0, 6.0), "box")
    add_person(world, (5.0, 5.0), (0.0, 5.0), 1.0, 0.25, 2)
    commands = {COUNT: Twist(0.5, 0.1), agent: Twist(0.3)}
    world.step(commands)
    kept = select_environments(world, [2, 0])
    world.step(commands)
    kept.step(commands)
    for k, e in enumerate((2, 0)):
        np.testing.assert_array_equal(kept.environment_scene(k).position, world.environment_scene(e).position)
    put_environments(world, [1], hall(7, 0))
    world.step(commands)
    assert world.scene.active[:, agent].tolist() == [True, False, True]
    single = world.worlds[2].copy()
    assert single.engine_model is world.worlds[2].engine_model
    single.step(commands)
    world.remove_prop("box")
    world.step(commands)
    assert np.isfinite(world.scene.position).all()


def test_environments_of_a_trial_share_a_model_and_not_a_state() -> None:
    first, second = hall(0, 0), hall(1, 0)
    assert first.engine_model is second.engine_model
    assert first.data is not second.data
    both = join_worlds([hall(0, 0), hall(1, 0)])
    for _ in range(6):
        drive(both, 1)
    for e, alone in enumerate((hall(0, 6), hall(1, 6))):
        np.testing.assert_array_equal(both.environment_scene(e).position, alone.scene.position)
        np.testing.assert_array_equal(both.worlds[e].data.qpos, alone.data.qpos)


def test_changed_models_are_used_one_at_a_time() -> None:
    """Worlds that take turns have the results of worlds that do not."""
    turns, alone = [hall(0, 0), hall(1, 0)], []
    for _ in range(6):
        for world in turns:
            drive(world, 1)
    alone = [hall(0, 6), hall(1, 6)]
    for turn, two in zip(turns, alone, strict=True):
        assert_kept(state(turn), state(two))


def test_wrong_changes_are_explained_and_change_nothing() -> None:
    world = hall()
    before = state(world)
    bad: Any = BOT.drive
    with pytest.raises(InputError, match="robot is a DifferentialDrive; give a Robot"):
        world.add_robot(bad, 0.0, 0.0)
    with pytest.raises(InputError, match="x = nan, y = 0.0 m, heading = 0.0 rad"):
        world.add_robot(BOT, float("nan"), 0.0)
    with pytest.raises(InputError, match=r"environments = \[2\]: give each environment once, from 0 to 0"):
        world.add_robot(BOT, 0.0, 0.0, environments=[2])
    wheelless = Robot("stone", BOT.model, BOT.drive)
    with pytest.raises(InputError, match="has no driven wheels"):
        world.add_robot(wheelless, 0.0, 5.0)
    assert_kept(before, state(world))
    assert world.scene.shape == (1, COUNT + 1)
    drive(world, 1)
    assert world.clock.tick == 9


def test_planar_worlds_offer_the_same() -> None:
    scene = crowded(COUNT, BOT).replace(walls=WALL)
    world = PlanarWorld(scene, ORCA(), {COUNT: BOT.drive}, 0.05)
    edges = len(world.scene.walls)
    world.add_prop(Cube(5.0, 5.0), "box")
    table = world.add_prop(Table(0.0, 7.0))
    assert (table, len(world.scene.walls)) == ("prop1", edges + 8)
    world.remove_prop("box")
    assert len(world.scene.walls) == edges + 4
    agent = world.add_robot(BOT, 3.0, -6.0)
    drive(world, 3, **{str(agent): Twist(0.4)})
    assert world.pose(agent).position[0, 0] > 3.001
    world.remove_robot(agent)
    drive(world, 2)
    assert not world.scene.active[0, agent]
    world.remove_prop("prop1")
    np.testing.assert_array_equal(world.scene.walls.start, WALL.start)
    np.testing.assert_array_equal(world.scene.walls.next, WALL.next)
