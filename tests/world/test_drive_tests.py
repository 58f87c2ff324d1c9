"""What a robot reaches at full speed in both worlds, and what `new robot` prints of it."""

import dataclasses
import json

import pytest
from base_texts import BASES, base_file

from crowdbot.cli import main
from crowdbot.core import MissingExtra
from crowdbot.world import Drive, Robot, Twists, builtin_robots, drive_tests, integrate_twist
from crowdbot.world.physics import world as physics_world


@dataclasses.dataclass(frozen=True)
class Turned(Drive):
    """Has these speeds [m/s], whatever the command."""

    ahead: float
    left: float
    max_speed: float = 1.0

    def step(self, pose, twist, command, dt):
        after = Twists.of(type(command)(self.ahead, 0.0, left=self.left), len(pose.heading))
        return integrate_twist(pose, after, dt), after


@pytest.mark.parametrize("name", ["differential", "pepper", "turtlebot2", "wheelchair"])
def test_robots_of_the_package_reach_their_speed(name):
    assert name in builtin_robots()
    robot = Robot.load(name)
    planar, physics = drive_tests(robot)
    for test, world in ((planar, "planar"), (physics, "physics")):
        assert (test.world, test.wanted, test.problem) == (world, robot.drive.max_speed, "")
        assert 0.8 * test.wanted < test.speed < 1.05 * test.wanted
        assert test.forward > 0.5 * test.wanted
        assert abs(test.left) < 0.02
    assert planar.tilt == 0.0


@pytest.mark.parametrize(
    ("ahead", "left", "problem"),
    [
        (1.0, 0.0, ""),
        (0.55, 0.0, ""),
        (1.0, 0.05, ""),
        (0.4, 0.0, "it reaches less than half of its maximum speed of 1 m/s"),
        (0.0, 0.0, "it reaches less than half of its maximum speed of 1 m/s"),
        (-0.5, 0.0, "it moves backwards, 1.00 m in 2 s"),
        (0.5, 0.2, "it moves sideways, 0.40 m to the left in 2 s"),
        (0.0, -0.5, "it moves sideways, 1.00 m to the right in 2 s"),
    ],
)
def test_what_is_wrong_in_the_plane_is_told(ahead, left, problem):
    robot = dataclasses.replace(Robot.load("pepper"), drive=Turned(ahead, left))
    test = drive_tests(robot)[0]
    assert (test.world, test.problem) == ("planar", problem)
    assert test.speed == pytest.approx(ahead)


@pytest.mark.parametrize("most", [0.1, 0.2])
def test_a_slow_acceleration_is_the_reason(most):
    robot = Robot.load("differential")
    drive = dataclasses.replace(robot.drive, max_acceleration=most)
    for test in drive_tests(dataclasses.replace(robot, drive=drive)):
        assert test.problem.endswith(f"; its acceleration of {most} m/s2 allows no more")


def test_without_mujoco_only_the_plane_is_tried(monkeypatch):
    def missing(*_, **__):
        raise MissingExtra("the physics world", "physics")

    monkeypatch.setattr(physics_world, "PhysicsWorld", missing)
    assert [test.world for test in drive_tests(Robot.load("turtlebot2"))] == ["planar"]


def convert(folder, text, *words):
    (folder / "maker.xacro").write_text(text)
    assert main(["new", "robot", str(folder / "maker.xacro"), "--out", str(folder / "maker"), "--yes", *words]) == 0


@pytest.mark.parametrize("kind", BASES)
def test_new_robot_prints_what_is_reached(tmp_path, capsys, kind):
    convert(tmp_path, base_file(kind))
    lines = capsys.readouterr().out.splitlines()
    (line,) = [line for line in lines if line.startswith("drives: ")]
    speeds = [float(word.split()[0]) for word in line.removeprefix("drives: ").split(", ")]
    assert line.endswith(" m/s in the physics world")
    assert " m/s after 2 s in the plane, " in line
    assert speeds == pytest.approx([1.0, 1.0], abs=0.1)
    assert not any(line.startswith("warning: ") for line in lines)


def test_json_has_the_numbers(tmp_path, capsys):
    convert(tmp_path, base_file("differential"), "--json")
    planar, physics = json.loads(capsys.readouterr().out)["drives"]
    assert (planar["world"], physics["world"]) == ("planar", "physics")
    assert planar["speed"] == pytest.approx(1.0)
    assert physics["speed"] == pytest.approx(1.0, abs=0.05)
    assert set(planar) == {"world", "speed", "wanted", "forward", "left", "tilt", "problem"}


@pytest.mark.parametrize(("friction", "damping"), [(8, 0), (0, 4)])
def test_a_robot_that_does_not_move_in_the_physics_world_is_told(tmp_path, capsys, friction, damping):
    axle = "rpy='${-pi / 2} 0 ${yaw}'/><axis xyz='0 0 1'/>"
    weak = f"{axle}<limit effort='7' velocity='10'/><dynamics friction='{friction}' damping='{damping}'/>"
    convert(tmp_path, base_file("differential").replace(axle, weak))
    printed = capsys.readouterr().out
    assert "warning: in the physics world, it reaches less than half of its maximum speed of 1 m/s" in printed
    assert "warning: in the plane" not in printed
