"""Elements of a trial that are added and removed by path."""

from __future__ import annotations

import pytest

from crowdbot.core import TrialError
from crowdbot.trials import add_element, load_trial, needs_trust, parse_trial, remove_element
from trial_texts import GOOD

ROBOT = (
    '<robot name="second" x="0" y="0"><goal x="5" y="2"/><drive type="differential-drive"/>'
    '<navigator type="straight"/></robot>'
)


@pytest.mark.parametrize(
    ("xml", "parent", "path"),
    [
        ('<wall points="1,1 2,1"/>', "stage", "stage/wall[2]"),
        ('<cube x="2" y="-1.5"/>', "stage", "stage/cube"),
        (ROBOT, "", "robot[second]"),
        ('<sensor name="more" type="imu"/>', "robot", "robot/sensor[more]"),
        ('<exit name="east" zone="5.5,-3 6,-3 6,3 5.5,3"/>', "/", "exit[east]"),
    ],
)
def test_what_is_added_is_there_and_removing_it_gives_the_trial_back(xml: str, parent: str, path: str) -> None:
    trial = parse_trial(GOOD)
    more = add_element(trial, xml, parent)
    assert more != trial
    assert remove_element(more, path) == trial


@pytest.mark.parametrize(
    ("xml", "parent", "sentence"),
    [
        ("<wal/>", "stage", "<stage> takes no <wal>; it takes wall, obstacle,"),
        ("<cube/>", "crowd", "<crowd> takes no <cube>; it takes no elements"),
        ('<wall points="0"/>', "stage", "where a point x,y should be"),
        ("<wall/>", "stag", "has no element 'stag', did you mean 'stage'?"),
        ("text", "stage", "is not well-formed XML"),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]><wall points='&b;'/>", "stage", "DOCTYPE"),
        ("<wall" + " " * 1_000_000 + "/>", "stage", "characters, at most 1000000"),
    ],
)
def test_what_cannot_be_added_is_explained(xml: str, parent: str, sentence: str) -> None:
    with pytest.raises(TrialError) as caught:
        add_element(parse_trial(GOOD), xml, parent)
    assert sentence in str(caught.value)


@pytest.mark.parametrize(
    ("path", "sentence"),
    [
        ("stage/wall[2]", "there are 1 <wall>, numbered from 1"),
        ("stage/cube", "does not exist: there are 0 <cube>"),
        ("robot[hal]", "no <robot> has the name 'hal'"),
        ("", "does not exist"),
        ("crowd", "needs the element <crowd>"),
    ],
)
def test_what_cannot_be_removed_is_explained(path: str, sentence: str) -> None:
    with pytest.raises(TrialError) as caught:
        remove_element(parse_trial(GOOD), path)
    assert sentence in str(caught.value)


def test_an_element_cannot_load_code_from_outside_the_folder(tmp_path) -> None:
    code = tmp_path / "mine.py"
    code.write_text("raise SystemExit\n")
    trial = load_trial("frontal")
    assert not needs_trust(trial)
    with pytest.raises(TrialError, match="outside"):
        add_element(trial, ROBOT.replace('"straight"', f'"{code}:Pilot"'), trust=False)
