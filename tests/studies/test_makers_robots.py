"""Robots of makers: the study imports, drives and compares own robot files with meshes, and says what it misses."""

import json
import struct
from pathlib import Path

import pytest

import makers_robots
from makers_robots import LIST, main, misses, read_robots

PAGE = Path(__file__).parents[2] / "docs" / "results" / "makers-robots.md"
CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
FACES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
INERTIA = "<inertia ixx='{0}' iyy='{0}' izz='{0}' ixy='0' ixz='0' iyz='0'/>"


def write_robot(folder, speed, mass, width):
    """Write a cart with a mesh of four triangles whose wheels turn at most ``speed`` m/s."""
    folder.mkdir(parents=True)
    rows = [struct.pack("<12fH", 0, 0, 0, *(value for k in face for value in CORNERS[k]), 0) for face in FACES]
    (folder / "prow.stl").write_bytes(bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows))
    wheels = "".join(
        f"<link name='{side}'><inertial><mass value='1'/>{INERTIA.format(0.004)}</inertial>"
        "<collision><geometry><cylinder radius='0.1' length='0.04'/></geometry></collision></link>"
        f"<joint name='{side}_axle' type='continuous'><parent link='base'/><child link='{side}'/>"
        f"<origin xyz='0 {y} 0.1' rpy='-1.5707963 0 0'/><axis xyz='0 0 1'/>"
        f"<limit effort='20' velocity='{10 * speed}'/></joint>"
        for side, y in (("left", width / 2), ("right", -width / 2))
    )
    (folder / "cart.urdf").write_text(
        f"<robot name='cart'><link name='base'><inertial><origin xyz='0 0 0.15'/><mass value='{mass - 2}'/>"
        f"{INERTIA.format(0.6)}</inertial><collision><origin xyz='0 0 0.2'/><geometry><box size='0.5 0.3 0.2'/>"
        "</geometry></collision><collision><origin xyz='-0.2 0 0.04'/><geometry><sphere radius='0.04'/></geometry>"
        "</collision><collision><origin xyz='0.25 0 0.15'/><geometry><mesh filename='prow.stl' scale='0.1 0.1 0.1'/>"
        f"</geometry></collision></link>{wheels}</robot>"
    )


def write_list(file, rows, pair):
    text = [
        f"[[robot]]\n{''.join(f'{key} = {json.dumps(value)}' + chr(10) for key, value in row.items())}" for row in rows
    ]
    file.write_text("\n".join([*text, f"[together]\nrobots = {json.dumps(pair)}\n"]))


@pytest.fixture
def study(tmp_path):
    write_robot(tmp_path / "checkouts" / "ann" / "one", 1.2, 20, 0.4)
    write_robot(tmp_path / "checkouts" / "bob" / "two", 0.9, 35, 0.46)
    rows = [
        {"name": "Cart One", "repository": "ann/one", "commit": "a" * 40, "file": "cart.urdf", "base": "differential",
         "speed": 1.2, "mass": 20, "source": "own sheet"},
        {"name": "Cart Two", "repository": "bob/two", "commit": "b" * 40, "file": "cart.urdf", "base": "mecanum",
         "speed": 2.0, "mass": 90},
        {"name": "Lost", "repository": "eve/lost", "commit": "c" * 40, "file": "robot.urdf"},
    ]  # fmt: skip
    write_list(tmp_path / "list.toml", rows, ["Cart One", "Cart Two"])
    (tmp_path / "keep").mkdir()
    return ["--list", str(tmp_path / "list.toml"), "--keep", str(tmp_path / "keep"), str(tmp_path / "checkouts")]


