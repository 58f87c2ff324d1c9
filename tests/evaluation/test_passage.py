"""Remarks on robots in an evaluation: wider than a passage on their way, or blind to people."""

import json

import pytest

from crowdbot.cli import main
from crowdbot.evaluation import EvaluationPlan, load_evaluation, own_method
from crowdbot.trials import load_trial, parse_trial, trial_xml

SHORT = ["--set", "duration=0.2", "--seeds", "0:1", "--worst", "0"]
WIDTH = "the narrowest passage on the way of the robot is 0.50 m wide: less than the width of the robot, 0.60 m"
REMARK = WIDTH + ", so it cannot reach its goal."
CORNER = """<trial name="corner" duration="5"><stage walkable="-5,-3 5,-3 5,3 -5,3"/><crowd type="orca"/>
<robot type="qolo" x="-3" y="0"><goal x="3" y="-2.5" tolerance="0.5"/><navigator type="straight"/></robot></trial>"""


def remarks(trial, robot=""):
    return EvaluationPlan([trial], [own_method()], [robot]).cells[0].remarks


def narrow(gap, robot="qolo"):
    half = 0.5 * gap
    walls = f'3 -5,3"><wall points="0,-3 0,{-half:g}"/><wall points="0,{half:g} 0,3"/></stage>'
    return CORNER.replace('3 -5,3"/>', walls, 1).replace('"qolo"', f'"{robot}"')


def test_terminal_json_report_and_file_name_passage_and_robot(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "corner.xml").write_text(narrow(0.5), encoding="utf-8")
    words = ["evaluate", "corner.xml", "--robots", "wheelchair, pepper", *SHORT]
    assert main([*words, "--out", "out"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert printed.count("Note on corner on wheelchair: " + REMARK) == printed.count("Note on") == 1
    assert (tmp_path / "out" / "report.html").read_text().count("Note: " + REMARK) == 1
    cells = load_evaluation(tmp_path / "out" / "result.json").cells
    assert [cell.remarks for cell in cells] == [(REMARK,), ()]
    assert main([*words, "--json"]) == 0
    page = (tmp_path / "out" / "report.html").read_text()
    cause = (
        "the robot is 0.60 m wide and the narrowest passage on its way 0.50 m, so it never arrived, and a small number"
        " of contacts is no proof of safety"
    )
    assert page.count(f"not shown safe: {cause}.") == printed.count(f"not shown safe: {cause}.") == 1
    assert [cell.protocol["narrow_passage"] for cell in cells] == [pytest.approx(0.5, abs=0.002), None]
    assert "<td>control period [s]</td>" in page  # equal settings are rows
    assert "<th>senses</th>" in page
    assert "robot type" not in page
    assert [cell["remarks"] for cell in json.loads(capsys.readouterr().out)["cells"]] == [[REMARK], []]


@pytest.mark.parametrize(
    ("values", "robot"),
    [
        ({}, ""),  # a disc without a type
        ({}, "wheelchair"),  # the outline fits, the disc does not
        ({"world": "physics"}, "wheelchair"),
    ],
)
def test_nothing_is_said_where_the_robot_fits(values, robot):
    assert remarks(load_trial("doorway", values), robot) == ()


def test_nothing_is_said_about_ghosts_and_in_the_physics_world():
    for old, new in (('name="corner"', 'name="corner" world="physics"'), ('x="-3"', 'x="-3" ghost="true"')):
        assert remarks(parse_trial(narrow(0.5).replace(old, new))) == ()


SECOND = (
    """<robot name="second" type="wheelchair" x="-4" y="1"><goal x="3" y="0"/><navigator type="straight"/></robot>"""
)


def test_every_robot_of_a_trial_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = CORNER.replace('3 -5,3"/>', '3 -5,3"><wall points="0,-3 0,-0.28"/><wall points="0,0.28 0,3"/></stage>', 1)
    text = text.replace('"qolo"', '"pepper"').replace("</trial>", SECOND + "</trial>")
    (remark,) = remarks(parse_trial(text))
    start = (
        "the narrowest passage on the way of robot 'second' is 0.56 m wide: less than the width of the robot, 0.60 m"
    )
    assert remark.startswith(start)
    (tmp_path / "two.xml").write_text(text, encoding="utf-8")
    assert main(["run", "two.xml", "--set", "duration=0.2"]) == 0
    assert " ".join(capsys.readouterr().out.split()).count("note: " + start) == 1


def test_a_wall_beside_the_goal_is_no_passage():
    assert remarks(parse_trial(CORNER)) == ()


def test_a_wall_that_the_outline_cannot_pass_is_no_passage():
    text = CORNER.replace('3 -5,3"/>', '3 -5,3"><wall points="0,-3 0,3"/></stage>', 1)
    assert remarks(parse_trial(text)) == ()


BLIND = (
    "the robot has no scanner, depth camera or other sensor that shows people (imu), so observation.people of its"
    " navigator is empty; add a <sensor> to its robot.xml, or set robot/people=true to test the navigator with perfect"
    " knowledge."
)


def blind(old="", new=""):
    sensors = '<navigator type="orca"/><sensor name="imu" type="imu"/>'
    text = CORNER.replace("<robot ", '<agent x="0" y="0"/><robot default-sensors="false" ', 1)
    return parse_trial(text.replace('<navigator type="straight"/>', sensors).replace(old, new, 1 if old else 0))


def test_a_robot_without_a_sensor_that_shows_people_has_a_note():
    assert remarks(blind()) == (BLIND,)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('default-sensors="false"', ""),  # the scanners of the type
        ('type="imu"/>', 'type="imu"/><sensor name="eye" type="depth-camera"/>'),
        ('type="imu"/>', 'type="imu"/><sensor name="eye" type="ground-truth-people"/>'),
        ("<robot default-sensors", '<robot people="true" default-sensors'),
        ('<agent x="0" y="0"/>', ""),  # nobody to see
    ],
)
def test_robots_that_see_people_have_no_note(old, new):
    assert remarks(blind(old, new)) == ()


