"""The remark on a robot that is wider than a passage on its way."""

import json

import pytest

from crowdbot.cli import main
from crowdbot.evaluation import EvaluationPlan, load_evaluation, own_method
from crowdbot.trials import load_trial, parse_trial

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
