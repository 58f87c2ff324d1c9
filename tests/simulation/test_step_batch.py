"""Records of many environments as arrays: the same episodes, digests and metrics as single records."""

from __future__ import annotations

import dataclasses
import pickle
from typing import Any

import numpy as np
import pytest

from crowdbot.core import TrialError
from crowdbot.sensors import GroundTruthPeople, Lidar2D, Reading
from crowdbot.simulation import (
    BatchSink,
    Episode,
    EpisodeDigest,
    Simulation,
    SimulationRun,
    StepBatch,
    StepRecord,
    simulate,
    simulate_seeds,
)
from crowdbot.trials import Mount, Spawner, Trial, load_trial, parse_trial
from space_trials import LEAN, room
from trial_texts import FLOW

ARRAYS = ("times", "position", "velocity", "heading", "radius", "active", "ids", "twists", "commands")


def equal(one: Any, other: Any) -> bool:
    """Return whether two values have the same types and the same bits."""
    if dataclasses.is_dataclass(one):
        return type(one) is type(other) and all(
            equal(getattr(one, field.name), getattr(other, field.name)) for field in dataclasses.fields(one)
        )
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    return repr(one) == repr(other)


def check_equal(episode: Episode, other: Episode) -> None:
    assert (episode.digest, episode.outcome, episode.steps) == (other.digest, other.outcome, other.steps)
    assert repr(dict(episode.metrics)) == repr(dict(other.metrics))
    for name in (*ARRAYS, "contacts", "forces", "collisions", "orders"):
        assert equal(getattr(episode, name), getattr(other, name)), name
    assert list(episode.readings) == list(other.readings)
    for name, readings in episode.readings.items():
        assert len(readings) == len(other.readings[name])
        assert all(map(equal, readings, other.readings[name])), name


def sensing(trial: Trial) -> Trial:
    """Return a trial whose robots have two kinds of sensors, one of them late."""
    mounts = (
        Mount(name="scan", sensor=Lidar2D(rate=10.0, rays=30, delay=0.1), z=0.4),
        Mount(name="people", sensor=GroundTruthPeople(rate=5.0, range_max=8.0), z=0.4),
    )
    return dataclasses.replace(
        trial, robots=tuple(dataclasses.replace(robot, sensors=mounts) for robot in trial.robots)
    )


@pytest.mark.parametrize(
    "trial",
    [
        load_trial("circle-crossing", navigator="straight", reactive=False, duration=6.0),
        sensing(dataclasses.replace(parse_trial(FLOW), duration=4.0)),
        sensing(load_trial("frontal", duration=2.0)),
        dataclasses.replace(parse_trial(room("physics", LEAN)), duration=1.0),
    ],
    ids=["circle", "flow", "frontal", "physics"],
)
def test_episodes_of_a_batch_have_the_bits_of_single_runs(trial: Trial) -> None:
    for episode in simulate_seeds(trial, range(3)):
        check_equal(episode, simulate(trial, episode.seed))


class Counter:
    """A user's sink, which takes single records."""

    def __init__(self, environments: int) -> None:
        self.digests = [EpisodeDigest() for _ in range(environments)]

    def take(self, frame: StepRecord) -> None:
        self.digests[frame.environment].take(frame)


class Keeper(Counter):
    """A sink of batches."""

    batches = 0

    def take_batch(self, batch: StepBatch) -> None:
        self.batches += 1


@pytest.mark.parametrize("mixed", [False, True])
def test_a_sink_of_single_records_gets_all_records(mixed: bool) -> None:
    trial = dataclasses.replace(parse_trial(FLOW), duration=2.0)
    sink, keeper = Counter(3), Keeper(3)
    run = SimulationRun(Simulation(trial, range(3)), [keeper, sink] if mixed else [sink])
    run.advance()
    ends = [end.outcome for end in run.ends if end is not None]
    digests = [digest.hexdigest(outcome) for digest, outcome in zip(sink.digests, ends, strict=True)]
    assert digests == [simulate(trial, seed).digest for seed in range(3)]
    assert keeper.batches == 0
    assert isinstance(keeper, BatchSink)
    assert not isinstance(sink, BatchSink)


def test_a_run_without_sinks_writes_nothing() -> None:
    run = SimulationRun(Simulation(dataclasses.replace(parse_trial(FLOW), duration=0.5), range(2)))
    assert run.advance() == "finished"


def test_readings_of_a_batch_are_written_without_the_batch() -> None:
    first, _ = simulate_seeds(load_trial("circle-crossing", duration=1.0), range(2))
    copy = pickle.loads(pickle.dumps(first.readings))
    assert isinstance(copy, dict)
    assert all(isinstance(item, Reading) for item in copy["robot/scan"])
    assert all(map(equal, copy["robot/scan"], first.readings["robot/scan"]))
    assert "robot/scan" in repr(first.readings)


def test_people_who_do_not_fit_with_a_later_seed_are_reported() -> None:
    zone = [(0, 0), (1.5, 0), (1.5, 1.5), (0, 1.5)]
    trial = dataclasses.replace(
        load_trial("frontal", duration=1.0),
        agents=(),
        spawners=(Spawner(count=5, zone=zone, goal=zone, radius=0.3),),
    )
    fits = []
    for seed in range(60):
        try:
            simulate(trial, seed)
            fits.append(seed)
        except TrialError as error:
            message = str(error)
            break
    assert fits
    with pytest.raises(TrialError) as caught:
        simulate_seeds(trial, [fits[0], seed])
    assert str(caught.value) == message
