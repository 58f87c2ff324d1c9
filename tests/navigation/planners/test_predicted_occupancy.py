"""A navigator among predicted scans: what it avoids and what it does not know; equal runs."""

import dataclasses

import numpy as np
import pytest

from crowdbot.core import InputError, Pose, Scene, Twist, Walls
from crowdbot.evaluation import parse_methods
from crowdbot.navigation import (
    DriveLimits,
    Observation,
    PredictedOccupancyNavigator,
    VisiblePeople,
    check_navigator,
)
from crowdbot.navigation.planners.predicted_occupancy import _gaps
from crowdbot.recording import branch, record, replay
from crowdbot.sensors import Lidar2D
from crowdbot.simulation import simulate, simulate_seeds
from crowdbot.trials import load_trial

LIMITS = DriveLimits(1.0, 1.5, 1.0, 3.0)


def scan_at(pose, time, people, walls=None):
    scene = Scene.of(np.array(people, dtype=float).reshape(1, -1, 2), radius=0.25, walls=walls or Walls.of())
    scan = Lidar2D(rays=360, range_max=10.0).read(scene, Pose.of(pose[:2], pose[2]))
    return dataclasses.replace(scan, time=time)


def nobody(time):
    """Return a person who is far from the way."""
    return [[4.0, -6.0]]


def drive(navigator, people, walls=None, known=()):
    """Return the last action of a robot that drives ahead for 1.1 s and scans people, whose places depend on time."""
    memory = None
    for k in range(12):
        time, pose = 0.1 * k, (0.08 * k, 0.0, 0.0)
        now = {"pose": pose, "goal": (9.0, 0.0), "radius": 0.3, "limits": LIMITS, "dt": 0.1, "time": time}
        now |= {"scan": scan_at(pose, time, people(time), walls), "twist": Twist(0.8)}
        observation = Observation(**(now | dict(known)))
        memory = navigator.begin(observation) if memory is None else memory
        action, memory = navigator.act(observation, memory)
    return action


def test_it_drives_on_where_nothing_will_be():
    action = drive(PredictedOccupancyNavigator(), nobody)
    assert action.twist.forward == pytest.approx(1.0)
    assert action.twist.turn == pytest.approx(0.0, abs=1e-9)


def test_it_avoids_where_a_person_will_be_and_not_where_the_person_is():
    """The person is ahead now and leaves; another one is aside now and comes."""
    leaving = drive(PredictedOccupancyNavigator(), lambda time: [[3.2, -0.1 + 1.3 * time]])
    assert leaving.twist.forward > 0.9
    assert abs(leaving.twist.turn) < 0.2
    coming = drive(PredictedOccupancyNavigator(), lambda time: [[2.6, 3.2 - 1.3 * time]])
    assert coming.twist.forward < 0.9 or abs(coming.twist.turn) > 0.2


def test_people_and_walls_of_the_observation_do_not_count():
    person = VisiblePeople(np.array([[1.6, 0.1]]), np.zeros((1, 2)), np.full(1, 0.3))
    walls = Walls.of([[(1.8, -1.0), (1.8, 1.0)]])
    navigator = PredictedOccupancyNavigator()
    alone = drive(navigator, nobody)
    assert drive(navigator, nobody, known={"people": person, "walls": walls}) == alone
    assert drive(navigator, nobody, walls) != alone


def test_it_stands_before_the_first_scan():
    navigator = PredictedOccupancyNavigator()
    blind = Observation(pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=LIMITS, dt=0.1)
    action, memory = navigator.act(blind, navigator.begin(blind))
    assert action.twist == Twist()
    assert memory == navigator.begin(blind)


def test_the_contract_and_the_limits_are_kept():
    navigator = PredictedOccupancyNavigator(speed=0.6, samples=3)
    check_navigator(navigator)
    action = drive(navigator, lambda time: [[2.5, 0.0]])
    assert 0.0 <= action.twist.forward <= 0.6
    assert abs(action.twist.turn) <= LIMITS.max_turn_rate
    assert action == drive(navigator, lambda time: [[2.5, 0.0]])


def test_gaps_are_distances_to_the_returns_of_the_same_time():
    angle = np.linspace(0.0, 2.0 * np.pi, 90, endpoint=False)
    ray = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    ranges = np.where(np.arange(180).reshape(2, 90) % 3 == 0, 1.0 + np.arange(180).reshape(2, 90) / 60.0, np.inf)
    places = np.array([[[0.5, 0.2], [1.0, -0.5]], [[0.0, 0.0], [-1.0, 1.0]]])
    ends = np.array([0.1, -0.2]) + ranges[..., None] * ray
    away = np.linalg.norm(np.where(np.isfinite(ends), ends, 99.0) - places[:, :, None], axis=-1).min(axis=-1)
    assert _gaps(places, ranges, ray, np.array([0.1, -0.2]), 9.0) == pytest.approx(away)


@pytest.mark.parametrize(
    ("values", "message"),
    [({"horizon": 0.0}, "horizon = 0"), ({"risk": -1.0}, "risk = -1"), ({"samples": 0}, "samples = 0")],
)
def test_wrong_values_are_explained(values, message):
    with pytest.raises(InputError, match=message):
        PredictedOccupancyNavigator(**values)


def test_runs_are_equal_in_batches_alone_replayed_and_branched(tmp_path):
    trial = parse_methods("predicted-occupancy")[0].put_into(load_trial("frontal", duration=2.0))
    together = [seed.digest for seed in simulate_seeds(trial, range(2))]
    first = record(trial, 0, out=tmp_path / "first")
    assert together == [first.digest, simulate(trial, 1).digest]
    assert replay(tmp_path / "first" / "episode.mcap").equal
    assert branch(tmp_path / "first" / "episode.mcap", at=1.5).digest == first.digest


def test_a_robot_with_scans_only_passes_a_person():
    trial = parse_methods("predicted-occupancy")[0].put_into(load_trial("frontal"))
    runs = list(simulate_seeds(trial, range(3)))
    assert [run.outcome for run in runs] == ["success"] * 3
    assert min(run.metrics["min_clearance"] for run in runs) > 0.05
