"""Partial elements: what can be read of an element with a problem, and what a check does without the rest."""

from __future__ import annotations

from pathlib import Path

import pytest

from crowdbot.cli import main
from crowdbot.core import TrialError, UnreadableValue, without_running_code
from crowdbot.models import ORCA
from crowdbot.navigation import Navigator
from crowdbot.trials import Agent, EndCondition, Point, SourceSpec, Spawner, Stage, load_trial, readable
from crowdbot.trials.partial_element import (
    PartialElement,
    fill_defaults,
    has_kind,
    is_partial,
    kind_of,
    original_element,
    plugin_with_defaults,
    post_init_problem,
)
from trial_texts import SHY, changed, written


def test_fields_are_read_and_unreadable_fields_raise() -> None:
    agent = PartialElement(Agent, {"x": 1.0, "goal": ()}, {"y"})
    assert agent.x == 1.0
    for name in ("y", "position"):
        with pytest.raises(UnreadableValue):
            getattr(agent, name)
    with pytest.raises(AttributeError):
        _ = agent.colour
    assert agent.count == 1
    assert readable([agent, Point(2.0, 3.0)], "y") == [(1, 3.0)]


def test_nothing_pretends_to_be_an_element() -> None:
    agent = PartialElement(Agent, {"x": 1.0}, {"y"})
    assert type(agent) is PartialElement
    assert not isinstance(agent, Agent)
    assert kind_of(agent) is Agent
    assert has_kind(agent, Agent)
    assert has_kind(Point(0, 0), Point)
    assert not has_kind(agent, Spawner)
    assert is_partial(agent)
    assert not is_partial(Point(0, 0))


def test_of_an_unknown_class_nothing_is_readable() -> None:
    plugin = PartialElement(Navigator, {}, None)
    for name in ("speed", "act"):
        with pytest.raises(UnreadableValue):
            getattr(plugin, name)
    with pytest.raises(UnreadableValue):
        plugin_with_defaults(plugin)


def test_methods_of_the_class_use_the_readable_fields() -> None:
    source = PartialElement(SourceSpec, {"rate": 2.0, "begin": 0.0, "end": 5.0, "max_count": None}, {"zone"})
    assert source.arrival_count(10.0) == 11.0
    stage = PartialElement(Stage, {"walls": (), "obstacles": (), "props": (), "walkable": (), "area": ""}, {"map"})
    with pytest.raises(UnreadableValue):
        stage.clearance([(0.0, 0.0)])


def test_defaults_fill_what_is_unreadable() -> None:
    values = {"count": 2, "zone": ((0, 0), (1, 0), (1, 1)), "groups": (PartialElement(Point, {}, {"x"}),)}
    spawner = PartialElement(Spawner, values, {"speed", "name"})
    filled = fill_defaults(spawner, "count", groups=())
    assert (filled.count, filled.name, filled.groups) == (2, "", ())
    assert filled.speed.extent == Spawner(count=1, zone=values["zone"]).speed.extent
    assert original_element(filled) is spawner
    with pytest.raises(UnreadableValue):
        fill_defaults(spawner, "name")
    model = PartialElement(ORCA, {}, {"time_horizon"}, default=ORCA())
    assert plugin_with_defaults(model) == plugin_with_defaults(ORCA())


def test_the_checks_of_a_class_use_the_readable_fields() -> None:
    both = {"what": "x", "below": None, "above": None}
    assert post_init_problem(PartialElement(EndCondition, both, {"robot"})) == "needs one of below and above"
    assert post_init_problem(PartialElement(EndCondition, {"what": "x", "below": None}, {"above"})) == ""


@pytest.mark.parametrize("part", ["navigator", "crowd"])
def test_a_default_that_only_running_code_knows_does_not_stop_a_check(tmp_path: Path, part: str) -> None:
    """A sweep reads the trial once more from its elements."""
    (tmp_path / "shy.py").write_text("import os\n" + SHY.replace("float = 1.0", "float = os.getpid() / 1e6"))
    model = "import os\nfrom dataclasses import dataclass\nfrom crowdbot.models import ORCA\n"
    (tmp_path / "mine.py").write_text(
        f"{model}@dataclass(frozen=True)\nclass Mine(ORCA):\n    wish: float = os.nice(0)\n"
    )
    old, new = (
        ('type="straight"', 'type="shy.py:Shy"') if part == "navigator" else ('type="orca"', 'type="mine.py:Mine"')
    )
    text = changed(old, new).replace("<stage", '<sweep path="duration" values="3 4"/><stage', 1)
    trial = written(tmp_path, text)
    with without_running_code():
        assert load_trial(trial, duration=2).duration == 2.0
    assert main(["check", str(trial)]) == 0


def test_an_unreadable_default_is_no_problem_of_a_person(tmp_path: Path) -> None:
    model = "import os\nfrom dataclasses import dataclass\nfrom crowdbot.models import ORCA\n"
    (tmp_path / "mine.py").write_text(
        f"{model}@dataclass(frozen=True)\nclass Mine(ORCA):\n    wish: float = os.nice(0)\n"
    )
    agent = '<agent x="1" y="0.5"><parameter name="wish" value="3"/></agent><robot'
    trial = written(tmp_path, changed('type="orca"', 'type="mine.py:Mine"').replace("<robot", agent, 1))
    with without_running_code():
        assert load_trial(trial).agents[0].parameters[0].value == 3.0
    trial.write_text(trial.read_text().replace('name="wish" value="3"', 'name="wish"'))
    with without_running_code(), pytest.raises(TrialError, match="needs the attribute 'value'"):
        load_trial(trial)
