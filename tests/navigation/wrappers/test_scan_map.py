"""A navigator that knows only scans: its map, its limits, and equal runs in batches, replays and branches."""

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import InputError, Pose, Scene, TrialError, Walls
from crowdbot.evaluation import parse_methods
from crowdbot.navigation import DriveLimits, Observation, ScanMapNavigator, VisiblePeople, check_navigator
from crowdbot.navigation.wrappers.scan_map import OCCUPIED, PLANNERS
from crowdbot.recording import branch, record, replay
from crowdbot.sensors import Lidar2D
from crowdbot.simulation import simulate, simulate_seeds
from crowdbot.trials import load_trial

LIMITS = DriveLimits(1.0, 1.5, 1.0, 3.0)


def scan_at(pose, time=0.0, people=((2.0, 0.0),)):
    """Return a scan of people at rest with a radius of 0.3 m."""
    rows = np.array(people, dtype=float).reshape(1, -1, 2)
    scene = Scene.of(rows, radius=0.3, walls=Walls.of([[(-3.0, 3.0), (3.0, 3.0)]]))
    scan = Lidar2D(rays=360, range_max=10.0).read(scene, Pose.of(pose[:2], pose[2]))
    return dataclasses.replace(scan, time=time)


def seen(pose=(0.0, 0.0, 0.0), time=0.0, **changes):
    known = {"pose": pose, "goal": (6.0, 0.0), "radius": 0.3, "limits": LIMITS, "dt": 0.1, "time": time}
    return Observation(**(known | {"scan": scan_at(pose, time)} | changes))


def occupied(memory, navigator):
    """Return the centres of the occupied cells [m]."""
    grid, i, j, *_ = memory
    return (np.argwhere(grid >= OCCUPIED) + (i, j) + 0.5) * navigator.cell


def after(navigator, observations):
    memory = navigator.begin(observations[0])
    for observation in observations:
        action, memory = navigator.act(observation, memory)
    return action, memory


def test_the_map_has_what_beams_hit_and_moves_with_the_robot():
    navigator = ScanMapNavigator()
    poses = [(0.13 * k, 0.02 * k, 0.05 * k) for k in range(6)]
    _, memory = after(navigator, [seen(pose, 0.1 * k) for k, pose in enumerate(poses)])
    cells = occupied(memory, navigator)
    person = np.abs(np.hypot(*(cells - (2.0, 0.0)).T) - 0.3)
    wall = np.abs(cells[:, 1] - 3.0)
    assert len(cells) > 20
    assert np.minimum(person, wall).max() < 0.1
    assert (person < 0.1).any()
    assert (wall < 0.1).any()


def test_who_leaves_is_forgotten():
    navigator = ScanMapNavigator()
    here = [seen(time=0.1 * k) for k in range(4)]
    _, memory = after(navigator, here)
    assert len(occupied(memory, navigator)) > 0
    for k in range(4, 12):
        gone = seen(time=0.1 * k, scan=scan_at((0.0, 0.0, 0.0), 0.1 * k, people=((2.0, 9.0),)))
        _, memory = navigator.act(gone, memory)
    cells = occupied(memory, navigator)
    assert not (np.hypot(*(cells - (2.0, 0.0)).T) < 0.5).any()


@pytest.mark.parametrize("planner", PLANNERS)
def test_people_and_walls_of_the_observation_do_not_count(planner):
    navigator = ScanMapNavigator(planner=planner)
    person = VisiblePeople(np.array([[1.0, 0.2]]), np.zeros((1, 2)), np.full(1, 0.3))
    walls = Walls.of([[(0.8, -1.0), (0.8, 1.0)]])
    one, _ = after(navigator, [seen()])
    other, _ = after(navigator, [seen(people=person, walls=walls)])
    assert one == other


@pytest.mark.parametrize("planner", PLANNERS)
def test_the_contract_and_the_limits_are_kept(planner):
    navigator = ScanMapNavigator(planner=planner, speed=0.6)
    check_navigator(navigator)
    action, _ = after(navigator, [seen(time=0.1 * k) for k in range(5)])
    assert 0.0 <= action.twist.forward <= 0.6
    assert abs(action.twist.turn) <= LIMITS.max_turn_rate


def test_invalid_ranges_add_nothing():
    scan = scan_at((0.0, 0.0, 0.0))
    broken = dataclasses.replace(scan, ranges=np.where(np.arange(360) % 2 == 0, np.nan, -np.inf)[None])
    _, memory = after(ScanMapNavigator(), [seen(scan=broken)])
    assert not memory[0].any()


@pytest.mark.parametrize(
    ("values", "message"),
    [({"planner": "orka"}, "did you mean 'orca'"), ({"cell": 5.0}, "4 to 400 cells"), ({"memory": 0.0}, "memory = 0")],
)
def test_wrong_values_are_explained(values, message):
    with pytest.raises(InputError, match=message):
        ScanMapNavigator(**values)


@pytest.mark.parametrize("name", ["predicted-occupancy", "scan-map", "scan-policy"])
def test_a_robot_without_a_planar_scanner_is_refused(name):
    with pytest.raises(TrialError, match=r"but no planar laser scanner; add <sensor type=\"lidar2d\"/>"):
        load_trial("crowdnav-circle-5", {"robot/navigator/type": name})
    assert load_trial("frontal", {"robot/navigator/type": name}).robots[0].navigator.needs_scan


def test_runs_are_equal_in_batches_alone_replayed_and_branched(tmp_path):
    trial = parse_methods("scan-map")[0].put_into(load_trial("frontal", duration=2.5))
    together = [seed.digest for seed in simulate_seeds(trial, range(2))]
    first = record(trial, 0, out=tmp_path / "first")
    assert together == [first.digest, simulate(trial, 1).digest]
    assert replay(tmp_path / "first" / "episode.mcap").equal
    assert branch(tmp_path / "first" / "episode.mcap", at=2.0).digest == first.digest


def test_a_robot_without_tracker_passes_a_person():
    trial = parse_methods("scan-map")[0].put_into(load_trial("frontal"))
    runs = list(simulate_seeds(trial, range(4)))
    assert [run.outcome for run in runs].count("success") >= 3
    assert math.isfinite(sum(run.metrics["min_clearance"] for run in runs))
