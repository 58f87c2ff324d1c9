"""How real the people of a trial are around its robot: in the report, the terminal and the files of an evaluation."""

from __future__ import annotations

import dataclasses
import html
import json
import sys
from pathlib import Path

import jsonschema
import pytest

from crowdbot.cli import main
from crowdbot.evaluation import (
    ClearanceRow,
    EvaluationPlan,
    evaluate,
    load_clearances,
    load_evaluation,
    parse_statistic,
    realism_notice,
    result_schema,
    trial_realism,
    write_report,
)
from crowdbot.trials import Trial, load_trial, parse_trial

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "studies"))

COMMAND = "python studies/around_robots.py --data RECORDINGS --sets FILE --out docs/results/around-robots.md"
UNKNOWN = "whether contacts are likelier or rarer here than with real people is unknown"
PERSON = 'zone="2,-1 4,-1 4,1 2,1" goal="-4,-1 -3,-1 -3,1 -4,1"'
ROBOT = '<robot x="-3" y="0"><goal x="3" y="0"/><drive type="differential-drive"/><navigator type="straight"/></robot>'


def trial(crowds: str, people: str = f'<spawner count="2" {PERSON}/>', robot: str = ROBOT, more: str = "") -> Trial:
    return parse_trial(f'<trial name="hall" duration="0.2" {more}>{crowds}{people}{robot}</trial>')


def report(folder: Path, *trials: Trial) -> str:
    """The text of the report of an evaluation."""
    result = evaluate(EvaluationPlan(trials, seeds=[0]))
    write_report(result, folder / "report.html", [parse_statistic("min-clearance")])
    return html.unescape((folder / "report.html").read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("crowd", "words"),
    [
        (
            "people",
            "Around a golf cart, recorded people keep a median least clearance of 0.82 m (quartiles 0.54 to 2.06 m),"
            " simulated people of the crowd 'people' 0.70 m (0.48 to 1.63 m); in their median run they touch"
            " the cart in none of 23 recordings, recorded people in none."
            " It keeps the distance of recorded people within 20 %, and touches"
            " the robot as rarely. Its parameters are fitted to these recordings, so this is no independent test.",
        ),
        (
            "orca",
            "of the crowd 'orca' 0.11 m (0.10 to 1.85 m); in their median run they touch the cart in none of 23",
        ),
        (
            "social-force",
            "of the crowd 'social-force' -0.03 m, an overlap (-0.07 to 1.64 m); in their median run they touch"
            " the cart in 12 of 23 recordings, recorded people in none. It comes nearer than recorded people",
        ),
        ("anticipation-velocity", "they touch the cart in 9 of 23 recordings"),
    ],
)
def test_the_report_compares_the_crowd_with_recorded_people(tmp_path: Path, crowd: str, words: str) -> None:
    text = report(tmp_path, trial(f'<crowd type="{crowd}"/>'))
    assert "How real are these people?" in text
    assert words in text
    note = "Contacts with these people are likelier than with real people."
    if crowd == "people":
        note = "These people keep about the distance of recorded people around a robot."
    assert text.count(f"Note: {note}") == 1
    assert ("Its parameters are fitted to these recordings" in text) == (crowd == "people")


@pytest.mark.parametrize(
    ("crowds", "words"),
    [
        ('<crowd type="people" robot-gap="0.5"/>', "The crowd people with robot-gap=0.5 was"),
        ('<crowd type="orca" time-horizon="uniform(1, 3)"/>', "The crowd orca with drawn time-horizon was"),
        ('<crowd type="power-law"/>', "The crowd power-law was"),
        ('<crowd type="orca+headway"/>', "The crowd orca+headway was"),
    ],
)
def test_a_crowd_that_was_not_compared_is_named_as_such(tmp_path: Path, crowds: str, words: str) -> None:
    text = report(tmp_path, trial(crowds))
    assert f"{words} not compared with recordings around a robot: {UNKNOWN}." in text
    assert "Note: These people were not compared with recordings around a robot." in text
    assert "Around a golf cart, recorded people keep" not in text


def test_a_changed_value_that_was_compared_has_its_own_numbers(tmp_path: Path) -> None:
    text = report(tmp_path, trial('<crowd type="people" robot-gap="0"/>'))
    assert "simulated people of the crowd 'people' with robot-gap=0 0.11 m (-0.04 to 1.86 m)" in text
    assert "they touch the cart in 9 of 23 recordings" in text
    assert "Its parameters are fitted" not in text


