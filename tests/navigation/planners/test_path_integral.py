"""MPPI: reaches goals among people, keeps limits, mirrors, and repeats its random plans."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from open_ground import ANY_WAY, WHEELS, drive, observe

from crowdbot.core import InputError, Twist, Walls
from crowdbot.navigation import DriveLimits, MPPINavigator, check_navigator
from crowdbot.recording import branch
from crowdbot.simulation import simulate, simulate_seeds
from crowdbot.trials import load_trial

every_drive = pytest.mark.parametrize("limits", [WHEELS, ANY_WAY], ids=["differential", "holonomic"])


def decide(seen, navigator=None):
    navigator = navigator or MPPINavigator()
    return navigator.decide(seen, navigator.first_memory(seen))


def test_keeps_the_contract():
    check_navigator(MPPINavigator())


@every_drive
def test_reaches_its_goal_and_stays(limits):
    path, _ = drive(MPPINavigator(), limits, (3.0, 2.0), 9.0)
    assert math.dist(path[-1], (3.0, 2.0)) < 0.2
    assert math.dist(path[-1], path[-6]) < 0.05


@every_drive
def test_passes_people_who_come_towards_it(limits):
    people = [(4.0, 0.1, -1.0, 0.0), (6.0, -0.8, -0.8, 0.1), (5.0, 2.5, 0.0, -0.7)]
    path, gap = drive(MPPINavigator(), limits, (7.0, 0.0), 12.0, people)
    assert gap > 0.1
    assert math.dist(path[-1], (7.0, 0.0)) < 0.3


@every_drive
def test_stops_for_people_in_front_of_a_wall(limits):
    people = [(2.0, y, 0.0, 0.0) for y in (-0.4, 0.0, 0.4)]
    walls = [[(2.4, -1.0), (2.4, 1.0)], [(-1.0, -0.8), (2.4, -0.8)], [(-1.0, 0.8), (2.4, 0.8)]]
    path, gap = drive(MPPINavigator(), limits, (5.0, 0.0), 8.0, people, walls)
    assert gap > 0.0
    assert np.abs(path[:, 1]).max() < 0.5
    assert path[-1, 0] < 1.45


@every_drive
def test_a_mirrored_scene_mirrors_the_twist(limits):
    people = np.array([(2.5, 0.3, -1.0, 0.1), (1.5, -1.2, 0.2, 0.6)])
    wall = np.array([(-2.0, 1.4), (9.0, 1.2)])
    one, _ = decide(observe(people, twist=Twist(0.8, 0.2), goal=(9.0, 1.0), walls=Walls.of([wall]), limits=limits))
    mirror = {"walls": Walls.of([wall * (1.0, -1.0)]), "twist": Twist(0.8, -0.2), "goal": (9.0, -1.0)}
    other, _ = decide(observe(people * (1.0, -1.0, 1.0, -1.0), limits=limits, **mirror))
    flipped = (other.twist.forward, -other.twist.turn, -other.twist.left)
    assert tuple(one.twist) == pytest.approx(flipped, abs=1e-9)


@pytest.mark.parametrize("limits", [DriveLimits(0.5, 0.4, 0.6, 0.8), DriveLimits(0.7, 9.0, holonomic=True)])
def test_limits_are_kept_and_values_finite_among_200_people(limits):
    rng = np.random.default_rng(7)
    walls = Walls.of([[(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)]])
    people = np.column_stack([rng.uniform(-6.0, 6.0, (200, 2)), rng.normal(0.0, 1.0, (200, 2))])
    people[0, :2] = 0.0  # at the place of the robot
    for goal in ((0.0, 0.0), (-8.0, 3.0), (0.2, 0.0)):
        action, plan = decide(observe(people, limits=limits, goal=goal, walls=walls), MPPINavigator(speed=0.6))
        forward, turn, left = action.twist
        assert np.all(np.isfinite([forward, turn, left]))
        assert np.all(np.isfinite(plan))
        assert math.hypot(forward, left) <= min(0.6, limits.max_speed) + 1e-9
        assert abs(turn) <= limits.max_turn_rate + 1e-9
        assert limits.holonomic or (left == 0.0 and forward >= 0.0)


def test_random_plans_follow_from_seed_and_time():
    seen = observe([(2.5, 0.3, -1.0, 0.1)], twist=Twist(0.8, 0.0))
    twist = decide(seen)[0].twist
    assert decide(seen)[0].twist == twist
    assert decide(seen, MPPINavigator(seed=1))[0].twist != twist
    assert decide(dataclasses.replace(seen, time=0.1))[0].twist != twist


def test_the_next_decision_begins_at_the_plan_of_the_last():
    seen = observe([(2.5, 0.1, -1.0, 0.0)], twist=Twist(0.8, 0.0))
    action, plan = decide(seen)
    assert plan.shape == (20, 2)
    assert 0.5 * (plan[0] + plan[0]) == pytest.approx(plan[0])
    later = MPPINavigator(rollouts=1, speed_noise=1e-9, turn_noise=1e-9).decide(
        dataclasses.replace(seen, time=0.1), plan
    )
    assert later[0].twist.turn == pytest.approx(plan[0, 1], abs=1e-6)
    assert abs(action.twist.turn) > 0.1


def test_equal_seeds_give_equal_digests_and_a_branch_keeps_the_plan():
    settings = {"robot/navigator/type": "mppi", "robot/navigator/rollouts": 16, "duration": 3.0}
    trial = load_trial("crowdnav-circle-5", **settings)
    alone = simulate(trial, 1)
    assert simulate_seeds(trial, range(2))[1].digest == alone.digest
    assert branch(alone, 1.5).digest == alone.digest


@pytest.mark.parametrize(
    ("field", "value"),
    [("temperature", 0.0), ("rollouts", 0), ("rollouts", 1.5), ("turn_noise", -1.0), ("risk", math.nan)],
)
def test_wrong_values_are_explained(field, value):
    with pytest.raises(InputError, match=rf"MPPINavigator: {field} = .*must be"):
        MPPINavigator(**{field: value})
