"""A robot is a folder with a URDF and a robot.xml: what is read, what is refused."""

import dataclasses
import shutil

import numpy as np
import pytest
from robot_texts import BALL, joint, link, robot

from crowdbot.cli import main
from crowdbot.core import InputError, Pose, RobotError
from crowdbot.sensors import Gaussian, Lidar2D, preset
from crowdbot.world import AckermannDrive, Robot, SensorMount, VelocityServo, Wheel, read_urdf

URDF = robot(
    link("base", BALL.format(radius=0.3)),
    link("head"),
    link("wheel"),
    joint(
        "neck", "revolute", "base", "head", "<origin xyz='0.1 0 1'/><axis xyz='0 0 1'/><limit lower='-1' upper='1'/>"
    ),
    joint("axle", "continuous", "base", "wheel", "<axis xyz='0 1 0'/>"),
)
DRIVE = '<drive type="velocity-servo" max-speed="0.7" latency="0.15"/>'


def folder(tmp_path, *parts, head='name="mine" urdf="mine.urdf"', urdf=URDF):
    (tmp_path / "mine.urdf").write_text(urdf)
    (tmp_path / "robot.xml").write_text("\n".join([f"<robot {head}>", *parts, "</robot>"]))
    return tmp_path


def test_everything_in_the_file_is_read(tmp_path):
    parts = (
        DRIVE,
        '<footprint points="0.4,0.3 -0.4,0.3 -0.4,-0.3 0.4,-0.3"/>',
        '<wheel joint="axle" radius="0.1"/>',
        '<posture joint="neck" position="0.5"/>',
        '<sensor name="eye" type="lidar-2d" link="head" x="0.1" z="0.2" yaw="1" rays="90" noise="gaussian(0.02)"/>',
        '<sensor name="foot" type="lidar2d" rate="20"/>',
    )
    mine = Robot.load(folder(tmp_path, *parts, head='name="mine" urdf="mine.urdf" about="A test" base="planar"'))
    assert (mine.name, mine.about, mine.base, mine.latency) == ("mine", "A test", "planar", 0.15)
    assert mine.drive == VelocityServo(max_speed=0.7)
    assert mine.footprint.shape == (4, 2)
    assert mine.radius == pytest.approx(0.5)
    assert mine.wheels == (Wheel("axle", 0.1),)
    assert mine.posture == {"neck": 0.5}
    eye = mine.mount("eye")
    assert eye == SensorMount("eye", Lidar2D(rays=90, noise=Gaussian(0.02)), "head", x=0.1, z=0.2, yaw=1.0)
    np.testing.assert_allclose(mine.sensor_frame("eye")[:3, 3], [0.1 + 0.1 * np.cos(0.5), 0.1 * np.sin(0.5), 1.2])
    here = Pose.of((0.0, 0.0), 0.0)
    assert mine.sensor_pose("eye", here).heading[0] == pytest.approx(1.5)
    assert mine.sensor_pose("foot", here).planar.position.tolist() == [[0.0, 0.0]]
    assert Robot.load(tmp_path / "robot.xml").drive == mine.drive


def test_without_a_footprint_the_colliders_give_it(tmp_path):
    mine = Robot.load(folder(tmp_path, DRIVE))
    assert mine.radius == pytest.approx(0.3, abs=1e-3)
    assert (mine.latency, mine.base, mine.mounts) == (0.15, "wheels", ())


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ((), "robot.xml:1: <robot> needs the element <drive type=...>"),
        ((DRIVE, DRIVE), "robot.xml:3: <drive> occurs more than once in <robot>"),
        (("<drive/>",), "<drive> needs the attribute 'type': ackermann"),
        (('<drive type="diferential-drive"/>',), "did you mean 'differential-drive'?"),
        (
            ('<drive type="differential-drive" max-sped="1"/>',),
            "has no attribute 'max-sped', did you mean 'max-speed'?",
        ),
        (
            ('<drive type="differential-drive" max-speed="-1"/>',),
            "max_speed = -1.0 m/s must be finite and above 0 m/s",
        ),
        (('<drive type="differential-drive" latency="-1"/>',), 'latency="-1" must be at least 0 s'),
        ((DRIVE, "<lidar/>"), "robot.xml:3: <lidar> is not an element of <robot>; it accepts drive, footprint, sensor"),
        ((DRIVE, '<sensor type="lidar-2d"/>'), "robot.xml:3: <sensor> needs the attribute 'name'"),
        ((DRIVE, '<sensor name="s" type="sonar"/>'), "robot.xml:3: <sensor> unknown sensor 'sonar'"),
        ((DRIVE, '<sensor name="s" type="lidar-2d" x="near"/>'), 'x="near" is not a number'),
        ((DRIVE, '<sensor name="s" type="lidar-2d" rays="0"/>'), "rays = 0 must be a whole number of at least 1"),
        (
            (DRIVE, '<sensor name="s" type="lidar-2d" link="hed"/>'),
            "<sensor> link='hed' is not a link of the robot, did you mean 'head'?",
        ),
        (
            (DRIVE, *['<sensor name="s" type="lidar-2d"/>'] * 2),
            "robot.xml:4: <sensor> name 's' is already used by another sensor",
        ),
        (
            (DRIVE, '<wheel joint="axel" radius="0.1"/>'),
            "robot.xml:3: <wheel> joint='axel' is not a rotating joint, did you mean 'axle'?",
        ),
        ((DRIVE, '<wheel joint="axle" radius="0"/>'), 'radius="0" must be above 0'),
        ((DRIVE, '<wheel joint="axle"/>'), "<wheel> needs the attribute 'radius', a number"),
        (
            (DRIVE, '<posture joint="nek" position="1"/>'),
            "robot.xml:3: <posture> joint='nek' is not a joint of the robot, did you mean 'neck'?",
        ),
        ((DRIVE, *['<posture joint="neck" position="1"/>'] * 2), "gives the posture of a joint twice"),
        ((DRIVE, "<footprint/>"), "<footprint> needs either points or radius"),
        ((DRIVE, '<footprint points="0,0 1,1"/>'), "must be at least 3 points x,y"),
        ((DRIVE, '<footprint points="0,0 1,x 2,2"/>'), "is not a number"),
        ((DRIVE, '<footprint radius="-1"/>'), 'radius="-1" must be above 0'),
    ],
)
def test_what_is_wrong_is_said(tmp_path, parts, message):
    with pytest.raises(RobotError) as caught:
        Robot.load(folder(tmp_path, *parts))
    assert message in str(caught.value)
    assert "robot.xml" in str(caught.value)


