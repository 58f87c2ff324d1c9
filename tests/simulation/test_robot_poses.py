"""Robots whose pose comes from a file, a function or orders, in both worlds."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError, TrialError
from crowdbot.recording import branch, open_run, read_episode, replay
from crowdbot.simulation import (
    AddElementOrder,
    AvatarOrder,
    MoveOrder,
    Order,
    RobotPoseOrder,
    Simulation,
    SimulationRun,
    VelocityOrder,
    apply_overrides,
    decode_state,
    encode_state,
    read_order,
    restore_state,
    state_of,
    write_order,
)
from crowdbot.trials import Trial, load_trial, parse_trial, trial_xml
from crowdbot.world import two_body_force

TOUR = """
import math
from dataclasses import dataclass
from crowdbot.humans import BodyPose, PoseSource

@dataclass(frozen=True)
class Tour(PoseSource):
    def at(self, time):
        return BodyPose(math.sin(time), 1.0 - math.cos(time), time)
"""
WORLDS = ("planar", "physics")


def text(pose: str, world: str = "planar", kind: str = "pepper", people: str = "", robot: str = "") -> str:
    return f"""<trial name="mirror" duration="2" world="{world}"><stage/><crowd type="orca"/>
{people or '<agent x="8" y="0.6" goal="-5,0.6"/>'}
<robot name="twin" type="{kind}" x="0" y="0" visible="false" default-sensors="false" {robot}>
<goal x="6" y="0"/>{pose}<navigator type="external"/></robot><end collision="false" goal="false"/></trial>"""


EXTERNAL = '<pose source="external"/>'
TRIALS = {world: parse_trial(text(EXTERNAL, world)) for world in WORLDS}


def sample(time: float, environment: int = 0, speed: float = 0.5, turn: float = 0.3) -> RobotPoseOrder:
    heading = turn * time
    y = 0.2 * environment * time
    return RobotPoseOrder(robot="twin", time=time, x=speed * time, y=y, heading=heading, environment=environment)


class Drive:
    """A source that gives the pose of the next step, at a rate that depends on the tick only."""

    def orders(self, simulation: Simulation) -> list[Order]:
        step = simulation.trial.step
        found: list[Order] = []
        for e, tick in enumerate(simulation.ticks.tolist()):
            if tick % 5 != 3:
                found += [sample((tick + k) * step, e) for k in (1.0, 0.4)]
        return found


@pytest.mark.parametrize("world", WORLDS)
def test_the_scene_has_the_pose_and_the_velocity_of_the_samples(world: str) -> None:
    trial = TRIALS[world]
    run = SimulationRun(Simulation(trial))
    for tick in range(1, 25):
        run.step([sample((tick + k) * trial.step) for k in (0.0, 1.0)])
        scene = run.simulation.world.scene
        assert scene.position[0, 1].tolist() == pytest.approx([0.5 * tick * trial.step, 0.0], abs=1e-12)
        assert scene.heading[0, 1] == pytest.approx(0.3 * tick * trial.step)
        assert scene.velocity[0, 1].tolist() == pytest.approx([0.5, 0.0])
        twist = run.simulation.world.twists[1].at(0)
        assert twist.turn == pytest.approx(0.3)
        assert math.hypot(twist.forward, twist.left) == pytest.approx(0.5)
        assert scene.external[0, 1]
    pose = run.simulation.world.pose(1)
    assert pose.position[0].tolist() == scene.position[0, 1].tolist()


def test_a_robot_keeps_its_velocity_and_turn_rate_until_the_timeout() -> None:
    trial = TRIALS["planar"]
    run = SimulationRun(Simulation(trial))
    run.step([sample(k * trial.step) for k in (0, 1, 2)])
    for _ in range(12):
        run.step()
        if run.simulation.tick == 6:
            assert run.simulation.world.twists[1].turn[0] == pytest.approx(0.3)
    scene = run.simulation.world.scene
    assert scene.position[0, 1, 0] == pytest.approx(0.5 * (0.1 + 0.25))
    assert scene.heading[0, 1] == pytest.approx(0.3 * (0.1 + 0.25))
    assert run.simulation.world.twists[1].turn[0] == 0.0


@pytest.mark.parametrize("kind", ["pepper", "turtlebot2", "wheelchair"])
def test_the_body_of_a_robot_is_where_its_pose_is(kind: str) -> None:
    """Bases that are pulled and bases on wheels, with their height above the floor."""
    trial = parse_trial(text(EXTERNAL, "physics", kind))
    run = SimulationRun(Simulation(trial))
    height = float(run.simulation.world.robot_bodies[1].frames()[run_root(run)][2, 3])  # type: ignore[attr-defined]
    for tick in range(1, 20):
        run.step([sample(tick * trial.step)])
    world = run.simulation.world
    body = world.robot_bodies[1]  # type: ignore[attr-defined]
    frame = body.frames()[body.robot.model.root]
    assert body.pose.position[0] == pytest.approx(world.scene.position[0, 1], abs=1e-9)
    assert body.pose.heading[0] == pytest.approx(float(world.scene.heading[0, 1]), abs=1e-9)
    assert frame[2, 3] == pytest.approx(height, abs=1e-6)
    assert body.tilt < 1e-6
    assert body.twist.forward[0] == pytest.approx(world.twists[1].forward[0], abs=1e-3)


def run_root(run: SimulationRun) -> str:
    root: str = run.simulation.world.robot_bodies[1].robot.model.root  # type: ignore[attr-defined]
    return root


@pytest.mark.parametrize(
    ("kind", "speed"), [("pepper", 0.5), ("wheelchair", 0.5), ("wheelchair", 1.0), ("cuybot", 1.0), ("qolo", 0.5)]
)
def test_a_mirrored_robot_hits_with_the_force_of_its_speed(kind: str, speed: float) -> None:
    """The first contact with a standing person has the two-body force at the speed of the robot, within 10 %."""
    trial = parse_trial(text(EXTERNAL, "physics", kind, people='<agent x="1.2" y="0" heading="0" body="man-36"/>'))
    run = SimulationRun(Simulation(trial))
    world = run.simulation.world
    for tick in range(1, 80):
        run.step([sample(tick * trial.step, speed=speed, turn=0.0)])
        if run.simulation.world.contact_events:
            break
    world = run.simulation.world
    (event,) = world.contact_events
    mass = world.robot_bodies[1].mass  # type: ignore[attr-defined]
    person = float(world.people.people.mass[0])  # type: ignore[union-attr]
    assert event.impact_speed == pytest.approx(speed, rel=0.1)
    assert event.peak_force == pytest.approx(two_body_force(speed, mass, event.region, person), rel=0.1)
    assert world.scene.position[0, 1, 0] == pytest.approx(speed * tick * trial.step)


@pytest.mark.parametrize("speed", [0.5, 1.0])
def test_a_tracked_person_hits_with_the_force_of_their_speed(speed: float) -> None:
    """A person whose whole skeleton is tracked slides against a standing robot: no leg swings."""
    person = '<avatar name="guide" source="external" x="1.4" y="0" heading="3.14159265" body="man-36"/>'
    trial = parse_trial(text("", "physics", "cuybot", people=person))
    run = SimulationRun(Simulation(trial))
    rest = [1.0, 0.0, 0.0, 0.0] * 28
    for tick in range(1, 80):
        time = tick * trial.step
        x = 1.4 - speed * time
        order = AvatarOrder(avatar="guide", time=time, x=x, y=0, heading=math.pi, skeleton=(x, 0.0, 0.95, *rest))
        run.step([order])
        if run.simulation.world.contact_events:
            break
    world = run.simulation.world
    (event,) = world.contact_events
    mass, own = world.robot_bodies[1].mass, float(world.people.people.mass[0])  # type: ignore
    assert event.impact_speed == pytest.approx(speed, rel=0.1)
    assert event.peak_force == pytest.approx(two_body_force(speed, mass, event.region, own), rel=0.1)


@pytest.mark.parametrize("world", WORLDS)
def test_a_mirrored_run_replays_branches_and_continues_to_the_byte(world: str, tmp_path: Path) -> None:
    trial = dataclasses.replace(TRIALS[world], duration=1.0)
    with open_run(trial, out=tmp_path / "one", sources=[Drive()]) as running:
        while running.outcome is None:
            running.step()
    path = tmp_path / "one" / "episode.mcap"
    assert replay(path).equal
    branch(path, at=0.5, out=tmp_path / "two")
    assert read_episode(tmp_path / "two" / "episode.mcap").digest == read_episode(path).digest
    first = SimulationRun(Simulation(trial), sources=[Drive()])
    for _ in range(9):
        first.step()
    second = Simulation(trial)
    restore_state(second, decode_state(encode_state(state_of(first.simulation))))
    runs = SimulationRun(first.simulation), SimulationRun(second)
    for tick in range(10, 16):
        for run in runs:
            run.step([sample(tick * trial.step)])
        for name in ("position", "velocity", "heading"):
            here, there = (getattr(run.simulation.world.scene, name) for run in runs)
            np.testing.assert_array_equal(here, there)


@pytest.mark.parametrize("world", WORLDS)
def test_environments_are_those_of_single_runs(world: str) -> None:
    trial = TRIALS[world]
    many = SimulationRun(Simulation(trial, range(3)), sources=[Drive()])
    alone = SimulationRun(Simulation(trial, 2))
    for tick in range(8):
        many.step()
        orders = [sample((tick + k) * trial.step, 2) for k in (1.0, 0.4)] if tick % 5 != 3 else []
        alone.step([dataclasses.replace(order, environment=0) for order in orders])
    scenes = many.simulation.world.environment_scene(2), alone.simulation.world.scene
    np.testing.assert_array_equal(scenes[0].position, scenes[1].position)
    np.testing.assert_array_equal(scenes[0].velocity, scenes[1].velocity)


def test_a_file_moves_a_robot_and_belongs_to_the_episode(tmp_path: Path) -> None:
    rows = "".join(f"{0.5 * k},{0.25 * k},1,0.1\n" for k in range(8))
    (tmp_path / "drive.csv").write_text("time,x,y,heading\n" + rows)
    pose = '<pose source="file" file="drive.csv"/>'
    (tmp_path / "t.xml").write_text(text(pose).replace('x="0" y="0"', 'x="0" y="1" heading="0.1"'))
    trial = load_trial(tmp_path / "t.xml")
    assert parse_trial(trial_xml(trial), folder=tmp_path) == trial
    with open_run(trial, out=tmp_path / "elsewhere" / "one") as running:
        running.advance()
        assert running.simulation.world.scene.position[0, 1].tolist() == pytest.approx([1.0, 1.0])
    (tmp_path / "drive.csv").unlink()
    assert replay(tmp_path / "elsewhere" / "one" / "episode.mcap").equal


def test_a_function_moves_a_robot_and_its_code_is_needed_for_a_replay(tmp_path: Path) -> None:
    (tmp_path / "tour.py").write_text(TOUR)
    (tmp_path / "t.xml").write_text(text('<pose source="function" function="tour.py:Tour"/>'))
    trial = load_trial(tmp_path / "t.xml")
    with open_run(trial, out=tmp_path / "one") as running:
        running.advance()
        scene = running.simulation.world.scene
    now = trial.ticks * trial.step
    assert scene.position[0, 1] == pytest.approx([math.sin(now), 1.0 - math.cos(now)])
    path = tmp_path / "one" / "episode.mcap"
    with pytest.raises(InputError, match="needs the code"):
        replay(path)
    assert replay(path, trust=True).equal


@pytest.mark.parametrize("world", WORLDS)
def test_nothing_is_touched_on_the_way_of_a_teleport(world: str) -> None:
    trial = parse_trial(text(EXTERNAL, world, people='<agent x="2" y="0" heading="3"/>'))
    run = SimulationRun(Simulation(trial))
    run.step([RobotPoseOrder(robot="twin", time=0.0, x=0, y=0)])
    run.step([RobotPoseOrder(robot="twin", time=0.1, x=4, y=0, heading=3.0)])
    for _ in range(3):
        run.step()
        assert run.simulation.contacts() == ()
    scene = run.simulation.world.scene
    assert scene.position[0, 1].tolist() == [4.0, 0.0]
    assert scene.velocity[0, 1].tolist() == [0.0, 0.0]


def test_a_ghost_is_mirrored_without_contacts() -> None:
    trial = parse_trial(text(EXTERNAL, "physics", people='<agent x="0.6" y="0"/>', robot='ghost="true"'))
    run = SimulationRun(Simulation(trial))
    for tick in range(1, 20):
        run.step([sample(tick * trial.step)])
    world = run.simulation.world
    assert world.contact_events == ()
    assert world.robot_bodies[1].pose.position[0] == pytest.approx(world.scene.position[0, 1])  # type: ignore


def test_orders_round_trip_and_are_checked() -> None:
    order = sample(0.1)
    assert read_order(write_order(order)) == order
    simulation = Simulation(TRIALS["planar"])
    wrong: list[tuple[Order, str]] = [
        (RobotPoseOrder(robot="twinn", x=0, y=0), "there is no robot 'twinn'"),
        (RobotPoseOrder(robot="twin", x=0, y=0, time=11.0), "more than 10 s after the current 0 s"),
        (MoveOrder(person=1, x=0.0, y=0.0), "1 is the id of robot 'twin', whose pose comes from its source"),
        (VelocityOrder(robot="twin", forward=1.0), "robot 'twin' has <pose>; it is where its source says"),
    ]
    for item, message in wrong:
        with pytest.raises(InputError, match=message):
            item.check(simulation)
    with pytest.raises(InputError, match="x = nan must be a finite number"):
        RobotPoseOrder(robot="twin", x=math.nan, y=0.0)
    with pytest.raises(InputError, match="time = inf must be a finite number of seconds"):
        RobotPoseOrder(robot="twin", x=0.0, y=0.0, time=math.inf)
    free = Simulation(parse_trial(text("")))
    with pytest.raises(InputError, match="robot 'twin' does not take poses; add <pose"):
        sample(0.1).check(free)
    xml = text(EXTERNAL).split("<robot")[1].split("</robot>")[0].replace("twin", "other").replace('x="0"', 'x="3"', 1)
    with pytest.raises(InputError, match="only robots of the start can be moved from outside"):
        AddElementOrder(parent="", xml=f"<robot{xml}</robot>").check(simulation)


def test_a_pose_cannot_change_in_a_branch() -> None:
    trial: Trial = TRIALS["planar"]
    simulation = Simulation(trial)
    robot = dataclasses.replace(trial.robots[0], pose=None)
    with pytest.raises(InputError, match="pose of robot 'twin' cannot change in a branch"):
        apply_overrides(simulation, dataclasses.replace(trial, robots=(robot,)))


@pytest.mark.parametrize(
    ("pose", "message"),
    [
        ('<pose source="file"/>', 'source="file" needs the attribute file'),
        ('<pose source="external" file="far.csv"/>', 'needs source="file"'),
        ('<pose source="file" file="../a.csv"/>', "lies outside"),
        ('<pose source="file" file="far.csv"/>', 'its pose begins elsewhere; write x="3" y="1" heading="0"'),
        ('<pose source="file" file="bad.csv"/>', "bad.csv:2: x = 'far' must be a finite number"),
        ('<pose source="function" function="tour.py:Trip"/>', "is not a concrete PoseSource"),
        ('<pose source="radio"/>', "must be file or function or external"),
    ],
)
def test_wrong_poses_are_refused(pose: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "tour.py").write_text(TOUR)
    (tmp_path / "bad.csv").write_text("time,x,y\n0,far,0\n")
    (tmp_path / "far.csv").write_text("time,x,y\n0,3,1\n")
    (tmp_path / "t.xml").write_text(text(pose))
    with pytest.raises(TrialError) as told:
        load_trial(tmp_path / "t.xml")
    assert message in str(told.value)


def test_a_navigator_does_not_move_a_mirrored_robot() -> None:
    with pytest.raises(TrialError, match='has <pose>, so no navigator moves it; take <navigator type="external"/>'):
        parse_trial(text(EXTERNAL).replace('type="external"/></robot>', 'type="straight"/></robot>'))
