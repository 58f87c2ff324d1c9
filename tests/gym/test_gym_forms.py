"""Occupancy grids, accelerations, images, and the standard tasks by their ids."""

from __future__ import annotations

import dataclasses
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Walls
from crowdbot.gym import ActionForm, CrowdEnv, CrowdTask, CrowdVectorEnv, ObservationForm, register_environments
from crowdbot.gym.spaces import occupancy_grids
from crowdbot.navigation import AgentsInView, DriveLimits, ObservationBatch
from crowdbot.trials import load_trial
from crowdbot.world import Omnidirectional

LIMITS = DriveLimits(0.8, 2.0, 1.0, 3.0)
IDS = register_environments()


def seen_from(pose: tuple[float, float, float], person: tuple[float, float], walls: Any = ()) -> ObservationBatch:
    people = AgentsInView(
        np.array([[person]]), np.zeros((1, 1, 2)), np.full((1, 1), 0.3), np.ones((1, 1), bool), np.zeros((1, 1), int)
    )
    return ObservationBatch(
        pose=np.array([pose]), goal=np.ones((1, 2)), radius=np.full(1, 0.3), limits=LIMITS, dt=0.1, people=people,
        walls=Walls.of(list(walls)),
    )  # fmt: skip


def centres(cells: int, cell: float) -> np.ndarray:
    along = (np.arange(cells) + 0.5) * cell - 0.5 * cells * cell
    return np.stack(np.meshgrid(along, along, indexing="ij"), axis=-1)


@settings(max_examples=60, deadline=None)
@given(st.floats(-3, 3), st.floats(-4, 4), st.floats(-4, 4), st.integers(1, 24), st.sampled_from([0.2, 0.25, 0.5]))
def test_cells_of_a_person_are_those_near_the_disc(heading: float, x: float, y: float, cells: int, cell: float) -> None:
    grid = occupancy_grids(seen_from((0.5, -0.2, heading), (x, y)), cells, cell)[0]
    dx, dy = x - 0.5, y + 0.2
    place = np.array([np.cos(heading) * dx + np.sin(heading) * dy, np.cos(heading) * dy - np.sin(heading) * dx])
    away = np.hypot(*np.moveaxis(centres(cells, cell) - place, -1, 0))
    clear = np.abs(away - (0.3 + 0.5 * cell)) > 1e-9
    np.testing.assert_array_equal(grid[clear] > 0.5, (away < 0.3 + 0.5 * cell)[clear])


def test_cells_of_a_wall_are_those_that_it_crosses() -> None:
    batch = seen_from((0.0, 0.0, 0.0), (50.0, 0.0), [[(1.0, -9.0), (1.0, 9.0)]])
    grid = occupancy_grids(batch, 16, 0.5)[0]
    away = np.abs(centres(16, 0.5)[..., 0] - 1.0)
    np.testing.assert_array_equal(grid > 0.5, away < 0.25)
    assert grid.sum() == 0.0 or set(np.flatnonzero(grid.any(axis=1))) <= {9, 10}


def test_an_unseen_person_leaves_the_grid_empty() -> None:
    batch = seen_from((0.0, 0.0, 0.0), (1.0, 0.0))
    hidden = dataclasses.replace(batch.people, seen=np.zeros((1, 1), bool))
    assert occupancy_grids(batch, 16, 0.25).sum() > 4.0
    assert occupancy_grids(dataclasses.replace(batch, people=hidden), 16, 0.25).sum() == 0.0


@pytest.mark.parametrize(("observation", "action"), [("occupancy", "velocity"), ("people", "acceleration")])
def test_the_official_checker_passes_with_other_forms(observation: str, action: str) -> None:
    trial = load_trial("circle-crossing", duration=3.0)
    drive = Omnidirectional(1.0, 1.5, 1.0, 3.0)
    trial = dataclasses.replace(trial, robots=(dataclasses.replace(trial.robots[0], drive=drive),))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(CrowdEnv(trial, observation, action), skip_render_check=True)
    envs = CrowdVectorEnv(trial, 3, observation, action)
    first, _ = envs.reset(seed=5)
    rows = envs.step(np.full((3, 2), 0.5, np.float32))[0]
    env = CrowdEnv(trial, observation, action)
    alone = env.reset(seed=6)[0], env.step(np.full(2, 0.5, np.float32))[0]
    for name in alone[0]:
        assert alone[0][name].tobytes() == first[name][1].tobytes()
        assert alone[1][name].tobytes() == rows[name][1].tobytes()


