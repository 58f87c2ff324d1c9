"""The recurrent policy: windows of positions, its network, invariances, memory of a simulation, and its weights."""

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
from crowdbot.evaluation import parse_methods
from crowdbot.navigation import (
    AgentsInView,
    DriveLimits,
    Observation,
    ObservationBatch,
    RecurrentPolicyNavigator,
    RecurrentWeights,
    TrackBatch,
    VisiblePeople,
    check_navigator,
    empty_memory,
    policy_file,
    recurrent_inputs,
    remember,
    with_memory,
)
from crowdbot.recording import branch, run
from crowdbot.simulation import simulate, simulate_seeds
from crowdbot.trials import load_trial
from crowdbot.world import DifferentialDrive, Omnidirectional, Twists

ANY_WAY = DriveLimits(1.0, 1.5, holonomic=True)
STIFF = DriveLimits(1.0, 1e-6, holonomic=True)
"""Limits of a robot that keeps its heading."""
WHEELS = DriveLimits(1.0, 1.5, 1.0, 3.0)
ROOM = [[(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0)]]


def random_weights(folder: Path, seed: int = 0) -> str:
    """Write weights of a network that nobody trained, in which every input has an effect."""
    rng = np.random.default_rng(seed)
    arrays = {name: rng.normal(0.0, 0.3, shape).astype(np.float32) for name, shape in RecurrentWeights.shapes().items()}
    RecurrentWeights(**arrays).save(folder / "random.npz", {})
    return str(folder / "random.npz")


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> str:
    return random_weights(tmp_path_factory.mktemp("weights"))


def view_of(k: int, people: int, seed: int = 0, count: int = 1, dt: float = 0.25, **changes: Any) -> ObservationBatch:
    """Return decision k in some environments, where the robot and people walk straight."""
    rng = np.random.default_rng(seed)
    start, velocity = rng.uniform(-5, 5, (count, people, 2)), rng.uniform(-1.3, 1.3, (count, people, 2))
    pose = np.column_stack([rng.uniform(-3, 3, (count, 2)), rng.uniform(-3, 3, count)])
    motion, goal = rng.uniform(-1, 1, (count, 2)), rng.uniform(-6, 6, (count, 2))
    fields: dict[str, Any] = {
        "pose": pose + k * dt * np.column_stack([motion, np.zeros(count)]),
        "goal": goal,
        "radius": np.full(count, 0.3),
        "limits": STIFF,
        "dt": dt,
        "time": np.full(count, k * dt),
        "people": AgentsInView(
            start + k * dt * velocity,
            velocity,
            rng.uniform(0.2, 0.4, (count, people)),
            np.ones((count, people), np.bool_),
            np.tile(np.arange(people), (count, 1)),
        ),
    }
    return ObservationBatch(**(fields | changes))


def remembered(steps: int, people: int, **options: Any) -> ObservationBatch:
    """Return the last of some decisions, with the memory of all."""
    batch = view_of(0, people, **options)
    memory = empty_memory(len(batch), batch.dt)
    for k in range(steps):
        batch = view_of(k, people, **options)
        memory = remember(memory, batch)
    return with_memory(batch, memory)


def test_it_keeps_the_contract(file: str) -> None:
    check_navigator(RecurrentPolicyNavigator(file=file))
    check_navigator(RecurrentPolicyNavigator())


@pytest.mark.parametrize("dt", [0.02, 0.1, 0.25])
def test_a_window_has_the_places_of_the_last_steps(dt: float) -> None:
    decisions = round(1.5 / dt) + 1
    batch, straight = remembered(decisions, 3, dt=dt), view_of(decisions - 1, 3, dt=dt)
    found, (ax, ay) = recurrent_inputs(batch), recurrent_inputs(batch).axis[0]
    assert found.steps[0].tolist() == [6] * 4 + [0] * 9
    people, here = straight.people, straight.pose[0, :2]
    gap = np.hypot(*(people.position[0] - here).T) - people.radius[0] - 0.3
    turn = np.array([[ax, ay], [-ay, ax]])
    for row, a in zip(found.windows[0, 1:4], np.argsort(gap), strict=True):
        ages = 0.25 * np.arange(5, -1, -1)
        places = people.position[0, a] - ages[:, None] * people.velocity[0, a] - here
        np.testing.assert_allclose(row[:, :2], places @ turn.T / 5.0, atol=1e-9)
        np.testing.assert_allclose(row[1:, 2:], np.tile(turn @ people.velocity[0, a], (5, 1)), atol=1e-9)
        assert (row[0, 2:] == 0.0).all()
    np.testing.assert_allclose(found.windows[0, 0, -1, :2], 0.0, atol=1e-12)  # the robot is here now
    np.testing.assert_allclose(batch.people.velocity, people.velocity, atol=1e-9)  # estimated from the places
    nearest = np.sort(gap)
    np.testing.assert_allclose(found.bodies[0, :3, 2], np.clip(nearest, -0.5, 1.0), atol=1e-12)
    assert (found.windows[0, 4:] == 0.0).all()