@pytest.mark.parametrize(
    ("head", "message"),
    [
        ('name="m"', "needs the attribute 'urdf'"),
        ('urdf="absent.urdf"', "there is no URDF file"),
        ('urdf="../mine.urdf"', "is outside the robot folder"),
        ('urdf="/etc/passwd"', "is outside the robot folder"),
        ('urdf="mine.urdf" base="legs"', "base = 'legs' must be wheels or planar"),
        ('urdf="mine.urdf" wheels="4"', "has no attribute 'wheels'"),
    ],
)
def test_a_wrong_head_is_said(tmp_path, head, message):
    with pytest.raises(RobotError) as caught:
        Robot.load(folder(tmp_path, DRIVE, head=head))
    assert message in str(caught.value)


def test_problems_of_both_files_come_together(tmp_path):
    place = folder(tmp_path, "<drive type='x'/>", urdf=robot(link("a", mass=-1)))
    with pytest.raises(RobotError) as caught:
        Robot.load(place)
    assert len(caught.value.problems) == 2
    assert "mine.urdf:2: <mass>" in str(caught.value)


def test_no_mistake_hides_another(tmp_path):
    parts = (
        '<drve type="differential-drive" max-speed="-1"/>',
        '<sensor name="s" type="lidar-2d" link="hed" rays="0"/>',
        '<sensor name="s" type="lidar-2d"/>',
        '<wheel joint="axel" raduis="0.1"/>',
        '<posture joint="nek" position="up"/>',
    )
    with pytest.raises(RobotError) as caught:
        Robot.load(folder(tmp_path, *parts, head='urdf="mine.urdf" base="legs"'))
    lines = [int(problem.split("robot.xml:")[1].split(":")[0]) for problem in caught.value.problems]
    assert lines == [1, 2, 2, 3, 3, 4, 5, 5, 6, 6], caught.value.problems


def test_an_entity_bomb_is_refused(tmp_path):
    folder(tmp_path, DRIVE)
    (tmp_path / "robot.xml").write_text('<!DOCTYPE robot [<!ENTITY a "b">]><robot name="&a;"/>')
    with pytest.raises(RobotError, match="robot.xml:1: a robot must not have a DOCTYPE or entities"):
        Robot.load(tmp_path)


def test_names_that_are_no_robot(tmp_path):
    for name, message in (
        ("peper", "there is no robot 'peper', did you mean 'pepper'?"),
        (tmp_path, "has no robot.xml; a robot is a folder with a URDF and a robot.xml"),
        (tmp_path / "x.urdf", "does not define drive and sensors"),
    ):
        with pytest.raises(RobotError) as caught:
            Robot.load(name)
        assert message in str(caught.value)


def test_code_from_outside_the_folder_needs_trust(tmp_path):
    body = (
        "from dataclasses import dataclass\nfrom crowdbot.world import DifferentialDrive\n"
        "@dataclass(frozen=True)\nclass Slow(DifferentialDrive):\n    '''Slow.'''\n    max_speed: float = 0.1\n"
    )
    inside, outside = tmp_path / "robot", tmp_path / "slow_outside.py"
    inside.mkdir()
    outside.write_text(body)
    (inside / "slow_inside.py").write_text(body)
    assert Robot.load(folder(inside, '<drive type="slow_inside.py:Slow"/>')).drive.max_speed == 0.1
    place = folder(inside, '<drive type="../slow_outside.py:Slow"/>')
    with pytest.raises(RobotError, match="lies outside"):
        Robot.load(place)
    assert Robot.load(place, trust=True).drive.max_speed == 0.1


