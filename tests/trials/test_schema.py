"""The schema: up to date, and of one mind with the reader, as an independent validator sees it."""

from __future__ import annotations

import importlib.resources

import pytest
from hypothesis import given, settings
from lxml import etree
from test_reading import trials

from crowdbot.trials import Trial, builtin_trials, expand_spawners, load_trial, schema, trial_xml
from trial_schema import SCHEMA, valid
from trial_texts import FLOW, GOOD


def test_the_schema_that_is_shipped_is_up_to_date() -> None:
    shipped = importlib.resources.files("crowdbot").joinpath("assets", "trial.xsd").read_text(encoding="utf-8")
    assert shipped == schema(), "run make fix"


@pytest.mark.parametrize("name", builtin_trials())
def test_builtin_trials_are_valid(name: str) -> None:
    assert valid(trial_xml(load_trial(name))), SCHEMA.error_log
    assert valid(trial_xml(expand_spawners(load_trial(name)))), SCHEMA.error_log


@pytest.mark.parametrize("text", [GOOD, FLOW], ids=["good", "flow"])
def test_the_trials_of_the_tests_are_valid(text: str) -> None:
    assert valid(text), SCHEMA.error_log


@settings(max_examples=40, deadline=None)
@given(trials())
def test_any_trial_is_valid(trial: Trial) -> None:
    assert valid(trial_xml(trial)), SCHEMA.error_log


ALL = """<trial name="all" duration="5" capacity="20">
  <stage area="POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0))" map="m.yaml" unknown="free"/>
  <routing radius="0.2" unreachable="nearest"/>
  <crowd type="orca" time-horizon="normal(2, 0.1)"/>
  <contact/><limits max-speed="2"/>
  <journey name="lap" then="again"><zone points="1,1 2,1 2,2" aim="random"/></journey>
  <agent x="1" y="1" heading="-2" goal="3,3" group="0"><parameter name="time-horizon" value="2"/></agent>
  <spawner count="2" zone="1,1 2,1 2,2" stands="true"><group size="2" share="0.5"/></spawner>
  <recorded data="a.txt" fps="2.5" mode="reactive" exclude="1 2"/>
  <portal zone="1,1 2,1 2,2" dx="1"/>
  <end empty="true"><when what="people" below="2" outcome="success"/></end>
  <recording period="0.2"/>
  <sweep path="seed" values="0:4"/>
</trial>"""


def test_new_parts_are_known() -> None:
    assert valid(ALL), SCHEMA.error_log


WORSE = [
    ('unknown="free"', 'unknown="fre"'),
    ('share="0.5"', 'share="0"'),
    ('share="0.5"', 'shar="0.5"'),
    ('fps="2.5"', 'fps="x"'),
    ('group="0"', 'group="-2"'),
    ('goal="3,3"', 'goal="3;3"'),
    ('stands="true"', 'stands="yes"'),
    ('name="all"', ""),
    ("<contact/>", "<contct/>"),
    ('capacity="20"', 'capacity="1e9"'),
]


@pytest.mark.parametrize(("old", "new"), WORSE)
def test_what_is_wrong_is_not_valid(old: str, new: str) -> None:
    assert not valid(ALL.replace(old, new, 1))


def test_every_element_and_attribute_has_words_for_people() -> None:
    root = etree.fromstring(schema().encode())
    space = {"xs": "http://www.w3.org/2001/XMLSchema"}
    for kind in ("attribute", "complexType"):
        named = [
            item for item in root.iterfind(f".//xs:{kind}", space) if item.get("name") and item.get("name") != "type"
        ]
        assert len(named) > 10
        assert all(item.find("xs:annotation/xs:documentation", space).text for item in named)
