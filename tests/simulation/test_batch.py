"""Environments of one simulation are their single runs, to the last bit."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.models import ORCA
from crowdbot.navigation import Navigator, Observation
from crowdbot.recording import run
from crowdbot.simulation import (
    EpisodeLog,
    RunFailureWarning,
    Simulation,
    SimulationRun,
    StepRecord,
    simulate,
    simulate_seeds,
)
from crowdbot.trials import Trial, expand_sweeps, load_trial, parse_trial
from samples import sample
from space_trials import LEAN, room
from trial_texts import FLOW

SEEDS = range(4)
SENSORS = FLOW  # sources, journeys, a robot with a scanner


def short(name: str, duration: float = 1.5) -> Trial:
    trial = load_trial(name)
    first = expand_sweeps(trial)[0] if trial.sweeps else trial
    return dataclasses.replace(first, duration=duration)


def digest(record: StepRecord) -> str:
    """Return the digest of everything in a record."""
    log = EpisodeLog(TINY, 0)
    log.digest.take(record)
    return log.digest.hexdigest("")


TINY = parse_trial(FLOW)


@pytest.mark.parametrize(
    "name",
    sample(
        ["frontal", "crossing-flows", "bottleneck", "two-crowds", "random-goals", "challenge-both-50", "two-way"],
        ["frontal", "two-crowds"],
    ),
)
def test_a_batch_is_its_single_runs(name: str) -> None:
    trial = short(name)
    many = simulate_seeds(trial, SEEDS)
    assert [item.digest for item in many] == [run(trial, seed).digest for seed in SEEDS]
    assert [item.seed for item in many] == list(SEEDS)
    assert len({item.digest for item in many}) > 1 or name == "frontal"


@pytest.mark.parametrize("text", [FLOW, room("planar", LEAN), room("physics", LEAN)], ids=["flow", "planar", "physics"])
def test_runs_of_different_lengths_and_worlds(text: str) -> None:
    trial = parse_trial(text)
    short_one = dataclasses.replace(trial, duration=min(trial.duration, 2.0))
    assert [seed.digest for seed in simulate_seeds(short_one, SEEDS)] == [run(short_one, seed).digest for seed in SEEDS]


def test_who_ends_early_leaves_the_others_alone() -> None:
    trial = load_trial("circle-crossing", navigator="straight", reactive=False)
    singles = [run(trial, seed) for seed in SEEDS]
    assert len({single.steps for single in singles}) > 1
    assert [seed.digest for seed in simulate_seeds(trial, SEEDS)] == [single.digest for single in singles]


def test_the_last_environment_has_its_own_number_of_people() -> None:
    """Environments with more people end first; the arrays of the last one are wider than its scene."""
    trial, seeds = load_trial("bottleneck", {"crowd/robot-gap": 0.0}), (9, 1)
    singles = [run(trial, seed) for seed in seeds]
    assert singles[0].steps < singles[1].steps
    assert [seed.digest for seed in simulate_seeds(trial, seeds)] == [single.digest for single in singles]


@dataclasses.dataclass(frozen=True)
class Shaky(ORCA):
    """A model of a user, with random numbers, for one environment at a time."""

    def step(self, scene, dt, rng=None):  # type: ignore[no-untyped-def]
        assert scene.shape[0] == 1
        after = super().step(scene, dt, rng)
        return after.replace(position=after.position + 1e-3 * rng.normal(size=after.position.shape))


def test_a_model_with_random_numbers_is_asked_for_each_environment() -> None:
    trial = dataclasses.replace(short("crossing-flows"), crowd=Shaky())
    assert [seed.digest for seed in simulate_seeds(trial, SEEDS)] == [simulate(trial, seed).digest for seed in SEEDS]


@pytest.mark.parametrize("text", [FLOW, room("planar", LEAN)], ids=["flow", "planar"])
@given(data=st.data())
@settings(max_examples=3, deadline=None)
def test_environments_restart_on_their_own(text: str, data: Any) -> None:
    trial = parse_trial(text)
    simulation = Simulation(trial, [0, 1, 2])
    singles = {e: Simulation(trial, e) for e in range(3)}
    simulation.begin()
    for single in singles.values():
        single.begin()
    seed = 3
    for _ in range(40):
        again = data.draw(st.lists(st.integers(0, 2), max_size=1 if seed > 8 else 2, unique=True)) if seed < 9 else []
        if again:
            seeds = list(range(seed, seed + len(again)))
            seed += len(again)
            simulation.restart(again, seeds)
            for e, new in zip(again, seeds, strict=True):
                singles[e] = Simulation(trial, new)
                singles[e].begin()
        assert [digest(simulation.record(e)) for e in range(3)] == [digest(singles[e].record()) for e in range(3)]
        simulation.advance()
        for single in singles.values():
            single.advance()
    assert simulation.ticks.tolist() == [int(singles[e].ticks[0]) for e in range(3)]


@pytest.mark.parametrize("text", [FLOW, room("planar", LEAN)], ids=["flow", "planar"])
def test_a_copy_continues_as_the_original_and_leaves_it_alone(text: str) -> None:
    trial = parse_trial(text)
    simulation = Simulation(trial, [5, 6])
    for _ in range(17):
        simulation.advance()
    copies = simulation.select([1, 0, 1])
    for _ in range(20):
        copies.advance()
    for _ in range(20):
        simulation.advance()
    expected = [digest(simulation.record(e)) for e in (1, 0, 1)]
    assert [digest(copies.record(e)) for e in range(3)] == expected


@dataclasses.dataclass(frozen=True)
class Fragile(Navigator):
    """A navigator that raises an exception when people are near."""

    def act(self, observation: Observation) -> Any:
        if observation.time > 0.5 and observation.nearest < 2.0:
            raise RuntimeError("too near")
        return observation.towards_goal(0.5)


def test_a_failure_ends_only_its_environment() -> None:
    trial = load_trial("circle-crossing", duration=2.0)
    robot = dataclasses.replace(trial.robots[0], navigator=Fragile())
    trial = dataclasses.replace(trial, robots=(robot,))
    seeds = range(4)
    with pytest.warns(RunFailureWarning):
        singles = [simulate(trial, seed) for seed in seeds]
    with pytest.warns(RunFailureWarning):
        many = simulate_seeds(trial, seeds)
    assert [(item.outcome, item.digest, item.failure) for item in many] == [
        (single.outcome, single.digest, single.failure) for single in singles
    ]


@dataclasses.dataclass(frozen=True)
class Limited(ORCA):
    """A model that raises an exception for some people."""

    def step(self, scene, dt, rng=None):  # type: ignore[no-untyped-def]
        if np.any(scene.position[..., 0] > 3.0):
            raise RuntimeError("too far right")
        return super().step(scene, dt, rng)


def test_a_failure_of_the_crowd_ends_only_its_environment() -> None:
    trial = dataclasses.replace(short("crossing-flows", 4.0), crowd=Limited())
    seeds = range(4)
    with pytest.warns(RunFailureWarning):
        singles = [simulate(trial, seed) for seed in seeds]
    assert "error" in {single.outcome for single in singles}
    with pytest.warns(RunFailureWarning):
        many = simulate_seeds(trial, seeds)
    assert [(item.outcome, item.digest, item.failure, item.steps) for item in many] == [
        (single.outcome, single.digest, single.failure, single.steps) for single in singles
    ]


def test_wrong_batches_are_refused() -> None:
    with pytest.raises(InputError, match="at least one seed"):
        simulate_seeds(load_trial("frontal"), [])
    told: list[float] = []
    simulate_seeds(short("frontal"), [1, 2], progress=told.append)
    assert told[-1] == 1.0
    assert told == sorted(told)


@pytest.mark.parametrize(
    ("environments", "seeds", "message"),
    [
        ([2], [5], r"environments = \[2\]: each must be from 0 to 1"),
        ([-1], [5], r"environments = \[-1\]: each must be from 0 to 1"),
        ([0, 1], [5], r"environments = \[0, 1\] and 1 new ones: give each environment once"),
        ([0, 0], [5, 6], r"environments = \[0, 0\] and 2 new ones: give each environment once"),
        ([], [], r"environments = \[\] must be a list of one or more whole numbers"),
        ([0.5], [5], r"environments = \[0.5\] must be a list of one or more whole numbers"),
    ],
)
def test_wrong_environments_are_refused(environments: list[Any], seeds: list[int], message: str) -> None:
    simulation = Simulation(TINY, [3, 4])
    simulation.advance()
    before = [digest(simulation.record(e)) for e in range(2)]
    with pytest.raises(InputError, match=message):
        simulation.restart(environments, seeds)
    assert [digest(simulation.record(e)) for e in range(2)] == before


def test_records_name_their_environment() -> None:
    taken: list[tuple[int, int]] = []

    class Book:
        def take(self, frame: StepRecord) -> None:
            taken.append((frame.environment, frame.tick))

    trial = short("frontal", 0.5)
    running = SimulationRun(Simulation(trial, [3, 4]), [Book()])
    while running.outcome is None:
        running.step()
    assert taken == [(e, tick) for tick in range(0, 11, 2) for e in (0, 1)]