def test_who_was_seen_for_a_shorter_time_has_fewer_steps() -> None:
    for decisions, steps in ((1, 1), (2, 2), (4, 4), (9, 6)):
        batch = remembered(decisions, 2)
        found = recurrent_inputs(batch)
        assert found.steps[0, :3].tolist() == [steps] * 3
        assert (found.windows[0, 1, : 6 - steps] == 0.0).all()
    assert (remembered(1, 2).people.velocity == 0.0).all()


def test_people_appear_vanish_and_come_back() -> None:
    memory, steps, there = empty_memory(1, 0.25), [], [True, True, False, False, True, True, False, True]
    for k, seen in enumerate(there):
        batch = view_of(k, 2)
        batch.people.seen[0, 1] = seen
        memory = remember(memory, batch)
        found = recurrent_inputs(with_memory(batch, memory))
        assert found.present[0] == 1 + seen
        steps.append(sorted(found.steps[0, 1 : 2 + seen].tolist()))
    assert steps[:4] == [[1, 1], [2, 2], [3], [4]]
    assert steps[4] == [5, 5]  # the places between are interpolated
    late = empty_memory(1, 0.25)
    for k in range(5):
        batch = view_of(k, 2)
        batch.people.seen[0, 1] = k >= 3
        late = remember(late, batch)
    assert sorted(recurrent_inputs(with_memory(batch, late)).steps[0, 1:3].tolist()) == [2, 5]
    for k in range(5, 12):
        batch = view_of(k, 2)
        batch.people.seen[0, 1] = False
        late = remember(late, batch)
    assert late.people.tolist() == [2]  # the robot and one person: who left is forgotten


def test_an_earlier_time_begins_a_new_memory_and_the_same_time_changes_nothing() -> None:
    batch = remembered(5, 3, count=2)
    assert isinstance(batch.tracks, TrackBatch)
    again = remember(batch.tracks, view_of(4, 3, count=2))
    assert np.array_equal(again.position, batch.tracks.position, equal_nan=True)
    early = view_of(5, 3, count=2)
    early.time[1] = 0.0
    after = remember(again, early)
    assert np.isfinite(after.times).sum(axis=1).tolist() == [6, 1]
    assert recurrent_inputs(with_memory(early, after)).steps[:, 0].tolist() == [6, 1]


@pytest.mark.parametrize(("count", "limits", "walls"), [(0, STIFF, ROOM), (8, WHEELS, ROOM), (15, STIFF, ())])
@pytest.mark.parametrize("decisions", [1, 4, 9])
def test_the_network_equals_a_plain_calculation(file: str, count: int, limits: Any, walls: Any, decisions: int) -> None:
    batch = remembered(decisions, count, count=3, limits=limits, walls=Walls.of(walls), seed=decisions)
    weights, _ = RecurrentWeights.read(Path(file))
    inputs = recurrent_inputs(batch)
    axis, shares = RecurrentPolicyNavigator(file=file).shares(batch, np.ones(3, np.bool_))
    assert np.array_equal(axis, inputs.axis)

    def layer(name: str, value: np.ndarray) -> np.ndarray:
        return np.asarray(value @ getattr(weights, f"{name}_weight") + getattr(weights, f"{name}_bias"))

    def sigmoid(value: np.ndarray) -> np.ndarray:
        return np.asarray(1.0 / (1.0 + np.exp(-value)))

    def unit(edge: str, window: np.ndarray, width: int) -> np.ndarray:
        state = np.zeros(width)
        for row in window:
            (r, z, n), (hr, hz, hn) = (
                np.split(layer(f"{edge}_input", row), 3),
                np.split(layer(f"{edge}_state", state), 3),
            )
            update = sigmoid(z + hz)
            state = (1.0 - update) * np.tanh(n + sigmoid(r + hr) * hn) + update * state
        return state

    for e in range(3):
        own, known = inputs.own[e], inputs.steps[e]
        robot = np.concatenate([unit("temporal", inputs.windows[e, 0, 6 - known[0] :], 16), own])
        people = [
            np.concatenate(
                [unit("spatial", inputs.windows[e, 1 + k, 6 - known[1 + k] :], 32), inputs.bodies[e, k], own]
            )
            for k in range(inputs.present[e])
        ]
        attended = np.zeros(64)
        if people:
            rows = np.maximum(layer("person2", np.maximum(layer("person1", np.array(people)), 0.0)), 0.0)
            score = np.exp(layer("key", rows) @ layer("query", robot) / math.sqrt(32))
            attended = score / score.sum() @ rows
        value = np.concatenate([attended, robot, inputs.walls[e]])
        value = np.maximum(layer("action2", np.maximum(layer("action1", value), 0.0)), 0.0)
        alone = not people and not inputs.walls[e].any()
        np.testing.assert_allclose(shares[e], (1.0, 0.0) if alone else layer("action3", value), atol=1e-6, rtol=1e-6)


