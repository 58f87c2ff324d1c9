"""Voronoi density around a robot, and the flow through the gate on its way, on hand-made logs and against few lines."""

import dataclasses
import itertools
import math

import numpy as np
import pytest
from robot_logs import agents_of, log_of_paths, random_log, walk

from crowdbot.metrics import RobotLog, gate_metrics, log_metrics
from crowdbot.metrics.social.gate_flow import count_crossings, find_gate
from crowdbot.metrics.social.surroundings import voronoi_density

DISC = math.pi * 2.5**2
DOOR = np.array([[3.0, 0.8, 3.0, 9.0], [3.0, -1.2, 3.0, -9.0]])


def test_one_person_and_nobody_have_the_classic_density():
    assert voronoi_density(np.zeros(2), np.zeros((0, 2))) == 0.0
    assert voronoi_density(np.zeros(2), np.zeros((1, 2))) == pytest.approx(1 / DISC)
    assert voronoi_density(np.zeros(2), np.array([[5.0, 0.0]])) == 0.0
    # at the border of the disc, the lens of two equal discs that hold each other's centre on their border
    lens = 2.5**2 * (2 * math.pi / 3 - math.sqrt(3) / 2)
    assert voronoi_density(np.zeros(2), np.array([[2.5, 0.0]])) == pytest.approx(lens / DISC / DISC, rel=1e-3)


def test_people_on_a_lattice_have_its_density():
    lattice = np.array([*itertools.product(np.arange(-8.0, 8.0, 0.8), repeat=2)])
    assert voronoi_density(np.array([0.13, 0.31]), lattice) == pytest.approx(1 / 0.8**2, rel=2e-3)
    log = log_of_paths(walk((0, 0), (0, 0), 2), *(walk(item, (0, 0), 2) for item in lattice))
    found = log_metrics(log, ["density"])
    assert found["voronoi_density"] == pytest.approx(1 / 0.8**2, rel=2e-3)
    assert found["max_voronoi_density"] == pytest.approx(found["voronoi_density"])


@pytest.mark.parametrize("seed", range(8))
def test_voronoi_density_counts_points_of_a_grid(seed):
    rng = np.random.default_rng(seed)
    place, people = rng.uniform(-1, 1, 2), rng.uniform(-5, 5, (rng.integers(1, 20), 2))
    h = 0.02
    points = np.array([*itertools.product(np.arange(-8, 8, h), repeat=2)])
    best, owner = np.full(len(points), 2.5), np.full(len(points), -1)
    for k, person in enumerate(people):
        away = np.hypot(*(points - person).T)
        owner[away < best], best = k, np.minimum(best, away)
    inside = np.hypot(*(points - place).T) < 2.5
    whole, part = (np.bincount(owner[rows & (owner >= 0)], minlength=len(people)) for rows in (True, inside))
    assert voronoi_density(place, people) == pytest.approx(float(np.sum(part / whole)) / DISC, rel=0.01)


def test_the_gate_is_the_narrowest_place():
    way = walk((0, 0), (1, 0), 4)
    assert find_gate(log_of_paths(way, way + 9.0)) is None
    free = find_gate(log_of_paths(way, way + 9.0, goal=(8.0, 0.0)))
    np.testing.assert_allclose(free, [[4.0, -5.0], [4.0, 5.0]])
    door = find_gate(log_of_paths(way, way + 9.0, goal=(8.0, 0.0), walls=DOOR))
    np.testing.assert_allclose(door, [[3.0, -1.2], [3.0, 0.8]])
    corner = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 6.0]])
    walls = np.array([[3.0, 2.0, 3.5, 2.0], [4.75, 2.0, 6.0, 2.0]])
    turned = find_gate(log_of_paths(way, way + 9.0, goal=(4.0, 6.0), walls=walls, path=corner))
    np.testing.assert_allclose(turned, [[4.75, 2.0], [3.5, 2.0]])


def test_flow_is_lost_when_the_robot_stands_in_the_door():
    robot = walk((0, 0), (0.5, 0), 100)
    free = [walk((6 + k, 0.1), (-1, 0), 100) for k in range(4)]  # 10 s: all pass x = 3
    held = [free[0], free[1], walk((8, 0.1), (-0.4, 0), 100), walk((9, 0.1), (-0.4, 0), 100)]
    run, ghost = agents_of(robot, *held), agents_of(robot, *free)
    log = RobotLog.of(run, 0, (8.0, 0.0), walls=DOOR)
    found = gate_metrics(log, run, ghost, 0)
    assert found["gate_flow"] == pytest.approx(2 / (2.0 * 10.0))
    assert found["gate_flow_without_robot"] == pytest.approx(4 / (2.0 * 10.0))
    assert found["gate_flow_loss"] == pytest.approx(0.5)
    assert math.isnan(gate_metrics(log, run, agents_of(robot, *held[2:], *held[2:]), 0)["gate_flow_loss"])
    nowhere = dataclasses.replace(log, goal=None)
    assert all(map(math.isnan, gate_metrics(nowhere, run, ghost, 0).values()))
    # the time ends when the robot arrives, in both runs
    early = gate_metrics(RobotLog.of(run, 0, (2.0, 0.0), tolerance=0.25, walls=DOOR), run, ghost, 0)
    assert early["gate_flow_loss"] == 0.0 or math.isnan(early["gate_flow_loss"])


@pytest.mark.parametrize("seed", range(8))
def test_crossings_agree_with_a_loop(seed):
    log = random_log(seed, people=8)
    position = np.concatenate([log.position[:, None], log.people_position], axis=1)
    active = np.concatenate([np.ones((len(log.times), 1), bool), log.present], axis=1)
    agents = agents_of(*np.moveaxis(position, 1, 0))._replace(active=active)
    gate = np.array([[0.0, -3.0], [0.0, 2.0]])
    count = 0
    for p in range(1, position.shape[1]):
        for t in range(1, len(log.times)):
            (x, y), (u, v) = position[t - 1, p], position[t, p]
            if active[t - 1, p] and active[t, p] and (x > 0) != (u > 0) and agents.times[t] <= 4.0:
                count += -3.0 <= y + (v - y) * x / (x - u) <= 2.0
    assert count_crossings(agents, gate, 0, 4.0) == count
