"""The reward: progress sums to the distance gained, a robot that stands gets nothing, ends and discomfort count."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot.gym import CrowdTask, Reward
from crowdbot.trials import load_trial

PROGRESS = Reward(success=0.0, collision=0.0, discomfort=0.0)


@pytest.mark.parametrize("name", ["circle-crossing", "crowdnav-circle-5"])
def test_the_progress_of_an_episode_is_the_distance_gained(name: str) -> None:
    task = CrowdTask(load_trial(name, {"duration": 8}), reward=PROGRESS)
    task.reset([3, 4, 5, 6])
    start, total, rng = task.port.goal_distance(), np.zeros(4), np.random.default_rng(1)
    end = start.copy()
    while not task.ended.all():
        going = ~task.ended
        step = task.step(np.column_stack([rng.uniform(-0.5, 1.0, 4), rng.uniform(-0.3, 0.3, 4)]))
        total += step.rewards
        end[going] = task.port.goal_distance()[going]
    assert np.ptp(total) > 0.01
    np.testing.assert_allclose(total, 0.1 * (start - end), rtol=0.0, atol=1e-12)


def test_an_episode_that_begins_again_counts_from_its_own_start() -> None:
    task = CrowdTask(load_trial("circle-crossing"), reward=PROGRESS)
    task.reset([3, 4])
    for _ in range(20):
        task.step(np.array([[1.0, 0.0]] * 2))
    task.restart([1], [9])
    before = task.port.goal_distance()
    rewards = task.step(np.array([[1.0, 0.0]] * 2)).rewards
    np.testing.assert_allclose(rewards, 0.1 * (before - task.port.goal_distance()), rtol=0.0, atol=1e-12)
    assert 0.0 < rewards[1] < rewards[0]


def test_a_robot_that_stands_gets_nothing() -> None:
    task = CrowdTask(load_trial("circle-crossing", {"duration": 2}))
    task.reset([3, 4])
    while not task.ended.all():
        assert task.step(np.zeros((2, 2))).rewards.tolist() == [0.0, 0.0]


def test_ends_and_discomfort() -> None:
    end, none = np.array([True]), np.array([False])
    far, near, still = np.array([0.5]), np.array([0.05]), np.zeros(1)
    reward = Reward()
    assert reward.values(far, end, none, still, 0.1).tolist() == [1.0]
    assert reward.values(far, none, end, still, 0.1).tolist() == [-1.0]
    assert reward.values(near, none, end, still, 0.1).tolist() == [-1.0]
    assert reward.values(near, none, none, still, 0.1) == pytest.approx(-0.5 * 0.15 * 0.1, abs=1e-15)
    assert reward.values(near, end, none, np.array([0.2]), 0.1) == pytest.approx(1.02, abs=1e-15)


def test_no_collision_within_10_m_is_better_than_standing() -> None:
    assert Reward().collision + 10.0 * Reward().progress <= 0.0