def observe(place: Any, goal: Any, people: Any, velocity: Any, time: float = 0.0, ids: Any = None, heading: float = 0.0,
            walls: Any = ()) -> Observation:  # fmt: skip
    rows = np.array(people, dtype=float).reshape(-1, 2)
    who = np.arange(len(rows)) if ids is None else np.asarray(ids, dtype=np.int64)
    known = VisiblePeople(rows, np.array(velocity, dtype=float).reshape(-1, 2), np.full(len(rows), 0.3), who)
    return Observation(pose=(*map(float, place), heading), goal=tuple(map(float, goal)), radius=0.3, limits=STIFF,
                       dt=0.25, people=known, time=time, walls=Walls.of(list(walls)))  # fmt: skip


def twists_of(navigator: RecurrentPolicyNavigator, seen: list[Observation]) -> list[Twist]:
    memory, twists = navigator.begin(seen[0]), []
    for observation in seen:
        action, memory = navigator.act(observation, memory)
        twists.append(action.twist)
    return twists


def velocity_of(twist: Twist, heading: float) -> np.ndarray:
    drive = Omnidirectional(1.0, 1.5, 1e6, 1e6)
    moved, _ = drive.step(Pose.of((0.0, 0.0), heading), Twists.of(Twist(), 1), twist, 0.25)
    return np.asarray(moved.position[0] / 0.25)


@settings(max_examples=30, deadline=None)
@given(st.floats(-3, 3), st.floats(-3, 3), st.integers(0, 5), st.integers(0, 1000))
def test_it_is_invariant_to_rotations_shifts_and_the_order_of_people(
    angle: float, heading: float, count: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    start, velocity = rng.uniform(-4, 4, (count, 2)), rng.uniform(-1, 1, (count, 2))
    turn, order = (
        np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]),
        rng.permutation(count),
    )
    first, other, shift = [], [], np.array([2.0, -1.0])
    for k in range(7):
        people, here, goal = start + 0.25 * k * velocity, np.array([0.1 * k, 0.0]), np.array([5.0, 1.0])
        first.append(observe(here, goal, people, velocity, 0.25 * k))
        other.append(observe(turn @ here + shift, turn @ goal + shift, (people @ turn.T + shift)[order],
                             (velocity @ turn.T)[order], 0.25 * k, order, heading))  # fmt: skip
    navigator = RecurrentPolicyNavigator()
    for one, two in zip(twists_of(navigator, first), twists_of(navigator, other), strict=True):
        np.testing.assert_allclose(velocity_of(two, heading), turn @ velocity_of(one, 0.0), atol=2e-3)


@pytest.mark.parametrize("limits", [STIFF, WHEELS])
def test_velocities_of_people_have_no_effect(limits: DriveLimits) -> None:
    def seen(factor: float) -> list[Observation]:
        rows = [
            observe((0.0, 0.0), (5.0, 0.0), [(3.0 - 0.25 * k, 0.3)], [(-factor, factor)], 0.25 * k) for k in range(6)
        ]
        return [dataclasses.replace(row, limits=limits) for row in rows]

    navigator = RecurrentPolicyNavigator()
    assert twists_of(navigator, seen(1.0)) == twists_of(navigator, seen(-3.0))


def test_where_people_were_has_an_effect() -> None:
    def last(direction: float) -> Twist:
        places = [[(2.0, 0.25 * direction * (k - 5))] for k in range(6)]
        seen = [observe((0.0, 0.0), (5.0, 0.0), place, [(0.0, 0.0)], 0.25 * k) for k, place in enumerate(places)]
        return twists_of(RecurrentPolicyNavigator(horizon=0.0), seen)[-1]

    up, down, still = last(1.0), last(-1.0), last(0.0)
    assert len({up, down, still}) == 3


