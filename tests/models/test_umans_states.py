"""Cost terms against UMANS: what its policies choose in 1000 random states, kept in ``golden/umans_states.npz``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from engine_steps import report

from crowdbot.core import Scene
from crowdbot.models import CostModel
from crowdbot.models.costs import (
    AdmissibleRange,
    FocusOfExpansion,
    GoalForce,
    PassingTimes,
    ReciprocalObstacles,
    VelocityCost,
)

FILE = Path(__file__).with_name("golden") / "umans_states.npz"
TOP = 1.8
VIEW = {"neighbor_distance": 5.0, "max_neighbors": 59.0}


@pytest.fixture(scope="module")
def states():
    with np.load(FILE) as file:
        return {name: file[name].astype(float) for name in file.files}


def scene_of(states):
    away = states["goal"] - states["position"]
    wish = away / np.linalg.norm(away, axis=-1, keepdims=True) * states["preferred_speed"][..., None]
    return Scene.of(
        states["position"], states["velocity"], radius=0.25, goal=states["goal"], preferred_velocity=wish, max_speed=TOP
    )


@pytest.fixture(scope="module")
def world(states):
    """Return everyone of all crowds with the neighbours of everyone, as a cost gets them."""
    seen = []

    class Look(VelocityCost):
        def value(self, world, candidates):
            seen.append(world)
            return np.zeros(candidates.shape[:2])

    CostModel(Look(), speeds=1, angles=1, **VIEW).velocity(scene_of(states), 0.1)
    return seen[0]


def rings(base, angle, speeds):
    """Return the velocities ``[N, C, 2]`` that UMANS compares: angles from a direction [N, 2], ring by ring."""
    left = np.stack([-base[:, 1], base[:, 0]], axis=-1)
    way = np.cos(angle)[:, None] * base[:, None] + np.sin(angle)[:, None] * left[:, None]
    speed = TOP * (1.0 + np.arange(speeds)) / speeds
    return (speed[None, :, None, None] * way[:, None]).reshape(len(base), -1, 2)


def disagreement(world, cost, candidates, theirs):
    """Return the distance from the choice of UMANS to ours [m/s], 0 if ours is no better than 0.01 %."""
    own = np.concatenate([cost.value(world.part(k, k + 50), candidates[k : k + 50]) for k in range(0, len(theirs), 50)])
    everyone, best = np.arange(len(theirs)), own.argmin(axis=1)
    least = own[everyone, best]
    choice = np.where(np.isfinite(least)[:, None], candidates[everyone, best], 0.0)  # nothing is allowed: it stands
    gap = np.linalg.norm(candidates - theirs[:, None], axis=-1)
    same = (gap.min(axis=1) < 1e-5) & np.isfinite(least)
    tie = same & (own[everyone, gap.argmin(axis=1)] <= least + 1e-4 * (1.0 + np.abs(np.where(same, least, 0.0))))
    return np.where(tie, 0.0, np.linalg.norm(choice - theirs, axis=-1))


def around(world):
    east = np.broadcast_to([1.0, 0.0], world.position.shape)
    return rings(east, -np.pi + np.arange(36) * np.pi / 18.0, 4)


@pytest.mark.parametrize(
    ("name", "cost"), [("RVO", ReciprocalObstacles()), ("FOEAvoidance", FocusOfExpansion()), ("Paris", PassingTimes())]
)
def test_the_cheapest_velocity_is_that_of_umans(states, world, name, cost):
    error = disagreement(world, cost, around(world), states[name].reshape(-1, 2))
    report(f"CostModel({cost})", error, 1e-4, "m/s")
    assert error.size == 1000
    # Paris: a person in contact with one who stands may go nowhere, and takes the first velocity
    still = world.there & (np.linalg.norm(world.motion, axis=-1) == 0.0)
    touching = np.any(still & (np.linalg.norm(world.offset, axis=-1) <= world.reach), axis=-1)
    assert np.all(error[~touching] < 1e-4)
    assert np.count_nonzero(error > 1e-4) <= (1 if name == "Paris" else 0)
    assert np.mean(np.linalg.norm(states[name] - states["velocity"], axis=-1) > 0.1) > 0.9  # they do something


def test_the_range_of_velocities_is_that_of_umans_up_to_its_ramp(states, world):
    ahead = world.direction()
    candidates = rings(ahead, np.linspace(-0.5 * np.pi, 0.5 * np.pi, 19), 18)
    theirs = states["Karamouzas"].reshape(-1, 2)
    error = disagreement(world, AdmissibleRange(), candidates, theirs)
    report(f"CostModel({AdmissibleRange()})", error, 1e-4, "m/s")
    contact = world.first_contact(world.wish[:, None])[:, 0]
    ramp = (contact >= 6.0) & (contact < 8.0)
    assert np.all(error[~ramp] < 1e-4)
    assert 0 < np.count_nonzero(error > 1e-4) <= np.count_nonzero(ramp)
    for lowest, highest, some in ((0.0, 2.5, 50), (2.5, 6.0, 50), (6.0, 8.0, 3), (8.0, np.inf, 50)):
        assert np.count_nonzero((contact >= lowest) & (contact <= highest)) >= some


def test_the_gradient_of_the_focus_of_expansion_is_that_of_umans(states):
    model = CostModel(GoalForce(0.5) + 3.0 * FocusOfExpansion(), **VIEW)
    after = model.velocity(scene_of(states), 0.1)
    error = np.linalg.norm(after - states["FOEAvoidance-gradient"], axis=-1)
    share, _, _ = report(f"CostModel({model.costs})", error, 1e-4, "m/s")
    assert share == 1.0
    alone = CostModel(GoalForce(0.5)).velocity(scene_of(states), 0.1)
    assert np.mean(np.linalg.norm(after - alone, axis=-1) > 1e-3) > 0.5
