"""Exports whose up axis is not z: the cause is the first remark, and the kind of base is marked."""

import json

import numpy as np
import pytest
from maker_texts import box, cylinder, inertial, joint, link, robot

from crowdbot.cli import main
from crowdbot.world import import_robot

TURNS = {"y": "1.5708 0 0", "-y": "-1.5708 0 0", "x": "0 -1.5708 0", "-x": "0 1.5708 0"}
"""The rpy of a joint that turns a robot whose up axis is the key."""
AXES = {
    "y": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]), "-y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "x": np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]), "-x": np.array([[0.0, 0, -1], [-1, 0, 0], [0, 1, 0]]),
}  # fmt: skip
"""Rotations of an upright robot [3, 3] so that its z axis is along the key, and its axles along z."""


def rover(up, wheels=4, shapes=True, boxes=False):
    """Return a rover whose parts are all placed along a turned up axis, as CAD programs export."""
    turn = AXES[up]

    def place(*point):
        return " ".join(f"{value:.6g}" for value in turn @ np.array(point))

    size = np.abs(turn @ np.array([0.6, 0.3, 0.1]))
    parts = [link("base_link", 12, box(*size), place(0, 0, 0.16))]
    places = [(0.2, 0.22), (0.2, -0.22), (-0.2, 0.22), (-0.2, -0.22)][:wheels]
    for number, (x, y) in enumerate(places):
        axle = turn @ np.array([0.0, 1.0, 0.0])
        rpy = {0: "0 1.5707963 0", 1: "1.5707963 0 0", 2: "0 0 0"}[int(np.argmax(np.abs(axle)))]
        side = np.where(np.abs(axle) > 0.5, 0.04, 0.16)
        shape = box(*side) if boxes else cylinder(0.08)
        parts.append(link(f"part{number}", 0.8, shape, rpy="0 0 0" if boxes else rpy) if shapes else
                     f"<link name='part{number}'>{inertial(0.8, 0.16)}</link>")  # fmt: skip
        axis = " ".join(f"{value:g}" for value in axle)
        parts.append(joint(f"axle{number}", "continuous", "base_link", f"part{number}", place(x, y, 0.08), axis))
    return robot("rover", *parts)


@pytest.mark.parametrize(("up", "wheels", "boxes"), [
    ("y", 4, False), ("y", 2, False), ("-y", 4, False), ("x", 4, False), ("-x", 4, True), ("y", 4, True),
])  # fmt: skip
def test_a_robot_that_lies_on_its_side_says_so_first(tmp_path, up, wheels, boxes):
    file = tmp_path / "rover.urdf"
    file.write_text(rover(up, wheels, boxes=boxes))
    made = import_robot(file, "rover")
    first = made.remarks[0]
    assert "the robot lies on its side: with " in first
    assert "axle0, axle1" in first
    assert "but up is z (REP 103); export the file with z up, or put its root 'base_link' below a new root" in first
    assert first.startswith(str(file))
    (kind,) = (row for row in made.guesses if row.what == "kind of base")
    assert (kind.value, kind.status) == ("planar", "doubtful")
    assert kind.source.endswith("; the robot lies on its side")


@pytest.mark.parametrize("up", TURNS)
def test_the_turn_that_the_remark_names_makes_wheels(tmp_path, up):
    file = tmp_path / "rover.urdf"
    text = rover(up)
    file.write_text(text)
    assert f"with {up} up" in import_robot(file, "rover").remarks[0]
    assert f"a fixed joint of rpy={TURNS[up]!r}" in import_robot(file, "rover").remarks[0]
    file.write_text(
        text.replace(
            "</robot>",
            f"<link name='stand'/>{joint('up', 'fixed', 'stand', 'base_link', '0 0 0', rpy=TURNS[up])}</robot>",
        )
    )
    made = import_robot(file, "rover")
    assert made.kind == "skid-steer" or any("roll along y" in remark for remark in made.remarks)
    assert not any("lies on its side" in remark for remark in made.remarks)


@pytest.mark.parametrize("parts", [
    (joint("pan", "continuous", "base_link", "head", "0 0 0.4"), link("head", 1, cylinder(0.1))),
    (joint("pan", "continuous", "base_link", "head", "0 0 0.4"), link("head", 1, cylinder(0.1)),
     joint("spin", "continuous", "base_link", "scanner", "0 0 0.6"), link("scanner", 0.3, cylinder(0.05))),
    (joint("arm", "continuous", "base_link", "hand", "0.4 0 0.1", axis="1 0 0"), link("hand", 1, cylinder(0.1))),
])  # fmt: skip
def test_turning_parts_of_an_upright_base_are_no_wheels_of_a_turned_one(tmp_path, parts):
    file = tmp_path / "box.urdf"
    file.write_text(robot("box", link("base_link", 20, box(0.6, 0.5, 0.5), "0 0 0.25"), *parts))
    made = import_robot(file, "box")
    assert made.kind == "planar"
    assert not any("lies on its side" in remark for remark in made.remarks)
    assert next(row for row in made.guesses if row.what == "kind of base").status == "derived"


def test_wheels_along_x_without_a_plugin_say_that_the_robot_would_drive_sideways(tmp_path):
    file = tmp_path / "rover.urdf"
    parts = [link("base_link", 12, box(0.3, 0.6, 0.1), "0 0 0.16")]
    for number, (x, y) in enumerate([(0.22, 0.2), (-0.22, 0.2), (0.22, -0.2), (-0.22, -0.2)]):
        parts.append(link(f"part{number}", 0.8, cylinder(0.08), rpy="0 1.5707963 0"))
        parts.append(joint(f"axle{number}", "continuous", "base_link", f"part{number}", f"{x} {y} 0.08", "1 0 0"))
    file.write_text(robot("rover", *parts))
    made = import_robot(file, "rover")
    assert "the wheels roll along y, but the front of a robot is along x (REP 103)" in made.remarks[0]
    row = next(row for row in made.guesses if row.what == "kind of base")
    assert (row.status, row.source) == ("doubtful", "the axles are not across the robot; it would drive sideways")


def test_new_robot_prints_the_cause(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rover.urdf").write_text(rover("y"))
    assert main(["new", "robot", "rover.urdf", "--yes"]) == 0
    assert (
        "- rover.urdf: the robot lies on its side: with y up, axle0, axle1, axle2, axle3 would be wheels"
        in capsys.readouterr().out
    )
    assert main(["new", "robot", "rover.urdf", "--out", "again", "--yes", "--json"]) == 0
    assert "lies on its side" in json.loads(capsys.readouterr().out)["remarks"][0]
