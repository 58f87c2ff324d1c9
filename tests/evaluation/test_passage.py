"""The remark on a robot whose outline fits through a passage, but not its disc."""

import json

import pytest

from crowdbot.cli import main
from crowdbot.evaluation import EvaluationPlan, load_evaluation, own_method
from crowdbot.trials import load_trial, parse_trial

SHORT = ["--set", "duration=0.2", "--seeds", "0:1", "--worst", "0"]
REMARK = (
    "the narrowest passage on the way of the robot is 0.95 m wide: less than the diameter of its disc, 1.20 m, and more"
    " than the width of its outline, 0.60 m. In the planar world a robot is a disc, so it cannot reach its goal,"
    " although its outline fits through."
)
CORNER = """<trial name="corner" duration="5"><stage walkable="-5,-3 5,-3 5,3 -5,3"/><crowd type="orca"/>
<robot type="qolo" x="-3" y="0"><goal x="3" y="-2.5" tolerance="0.5"/><navigator type="straight"/></robot></trial>"""


def remarks(trial, robot=""):
    return EvaluationPlan([trial], [own_method()], [robot]).cells[0].remarks


def test_terminal_json_report_and_file_name_passage_disc_and_outline(tmp_path, capsys):
    words = ["evaluate", "doorway", "--robots", "wheelchair, pepper", *SHORT]
    assert main([*words, "--out", str(tmp_path)]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert printed.count("Note on doorway on wheelchair: " + REMARK) == printed.count("Note on") == 1
    assert (tmp_path / "report.html").read_text().count("Note: " + REMARK) == 1
    cells = load_evaluation(tmp_path / "result.json").cells
    assert [cell.remarks for cell in cells] == [(REMARK,), ()]
    assert main([*words, "--json"]) == 0
    assert [cell["remarks"] for cell in json.loads(capsys.readouterr().out)["cells"]] == [[REMARK], []]


def test_the_width_is_that_of_the_door():
    (remark,) = remarks(load_trial("doorway", door=0.75), "wheelchair")
    assert remark.startswith("the narrowest passage on the way of the robot is 0.75 m wide: less than")


@pytest.mark.parametrize(
    ("values", "robot"),
    [
        ({}, ""),  # a disc without a type
        ({"door": 1.3}, "wheelchair"),  # the disc fits
        ({"world": "physics"}, "wheelchair"),
        ({"robot/ghost": True}, "wheelchair"),
    ],
)
def test_nothing_is_said_without_such_a_passage(values, robot):
    assert remarks(load_trial("doorway", values), robot) == ()


SECOND = (
    """<robot name="second" type="wheelchair" x="-4" y="1"><goal x="3" y="0"/><navigator type="straight"/></robot>"""
)


def test_every_robot_of_a_trial_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = CORNER.replace('3 -5,3"/>', '3 -5,3"><wall points="0,-3 0,-0.45"/><wall points="0,0.45 0,3"/></stage>', 1)
    text = text.replace('"qolo"', '"pepper"').replace("</trial>", SECOND + "</trial>")
    (remark,) = remarks(parse_trial(text))
    start = (
        "the narrowest passage on the way of robot 'second' is 0.90 m wide: less than the diameter of its disc, 1.20 m"
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
