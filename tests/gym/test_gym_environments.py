"""Environments of Gymnasium: official checks, the same bytes as a run, vector and single equal, wrong input."""

from __future__ import annotations

import dataclasses
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from crowdbot.core import InputError, Twist
from crowdbot.gym import (
    ActionForm,
    CrowdEnv,
    CrowdTask,
    CrowdVectorEnv,
    ObservationForm,
    Reward,
    register_environments,
)
from crowdbot.models import ORCA
from crowdbot.navigation import Navigator, Observation
from crowdbot.simulation import simulate
from crowdbot.trials import Trial, load_trial

SHARE = (0.5, 0.25)
"""Shares of the maximum speed and turn rate that the robot of these tests takes."""


@dataclasses.dataclass(frozen=True)
class Steady(Navigator):
    """Commands constant shares of the limits."""

    def act(self, observation: Observation) -> Twist:
        return Twist(SHARE[0] * observation.limits.max_speed, SHARE[1] * observation.limits.max_turn_rate)


def trial_of(name: str = "circle-crossing", **values: Any) -> Trial:
    return load_trial(name, **values)


@pytest.mark.parametrize("observation", ["people", "scan", "both"])
def test_the_official_checker_passes_without_a_warning(observation: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(CrowdEnv("circle-crossing", observation=observation, duration=3.0), skip_render_check=True)
    assert CrowdEnv(observation=observation).metadata["render_modes"] == ["rgb_array"]


def test_an_episode_has_the_bytes_of_a_run() -> None:
    trial = trial_of(duration=4.0)
    robot = dataclasses.replace(trial.robots[0], navigator=Steady())
    episode = simulate(dataclasses.replace(trial, robots=(robot,)), 7)
    task = CrowdTask(trial)
    task.reset([7])
    steps = 0
    while not task.ended[0]:
        step = task.step(np.array([SHARE]))
        steps += 1
        assert task.simulation is not None
        now = np.flatnonzero(np.isclose(episode.times, steps * task.dt))
        assert task.simulation.world.scene.position[0].tobytes() == episode.position[now[0]].tobytes()
    assert step.outcomes == (episode.outcome,)


def play(envs: CrowdVectorEnv, seeds: list[int], actions: np.ndarray) -> list[dict[str, np.ndarray]]:
    observations, _ = envs.reset(seed=seeds)
    return [observations, *(envs.step(row)[0] for row in actions)]


def test_vector_and_single_environments_are_equal() -> None:
    rng = np.random.default_rng(0)
    actions = rng.uniform(-1.0, 1.0, (25, 3, 2)).astype(np.float32)
    many = play(CrowdVectorEnv("circle-crossing", 3, "both"), [4, 9, 2], actions)
    for e, seed in enumerate([4, 9, 2]):
        env = CrowdEnv("circle-crossing", "both")
        alone = [env.reset(seed=seed)[0], *(env.step(row[e])[0] for row in actions)]
        for item, rows in zip(alone, many, strict=True):
            for name, value in item.items():
                assert value.tobytes() == rows[name][e].tobytes()


@pytest.mark.parametrize("mode", ["next-step", "same-step"])
def test_environments_that_end_begin_again(mode: str) -> None:
    envs = CrowdVectorEnv("circle-crossing", 2, autoreset=mode, duration=0.5)
    assert envs.metadata["autoreset_mode"] == AutoresetMode(mode.title().replace("-S", "S"))
    observations, info = envs.reset(seed=3)
    assert info["seed"].tolist() == [3, 4]
    steps, first = 0, observations
    still = np.zeros((2, 2), dtype=np.float32)
    done = np.zeros(2, dtype=bool)
    while not done.any():
        observations, _, terminated, truncated, info = envs.step(still)
        done, steps = terminated | truncated, steps + 1
    assert steps == 5
    assert info["outcome"].tolist() == ["timeout", "timeout"]
    assert info["is_success"].tolist() == [False, False]
    if mode == "same-step":
        last = info["final_obs"]
    else:
        last, (observations, rewards, terminated, truncated, info) = observations, envs.step(still)
        assert rewards.tolist() == [0.0, 0.0]
        assert not (terminated | truncated).any()
    assert info["seed"].tolist() != [3, 4]
    alone = CrowdEnv("circle-crossing", duration=0.5)
    for e, seed in enumerate(info["seed"].tolist()):
        begun = alone.reset(seed=seed)[0]
        assert begun["people"].tobytes() == observations["people"][e].tobytes()
        assert last["people"][e].tobytes() != first["people"][e].tobytes()


@pytest.mark.parametrize("seed", [11, [11, 12], np.array([11, 12]), [None, 11]], ids=["one", "list", "array", "part"])
def test_the_same_seed_gives_the_same_episodes_after_the_first(seed: Any) -> None:
    def seeds() -> list[list[int]]:
        envs = CrowdVectorEnv("circle-crossing", 2, autoreset="same-step", duration=0.3)
        envs.reset(seed=seed)
        return [envs.step(np.zeros((2, 2), np.float32))[4]["seed"].tolist() for _ in range(12)]

    assert seeds() == seeds()


def test_observations_are_those_of_the_robot() -> None:
    trial = trial_of(duration=2.0)
    task = CrowdTask(trial, ObservationForm("both", max_people=3))
    found = task.reset([5])
    assert task.simulation is not None
    seen = task.simulation.observation("robot")
    own = np.array(seen.pose)
    away = np.array(seen.people.position) - own[:2]
    clearance = np.hypot(*away.T) - np.array(seen.people.radius) - trial.robots[0].radius
    order = np.argsort(clearance, kind="stable")[:3]
    count = len(order)
    np.testing.assert_allclose(found["people"][0, :count, 5], clearance[order], rtol=1e-5, atol=1e-6)
    turn = np.array([[np.cos(own[2]), np.sin(own[2])], [-np.sin(own[2]), np.cos(own[2])]])
    np.testing.assert_allclose(found["people"][0, :count, :2], (away @ turn.T)[order], rtol=1e-5, atol=1e-5)
    assert found["people"][0, :, 6].tolist() == [1.0] * count + [0.0] * (3 - count)
    assert found["scan"].shape == (1, task.beams)
    goal = np.array(trial.robots[0].goal.position)
    assert found["robot"][0, 3] == pytest.approx(np.hypot(*(goal - own[:2])), rel=1e-5)


def test_rewards_have_their_terms() -> None:
    reward = Reward(progress=2.0)
    values = reward.values(
        np.array([0.5, 0.1, -0.1, 0.1]),
        np.array([False, False, False, True]),
        np.array([False, False, True, False]),
        np.array([0.1, 0.0, 0.0, 0.2]),
        0.25,
    )
    np.testing.assert_allclose(values, [0.2, -0.5 * 0.1 * 0.25, -1.0, 1.4])


def test_holonomic_actions_stay_within_the_maximum_speed() -> None:
    task = CrowdTask(trial_of())
    task.reset([0])
    twists = ActionForm("holonomic").twists(np.array([[1.0, 1.0], [0.5, 0.0], [3.0, 0.0]]), task.limits)
    assert np.hypot(twists[:, 0], twists[:, 2]) == pytest.approx(
        [task.limits.max_speed, 0.5 * task.limits.max_speed, task.limits.max_speed]
    )


def test_registered_environments_are_made() -> None:
    for name in register_environments():
        env = gymnasium.make(name)
        observation, info = env.reset(seed=1)
        assert env.observation_space.contains(observation)
        assert info["seed"] == 1
    envs = gymnasium.make_vec("crowdbot/CircleCrossing-v0", num_envs=3, vectorization_mode="vector_entry_point")
    assert envs.reset(seed=0)[0]["people"].shape == (3, 10, 7)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"observation": "image"}, "observation = 'image' must be one of people, scan, both, occupancy"),
        ({"action": "force"}, "action = 'force' must be one of velocity, acceleration, holonomic"),
        ({"robot": "r2"}, "has no robot 'r2'; it has robot"),
        ({"trial": Trial(name="empty", duration=1.0, crowd=ORCA())}, "trial 'empty' has no robot"),
        ({"autoreset": "never", "num_envs": 2}, "autoreset = 'never' must be one of next-step, same-step"),
        ({"num_envs": 0}, "num_envs = 0 must be at least 1"),
    ],
)
def test_wrong_values_are_refused(values: dict[str, Any], words: str) -> None:
    kind: Any = CrowdVectorEnv if {"num_envs", "autoreset"} & set(values) else CrowdEnv
    with pytest.raises(InputError, match=words):
        kind(**values)


def test_a_form_without_people_is_refused() -> None:
    with pytest.raises(InputError, match="max_people = 0 must be from 1 to 1000"):
        ObservationForm(max_people=0)


def test_wrong_actions_are_refused() -> None:
    task = CrowdTask(trial_of())
    with pytest.raises(InputError, match="call reset before anything else"):
        task.step(np.zeros((1, 2)))
    task.reset([0, 1])
    with pytest.raises(InputError, match=r"actions have the shape \(1, 2\), expected \(2, 2\)"):
        task.step(np.zeros((1, 2)))
    with pytest.raises(InputError, match="actions must be finite"):
        task.step(np.full((2, 2), np.nan))
    envs = CrowdVectorEnv(num_envs=2)
    with pytest.raises(InputError, match="there are 3 seeds for 2 environments"):
        envs.reset(seed=[1, 2, 3])