def test_two_robots_with_meshes_are_compared_and_both_reach_their_goals(study, tmp_path, capsys):
    assert main([*study, "--page", str(tmp_path / "page.md")]) == 0
    text = (tmp_path / "page.md").read_text()
    assert "2 of 3 drive in both worlds without a warning." in text
    assert "| Cart One | differential | differential | 1.2 | 1.2 | 20 | 20 | 1.20 | 1.20 |" in text
    assert "* Cart Two: base differential (2 wheels on one axle), the maker has mecanum; max-speed 0.9 m/s (" in text
    assert "the maker has 90" in text
    assert (
        f"* Lost: refused: there is no {tmp_path}/checkouts/eve/lost/robot.urdf; git clone https://github.com/eve/lost"
        in text
    )
    assert f"[ann/one@aaaaaaaa](https://github.com/ann/one/blob/{'a' * 40}/cart.urdf) | own sheet |" in text
    assert text.count("reaches its goal after") == 2
    assert "Outcome: success." in text
    capsys.readouterr()
    assert main([*study, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [end["nearest"] < 0.3 for end in told["together"]["ends"]] == [True, True]
    assert told["robots"]["Cart One"]["misses"] == []
    assert len(told["robots"]["Cart Two"]["misses"]) == 3


def test_ctrl_c_keeps_what_is_done_and_the_command_continues(study, tmp_path, capsys, monkeypatch):
    import_robot, calls = makers_robots.import_robot, []

    def stopped(robot, *rest):
        calls.append(robot.name)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return import_robot(robot, *rest)

    monkeypatch.setattr(makers_robots, "import_robot", stopped)
    assert main([*study, "--page", str(tmp_path / "page.md")]) == 0
    assert "stopped; 1 robots are done, the same command continues" in capsys.readouterr().err
    assert "Cart One" in (tmp_path / "page.md").read_text()
    assert "Not run" in (tmp_path / "page.md").read_text()
    assert [path.name for path in (tmp_path / "keep").glob("*.json")] == ["cart-one.json"]
    monkeypatch.setattr(makers_robots, "drive_together", lambda *_: {})
    assert main([*study, "--page", str(tmp_path / "page.md")]) == 0
    assert calls == ["Cart One", "Cart Two", "Cart Two", "Lost"]


def test_missing_folders_and_wrong_lists_are_one_sentence(study, tmp_path, capsys):
    with pytest.raises(SystemExit):
        main([*study[:-1], str(tmp_path / "nowhere")])
    assert "there is no folder" in capsys.readouterr().err
    row = {"name": "x", "repository": "a/b", "commit": "c"}
    for rows, pair, wrong in [
        ([row], ["x", "x"], "the robot 'x' lacks 'file'"),
        ([{**row, "file": "f", "sped": 1}], ["x", "x"], "the robot 'x' has 'sped', allowed are arguments, base"),
        ([{**row, "file": "f"}], ["x", "y"], r"'robots' of [together] must be two of x"),
    ]:
        write_list(tmp_path / "list.toml", rows, pair)
        with pytest.raises(SystemExit):
            main(study)
        assert wrong in capsys.readouterr().err


def test_a_robot_that_does_not_drive_is_a_miss():
    robot = read_robots()[0][0]
    drives = [{"world": "physics", "speed": 0.0, "problem": "it falls over"}]
    table = [{"what": "max-speed", "value": "1 m/s", "status": "file", "source": "s"}]
    result = {"kind": robot.base, "mass": robot.mass, "table": table, "drives": drives, "remarks": []}
    assert misses(robot, result) == ["in the physics world, it falls over"]
    result["remarks"] = ["the package 'x' is not found", "the effort of 6 N m of 'axle' reaches 39 % of the speed"]
    assert misses(robot, result) == [
        "in the physics world, it falls over: the effort of 6 N m of 'axle' reaches 39 % of the speed"
    ]


def test_the_page_has_every_robot_of_the_list():
    robots, pair = read_robots(LIST)
    text = PAGE.read_text(encoding="utf-8")
    assert len(robots) >= 26
    for robot in robots:
        assert f"| {robot.name} | " in text
        assert f"[{robot.repository}@{robot.commit[:8]}]" in text
    assert all(name in {robot.name for robot in robots} for name in pair)
