"""Runs that are steered from outside replay and branch to the byte."""

from __future__ import annotations

import dataclasses
import math
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import EpisodeError, InputError, Twist
from crowdbot.navigation import Navigator, Observation
from crowdbot.recording import branch, open_run, read_episode, replay
from crowdbot.simulation import (
    MissedDecisionOrder,
    Order,
    Simulation,
    VelocityOrder,
    order_kinds,
    read_order,
    simulate,
    write_order,
)
from crowdbot.trials import parse_trial
from episode_copies import copy_episode
from space_trials import LEAN, room
from trial_texts import FLOW

TEXTS = {"flow": FLOW, "physics": room("physics", LEAN)}


class Wander:
    """Steers every robot now and then."""

    def __init__(self, seed: int, every: int = 3) -> None:
        self.rng, self.every = np.random.default_rng(seed), every

    def orders(self, simulation: Simulation) -> list[Order]:
        if simulation.tick % self.every:
            return []
        forward, turn = self.rng.uniform([-0.2, -1.0], [0.8, 1.0])
        names = [robot.robot.name for robot in simulation.robots]
        return [VelocityOrder(robot=name, forward=forward, turn=turn, source="wander") for name in names]


def steered(text: str, out: Path, seconds: float = 3.0, seed: int = 1) -> str:
    """Record a steered run and return its digest."""
    with open_run(parse_trial(text), 3, out=out, sources=[Wander(seed)]) as running:
        while running.outcome is None and running.simulation.world.clock.time < seconds - 1e-6:
            running.step()
    return read_episode(out).digest


