"""`crowdbot new robot FILE`: the table, its confirmation, changes and JSON."""

import json
import sys
from xml.etree import ElementTree

import pytest

from crowdbot.cli import main
from crowdbot.cli.templates import maker_file
from crowdbot.trials import load_trial
from crowdbot.world import Robot

CART = """<robot name='cart'>
<link name='base_link'><inertial><mass value='9'/>
  <inertia ixx='.1' iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial>
  <collision><origin xyz='0 0 0.15'/><geometry><box size='0.4 0.3 0.2'/></geometry></collision></link>
<link name='castor'><collision><geometry><sphere radius='0.04'/></geometry></collision></link>
<joint name='castor_joint' type='fixed'>
  <parent link='base_link'/><child link='castor'/><origin xyz='-0.15 0 0.04'/></joint>
<link name='tower'><visual><geometry><box size='0.1 0.1 0.5'/></geometry></visual></link>
<joint name='tower_joint' type='revolute'><parent link='base_link'/><child link='tower'/><origin xyz='0 0 0.5'/>
  <axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='5' velocity='1'/></joint>
{wheels}</robot>"""
WHEEL = """<link name='{side}'><inertial><mass value='1'/>
  <inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' iyz='0'/>
</inertial><collision><geometry><cylinder radius='{radius}' length='0.04'/></geometry></collision></link>
<joint name='{side}_joint' type='continuous'><parent link='base_link'/><child link='{side}'/>
<origin xyz='0 {y} {radius}' rpy='-1.5708 0 0'/><axis xyz='0 0 1'/></joint>"""


@pytest.fixture
def cart(tmp_path, monkeypatch):
    """Write a cart of which some values are unknown, and enter its folder."""
    monkeypatch.chdir(tmp_path)
    return write(tmp_path, 0.08)


def write(folder, radius):
    wheels = "".join(WHEEL.format(side=side, y=y, radius=radius) for side, y in (("left", 0.18), ("right", -0.18)))
    (folder / "cart.urdf").write_text(CART.format(wheels=wheels))
    return folder


