"""Forces and collisions of the physics world: what the recorder takes of them, and what other tools read."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd
import pytest
from rosbags.highlevel import AnyReader

from crowdbot.recording import Recorder, export, read_episode
from crowdbot.simulation import EpisodeDigest, EpisodeStatistics, Simulation, StepRecord
from crowdbot.trials import parse_trial
from trial_texts import GOOD


class Party(NamedTuple):
    """As of the physics world."""

    kind: str
    number: int


class BodyForce(NamedTuple):
    """As of the physics world."""

    first: Party
    second: Party
    first_part: str
    limb: str
    part: str
    force: float
    vector: tuple[float, float, float]
    depth: float
    point: tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class Collision:
    """As of the physics world."""

    first: Party
    second: Party
    begin: float
    end: float
    cause: str
    impact_speed: float
    depth: float
    impulse: float
    limb: str
    part: str
    region: str
    peak_force: float
    steady_force: float
    steady_region: str
    simulated_peak: float
    duration: float
    severity: float


@dataclasses.dataclass(frozen=True)
class Physical(StepRecord):
    """A frame of a world that knows forces."""

    forces: tuple[BodyForce, ...] = ()
    collisions: tuple[Collision, ...] = ()


ROBOT, PERSON, WALL, PROP = Party("robot", 4), Party("person", 2), Party("wall", 0), Party("prop", 3)
FORCE = BodyForce(ROBOT, PERSON, "base", "left_shin", "leg", 85.5, (85.0, 9.0, 0.0), 0.004, (1.0, 2.0, 0.3))
HIT = Collision(
    ROBOT, PERSON, 0.1, 0.35, "first", 0.8, 0.01, 12.5, "left_shin", "leg", "lower leg", 130.0, 40.0, "lower leg",
    140.0, 0.25, 0.5,
)  # fmt: skip
GRAZED = dataclasses.replace(HIT, first=PROP, second=WALL, limb="", part="", region="", peak_force=math.nan)


def physical(frame: StepRecord, **more: Any) -> Physical:
    return Physical(**({field.name: getattr(frame, field.name) for field in dataclasses.fields(frame)} | more))


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    path = tmp_path_factory.mktemp("forces") / "episode.mcap"
    trial = parse_trial(GOOD)
    simulation, tally = Simulation(trial, 3), EpisodeStatistics(trial, 3)
    with Recorder(path, tally) as recorder:
        for k in range(8):
            frame = physical(
                simulation.record(due=k % 2 == 0),
                forces=(FORCE, FORCE._replace(second=WALL, limb="", part="")) if k == 3 else (),
                collisions=(HIT, GRAZED) if k == 6 else (),
            )
            tally.take(frame)
            recorder.take(frame)
            simulation.advance()
        recorder.complete("collision", 8)
    return path, tally.digest.hexdigest("collision")


def test_forces_and_collisions_come_back(recorded: tuple[Path, str]) -> None:
    path, digest = recorded
    read = read_episode(path)
    assert read.digest == digest
    first, second = read.forces
    assert (first.time, first.first, first.second, first.limb, first.part) == (0.15, "robot", "2", "left_shin", "leg")
    assert (first.force, first.vector, first.depth, first.point) == FORCE[5:]
    assert (second.second, second.part) == ("wall", "")
    hit, grazed = read.collisions
    for name in ("begin", "end", "duration", "impact_speed", "impulse", "region", "peak_force", "severity", "cause"):
        assert getattr(hit, name) == getattr(HIT, name), name
    assert (grazed.first, grazed.second) == ("prop 3", "wall")
    assert math.isnan(grazed.peak_force)


def test_rosbags_reads_them(recorded: tuple[Path, str]) -> None:
    with AnyReader([recorded[0]]) as bag:
        kinds = {connection.topic: connection.msgtype for connection in bag.connections}
        found = {
            connection.topic: (stamp, bag.deserialize(raw, connection.msgtype))
            for connection, stamp, raw in bag.messages()
        }
    assert kinds["/crowdbot/forces"] == "crowdbot_msgs/msg/Forces"
    stamp, collisions = found["/crowdbot/collisions"]
    assert (stamp, collisions.collisions[0].region) == (300_000_000, "lower leg")


def test_they_count_for_the_digest_and_a_world_without_them_is_as_before() -> None:
    simulation = Simulation(parse_trial(GOOD), 3)
    sums = []
    for more in ({}, {"forces": (FORCE,)}, {"forces": (FORCE._replace(force=85.6),)}, {"collisions": (HIT,)}):
        digest = EpisodeDigest()
        digest.take(physical(simulation.record(), **more))
        sums.append(digest.hexdigest("x"))
    plain = EpisodeDigest()
    plain.take(simulation.record())
    assert len(set(sums)) == 4
    assert plain.hexdigest("x") == sums[0]


def test_they_are_tables(recorded: tuple[Path, str], tmp_path: Path) -> None:
    assert export(recorded[0], tmp_path / "f.parquet", "forces") == 2
    assert export(recorded[0], tmp_path / "c.csv", "collisions") == 2
    forces = pd.read_parquet(tmp_path / "f.parquet")
    assert forces["vector_x"].tolist() == [85.0, 85.0]
    collisions = pd.read_csv(tmp_path / "c.csv")
    assert collisions["peak_force"].tolist()[0] == 130.0