def test_accelerations_add_to_the_current_twist() -> None:
    trial = load_trial("circle-crossing", duration=3.0)
    drive = Omnidirectional(1.0, 1.5, 1.0, 3.0)
    trial = dataclasses.replace(trial, robots=(dataclasses.replace(trial.robots[0], drive=drive),))
    task = CrowdTask(trial, action=ActionForm("acceleration"))
    task.reset([1])
    speeds = [task.step(np.array([[0.5, -1.0]])).observations["robot"][0, 4:6] for _ in range(4)]
    np.testing.assert_allclose(np.diff([s[0] for s in speeds]), 0.05, atol=1e-6)
    np.testing.assert_allclose(np.diff([s[1] for s in speeds]), -0.3, atol=1e-6)
    most = ActionForm("acceleration").twists(np.ones((1, 2)), LIMITS, np.array([[0.79, 1.9, 0.0]]), 0.1)
    assert most.tolist() == [[0.8, 2.0, 0.0]]


def test_a_drive_without_limits_of_its_accelerations_is_refused() -> None:
    with pytest.raises(InputError, match="no limits of its accelerations"):
        ActionForm("acceleration").check(DriveLimits(1.0, 1.0))


@pytest.mark.parametrize(("name", "value", "words"), [
    ("cells", 0, "cells = 0 must be from 1 to 1000"), ("cell", 0.0, "cell = 0.0 m must be finite and above 0"),
])  # fmt: skip
def test_wrong_grids_are_refused(name: str, value: float, words: str) -> None:
    with pytest.raises(InputError, match=words):
        ObservationForm("occupancy", **{name: value})


def test_images_show_the_trial() -> None:
    env = CrowdEnv("circle-crossing", render_mode="rgb_array", duration=3.0)
    with pytest.raises(InputError, match="call reset before render"):
        env.render()
    env.reset(seed=2)
    first = env.render()
    for _ in range(5):
        env.step(np.array([1.0, 0.0], np.float32))
    second = env.render()
    assert first.dtype == np.uint8
    assert first.shape == (600, 960, 3)
    assert first.std() > 5.0
    assert (first != second).any()
    assert env.metadata["render_fps"] == 10
    assert CrowdEnv("circle-crossing").render() is None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make("crowdbot/CircleCrossing-v0", render_mode="rgb_array", duration=1.0).unwrapped)


def test_images_do_not_change_an_episode() -> None:
    ends = []
    for mode in (None, "rgb_array"):
        env = CrowdEnv("circle-crossing", render_mode=mode)
        env.reset(seed=4)
        ends.append([env.step(np.array([0.7, 0.1], np.float32))[0]["people"].tobytes() for _ in range(8)])
    assert ends[0] == ends[1]


@pytest.mark.parametrize(("values", "words"), [
    ({"render_mode": "human"}, "render_mode = 'human' must be 'rgb_array' or None"),
])  # fmt: skip
def test_unknown_render_modes_are_refused(values: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        CrowdEnv(**values)


@pytest.mark.parametrize("name", IDS)
def test_the_official_checker_passes_for_every_id(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(name, duration=1.0).unwrapped, skip_render_check=True)
    env = gymnasium.make(name)
    assert env.observation_space.contains(env.reset(seed=1)[0])


def test_the_tasks_of_crowdnav_have_holonomic_actions_and_full_states() -> None:
    env = gymnasium.make("crowdbot/CrowdNavCircle10-v0").unwrapped
    observation, _ = env.reset(seed=8)
    assert observation["people"][:, 6].tolist() == [1.0] * 10
    moved, *_ = env.step(np.array([0.0, 1.0], np.float32))
    assert moved["robot"][6] == pytest.approx(1.0, abs=1e-6)
