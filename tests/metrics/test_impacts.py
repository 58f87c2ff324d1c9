"""Metrics of impacts in the physics world."""

import dataclasses
import math

import pytest

from crowdbot.metrics import IMPACT_METRICS, impact_metrics
from crowdbot.recording import read_episode, run
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial, parse_trial
from space_trials import LEAN, room


@dataclasses.dataclass
class Hit:
    """A contact event."""

    cause: str = "first"
    impact_speed: float = 0.5
    impulse: float = 2.0
    peak_force: float = 100.0
    steady_force: float = 0.0
    severity: float = 0.4


def test_values_of_some_impacts() -> None:
    hits = [Hit(), Hit("second", 1.0, 1.5, 300.0, 20.0, 1.2), Hit("mutual", 0.1, 0.5, math.nan, 0.0, math.nan)]
    values = impact_metrics(hits)
    assert list(values) == list(IMPACT_METRICS)
    assert [values[name] for name in IMPACT_METRICS] == [3, 1, 1, 1, 1.2, 300.0, 20.0, 4.0, 1.0]


def test_a_blow_on_the_head_is_infinitely_severe() -> None:
    assert impact_metrics([Hit(severity=math.inf)])["max_severity"] == math.inf


def test_impacts_are_absent_in_the_planar_world() -> None:
    assert not set(IMPACT_METRICS) & set(simulate(load_trial("frontal", duration=1.0), 0).metrics)


@pytest.mark.needs("mujoco")
def test_impacts_of_a_run_are_those_of_its_contact_events(tmp_path) -> None:
    trial = dataclasses.replace(parse_trial(room("physics", LEAN)), duration=3.0)
    episode = run(trial, 0, out=tmp_path)
    robot = trial.people
    own = [
        collision
        for collision in episode.collisions
        if collision.first == ("robot", robot) and collision.second.kind == "person"
    ]
    assert {name: episode.metrics[name] for name in IMPACT_METRICS} == pytest.approx(impact_metrics(own))
    recorded = read_episode(tmp_path / "episode.mcap")
    assert {name: recorded.metrics[name] for name in IMPACT_METRICS} == {
        name: episode.metrics[name] for name in IMPACT_METRICS
    }