def test_people_who_are_far_away_have_no_effect(file: str) -> None:
    def last(people: Any) -> Twist:
        return twists_of(RecurrentPolicyNavigator(file=file), [
            observe((0.0, 0.0), (4.0, 0.0), people, np.zeros((len(people), 2)), 0.25 * k) for k in range(3)
        ])[-1]  # fmt: skip

    assert last([(2.0, 0.2)]) != last([])
    assert last([(11.5, 0.0)]) == last([])


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 500), st.floats(0.2, 1.4))
def test_twists_are_within_the_limits_of_the_drive(seed: int, speed: float) -> None:
    navigator = RecurrentPolicyNavigator(speed=speed)
    batch = view_of(0, 5, seed=seed, count=4, limits=ANY_WAY)
    memories, failures = navigator.first_memories(batch)
    assert not failures
    for k in range(3):
        decisions = navigator.decide_batch(view_of(k, 5, seed=seed, count=4, limits=ANY_WAY), memories)
        memories, twist = decisions.memories, decisions.twist
        assert not decisions.failures
        assert np.hypot(twist[:, 0], twist[:, 2]).max() <= min(speed, 1.0) + 1e-9
    twist = navigator.decide_batch(view_of(3, 5, seed=seed, count=4, limits=WHEELS), memories).twist
    assert (twist[:, 2] == 0.0).all()
    assert (np.abs(twist[:, 0]) <= 1.0 + 1e-9).all()
    assert (np.abs(twist[:, 1]) <= 1.5 + 1e-9).all()


def test_an_environment_with_a_wrong_value_fails_alone() -> None:
    batch = view_of(0, 4, count=3)
    navigator = RecurrentPolicyNavigator()
    memories, _ = navigator.first_memories(batch)
    batch.pose[1, 0] = np.nan
    decisions = navigator.decide_batch(batch, memories)
    assert list(decisions.failures) == [1]
    assert (decisions.twist[[0, 2]] != 0.0).any(axis=1).all()


@pytest.mark.parametrize("limits", [ANY_WAY, WHEELS])
def test_it_reaches_its_goal_alone(limits: DriveLimits) -> None:
    drive: Any = Omnidirectional(1.0, 1.5, 1e6, 1e6) if limits.holonomic else DifferentialDrive(1.0, 1.5, 1.0, 3.0)
    pose, twist, navigator, memory = Pose.of((0.0, 0.0), 1.0), Twists.of(Twist(), 1), RecurrentPolicyNavigator(), None
    for k in range(150):
        x, y = pose.position[0].tolist()
        seen = Observation(pose=(x, y, float(pose.heading[0])), twist=twist.at(0), goal=(4.0, 3.0), radius=0.3,
                           limits=limits, dt=0.1, time=0.1 * k)  # fmt: skip
        action, memory = navigator.act(seen, memory or navigator.begin(seen))
        pose, twist = drive.step(pose, twist, action.twist, 0.1)
    assert math.dist(pose.position[0], (4.0, 3.0)) < 0.3


@pytest.mark.parametrize(("name", "at"), [("crowdnav-circle-5", 2.75), ("corner-traffic", 1.7)])
def test_episodes_are_the_same_together_alone_and_from_a_saved_state(tmp_path: Path, name: str, at: float) -> None:
    trial = parse_methods("recurrent-policy")[0].put_into(load_trial(name, duration=4.0))
    together = [episode.digest for episode in simulate_seeds(trial, range(3))]
    assert together == [simulate(trial, seed=k).digest for k in range(3)]
    assert len(set(together)) == 3
    kept = run(trial, seed=0, out=tmp_path / "first")
    assert branch(tmp_path / "first" / "episode.mcap", at=at).digest == kept.digest == together[0]


def test_the_weights_say_how_they_were_made() -> None:
    file = policy_file("recurrent-policy")
    assert file.stat().st_size < 200_000
    _, card = RecurrentWeights.read(file)
    assert "train_navigator.py --network recurrent" in card["command"]
    assert card["steps"] >= card["planned_steps"]


def test_wrong_weights_are_refused(tmp_path: Path, file: str) -> None:
    here = observe((0.0, 0.0), (4.0, 0.0), [], [])

    def act(path: Path | str) -> Any:
        navigator = RecurrentPolicyNavigator(file=str(path))
        return navigator.act(here, navigator.begin(here))

    with pytest.raises(
        InputError, match=r"attention-policy.npz: temporal_input_weight must be \[4, 48\] finite numbers"
    ):
        act(policy_file("attention-policy"))
    with pytest.raises(InputError, match=r"there is no file .*none.npz; make one with examples/train_navigator.py"):
        act(tmp_path / "none.npz")
    weights, card = RecurrentWeights.read(Path(file))
    bad = np.full_like(weights.spatial_state_bias, np.inf)
    dataclasses.replace(weights, spatial_state_bias=bad).save(tmp_path / "bad.npz", card)
    with pytest.raises(InputError, match=r"bad.npz: spatial_state_bias must be \[96\] finite numbers"):
        act(tmp_path / "bad.npz")
    with pytest.raises(InputError, match=r"RecurrentPolicyNavigator: margin = 0"):
        RecurrentPolicyNavigator(margin=0.0)