def test_the_protocol_says_what_the_navigator_knows():
    cells = [
        EvaluationPlan([trial], [own_method()]).cells[0]
        for trial in (blind(), blind("<robot ", '<robot people="true" '))
    ]
    assert [cell.protocol["senses"] for cell in cells] == [["IMU"], ["true people", "IMU"]]


def test_check_run_and_falsify_print_the_note(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "corner.xml").write_text(trial_xml(blind()), encoding="utf-8")
    assert main(["check", "corner.xml"]) == 0
    assert f"note: {BLIND}" in capsys.readouterr().out
    assert main(["run", "corner.xml", "--set", "duration=0.2", "--out", "out"]) == 0
    assert f"note: {BLIND}" in capsys.readouterr().out
    words = [
        "falsify",
        "corner.xml",
        "--set",
        "duration=0.2",
        "--over",
        "agent[1]/speed=uniform(0.6,1.8)",
        "--runs",
        "2",
    ]
    assert main(words) == 0
    assert BLIND[:60] in " ".join(capsys.readouterr().out.split())


LOOKS = """from dataclasses import dataclass
import numpy as np
import crowdbot as cb


@dataclass(frozen=True)
class Looks(cb.Navigator):
    def act(self, observation):
        assert set(observation.readings) == {"narrow", "wide"}
        assert observation.readings["narrow"].ranges.shape[-1] == 11
        return cb.Twist(0.1 if observation.scan.ranges.shape[-1] == 91 else 0.0)
"""
SCANNERS = (
    '<navigator type="looks.py:Looks"/><sensor name="narrow" type="lidar2d" rays="11" field-of-view="0.5"/>'
    '<sensor name="wide" type="lidar2d" rays="91" field-of-view="4.5"/>'
)


def test_the_widest_of_several_scanners_is_the_scan_of_check_run_and_evaluate(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "looks.py").write_text(LOOKS, encoding="utf-8")
    text = CORNER.replace('<navigator type="straight"/>', SCANNERS).replace(
        "<robot ", '<robot default-sensors="false" '
    )
    (tmp_path / "corner.xml").write_text(text, encoding="utf-8")
    assert main(["check", "corner.xml"]) == 0
    assert "sensors narrow (lidar2d), wide (lidar2d)" in capsys.readouterr().out
    assert main(["run", "corner.xml", "--set", "duration=1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["metrics"]["path_length"] > 0.05
    assert main(["evaluate", "corner.xml", *SHORT, "--json"]) == 0
    (cell,) = json.loads(capsys.readouterr().out)["cells"]
    assert "1 timeout)" in cell["verdict"]["sentence"]