@pytest.mark.parametrize("name", TEXTS)
def test_a_steered_run_replays_and_branches_at_any_recorded_instant(name: str, tmp_path: Path) -> None:
    file = tmp_path / "steered.mcap"
    digest = steered(TEXTS[name], file)
    unsteered = tmp_path / "plain.mcap"
    with open_run(parse_trial(TEXTS[name]), 3, out=unsteered) as running:
        while running.outcome is None and running.simulation.world.clock.time < 3.0 - 1e-6:
            running.step()
    assert read_episode(unsteered).digest != digest
    done = replay(file)
    assert done.equal, str(done)
    times = read_episode(file).times
    for instant in times[[0, len(times) // 3, len(times) // 2]].tolist():
        again = branch(file, instant, out=tmp_path / f"branch-{instant:g}.mcap")
        if done.outcomes[0] != "interrupted":
            assert again.digest == digest
        assert replay(tmp_path / f"branch-{instant:g}.mcap").equal
    later = times[len(times) // 2]
    first = tmp_path / f"branch-{times[len(times) // 3]:g}.mcap"
    branch(first, float(later), out=tmp_path / "twice.mcap")
    assert replay(tmp_path / "twice.mcap").equal
    free = branch(file, float(later), out=tmp_path / "free.mcap", orders=False)
    assert free.digest != branch(file, float(later)).digest
    assert replay(tmp_path / "free.mcap").equal


def test_orders_between_steps_are_recorded_with_the_instant_before(tmp_path: Path) -> None:
    file = tmp_path / "stepped.mcap"
    with open_run(parse_trial(FLOW), 3, out=file) as running:
        robot = running.simulation.robots[0].robot.name
        for k in range(30):
            running.step([VelocityOrder(robot=robot, turn=0.1 * k)] if k % 4 == 0 else ())
    read = read_episode(file)
    first = read.commands[0, 0].tolist()
    assert first == [0.0, 0.0, 0.0]
    assert [order.turn for _, order in read.orders] == pytest.approx([0.4 * k for k in range(8)])
    assert replay(file).equal


def test_an_impossible_order_changes_nothing(tmp_path: Path) -> None:
    with open_run(parse_trial(FLOW), 3) as running:
        running.step()
        before = running.simulation.record().commands.tolist()
        robot = running.simulation.robots[0].robot.name
        good = VelocityOrder(robot=robot, forward=0.7)
        with pytest.raises(InputError, match=r"there is no robot 'hal'; the trial has"):
            running.step([good, VelocityOrder(robot="hal")])
        with pytest.raises(InputError, match=r"environment = 1 must be from 0 to 0"):
            running.step([VelocityOrder(robot=robot, environment=1)])
        assert running.simulation.tick == 1
        assert running.simulation.record().commands.tolist() == before


SLEEPS = [False]


@dataclass(frozen=True)
class Slow(Navigator):
    """Needs too long for some decisions, while a flag is set."""

    def act(self, observation: Observation) -> Twist:
        if SLEEPS[0] and round(observation.time * 10) % 3 == 1:
            time.sleep(0.12)
        return observation.towards_goal(0.1 + 0.05 * observation.time)


@pytest.mark.live
def test_a_missed_deadline_is_recorded_and_a_replay_measures_no_time(tmp_path: Path) -> None:
    trial = parse_trial(FLOW)
    robot = dataclasses.replace(trial.robots[0], navigator=Slow(), deadline=0.1)
    trial = dataclasses.replace(trial, robots=(robot, *trial.robots[1:]), duration=1.5)
    SLEEPS[0] = True
    slow = simulate(trial, 3)
    SLEEPS[0] = False
    missed = [tick for tick, order in slow.orders if order == MissedDecisionOrder(robot=robot.name)]
    assert len(missed) >= 4
    assert branch(slow, at=0.5).digest == slow.digest
    assert branch(slow, at=0.5, orders=False).digest != slow.digest
    assert simulate(trial, 3).digest != slow.digest


def test_nobody_can_give_a_missed_decision() -> None:
    simulation = Simulation(parse_trial(FLOW), 3)
    with pytest.raises(InputError, match="written by a run and cannot be given"):
        MissedDecisionOrder(robot="robot").check(simulation)


@given(values=st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=3, max_size=3), name=st.text())
@settings(max_examples=50, deadline=None)
def test_an_order_is_the_same_after_writing_and_reading(values: list[float], name: str) -> None:
    forward, turn, left = values
    order = VelocityOrder(robot=name, forward=forward, turn=turn, left=left, source="ros")
    assert read_order(write_order(order)) == order


def test_every_kind_of_order_is_known_by_name() -> None:
    assert order_kinds()["velocity"] is VelocityOrder


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "an order is not JSON"),
        ("[1]", 'must be a JSON object with "order"'),
        ('{"order": "velocty", "robot": "a"}', "order 'velocty' is unknown.*velocity"),
        ('{"order": "velocity"}', "order 'velocity' lacks robot"),
        ('{"order": "velocity", "robot": 3}', "robot = 3 must be of type str"),
        ('{"order": "velocity", "robot": "a", "forward": NaN}', "forward = nan must be a finite number"),
        ('{"order": "velocity", "robot": "a", "forward": true}', "forward = True must be of type float"),
        ('{"order": "velocity", "robot": "a", "foward": 1}', "has no value 'foward'.*forward"),
        ("[" * 100_000, "an order is not JSON"),
    ],
)
def test_wrong_orders_are_explained(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_order(text)


def test_a_velocity_that_is_not_finite_is_refused() -> None:
    with pytest.raises(InputError, match="turn = inf must be a finite number"):
        VelocityOrder(robot="a", turn=math.inf)


def test_a_damaged_order_in_a_file_is_explained(tmp_path: Path) -> None:
    file = tmp_path / "steered.mcap"
    steered(FLOW, file, 1.0)

    def change(topic: str, data: bytes) -> bytes:
        return data.replace(b'"velocity"', b'"velocitx"') if topic == "/crowdbot/orders" else data

    damaged = copy_episode(file, tmp_path / "damaged.mcap", bytes_of=change)
    with pytest.raises(EpisodeError, match="order 'velocitx' is unknown"):
        replay(damaged)
    with pytest.raises(EpisodeError, match="order 'velocitx' is unknown"):
        read_episode(damaged)