def test_json_tells_every_value_and_where_it_is_from(cart, capsys):
    assert main(["new", "robot", "cart.urdf", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    rows = {row["what"]: row for row in document["table"]}
    assert (document["folder"], document["trial"], document["kind"]) == ("cart", "cart-hall.xml", "differential")
    assert document["confirmed"] is False
    assert rows["max-speed"]["status"] == "guess"
    assert rows["max-turn-rate"]["status"] == "derived"
    assert rows["mass of tower"]["status"] == "guess"
    assert document["mass"] == pytest.approx(11.1)
    assert any("'tower' moves but neither it nor a link fixed to it has a mass" in text for text in document["remarks"])
    assert json.loads((cart / "cart" / "import.json").read_text())["table"] == document["table"]


def test_values_and_remarks_of_one_kind_are_one_line(cart, capsys):
    text = (cart / "cart.urdf").read_text()
    mesh = "<collision><geometry><mesh filename='package://parts/{k}.stl'/></geometry></collision>"
    arm = "".join(
        f"<link name='arm{k}'>{mesh.format(k=k)}<inertial><mass value='1'/></inertial></link>"
        f"<joint name='turn{k}' type='continuous'><parent link='base_link'/><child link='arm{k}'/>"
        f"<origin xyz='0 0 1'/><axis xyz='0 0 1'/></joint>"
        for k in range(4)
    )
    (cart / "cart.urdf").write_text(text.replace("</robot>", f"{arm}</robot>"))
    assert main(["new", "robot", "cart.urdf"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert sum("motor of tower_joint and 4 more  " in line for line in lines) == 1
    assert not any("motor of turn" in line for line in lines)
    printed = [line for line in lines if line.startswith("  - ")]
    assert printed[0].startswith(
        "  - the package 'parts' is not found, and 4 mesh files of it are missing (give --package"
    )
    assert [line.endswith("(3 more like it)") for line in printed if "package://parts/" in line] == [True]
    assert printed[-1] == "  - all remarks are in import.json of the robot folder"
    remarks = json.loads((cart / "cart" / "import.json").read_text())["remarks"]
    assert sum("package://parts/" in remark for remark in remarks) == 4


def test_values_are_changed_by_set(cart, capsys):
    words = ["--set", "max-speed=0.5", "--set", "mass of tower=2.5", "--set", "wheel left_joint=0.079"]
    assert main(["new", "robot", "cart.urdf", "--yes", *words, "--set", "motor of tower_joint=none"]) == 0
    robot = Robot.load(cart / "cart")
    assert robot.drive.max_speed == 0.5
    assert robot.model.mass == 13.5
    assert robot.model.links["tower"].inertial.mass == 2.5
    assert [wheel.radius for wheel in robot.wheels] == [0.079, 0.08]
    assert robot.model.joints["tower_joint"].motor.kind == ""
    assert "--set" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--set", "max-sped=1"], "'max-sped' is not a value of this robot, did you mean 'max-speed'?"),
        (["--set", "max-speed=fast"], "--set max-speed=fast"),
        (["--set", "max-speed=-1"], "--set max-speed=-1 must be above 0"),
        (["--set", "motor of tower_joint=steam"], "must be position, velocity, effort, none"),
    ],
)
def test_wrong_values_are_told_and_nothing_is_written(cart, capsys, words, sentence):
    assert main(["new", "robot", "cart.urdf", *words]) == 2
    assert sentence in capsys.readouterr().err
    assert [path.name for path in cart.iterdir()] == ["cart.urdf"]


class Terminal:
    """A stream that is a terminal."""

    def __init__(self, stream):
        self.stream = stream

    def __getattr__(self, name):
        return getattr(self.stream, name)

    def isatty(self):
        return True


def answer(monkeypatch, *answers):
    rows = iter(answers)
    monkeypatch.setattr(sys, "stdin", Terminal(sys.stdin))
    monkeypatch.setattr(sys, "stdout", Terminal(sys.stdout))
    monkeypatch.setattr(maker_file, "input", lambda _: next(rows), raising=False)


def test_a_terminal_asks_until_the_table_is_right(cart, capsys, monkeypatch):
    answer(monkeypatch, "max-speed", "speed=1", "max-speed=0.4", "")
    assert main(["new", "robot", "cart.urdf"]) == 0
    printed = capsys.readouterr().out
    assert "the answer 'max-speed' must be NAME=VALUE" in printed
    assert "'speed' is not a value of this robot" in printed
    assert Robot.load(cart / "cart").drive.max_speed == 0.4


def test_a_terminal_may_leave_without_a_file(cart, capsys, monkeypatch):
    answer(monkeypatch, "q")
    assert main(["new", "robot", "cart.urdf"]) == 2
    assert "nothing was written" in capsys.readouterr().err
    assert [path.name for path in cart.iterdir()] == ["cart.urdf"]


@pytest.mark.parametrize("radius", [0.02, 0.033, 0.08, 0.2])
def test_the_hall_is_as_long_as_the_robot_needs(tmp_path, monkeypatch, radius):
    monkeypatch.chdir(write(tmp_path, radius))
    assert main(["new", "robot", "cart.urdf", "--yes"]) == 0
    trial = load_trial("cart-hall.xml")
    robot = ElementTree.parse("cart-hall.xml").getroot().find("robot")
    way = float(robot.find("goal").get("x")) - float(robot.get("x"))
    needed = way / Robot.load(tmp_path / "cart").drive.max_speed
    assert needed * 1.4 < trial.duration < max(21.0, needed * 1.6 + 7.0)


def test_json_is_for_a_robot_file_only(tmp_path, capsys):
    assert main(["new", "trial", str(tmp_path / "a.xml"), "--json"]) == 2
    assert "--json is for a robot from a file" in capsys.readouterr().err