@pytest.mark.parametrize(
    ("more", "inner", "words"),
    [
        ('robot-margin="0.02"', "", "robot-margin=0.02"),
        ("", '<limits max-acceleration="2"/>', "a limit of the acceleration"),
    ],
)
def test_values_of_the_trial_that_change_the_distance_count(more: str, inner: str, words: str) -> None:
    (found,) = trial_realism(trial(f'<crowd type="orca"/>{inner}', more=more))
    assert found.contacts == "unknown"
    assert f"The crowd orca with {words} was not compared" in found.sentence


def test_each_of_two_crowds_that_people_follow_has_a_sentence(tmp_path: Path) -> None:
    crowds = "".join(
        f'<crowd name="{name}" type="{kind}"/>'
        for name, kind in (("calm", "people"), ("new", "boids"), ("nobody", "orca"))
    )
    people = f'<spawner count="2" {PERSON}/><spawner count="1" crowd="new" {PERSON}/>'
    people += f'<spawner count="0" crowd="nobody" {PERSON}/>'
    both = trial(crowds, people)
    assert [(item.crowd, item.contacts) for item in trial_realism(both)] == [
        ("calm (people)", "alike"),
        ("new (boids)", "unknown"),
    ]
    text = report(tmp_path, both)
    assert "of the crowd 'calm (people)' 0.70 m" in text
    assert f"The crowd new (boids) was not compared with recordings around a robot: {UNKNOWN}." in text
    assert (
        "Note: Some of these people keep about the distance of recorded people around a robot; some of these people"
        " were not compared with recordings around a robot." in text
    )


@pytest.mark.parametrize(
    ("median", "touched", "contacts"),
    [(0.8, 3, "likelier"), (1.9, 3, "likelier"), (0.7, 0, "alike"), (0.3, 0, "likelier"), (1.9, 0, "rarer")],
)
def test_contacts_count_before_clearances(
    monkeypatch: pytest.MonkeyPatch, median: float, touched: int, contacts: str
) -> None:
    table = load_clearances()
    rows = [dataclasses.replace(row, median=median, touched=touched) for row in table.crowds]
    changed = dataclasses.replace(table, crowds=tuple(rows))
    monkeypatch.setattr("crowdbot.evaluation.realism.load_clearances", lambda: changed)
    (realism,) = trial_realism(trial('<crowd type="people"/>'))
    assert realism.contacts == contacts


def test_people_who_do_not_see_the_robot_are_not_compared(tmp_path: Path) -> None:
    hidden = trial('<crowd type="people"/>', robot=ROBOT.replace("<robot ", '<robot visible="false" '))
    text = report(tmp_path, hidden)
    assert "People do not see the robot (visible=false) and do not evade it, as real people would." in text
    assert "This was not compared with recordings around a robot." in text
    assert "Around a golf cart, recorded people keep" not in text
    assert realism_notice(trial_realism(hidden)) == "Contacts with these people are likelier than with real people."
    ghost = trial('<crowd type="people"/>', robot=ROBOT.replace("<robot ", '<robot ghost="true" '))
    assert [item.contacts for item in trial_realism(ghost)] == ["unknown"]


def test_only_the_robot_that_is_evaluated_counts() -> None:
    other = ROBOT.replace('<robot x="-3" y="0"', '<robot name="other" visible="false" x="-3" y="3"')
    (found,) = trial_realism(trial('<crowd type="people"/>', robot=ROBOT + other))
    assert found.crowd == "people"


@pytest.mark.parametrize(
    ("people", "crowd", "words"),
    [
        ('<agent x="2" y="0"/>', "people who stand", "Some people stand and do not step aside for a robot."),
        (f'<spawner count="2" {PERSON}><reaction type="curious" share="0.5"/></spawner>', "reactions", "(curious)"),
        (
            '<agent x="2" y="0" goal="-3,0"><parameter name="robot-gap" value="0.1"/></agent>',
            "people with own parameters",
            "1 of the people has own parameters (robot-gap).",
        ),
    ],
)
def test_people_who_differ_from_their_crowd_are_named(people: str, crowd: str, words: str) -> None:
    found = {item.crowd: item for item in trial_realism(trial('<crowd type="people"/>', people))}
    assert found[crowd].contacts == "unknown"
    assert words in found[crowd].sentence
    assert ("people" in found) == (crowd != "people who stand")


def test_people_of_a_recording_do_not_evade_unless_they_react(tmp_path: Path) -> None:
    (tmp_path / "walk.txt").write_text("".join(f"{10 * k} 1 {0.5 * k} 2\n" for k in range(8)), encoding="utf-8")
    text = (
        '<trial name="hall" duration="2"><crowd type="people"/><recorded data="walk.txt" fps="25" mode="{}"/>{}</trial>'
    )
    found = {
        mode: trial_realism(parse_trial(text.format(mode, ROBOT), folder=tmp_path)) for mode in ("scripted", "reactive")
    }
    assert [(one.crowd, one.contacts) for one in found["scripted"]] == [("people of a recording", "likelier")]
    assert [(one.crowd, one.contacts) for one in found["reactive"]] == [("people of a recording", "unknown")]


