"""Drag and kinematic links of robots, and robot files that extend a built-in robot."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError, RobotError, Scene, Twist
from crowdbot.models import ORCA
from crowdbot.world import PhysicsWorld, Robot

URDF = """<robot name="probe">
<link name="base"><inertial><mass value="30"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 0.3"/><geometry><box size="0.4 0.4 0.4"/></geometry></collision></link>
<link name="slider"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
</link>
<joint name="slide" type="prismatic"><parent link="base"/><child link="slider"/><origin xyz="0 0 0.6"/>
<axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="0" velocity="5"/></joint>
<link name="fan"><inertial><mass value="0.5"/><inertia ixx="0.2" iyy="0.2" izz="0.2" ixy="0" ixz="0" iyz="0"/>
</inertial></link>
<joint name="spin" type="continuous"><parent link="base"/><child link="fan"/><origin xyz="0 0 0.8"/>
<axis xyz="0 0 1"/></joint>
<link name="arm"><inertial><mass value="0.5"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
</inertial><collision><origin xyz="0.5 0 0"/><geometry><box size="0.6 0.05 0.05"/></geometry></collision></link>
<joint name="swing" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 1.1"/>
<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="5" velocity="1"/></joint></robot>"""


def probe(folder: Path, links: str, **attributes: str) -> Robot:
    folder.mkdir(exist_ok=True)
    (folder / "probe.urdf").write_text(URDF)
    (folder / "robot.xml").write_text(
        f'<robot name="probe" urdf="probe.urdf" base="planar"><drive type="omnidirectional"/>{links}</robot>'
    )
    return Robot.load(folder)


def world_of(robot: Robot, **how: Any) -> PhysicsWorld:
    people = how.pop("people", [[9.0, 9.0]])
    scene = Scene.of([[0.0, 0.0], *people], external=[True, *[False] * len(people)])
    return PhysicsWorld(scene, ORCA(), {0: robot}, dt=0.05, motors={0: {"swing": "position"}}, **how)


def let_go(world: PhysicsWorld, seconds: float, **speeds: float) -> dict[str, float]:
    """Return the speeds of joints after some time, from given speeds."""
    for name, speed in speeds.items():
        joint = world.engine_model.joint(f"robot0/{name}")
        world.data.qvel[joint.dofadr[0]] = speed
    for _ in range(round(seconds / world.dt)):
        world.step({0: Twist()})
    return {name: world.robot_bodies[0].joints()[name][1] for name in speeds}


def test_speeds_decay_with_the_drag_of_their_link(tmp_path: Path) -> None:
    links = '<link name="slider" drag="2"/><link name="fan" angular-drag="1.5"/>'
    found = let_go(world_of(probe(tmp_path, links)), 0.5, slide=0.5, spin=3.0)
    assert found["slide"] == pytest.approx(0.5 * math.exp(-1.0), rel=0.02)
    assert found["spin"] == pytest.approx(3.0 * math.exp(-0.75), rel=0.02)
    free = let_go(world_of(probe(tmp_path / "free", "")), 0.5, slide=0.5, spin=3.0)
    assert free["slide"] == pytest.approx(0.5, rel=0.02)
    assert free["spin"] == pytest.approx(3.0, rel=0.02)


def test_a_large_drag_is_stable_and_ghosts_have_it_too(tmp_path: Path) -> None:
    robot = probe(tmp_path, '<link name="slider" drag="1000"/>')
    assert abs(let_go(world_of(robot), 0.2, slide=0.5)["slide"]) < 1e-3
    ghost = world_of(robot, ghosts=[0])
    joint = ghost.rigid.ghosts[0].compiled.base.joint("robot0/slide")
    ghost.rigid.ghosts[0].data.qvel[joint.dofadr[0]] = 0.5
    for _ in range(4):
        ghost.step({0: Twist()})
    assert abs(ghost.robot_bodies[0].joints()["slide"][1]) < 1e-3


def test_a_kinematic_arm_moves_at_its_speed_through_what_stops_a_dynamic_one(tmp_path: Path) -> None:
    """A person stands in the way of an arm whose motor is too weak to move the person quickly."""
    person = [[0.45, 0.45]]
    angles, pushed = [], []
    for number, links in enumerate(("", '<link name="arm" kinematic="true"/>')):
        world = world_of(probe(tmp_path / str(number), links), people=person)
        start = world.scene.position[0, 1].copy()
        world.command(0, {"swing": 1.6})
        for _ in range(20):
            world.step({0: Twist()})
        angles.append(world.robot_bodies[0].joints()["swing"][0])
        pushed.append(float(np.linalg.norm(world.scene.position[0, 1] - start)))
    assert angles[1] == pytest.approx(1.0, abs=0.01)
    assert angles[0] < angles[1] - 0.1
    assert pushed[1] > pushed[0]


@pytest.mark.parametrize(
    ("links", "message"),
    [
        ('<link name="slidr" drag="1"/>', "name='slidr' is not a link of the robot, did you mean 'slider'"),
        ('<link name="slider" drag="-1"/>', "drag = -1.0 1/s must be finite and at least 0"),
        ('<link name="slider" drag="much"/>', "drag"),
        ('<link name="slider" dragg="1"/>', "dragg"),
        ('<link drag="1"/>', "name"),
        ('<link name="base" kinematic="true"/>', "it is the root of the robot"),
    ],
)
def test_wrong_links_are_refused(links: str, message: str, tmp_path: Path) -> None:
    with pytest.raises((RobotError, InputError)) as told:
        probe(tmp_path, links)
    assert message in str(told.value)


def test_a_robot_file_extends_a_built_in_robot(tmp_path: Path) -> None:
    (tmp_path / "robot.xml").write_text(
        """<robot extends="turtlebot2" about="slow">
        <drive type="differential-drive" max-speed="0.2"/>
        <sensor name="laser" type="lidar-2d" z="0.3" rays="11"/><sensor name="more" type="imu"/></robot>"""
    )
    mine, own = Robot.load(tmp_path), Robot.load("turtlebot2")
    assert (mine.name, mine.about) == (tmp_path.name, "slow")
    assert mine.drive.max_speed == 0.2  # type: ignore[attr-defined]
    assert mine.model.mass == own.model.mass
    assert [wheel.joint for wheel in mine.wheels] == [wheel.joint for wheel in own.wheels]
    assert sorted(mount.name for mount in mine.mounts) == sorted([*(mount.name for mount in own.mounts), "more"])
    assert next(mount.sensor for mount in mine.mounts if mount.name == "laser").rays == 11  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        ('extends="turtelbot2"', "extends='turtelbot2' is not a built-in robot, did you mean 'turtlebot2'"),
        ('extends="../secret"', "is not a built-in robot"),
        ('extends="pepper" rider="adult"', "needs a seat"),
    ],
)
def test_wrong_extensions_are_refused(attributes: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "robot.xml").write_text(f"<robot {attributes}/>")
    with pytest.raises(RobotError) as told:
        Robot.load(tmp_path)
    assert message in str(told.value)


def test_a_joint_without_a_motor_moves_to_its_target_and_hits_with_its_speed(tmp_path: Path) -> None:
    robot = probe(tmp_path, "")
    scene = Scene.of([[0.0, 0.0], [0.45, 0.45]], external=[True, False])
    world = PhysicsWorld(scene, ORCA(), {0: robot}, dt=0.05)
    world.robot_bodies[0].hold("swing", 1.6)
    found = []
    for _ in range(40):
        world.step({0: Twist()})
        found.append(world.robot_bodies[0].joints()["swing"])
    assert found[1] == pytest.approx((0.1, 1.0), abs=0.01)  # at the 1 rad/s of its limit
    assert found[-1] == pytest.approx((1.6, 0.0), abs=1e-6)
    assert any(event.impact_speed > 0.3 for event in world.contact_events)
