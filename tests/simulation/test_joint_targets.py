"""Joints that follow the trial or a navigator, and arms that are felt."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError, TrialError, Twist
from crowdbot.navigation import Action, Navigator, Observation, check_navigator
from crowdbot.recording import branch, open_run, read_episode, replay
from crowdbot.simulation import Simulation, SimulationRun
from crowdbot.trials import Trial, joint_positions, load_trial, parse_trial, trial_xml
from crowdbot.trials.robot import JointTarget
from crowdbot.world import free_joints

WORLDS = ("planar", "physics")
NOD = """
from dataclasses import dataclass
from crowdbot.core import Twist
from crowdbot.navigation import Action, Navigator

@dataclass(frozen=True)
class Nod(Navigator):
    far: float = 0.4
    def begin(self, observation):
        return 0
    def act(self, observation, memory):
        position = self.far if memory % 2 else -self.far
        return Action(Twist(0.2), {"HeadYaw": position}), memory + 1
"""


@dataclasses.dataclass(frozen=True)
class Point(Navigator):
    """Turns a joint to a position."""

    joint: str = "HeadYaw"
    position: Any = 0.5

    def act(self, observation: Observation, memory: Any) -> Any:
        return Action(Twist(0.1), {self.joint: self.position}), memory


def text(world: str = "planar", robot: str = "", people: str = "", navigator: str = "") -> str:
    return f"""<trial name="lab" duration="1.2" step="0.04" world="{world}"><stage/><crowd type="orca"/>
{people or '<agent x="8" y="0" goal="8,1"/>'}
<robot name="pepper" type="pepper" x="0" y="0" default-sensors="false" control-period="0.08" visible="false">
<goal x="9" y="0"/>{navigator or '<navigator type="external"/>'}{robot}</robot>
<end collision="false" goal="false"/></trial>"""


def with_navigator(navigator: Navigator, world: str = "planar") -> Trial:
    trial = parse_trial(text(world))
    return dataclasses.replace(trial, robots=(dataclasses.replace(trial.robots[0], navigator=navigator),))


def target(simulation: Simulation, joint: str, environment: int = 0) -> float:
    control = simulation.robots[0]
    return float(control.joints[environment, free_joints(control.robot.body).index(joint)])


def angle(simulation: Simulation, joint: str) -> float:
    """Return where a joint is in the world [rad]."""
    world: Any = simulation.world
    if world.walls_fixed:
        result: float = world.robot_bodies[1].joints()[joint][0]
        return result
    return float(world._bodies[0].joints[1][joint])


@pytest.mark.parametrize("world", WORLDS)
def test_a_joint_follows_the_targets_of_the_trial(world: str) -> None:
    joints = '<joint name="HeadYaw" target="0.8" at="0.2" over="0.2"/><joint name="HeadYaw" target="-0.4" at="0.8"/>'
    simulation = Simulation(parse_trial(text(world, joints)), posed=True)
    run = SimulationRun(simulation)
    found = []
    while run.outcome is None:
        run.step()
        found.append((simulation.tick * 0.04, target(simulation, "HeadYaw"), simulation))
    seen = {round(time, 2): value for time, value, _ in found}
    assert math.isnan(seen[0.16])
    assert seen[0.2] == pytest.approx(0.0)
    assert seen[0.28] == pytest.approx(0.32)
    assert seen[0.4] == 0.8
    assert seen[0.76] == 0.8
    assert seen[0.8] == -0.4
    assert angle(simulation, "HeadYaw") == pytest.approx(-0.4, abs=1e-6 if world == "planar" else 0.05)


@pytest.mark.parametrize("world", WORLDS)
def test_a_navigator_moves_joints_within_their_limits(world: str) -> None:
    simulation = Simulation(with_navigator(Point(position=0.5), world), posed=True)
    for _ in range(20):
        simulation.advance()
    assert simulation.failures == [None]
    assert target(simulation, "HeadYaw") == 0.5
    assert angle(simulation, "HeadYaw") == pytest.approx(0.5, abs=1e-6 if world == "planar" else 0.05)
    assert simulation.world.twists[1].forward[0] > 0.05
    far = Simulation(with_navigator(Point(position=99.0), world))
    far.advance()
    upper = far.robots[0].robot.body.model.joints["HeadYaw"].upper
    assert target(far, "HeadYaw") == upper


@pytest.mark.parametrize(
    ("navigator", "message"),
    [
        (
            Point("HeadYow"),
            "Point of robot 'pepper': pepper has no joint 'HeadYow' .* did you mean 'HeadYaw'",
        ),
        (Point("WheelB"), "has no joint 'WheelB' that can be moved"),
        (Point(position=math.nan), "returned the target nan for joint 'HeadYaw'; it must be a finite number"),
        (Point(position="up"), "returned the target 'up' for joint 'HeadYaw'"),
        (Point(position=True), "returned the target True for joint 'HeadYaw'"),
    ],
)
def test_wrong_targets_of_a_navigator_end_its_run(navigator: Navigator, message: str) -> None:
    simulation = Simulation(with_navigator(navigator))
    simulation.advance()
    with pytest.raises(Exception, match=message):
        raise InputError(str(simulation.failures[0]))


def test_joints_must_be_a_mapping_and_the_contract_check_accepts_them() -> None:
    check_navigator(Point())

    @dataclasses.dataclass(frozen=True)
    class Wrong(Navigator):
        def act(self, observation: Observation, memory: Any) -> Any:
            return Action(Twist(), [1.0]), memory  # type: ignore[arg-type]

    with pytest.raises(InputError, match=r"navigator Wrong returned joints = \[1.0\]; they must be a mapping"):
        check_navigator(Wrong())


@pytest.mark.parametrize("world", WORLDS)
def test_runs_with_moving_joints_replay_branch_and_match_single_environments(world: str, tmp_path: Path) -> None:
    (tmp_path / "nod.py").write_text(NOD)
    joints = '<joint name="LShoulderPitch" target="0.2" at="0.1" over="0.5"/>'
    (tmp_path / "t.xml").write_text(text(world, joints, navigator='<navigator type="nod.py:Nod"/>'))
    trial = load_trial(tmp_path / "t.xml")
    assert parse_trial(trial_xml(trial), folder=tmp_path) == trial
    with open_run(trial, out=tmp_path / "one") as running:
        running.advance()
    path = tmp_path / "one" / "episode.mcap"
    assert replay(path, trust=True).equal
    branch(path, at=0.6, out=tmp_path / "two", trust=True)
    assert read_episode(tmp_path / "two" / "episode.mcap").digest == read_episode(path).digest
    many, alone = Simulation(trial, range(3)), Simulation(trial, 2)
    for _ in range(8):
        many.advance()
        alone.advance()
    np.testing.assert_array_equal(many.robots[0].joints[2], alone.robots[0].joints[0])
    assert target(many, "HeadYaw", 2) == target(alone, "HeadYaw")
    copy = many.select([2])
    copy.advance()
    alone.advance()
    np.testing.assert_array_equal(copy.robots[0].joints, alone.robots[0].joints)


def test_an_arm_is_felt_by_a_person_beside_the_robot() -> None:
    """The left arm swings outwards into a person who stands beside the robot, which stands."""
    joints = """<joint name="LShoulderPitch" target="0.2" at="0"/><joint name="LElbowRoll" target="-0.01" at="0"/>
    <joint name="LShoulderRoll" target="1.5" at="0.6" over="0.3"/>"""
    person = '<agent x="0.1" y="0.72" heading="0" body="man-36"/>'
    trial = parse_trial(text("physics", joints, person))
    still = parse_trial(text("physics", "", person))
    runs = [SimulationRun(Simulation(item)) for item in (trial, still)]
    touched: set[str] = set()
    for run in runs:
        while run.outcome is None:
            run.step()
            touched |= {force.first_part for force in run.simulation.world.forces}
    (event,) = runs[0].simulation.world.contact_events
    assert runs[1].simulation.world.contact_events == ()
    assert event.impact_speed > 0.3
    assert event.peak_force > 50.0
    assert any(part.startswith(("l_", "L")) for part in touched), touched


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ('name="HeadYow" target="0"', "pepper has no joint 'HeadYow' that can be moved, did you mean 'HeadYaw'"),
        ('name="HeadYaw" target="9"', "the joint 'HeadYaw' of pepper cannot be at 9 rad"),
        ('name="HeadYaw" target="0" at="-1"', "must be at least 0 s"),
        ('name="HeadYaw"', "needs the attribute 'target'"),
        ('name="HeadYaw" target="1" over="2"/><joint name="HeadYaw" target="0" at="1"', "begins before the one before"),
    ],
)
def test_wrong_joints_are_refused(joint: str, message: str) -> None:
    with pytest.raises(TrialError) as told:
        parse_trial(text(robot=f"<joint {joint}/>"))
    assert message in str(told.value)


def test_positions_are_reached_at_the_end_of_a_motion() -> None:
    targets = [JointTarget(name="a", target=2.0, at=0.15, over=0.1), JointTarget(name="a", target=0.0, at=0.3)]
    step = 100_000_000
    rows = [joint_positions(targets, {"a": 1.0}, k * step - step, k * step) for k in range(5)]
    assert rows[:2] == [{}, {}]
    assert rows[2] == {"a": pytest.approx(1.5)}
    assert rows[3] == {"a": 0.0}
    assert rows[4] == {}
