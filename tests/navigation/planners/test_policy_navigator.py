"""The learned policy: contract, batch and single decisions, invariances, limits, files of weights, and its score."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Pose, Walls
from crowdbot.navigation import (
    AgentsInView,
    DriveLimits,
    Observation,
    ObservationBatch,
    PolicyNavigator,
    PolicyWeights,
    VisiblePeople,
    check_navigator,
    policy_file,
    policy_inputs,
)
from crowdbot.navigation.planners.policy_weights import read_policy
from crowdbot.world import DifferentialDrive, Omnidirectional, Twists

HOLONOMIC = DriveLimits(1.0, 1.5, holonomic=True)
STIFF = DriveLimits(1.0, 1e-6, holonomic=True)
"""Limits of a robot that keeps its heading."""
DIFFERENTIAL = DriveLimits(1.0, 1.5, 1.0, 3.0)


def batch_of(count: int, people: int, limits: DriveLimits, seed: int = 0, walls: Any = ()) -> ObservationBatch:
    rng = np.random.default_rng(seed)
    return ObservationBatch(
        pose=np.column_stack([rng.uniform(-4, 4, (count, 2)), rng.uniform(-3, 3, count)]),
        goal=rng.uniform(-6, 6, (count, 2)),
        radius=np.full(count, 0.3),
        limits=limits,
        dt=0.25,
        twist=np.column_stack([rng.uniform(0, 1, count), np.zeros((count, 2))]),
        people=AgentsInView(
            rng.uniform(-6, 6, (count, people, 2)),
            rng.uniform(-1.3, 1.3, (count, people, 2)),
            rng.uniform(0.2, 0.4, (count, people)),
            rng.random((count, people)) < 0.8,
            np.tile(np.arange(people), (count, 1)),
        ),
        walls=Walls.of(list(walls)),
    )


def test_it_keeps_the_contract() -> None:
    check_navigator(PolicyNavigator())


@pytest.mark.parametrize("people", [0, 1, 6, 30])
@pytest.mark.parametrize("limits", [HOLONOMIC, DIFFERENTIAL])
@pytest.mark.parametrize("walls", [(), ([(-5.0, -5.0), (5.0, -5.0)],)])
def test_decisions_of_a_batch_are_those_of_each_environment(people: int, limits: DriveLimits, walls: Any) -> None:
    batch = batch_of(9, people, limits, people, walls)
    navigator = PolicyNavigator(speed=0.9)
    decisions = navigator.decide_batch(batch, [None] * 9)
    assert not decisions.failures
    for k in range(9):
        assert tuple(navigator.act(batch.environment(k))) == tuple(decisions.twist[k].tolist())


def test_an_environment_with_a_wrong_value_fails_alone() -> None:
    batch = batch_of(3, 4, HOLONOMIC)
    batch.pose[1, 0] = np.nan
    decisions = PolicyNavigator().decide_batch(batch, [None] * 3)
    assert list(decisions.failures) == [1]
    assert (decisions.twist[[0, 2]] != 0.0).any(axis=1).all()


def observe(place: tuple[float, float], goal: Any, people: Any, velocity: Any, heading: float = 0.0) -> Observation:
    known = VisiblePeople(np.array(people, dtype=float).reshape(-1, 2), np.array(velocity, dtype=float).reshape(-1, 2),
                          np.full(len(people), 0.3))  # fmt: skip
    return Observation(pose=(*place, heading), goal=goal, radius=0.3, limits=STIFF, dt=0.25, people=known)


def velocity_of(observation: Observation) -> np.ndarray:
    twist, pose = PolicyNavigator().act(observation), observation.pose
    drive = Omnidirectional(1.0, 1.5, 1e6, 1e6)
    moved, _ = drive.step(Pose.of(pose[:2], pose[2]), Twists.of(observation.twist, 1), twist, observation.dt)
    return np.asarray((moved.position[0] - pose[:2]) / observation.dt)


@settings(max_examples=40, deadline=None)
@given(st.floats(-3, 3), st.floats(-3, 3), st.integers(0, 5), st.integers(0, 1000))
def test_it_is_invariant_to_rotations_shifts_and_the_order_of_people(
    angle: float, heading: float, count: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    people, velocity = rng.uniform(-4, 4, (count, 2)), rng.uniform(-1, 1, (count, 2))
    first = velocity_of(observe((0.0, 0.0), (5.0, 1.0), people, velocity))
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    order = rng.permutation(count)
    x, y = turn @ (5.0, 1.0) + (2.0, -1.0)
    other = observe((2.0, -1.0), (float(x), float(y)), (people @ turn.T + (2.0, -1.0))[order],
                    (velocity @ turn.T)[order], heading)  # fmt: skip
    np.testing.assert_allclose(velocity_of(other), turn @ first, atol=2e-3)


def test_people_who_are_far_away_or_unseen_have_no_effect() -> None:
    near = observe((0.0, 0.0), (4.0, 0.0), [(2.0, 0.2)], [(-1.0, 0.0)])
    alone = observe((0.0, 0.0), (4.0, 0.0), [], [])
    far = observe((0.0, 0.0), (4.0, 0.0), [(11.5, 0.0)], [(-1.0, 0.0)])
    assert PolicyNavigator().act(near) != PolicyNavigator().act(alone)
    assert PolicyNavigator().act(far) == PolicyNavigator().act(alone)


def test_the_network_equals_a_plain_calculation() -> None:
    batch = batch_of(5, 8, STIFF, 3)
    weights, _ = PolicyWeights.read(policy_file())
    inputs = policy_inputs(batch)
    for e in range(5):
        own, people = inputs.own[e], inputs.people[e, : inputs.present[e]]
        rows = np.concatenate([people, np.tile(own, (len(people), 1))], axis=1)
        for k in ("person1", "person2"):
            rows = np.maximum(rows @ getattr(weights, f"{k}_weight") + getattr(weights, f"{k}_bias"), 0.0)
        value = np.concatenate([rows.max(axis=0), own])
        for k in ("action1", "action2"):
            value = np.maximum(value @ getattr(weights, f"{k}_weight") + getattr(weights, f"{k}_bias"), 0.0)
        share = value @ weights.action3_weight + weights.action3_bias
        share = share / max(1.0, float(np.hypot(*share)))
        ax, ay = inputs.axis[e]
        expected = np.array([ax * share[0] - ay * share[1], ay * share[0] + ax * share[1]])
        left = np.hypot(*(batch.goal[e] - batch.pose[e, :2]))
        expected *= min(1.0, left / 0.5 / max(float(np.hypot(*expected)), 1e-9))
        heading = batch.pose[e, 2]
        forward, left_speed = PolicyNavigator(horizon=0.0).act(batch.environment(e))[::2]
        found = [math.cos(heading) * forward - math.sin(heading) * left_speed,
                 math.sin(heading) * forward + math.cos(heading) * left_speed]  # fmt: skip
        np.testing.assert_allclose(found, expected, atol=1e-5)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 500), st.floats(0.2, 1.4))
def test_twists_are_within_the_limits_of_the_drive(seed: int, speed: float) -> None:
    batch = batch_of(6, 5, HOLONOMIC, seed)
    twist = PolicyNavigator(speed=speed).decide_batch(batch, [None] * 6).twist
    assert np.hypot(twist[:, 0], twist[:, 2]).max() <= min(speed, 1.0) + 1e-9
    slow = dataclasses.replace(batch, limits=DIFFERENTIAL, twist=np.tile([0.3, 0.2, 0.0], (6, 1)), dt=0.1)
    twist = PolicyNavigator().decide_batch(slow, [None] * 6).twist
    assert (twist[:, 2] == 0.0).all()
    assert (np.abs(twist[:, 0]) <= 1.0 + 1e-9).all()
    assert (np.abs(twist[:, 1]) <= 1.5 + 1e-9).all()


@pytest.mark.parametrize("limits", [HOLONOMIC, DIFFERENTIAL])
def test_it_reaches_its_goal_alone(limits: DriveLimits) -> None:
    drive: Any = Omnidirectional(1.0, 1.5, 1e6, 1e6) if limits.holonomic else DifferentialDrive(1.0, 1.5, 1.0, 3.0)
    pose, twist = Pose.of((0.0, 0.0), 1.0), Twists.of(Observation.__dataclass_fields__["twist"].default_factory(), 1)
    for _ in range(150):
        x, y = pose.position[0].tolist()
        seen = Observation(pose=(x, y, float(pose.heading[0])), twist=twist.at(0), goal=(4.0, 3.0), radius=0.3,
                           limits=limits, dt=0.1)  # fmt: skip
        pose, twist = drive.step(pose, twist, PolicyNavigator().act(seen), 0.1)
    assert math.dist(pose.position[0], (4.0, 3.0)) < 0.3


def test_the_shipped_weights_have_a_card() -> None:
    assert policy_file().stat().st_size < 1_000_000
    _, card = PolicyWeights.read(policy_file())
    assert {"plan", "rounds", "origin", "score"} == set(card)
    assert "examples/train_navigator.py" in card["origin"]


def test_wrong_files_of_weights_are_refused(tmp_path: Path) -> None:
    weights, card = PolicyWeights.read(policy_file())
    with pytest.raises(InputError, match=r"there is no file .*none.npz; make one with examples/train_navigator.py"):
        PolicyWeights.read(tmp_path / "none.npz")
    (tmp_path / "text.npz").write_text("text")
    with pytest.raises(InputError, match="has no weights of a policy"):
        PolicyWeights.read(tmp_path / "text.npz")
    file = tmp_path / "own.npz"
    weights._replace(action3_bias=np.array([np.nan, 0.0], np.float32)).save(file, card)
    with pytest.raises(InputError, match=r"action3_bias must be \[2\] finite numbers"):
        PolicyWeights.read(file)
    weights._replace(person1_weight=np.zeros((3, 3), np.float32)).save(file, card)
    with pytest.raises(InputError, match="person1_weight must be"):
        PolicyNavigator(file=str(file)).act(observe((0.0, 0.0), (4.0, 0.0), [], []))
    weights.save(file, card)
    assert all(np.array_equal(a, b) for a, b in zip(read_policy(str(file)), read_policy(""), strict=True))
    with pytest.raises(InputError, match="speed = 0"):
        PolicyNavigator(speed=0.0)