def test_without_people_nothing_is_said(tmp_path: Path) -> None:
    text = report(tmp_path, trial('<crowd type="people"/>', people=""))
    assert "How real" not in text
    assert "compared with recordings around a robot" not in text


def test_terminal_json_and_file_say_it_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["evaluate", "frontal", "--set", "duration=0.2", "--seeds", "0:1", "--worst", "0"]
    assert main([*words, "--sweep", "robot.visible=true,false", "--navigators", "orca,straight"]) == 0
    printed = capsys.readouterr().out
    told = " ".join(printed.split())
    assert told.count("[visible false]: Contacts with these people are likelier than with real people.") == 1
    assert told.count("[visible true]: These people keep about the distance of recorded people around a robot.") == 1
    assert main([*words, "--sweep", "crowd/type=people,power-law", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    alike = "These people keep about the distance of recorded people around a robot."
    assert f"[type people]: {alike}" in " ".join(printed.split())
    assert "[type power-law]: These people were not compared with recordings around a robot.\n" in printed
    jsonschema.validate(json.loads((tmp_path / "result.json").read_text(encoding="utf-8")), result_schema())
    loaded = [cell.realism for cell in load_evaluation(tmp_path / "result.json").cells]
    assert loaded == [trial_realism(load_trial("frontal", {"crowd/type": kind})) for kind in ("people", "power-law")]
    assert main([*words, "--json"]) == 0
    (cell,) = json.loads(capsys.readouterr().out)["cells"]
    assert [(row["crowd"], row["contacts"]) for row in cell["realism"]] == [("people", "alike")]


def test_a_crowd_that_keeps_farther_away_makes_the_verdict_mild(monkeypatch: pytest.MonkeyPatch) -> None:
    far = trial('<crowd type="orca"/>')
    least = {"recorded people": [0.2, 0.4, 0.6], "orca": [0.5, 0.7, 0.9], "alike": [0.2, 0.4, 0.6]}
    table = load_clearances()
    for name, contacts in (("orca", "rarer"), ("alike", "alike")):
        changed = type(table)(
            3, 20, ClearanceRow.of("recorded people", least["recorded people"]),
            (ClearanceRow.of("orca", least[name], far.crowd),),
        )  # fmt: skip
        monkeypatch.setattr("crowdbot.evaluation.realism.load_clearances", lambda changed=changed: changed)
        (found,) = trial_realism(far)
        assert found.contacts == contacts
    assert "It keeps the distance of recorded people within 20 %" in found.sentence


def test_the_shipped_numbers_are_of_the_models_of_today() -> None:
    import around_robots

    table, models = load_clearances(), around_robots.compared_models()
    assert [row.crowd for row in table.crowds] == list(models)
    stale = [name for name, model in models.items() if (row := table.find(model)) is None or row.crowd != name]
    assert not stale, f"the parameters of {', '.join(stale)} are others than those that were compared: run {COMMAND}"
    assert [row.crowd for row in table.crowds if row.fitted] == list(around_robots.FITTED)
    assert table.seeds == around_robots.SEEDS


def test_the_page_and_the_shipped_numbers_are_the_same(tmp_path: Path) -> None:
    import around_robots

    table = load_clearances()
    page = (ROOT / "docs" / "results" / "around-robots.md").read_text(encoding="utf-8")
    assert "\n".join(around_robots.clearance_lines(table)) in page, f"run {COMMAND}"
    table.save(tmp_path / "table.json")
    assert (tmp_path / "table.json").read_bytes() == around_robots.CLEARANCES.read_bytes()


def test_the_page_has_every_change_that_was_tried_for_the_cart_from_behind() -> None:
    import around_robots

    page = (ROOT / "docs" / "results" / "around-robots.md").read_text(encoding="utf-8")
    part = page.split("### What was tried for the cart from behind")[1].split("\n## ")[0]
    shown = [line.split(" | ")[0].removeprefix("| ") for line in part.splitlines() if line.startswith("| ")]
    names = [
        ", ".join(f"{key.replace('_', '-')} {value:g}" for key, value in way.items()) for way in around_robots.BACK_WAYS
    ]
    assert shown == ["change", "recorded people", "none", *names[1:]]


def test_other_values_of_a_preset_find_no_row() -> None:
    from crowdbot.models import People

    table = load_clearances()
    assert table.find(People()) == table.crowds[0]
    assert table.find(People(robot_gap=0.9)) is None
    assert table.find(People(headway_time_gap=1.6)) is None
