"""Files of earlier versions load: old names of attributes are renamed, with one line that says what to write now."""

from __future__ import annotations

import warnings

import pytest

from crowdbot.core import TrialError
from crowdbot.experiments import parse_experiment
from crowdbot.trials import OldNameWarning, expand_sweeps, load_trial, parse_trial, trial_xml
from crowdbot.trials.xml.old_names import OLD_ATTRIBUTES

NEW = """<trial name="hall" duration="2" robot-margin="0.2" heading-jitter="0.01">
  <crowd type="orca"/>
  <source zone="0,0 1,0 1,1" goal="8,0 9,0 9,1" rate="0.5" max-count="3"/>
  <recorded data="walkers.csv" fps="25" mode="reactive" reaction-distance="4" exclude="2"/>
  <robot type="pepper" x="0" y="3" default-sensors="false" sensor-rates="nearest">
    <goal x="9" y="3"/>
    <navigator type="straight"/>
  </robot>
</trial>
"""
QUESTIONS = """<experiment name="e">
  <block name="b">
    <trial name="t" source="frontal"/>
    <after name="after" text="And now?">
      <choice name="c" text="?" multiple="true"><option value="a"/><option value="b"/></choice>
      <number name="n" text="?" min="1" max="9" integer="true"/>
      <free-text name="f" text="?" max-length="50"/>
    </after>
  </block>
</experiment>
"""


def aged(text: str) -> str:
    """Return the text with every attribute under its old name."""
    for (tag, old), new in OLD_ATTRIBUTES.items():
        head, found, rest = text.partition(f"<{tag} ")
        element, end, after = rest.partition(">")
        text = head + found + element.replace(f' {new}="', f' {old}="') + end + after
    return text


def test_the_texts_have_every_old_name() -> None:
    old = aged(NEW) + aged(QUESTIONS)
    assert [key for key in OLD_ATTRIBUTES if f' {key[1]}="' not in old] == []


def test_an_old_trial_loads_with_one_line(tmp_path) -> None:
    rows = "".join(f"{10 * k},{who},{0.5 * k},{who}.0\n" for k in range(8) for who in (1, 2))
    (tmp_path / "walkers.csv").write_text("frame,id,x,y\n" + rows)
    text = aged(NEW)
    with pytest.warns(OldNameWarning) as said:
        trial = parse_trial(text, place="hall.xml", folder=tmp_path)
    assert len(said) == 1
    assert str(said[0].message).startswith("hall.xml:1: old names of attributes: <trial berth> is now robot-margin; ")
    assert all(f"<{tag} {old}> is now {new}" in str(said[0].message) for (tag, old), new in OLD_ATTRIBUTES.items()
               if f"<{tag} " in NEW)  # fmt: skip
    assert trial == parse_trial(NEW, folder=tmp_path)
    assert not any(f' {old}="' in trial_xml(trial) for _, old in OLD_ATTRIBUTES)


def test_an_old_experiment_loads_with_one_line() -> None:
    with pytest.warns(OldNameWarning, match="<choice several> is now multiple; <number at-least> is now min") as said:
        experiment = parse_experiment(aged(QUESTIONS))
    assert len(said) == 1
    assert experiment == parse_experiment(QUESTIONS)


def test_current_names_do_not_warn() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert load_trial("two-crowds").heading_jitter > 0.0


def test_an_attribute_under_both_names_is_an_error() -> None:
    text = '<trial name="t" duration="1" robot-margin="0.1" berth="0.2"><crowd type="orca"/></trial>'
    with pytest.raises(TrialError, match="<trial> has no attribute 'berth'"):
        parse_trial(text)


def test_sweeps_may_have_old_paths() -> None:
    text = """<trial name="t" duration="1"><crowd type="orca"/><sweep path="berth" values="0.1 0.3"/></trial>"""
    assert [one.robot_margin for one in expand_sweeps(parse_trial(text))] == [0.1, 0.3]
