"""Learned policies: contract, batch and single decisions, invariances, walls, limits, and files of weights."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Pose, Twist, Walls
from crowdbot.navigation import (
    AgentsInView,
    AttentionPolicyNavigator,
    AttentionWeights,
    DriveLimits,
    Observation,
    ObservationBatch,
    PolicyNavigator,
    PolicyWeights,
    VisiblePeople,
    attention_inputs,
    check_navigator,
    policy_file,
    policy_inputs,
)
from crowdbot.navigation.planners.policy_weights import read_layers
from crowdbot.world import DifferentialDrive, Omnidirectional, Twists

HOLONOMIC = DriveLimits(1.0, 1.5, holonomic=True)
STIFF = DriveLimits(1.0, 1e-6, holonomic=True)
"""Limits of a robot that keeps its heading."""
DIFFERENTIAL = DriveLimits(1.0, 1.5, 1.0, 3.0)
KINDS = [PolicyNavigator, AttentionPolicyNavigator]
every_kind = pytest.mark.parametrize("kind", KINDS, ids=["pooled", "attention"])


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


@every_kind
def test_it_keeps_the_contract(kind: Any) -> None:
    check_navigator(kind())


@every_kind
@pytest.mark.parametrize("people", [0, 1, 6, 30])
@pytest.mark.parametrize("limits", [HOLONOMIC, DIFFERENTIAL])
@pytest.mark.parametrize("walls", [(), ([(-5.0, -5.0), (5.0, -5.0)],)])
def test_decisions_of_a_batch_are_those_of_each_environment(
    people: int, limits: DriveLimits, walls: Any, kind: Any
) -> None:
    batch = batch_of(9, people, limits, people, walls)
    navigator = kind(speed=0.9)
    decisions = navigator.decide_batch(batch, [None] * 9)
    assert not decisions.failures
    for k in range(9):
        assert tuple(navigator.act(batch.environment(k))) == tuple(decisions.twist[k].tolist())


@every_kind
def test_an_environment_with_a_wrong_value_fails_alone(kind: Any) -> None:
    batch = batch_of(3, 4, HOLONOMIC)
    batch.pose[1, 0] = np.nan
    decisions = kind().decide_batch(batch, [None] * 3)
    assert list(decisions.failures) == [1]
    assert (decisions.twist[[0, 2]] != 0.0).any(axis=1).all()


def observe(
    place: tuple[float, float], goal: Any, people: Any, velocity: Any, heading: float = 0.0, walls: Any = ()
) -> Observation:
    known = VisiblePeople(np.array(people, dtype=float).reshape(-1, 2), np.array(velocity, dtype=float).reshape(-1, 2),
                          np.full(len(people), 0.3))  # fmt: skip
    return Observation(pose=(*place, heading), goal=goal, radius=0.3, limits=STIFF, dt=0.25, people=known,
                       walls=Walls.of(list(walls)))  # fmt: skip


def velocity_of(kind: Any, observation: Observation) -> np.ndarray:
    twist, pose = kind().act(observation), observation.pose
    drive = Omnidirectional(1.0, 1.5, 1e6, 1e6)
    moved, _ = drive.step(Pose.of(pose[:2], pose[2]), Twists.of(observation.twist, 1), twist, observation.dt)
    return np.asarray((moved.position[0] - pose[:2]) / observation.dt)


@every_kind
@settings(max_examples=40, deadline=None)
@given(st.floats(-3, 3), st.floats(-3, 3), st.integers(0, 5), st.integers(0, 1000))
def test_it_is_invariant_to_rotations_shifts_and_the_order_of_people(
    kind: Any, angle: float, heading: float, count: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    people, velocity = rng.uniform(-4, 4, (count, 2)), rng.uniform(-1, 1, (count, 2))
    first = velocity_of(kind, observe((0.0, 0.0), (5.0, 1.0), people, velocity))
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    order = rng.permutation(count)
    x, y = turn @ (5.0, 1.0) + (2.0, -1.0)
    other = observe((2.0, -1.0), (float(x), float(y)), (people @ turn.T + (2.0, -1.0))[order],
                    (velocity @ turn.T)[order], heading)  # fmt: skip
    np.testing.assert_allclose(velocity_of(kind, other), turn @ first, atol=2e-3)


@every_kind
def test_people_who_are_far_away_or_unseen_have_no_effect(kind: Any) -> None:
    near = observe((0.0, 0.0), (4.0, 0.0), [(2.0, 0.2)], [(-1.0, 0.0)])
    alone = observe((0.0, 0.0), (4.0, 0.0), [], [])
    far = observe((0.0, 0.0), (4.0, 0.0), [(11.5, 0.0)], [(-1.0, 0.0)])
    assert kind().act(near) != kind().act(alone)
    assert kind().act(far) == kind().act(alone)


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


@pytest.mark.parametrize("count", [0, 8, 15])
def test_attention_equals_a_plain_calculation(count: int) -> None:
    walls = [[(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0)]]
    batch = batch_of(5, count, DIFFERENTIAL, 3, walls)
    weights, _ = AttentionWeights.read(policy_file("attention-policy"))
    inputs = attention_inputs(batch)
    axis, shares = AttentionPolicyNavigator().shares(batch, np.ones(5, np.bool_))
    assert np.array_equal(axis, inputs.axis)
    assert (inputs.walls > 0.0).any()

    def layer(name: str, value: np.ndarray) -> np.ndarray:
        return np.asarray(value @ getattr(weights, f"{name}_weight") + getattr(weights, f"{name}_bias"))

    for e in range(5):
        own, people = inputs.own[e], inputs.people[e, : inputs.present[e]]
        rows = np.concatenate([people, np.tile(own, (len(people), 1))], axis=1)
        rows = np.maximum(layer("person2", np.maximum(layer("person1", rows), 0.0)), 0.0)
        attended = np.zeros(rows.shape[1])
        if len(people):
            both = np.concatenate([rows, np.tile(rows.mean(axis=0), (len(rows), 1))], axis=1)
            score = np.exp(layer("score2", np.maximum(layer("score1", both), 0.0)))
            attended = (score / score.sum() * rows).sum(axis=0)
        value = np.concatenate([attended, own, inputs.walls[e]])
        value = np.maximum(layer("action2", np.maximum(layer("action1", value), 0.0)), 0.0)
        alone = not len(people) and not inputs.walls[e].any()
        np.testing.assert_allclose(shares[e], (1.0, 0.0) if alone else layer("action3", value), atol=1e-5)


@settings(max_examples=20, deadline=None)
@given(st.floats(-3, 3), st.integers(0, 1000))
def test_walls_turn_with_the_world(angle: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    walls, goal = rng.uniform(-3, 3, (4, 2, 2)), rng.uniform(-6, 6, 2)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])

    def near(goal: np.ndarray, walls: np.ndarray, heading: float) -> Any:
        return attention_inputs(ObservationBatch(
            pose=np.array([[0.0, 0.0, heading]]), goal=goal[None], radius=np.full(1, 0.3), limits=DIFFERENTIAL, dt=0.1,
            walls=Walls.of(list(walls)),
        ))  # fmt: skip

    first, other = near(goal, walls, 0.4), near(turn @ goal, walls @ turn.T, 0.4 + angle)
    np.testing.assert_allclose(other.own, first.own, atol=1e-9)
    assert (np.abs(other.walls - first.walls) < 1e-6).mean() > 0.9  # but for rays past an end of a wall


def test_only_attention_knows_walls() -> None:
    open_space, wall = observe((0.0, 0.0), (4.0, 0.0), [], []), [[(1.0, -2.0), (1.0, 2.0)]]
    ahead = observe((0.0, 0.0), (4.0, 0.0), [], [], walls=wall)
    axis = np.ones(1, np.bool_)

    def shares(navigator: Any, seen: Observation) -> Any:
        batch = ObservationBatch(pose=np.array([seen.pose]), goal=np.array([seen.goal]), radius=np.full(1, 0.3),
                                 limits=STIFF, dt=0.25, walls=seen.walls)  # fmt: skip
        return navigator.shares(batch, axis)[1][0].tolist()

    assert shares(AttentionPolicyNavigator(), ahead) != shares(AttentionPolicyNavigator(), open_space)
    assert shares(PolicyNavigator(), ahead) == shares(PolicyNavigator(), open_space)
    near = attention_inputs(batch_of(1, 0, HOLONOMIC)).walls
    assert near.shape == (1, 32)
    assert (near == 0.0).all()


@every_kind
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 500), st.floats(0.2, 1.4))
def test_twists_are_within_the_limits_of_the_drive(kind: Any, seed: int, speed: float) -> None:
    batch = batch_of(6, 5, HOLONOMIC, seed)
    twist = kind(speed=speed).decide_batch(batch, [None] * 6).twist
    assert np.hypot(twist[:, 0], twist[:, 2]).max() <= min(speed, 1.0) + 1e-9
    slow = dataclasses.replace(batch, limits=DIFFERENTIAL, twist=np.tile([0.3, 0.2, 0.0], (6, 1)), dt=0.1)
    twist = kind().decide_batch(slow, [None] * 6).twist
    assert (twist[:, 2] == 0.0).all()
    assert (np.abs(twist[:, 0]) <= 1.0 + 1e-9).all()
    assert (np.abs(twist[:, 1]) <= 1.5 + 1e-9).all()


@every_kind
@pytest.mark.parametrize("limits", [HOLONOMIC, DIFFERENTIAL])
def test_it_reaches_its_goal_alone(kind: Any, limits: DriveLimits) -> None:
    drive: Any = Omnidirectional(1.0, 1.5, 1e6, 1e6) if limits.holonomic else DifferentialDrive(1.0, 1.5, 1.0, 3.0)
    pose, twist = Pose.of((0.0, 0.0), 1.0), Twists.of(Twist(), 1)
    for _ in range(150):
        x, y = pose.position[0].tolist()
        seen = Observation(pose=(x, y, float(pose.heading[0])), twist=twist.at(0), goal=(4.0, 3.0), radius=0.3,
                           limits=limits, dt=0.1)  # fmt: skip
        pose, twist = drive.step(pose, twist, kind().act(seen), 0.1)
    assert math.dist(pose.position[0], (4.0, 3.0)) < 0.3


@every_kind
@pytest.mark.parametrize(("top", "speed", "expected"), [(0.7, 1.0, 0.7), (1.5, 1.0, 1.0), (1.5, 2.0, 1.5)])
def test_alone_it_moves_at_its_largest_speed(kind: Any, top: float, speed: float, expected: float) -> None:
    limits = DriveLimits(top, 1.5, holonomic=True)
    alone = dataclasses.replace(observe((0.0, 0.0), (8.0, 0.0), [], []), limits=limits)
    assert kind(speed=speed).act(alone).forward == pytest.approx(expected)


def test_the_shipped_weights_have_a_card() -> None:
    assert policy_file().stat().st_size < 1_000_000
    _, card = PolicyWeights.read(policy_file())
    assert {"plan", "rounds", "origin", "score"} == set(card)
    assert "examples/train_navigator.py" in card["origin"]


def test_the_weights_of_attention_say_how_they_were_made() -> None:
    file = policy_file("attention-policy")
    assert file.stat().st_size < 300_000
    _, card = AttentionWeights.read(file)
    assert "train_navigator.py --network attention" in card["command"]
    assert card["steps"] >= card["planned_steps"]


def test_weights_of_another_network_are_refused() -> None:
    with pytest.raises(InputError, match=r"policy.npz: person1_weight must be \[19, 64\] finite numbers"):
        AttentionPolicyNavigator(file=str(policy_file())).act(observe((0.0, 0.0), (4.0, 0.0), [], []))
    with pytest.raises(InputError, match=r"attention-policy.npz: person1_weight must be \[17, 64\] finite numbers"):
        PolicyNavigator(file=str(policy_file("attention-policy"))).act(observe((0.0, 0.0), (4.0, 0.0), [], []))


def test_wrong_files_of_weights_are_refused(tmp_path: Path) -> None:
    weights, card = PolicyWeights.read(policy_file())
    with pytest.raises(InputError, match=r"there is no file .*none.npz; make one with examples/train_navigator.py"):
        PolicyWeights.read(tmp_path / "none.npz")
    (tmp_path / "text.npz").write_text("text")
    with pytest.raises(InputError, match="has no weights of a policy"):
        PolicyWeights.read(tmp_path / "text.npz")
    file = tmp_path / "own.npz"
    dataclasses.replace(weights, action3_bias=np.array([np.nan, 0.0], np.float32)).save(file, card)
    with pytest.raises(InputError, match=r"action3_bias must be \[2\] finite numbers"):
        PolicyWeights.read(file)
    dataclasses.replace(weights, person1_weight=np.zeros((3, 3), np.float32)).save(file, card)
    with pytest.raises(InputError, match="person1_weight must be"):
        PolicyNavigator(file=str(file)).act(observe((0.0, 0.0), (4.0, 0.0), [], []))
    weights.save(file, card)
    own, shipped = read_layers(PolicyWeights, str(file)), read_layers(PolicyWeights, "")
    assert all(np.array_equal(a, b) for a, b in zip(own, shipped, strict=True))
    np.savez(file, content=np.array([{"code": print}], dtype=object))  # an object that only pickle reads
    with pytest.raises(InputError, match="has no weights of a policy .*pickle"):
        AttentionWeights.read(file)
    with pytest.raises(InputError, match="AttentionPolicyNavigator: speed = 0|AttentionPolicyNavigator.* speed = 0"):
        AttentionPolicyNavigator(speed=0.0)
    with pytest.raises(InputError, match="speed = 0"):
        PolicyNavigator(speed=0.0)