def test_robots_can_be_made_in_python():
    model = read_urdf(URDF)
    mine = Robot("mine", model, AckermannDrive())
    assert dataclasses.replace(mine, latency=0.2).latency == 0.2
    for values, message in (
        ({"latency": -1.0}, "latency = -1.0 s"),
        ({"footprint": [[0.0, 0.0]]}, "the footprint of mine must be at least 3 points"),
        ({"mounts": (SensorMount("s", Lidar2D(), "nose"),)}, "'nose', which is not a link"),
    ):
        with pytest.raises(InputError, match=message):
            dataclasses.replace(mine, **values)
    with pytest.raises(InputError, match="mine has no sensor 'x'; it has none"):
        mine.mount("x")
    with pytest.raises(InputError, match="no colliders to take it from"):
        Robot("bare", read_urdf("<robot name='r'><link name='a'/></robot>"), AckermannDrive())


def test_check_tells_of_robots(capsys, tmp_path, urdf):
    assert main(["check", "pepper", "crossing-flows", str(urdf / "pepper" / "pepper.urdf")]) == 0
    said = capsys.readouterr().out
    assert "mass    28.68 kg" in said
    assert "sensor  laser_front: lidar2d: rate 6.25 Hz" in said
    assert "crossing-flows: OK" in said
    assert "replaced" in said
    assert "--json lists all" in said
    assert main(["check", str(folder(tmp_path, "<drive/>"))]) == 2
    assert "needs the attribute 'type'" in capsys.readouterr().out


def test_check_counts_for_programs(capsys, urdf):
    import json

    path = str(urdf / "urdf_tutorial" / "06-flexible.urdf")
    assert main(["check", path, "--json"]) == 0
    row = json.loads(capsys.readouterr().out)[path]
    assert row["valid"]
    assert (row["robot"]["links"], row["robot"]["joints"], row["robot"]["joints_that_move"]) == (16, 15, 8)
    assert row["robot"]["joint_kinds"] == {"continuous": 5, "fixed": 7, "prismatic": 1, "revolute": 2}
    assert len(row["robot"]["repaired"]) == 14
    assert row["robot"]["footprint"] == []


def test_check_takes_package_folders(capsys, tmp_path, urdf):
    shutil.copytree(urdf / "double_pendulum" / "meshes", tmp_path / "parts" / "meshes")
    path = tmp_path / "one" / "arm.urdf"
    path.parent.mkdir()
    mesh = "<visual><geometry><mesh filename='package://parts/meshes/link1.stl'/></geometry></visual>"
    path.write_text(robot(link("a", mesh)))
    assert main(["check", str(path), "--package", f"parts={tmp_path / 'parts'}"]) == 0
    assert "meshes  1 read" in capsys.readouterr().out
    assert main(["check", str(path), "--package", "parts"]) == 2
    assert "must be NAME=FOLDER" in capsys.readouterr().err


def test_a_preset_names_a_product_and_attributes_change_it(tmp_path):
    text = '<sensor name="top" preset="velodyne-vlp-16" link="head" z="0.1" columns="900" noise="gaussian(0.03)"/>'
    top = Robot.load(folder(tmp_path, DRIVE, text)).mount("top")
    assert top.sensor == dataclasses.replace(preset("velodyne-vlp-16"), columns=900, noise=Gaussian(0.03))
    assert (top.link, top.z) == ("head", 0.1)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        (
            '<sensor name="a" preset="velodyne-16"/>',
            "unknown sensor preset 'velodyne-16', did you mean 'velodyne-vlp-16'",
        ),
        ('<sensor name="a" preset="velodyne-vlp-16" type="lidar-3d"/>', "has both preset and type; give one of them"),
        ('<sensor name="a" preset="velodyne-vlp-16" colums="9"/>', "colums"),
        ('<sensor name="a" preset="velodyne-vlp-16" columns="-9"/>', "columns"),
        ('<wheel joint="axle" radius="0.1" driven="perhaps"/>', 'driven="perhaps" must be true or false'),
        ('<wheel joint="axle" radius="0.1" steering="nek"/>', "steering='nek' is not a rotating joint"),
    ],
)
def test_wrong_presets_and_wheels_are_refused_in_one_sentence(tmp_path, text, match):
    with pytest.raises(RobotError, match=match) as caught:
        Robot.load(folder(tmp_path, DRIVE, text))
    assert len(caught.value.problems) == 1


def test_wheels_that_steer_are_read(tmp_path):
    text = '<wheel joint="axle" radius="0.1" steering="neck" driven="false"/>'
    assert Robot.load(folder(tmp_path, DRIVE, text)).wheels == (Wheel("axle", 0.1, "neck", driven=False),)
