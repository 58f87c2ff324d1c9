"""A recorded episode is drawn with its uneven ground and doors."""

from __future__ import annotations

from pathlib import Path

import pytest

from crowdbot.core import TrialError
from crowdbot.recording import read_episode, run
from crowdbot.trials import floor_plan_of_xml, parse_trial

TEXT = """<trial name="d" duration="0.2" world="physics">
  <stage walkable="-1,-2 16,-2 16,2 -1,2">
    <ramp x="1" y="0" length="2" width="1" height="0.16"/>
    <stairs x="7" y="0" steps="3"/>
    <threshold x="5" y="1" bevel="0.02"/>
    <wall points="3,-2 3,-0.5"/><wall points="3,0.5 3,2"/>
    <door name="hall" points="3,-0.5 3,0.5"/>
  </stage>
  <crowd type="orca"/>
  <agent name="p" x="13" y="0.3" goal="15,0"/>
</trial>
"""


def test_a_recorded_episode_is_drawn_like_the_episode(tmp_path: Path) -> None:
    made = run(parse_trial(TEXT.encode()), 0, out=tmp_path / "out")
    recorded = read_episode(tmp_path / "out" / "episode.mcap")
    drawing = recorded._repr_svg_()
    assert drawing.count("#b08d57") == made._repr_svg_().count("#b08d57") > 8
    assert drawing.count("#2a7f9e") == 2  # arc and leaf of the door


def test_a_plan_needs_no_files_and_no_code_of_the_trial() -> None:
    text = TEXT.replace("walkable=", 'map="missing.yaml" walkable=').replace("orca", "missing.py:Model")
    assert len(floor_plan_of_xml(text)) == len(floor_plan_of_xml(TEXT)) > 8
    assert floor_plan_of_xml("<trial><stage/></trial>") == []


def test_wrong_ground_is_explained() -> None:
    with pytest.raises(TrialError, match="episode:4: <ramp> length"):
        floor_plan_of_xml(TEXT.replace('length="2"', 'length="-2"'), "episode")
