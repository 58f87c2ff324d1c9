"""Friction and damping of wheels: guesses of the effort exceed them, and motors that do not are told."""

import json

import pytest
from base_texts import base_file
from physics_worlds import alone

from crowdbot.cli import main
from crowdbot.core import Twist
from crowdbot.world import Robot

AXLE = "rpy='${-pi / 2} 0 ${yaw}'/><axis xyz='0 0 1'/>"


def make(folder, kind, friction, damping, effort=None, *words):
    """Convert a robot whose wheels have friction [N m] and damping [N m s/rad], and return its folder."""
    limit = "" if effort is None else f"<limit effort='{effort}' velocity='10'/>"
    text = base_file(kind)
    assert AXLE in text
    text = text.replace(AXLE, f"{AXLE}{limit}<dynamics friction='{friction}' damping='{damping}'/>")
    (folder / "maker.xacro").write_text(text)
    assert main(["new", "robot", str(folder / "maker.xacro"), "--out", str(folder / "maker"), "--yes", *words]) == 0
    return folder / "maker"


def reached(robot, seconds=3.0):
    """Return the mean speed [m/s] of a robot in the physics world in one second after these."""
    world, places = alone(robot), []
    for _ in range(round(seconds / 0.05) + 20):
        scene = world.step({0: Twist(robot.drive.max_speed)})
        places.append(float(scene.position[0, 0, 0]))
    return places[-1] - places[-21]


STRONG = [(kind, *row) for kind in ("differential", "skid-steer") for row in ((0, 0), (15, 0), (0, 12), (60, 5))]
SLIGHT = [("tricycle", *row) for row in ((0, 0), (1, 0), (0, 0.1))]  # its front tyre alone pulls the other wheels


@pytest.mark.parametrize(("kind", "friction", "damping"), STRONG + SLIGHT)
def test_a_guessed_effort_moves_the_robot(tmp_path, capsys, kind, friction, damping):
    robot = Robot.load(make(tmp_path, kind, friction, damping, None, "--json"))
    against = (3.0 if kind == "tricycle" else 1.0) * (friction + damping * 10.0)  # two wheels of a tricycle only roll
    efforts = [row for row in json.loads(capsys.readouterr().out)["table"] if row["what"].startswith("effort of ")]
    wheels = [row for row in efforts if row["what"].removeprefix("effort of ") in {w.joint for w in robot.wheels}]
    assert wheels
    for row in wheels:
        assert float(row["value"].split()[0]) > against
        assert (f"{against:g} N m of <dynamics>" in row["source"]) == (against > 0.0)
        assert row["status"] == "guess"
    assert robot.weak_motors == ()
    assert reached(robot) == pytest.approx(robot.drive.max_speed, rel=0.05)


WEAK = [
    (10, 0, 6, "does not exceed its friction of 10 N m: the robot cannot move in the physics world; set its effort"),
    (10, 1, 10, "does not exceed its friction of 10 N m: the robot cannot move in the physics world; set its effort"),
    (0, 20, 10, "reaches 5 % of the maximum speed in the physics world, against damping of 20 N m s/rad"),
    (2, 4, 10, "reaches 20 % of the maximum speed in the physics world, against friction of 2 N m and damping of 4"),
]


@pytest.mark.parametrize(("friction", "damping", "effort", "reason"), WEAK)
@pytest.mark.parametrize("kind", ["differential", "skid-steer"])
def test_a_given_effort_that_is_too_low_is_told(tmp_path, capsys, monkeypatch, kind, friction, damping, effort, reason):
    monkeypatch.chdir(tmp_path)
    robot = Robot.load(make(tmp_path, kind, friction, damping, effort))
    assert reason in capsys.readouterr().out
    assert all(reason in sentence for sentence in robot.weak_motors)
    assert len(robot.weak_motors) == sum(wheel.driven for wheel in robot.wheels)
    share = max(0.0, effort - friction) / damping / 10.0 if damping else 0.0
    assert reached(robot) == pytest.approx(share * robot.drive.max_speed, abs=0.04)
    assert main(["check", "maker"]) == 0
    assert reason in capsys.readouterr().out
    trial = tmp_path / "maker-hall.xml"
    assert main(["check", str(trial)]) == 0
    assert reason not in capsys.readouterr().out, "the plane has no wheels"
    trial.write_text(trial.read_text().replace('<trial name="', '<trial world="physics" name="'))
    assert main(["check", str(trial)]) == 0
    printed = capsys.readouterr().out
    assert "note: robot 'maker': the effort of " in printed
    assert reason in printed


@pytest.mark.parametrize(("friction", "damping", "effort"), [(10, 0, 30), (0, 1, 30), (5, 1, 40), (0, 0, 5)])
def test_an_effort_that_is_enough_is_not_told(tmp_path, capsys, friction, damping, effort):
    robot = Robot.load(make(tmp_path, "differential", friction, damping, effort))
    assert robot.weak_motors == ()
    assert "the effort of" not in capsys.readouterr().out
    assert reached(robot) == pytest.approx(robot.drive.max_speed, rel=0.05)


def test_an_effort_that_the_user_gives_is_compared_too(tmp_path, capsys):
    words = ["--set", "effort of left_joint=4"]
    make(tmp_path, "differential", 9, 0, None, *words)
    assert "the effort of 4 N m of 'left_joint' does not exceed its friction of 9 N m" in capsys.readouterr().out
