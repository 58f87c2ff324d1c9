"""Clearance to the outline of a robot."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import stream
from crowdbot.metrics import FOOTPRINT_METRICS, AgentStates, footprint_clearance
from crowdbot.recording import read_episode, run
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial, parse_trial, trial_xml


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 10**6))
def test_it_is_the_distance_of_polygons(seed: int) -> None:
    rng = stream(seed, "outline")
    angle = np.sort(rng.uniform(-math.pi, math.pi, 7))
    corners = (rng.uniform(0.2, 1.0, 7) * np.array([np.cos(angle), np.sin(angle)])).T
    place, heading = rng.uniform(-1.5, 1.5, (2, 2)), rng.uniform(-3.0, 3.0, 2)
    states = AgentStates(0.0, np.arange(2), place, np.zeros((2, 2)), heading, np.full(2, 0.3))
    turn = np.array([[math.cos(heading[0]), -math.sin(heading[0])], [math.sin(heading[0]), math.cos(heading[0])]])
    shape, point = shapely.Polygon(corners @ turn.T + place[0]), shapely.Point(place[1])
    if not shape.is_valid:
        return
    away = -shape.exterior.distance(point) if shape.contains(point) else shape.distance(point)
    assert footprint_clearance(states, 0, corners) == pytest.approx(away - 0.3, abs=1e-9)


def test_nobody_else_and_an_unknown_heading_give_infinity() -> None:
    box = np.array([[0.5, 0.2], [-0.5, 0.2], [-0.5, -0.2], [0.5, -0.2]])
    alone = AgentStates(0.0, np.arange(1), np.zeros((1, 2)), np.zeros((1, 2)), np.zeros(1), np.ones(1))
    blind = AgentStates(0.0, np.arange(2), np.zeros((2, 2)), np.zeros((2, 2)), np.full(2, np.nan), np.ones(2))
    assert footprint_clearance(alone, 0, box) == footprint_clearance(blind, 0, box) == math.inf


def test_a_robot_with_a_type_keeps_its_footprint(tmp_path) -> None:
    text = trial_xml(load_trial("frontal", duration=3.0))
    assert "<robot " in text
    trial = parse_trial(text.replace("<robot ", '<robot type="turtlebot2" default-sensors="false" ', 1))
    episode = run(trial, 0, out=tmp_path)
    recorded = read_episode(tmp_path / "episode.mcap")
    for one in (episode, recorded):
        assert np.array_equal(one.footprints[0], trial.robots[0].body.footprint)
        assert set(FOOTPRINT_METRICS) < set(one.metrics)
    assert repr(dict(recorded.metrics)) == repr(dict(episode.metrics))
    assert episode.metrics["min_footprint_clearance"] >= episode.metrics["min_clearance"] - 1e-9


def test_a_disc_has_no_footprint() -> None:
    episode = simulate(load_trial("frontal", duration=1.0), 0)
    assert episode.footprints == (None,)
    assert not set(FOOTPRINT_METRICS) & set(episode.metrics)
