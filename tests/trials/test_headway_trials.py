"""The headway layer and presets in trials: names, parameters, both ways through XML, and in the world."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from crowdbot.core import TrialError
from crowdbot.models import ORCA, People, with_headway
from crowdbot.recording import run
from crowdbot.trials import Trial, load_trial
from crowdbot.trials.parser import parse_trial
from crowdbot.trials.xml.writer import trial_xml

TEXT = """<trial name="file" duration="4" step="0.1">
  <crowd type="{kind}" {more}/>
  <agent name="slow" x="1.5" y="0" goal="9,0" speed="0.2" radius="0.2"/>
  <agent name="fast" x="0" y="0" goal="9,0" speed="1.3" radius="0.2"/>
</trial>"""

OWN = '''
from dataclasses import dataclass
import crowdbot as cb
from crowdbot.core import Paper, PerAgent, parameter
from crowdbot.models.model import desired_velocity

@dataclass(frozen=True)
class Straight(cb.CrowdModel):
    """People walk straight ahead."""

    paper = Paper("Nobody", 2026, "Straight", "Nowhere")
    factor: PerAgent = parameter(1.0, low=0.5, high=2.0, unit="1", source="own choice")

    def velocity(self, scene, dt, rng=None):
        return desired_velocity(scene, dt) * self.factor
'''


def parse(kind: str, more: str = "", **how) -> Trial:
    return parse_trial(TEXT.format(kind=kind, more=more), **how)


@pytest.mark.parametrize("kind", ["orca+headway", "people", "collision-free-speed+headway"])
def test_names_go_both_ways_through_xml(kind):
    trial = parse(kind, 'headway-time-gap="0.8"')
    assert trial.crowd.headway_time_gap == 0.8
    text = trial_xml(trial)
    assert f'type="{kind}"' in text
    assert parse_trial(text) == trial


def test_parameters_of_the_layer_are_drawn_for_each_person():
    trial = parse("orca+headway", 'headway-time-gap="uniform(0.8, 1.2)" time-horizon="3"')
    model = trial.crowd.resolve(0, 0, 2)
    assert model.headway_time_gap.shape == (2,)
    assert model.model.time_horizon == 3.0


def test_problems_are_told():
    with pytest.raises(TrialError, match="headway-tim-gap.*did you mean 'headway-time-gap'"):
        parse("orca+headway", 'headway-tim-gap="0.8"')
    with pytest.raises(TrialError, match="single crowd model"):
        parse("mixture+headway")
    with pytest.raises(TrialError, match="headway_time_gap"):
        parse("people", 'headway-time-gap="-1"')


def test_a_model_in_a_file_takes_the_layer(tmp_path):
    (tmp_path / "own.py").write_text(OWN)
    trial = parse("own.py:Straight+headway", 'factor="0.9"', folder=tmp_path)
    assert trial.crowd.model.factor == 0.9
    assert 'type="own.py:Straight+headway"' in trial_xml(trial)
    with pytest.raises(TrialError):
        parse(f"{tmp_path}/own.py:Straight+headway", folder=tmp_path / "other", trust=False)


@pytest.mark.parametrize("world", ["planar", "physics"])
def test_nobody_runs_into_the_person_ahead_in_either_world(world):
    trial = dataclasses.replace(parse("people"), world=world)
    tracks = run(trial, seed=0).tracks(dt=0.1)
    slow, fast = ((tracks.x[tracks.id == item], tracks.y[tracks.id == item]) for item in np.unique(tracks.id))
    distance = np.hypot(slow[0] - fast[0], slow[1] - fast[1])
    assert len(distance) > 30
    assert distance.min() > 0.38
    assert distance[-1] < 1.5


def test_the_layer_is_on_the_previous_crowd_by_name_only():
    assert type(load_trial("crossing-flows").crowd) is People
    assert type(load_trial("crossing-flows", model="orca").crowd) is ORCA
    assert type(load_trial("crossing-flows", model="orca+headway").crowd) is with_headway(ORCA)
