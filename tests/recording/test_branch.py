"""Branches: from any recorded instant, with the same or other values, and again from what was recorded of it."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import EpisodeError, InputError, TrialError
from crowdbot.data import McapReader
from crowdbot.recording import branch, is_latched, read_episode, record, replay, run
from crowdbot.trials import apply_values, parse_trial
from episode_copies import copy_episode
from space_trials import LEAN, room
from trial_texts import BRIEF_FLOW, GOOD

SMALL, FLOWING = parse_trial(GOOD), parse_trial(BRIEF_FLOW)


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("small")
    record(SMALL, out=folder)
    return folder / "episode.mcap"


@pytest.fixture(scope="module")
def flowing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("flowing")
    record(FLOWING, out=folder)
    return folder / "episode.mcap"


def messages(path: Path, begin: float = 0.0) -> list[tuple[str, int, bytes]]:
    with path.open("rb") as stream:
        rows = [(h.topic.topic, h.stamp, h.data) for h in McapReader(stream).messages()]
    latched = [row for row in rows if is_latched(row[0])]
    assert rows[0][1] in {row[1] for row in latched}
    return [row for row in rows if row[1] >= begin * 1e9 and not is_latched(row[0])]


@pytest.mark.parametrize("at", [0.0, 0.1, 2.0, 3.9, 4.0])
def test_a_branch_without_changes_is_the_rest_of_the_original(small: Path, tmp_path: Path, at: float) -> None:
    done = branch(small, at, out=tmp_path)
    original, rest = read_episode(small), read_episode(tmp_path / "episode.mcap")
    assert done.digest == rest.digest == original.digest
    assert (rest.outcome, rest.steps, done.begin) == (original.outcome, original.steps, at)
    assert np.array_equal(rest.position, original.position[original.times >= at - 1e-9])
    wanted = messages(small, at)
    assert messages(tmp_path / "episode.mcap") == wanted
    assert len(wanted) > 6


@given(tick=st.integers(0, 80))
@settings(deadline=None, max_examples=3)
def test_people_who_come_ways_journeys_and_chance_go_on_as_they_were(
    flowing: Path, tmp_path_factory: pytest.TempPathFactory, tick: int
) -> None:
    out = tmp_path_factory.mktemp("branch")
    done = branch(flowing, tick / 10, out=out)
    assert done.digest == read_episode(flowing).digest
    assert messages(out / "episode.mcap") == messages(flowing, tick / 10)


def test_a_branch_in_the_physics_world_is_the_rest_of_the_original(tmp_path: Path) -> None:
    stands = LEAN.replace('x="6" y="4" goal="1,4" body="woman-36" outfit="3"', 'x="2.8" y="2.2"')
    trial = parse_trial(room("physics", stands).replace('duration="1"', 'duration="2"'))
    first = record(trial, out=tmp_path / "whole")
    whole = messages(tmp_path / "whole" / "episode.mcap")
    assert {"/crowdbot/forces", "/crowdbot/contacts"} <= {topic for topic, *_ in whole}, "somebody is run into"
    for at in (0.52, 1.6):
        done = branch(tmp_path / "whole" / "episode.mcap", at, out=tmp_path / f"{at}")
        assert done.digest == first.digest
        wanted = messages(tmp_path / "whole" / "episode.mcap", at)
        assert messages(tmp_path / f"{at}" / "episode.mcap") == wanted
        assert 6 < len(wanted) < len(whole)
    assert replay(tmp_path / "1.6" / "episode.mcap").equal


def test_a_branch_with_changes_differs_from_then_on_and_replays(flowing: Path, tmp_path: Path) -> None:
    original = read_episode(flowing)
    changes = {
        "duration": 7,
        "robot-margin": 0.3,
        "crowd[hurried].type": "orca",
        "limits.max-speed": 1.0,
        "source[west].rate": 2.0,
        "source[north].rate": 1.5,
        "robot.navigator.type": "straight",
        "robot.goal.y": -1.0,
        "end.goal": True,
        "routing.radius": 0.3,
        "recording.period": 0.2,
    }
    done = branch(flowing, 3.0, out=tmp_path, changes=changes)
    read = read_episode(tmp_path / "episode.mcap")
    assert (read.times[0], done.digest) == (3.0, read.digest)
    assert read.digest != original.digest
    assert np.array_equal(read.position[0, :5], original.position[30, :5])
    assert not np.array_equal(read.position[-1, :5], original.position[30 + 2 * len(read.times) - 2, :5])
    assert read.times[1] == 3.2
    speeds = np.hypot(*read.velocity[5:, :4].reshape(-1, 2).T)
    assert speeds.max() < 1.0 + 1e-9
    assert parse_trial(read.xml).robot_margin == 0.3
    assert replay(tmp_path / "episode.mcap").equal


def test_new_chance_and_branches_of_branches(flowing: Path, tmp_path: Path) -> None:
    first = branch(flowing, 2.0, seed=77, out=tmp_path / "1")
    again = branch(flowing, 2.0, seed=77)
    assert first.digest == again.digest != read_episode(flowing).digest
    second = branch(first.path or "", 4.0, changes={"source[west].rate": 0.1}, out=tmp_path / "2")
    third = branch(second.path or "", 6.0, out=tmp_path / "3")
    assert third.digest == second.digest != first.digest
    assert messages(tmp_path / "3" / "episode.mcap") == messages(tmp_path / "2" / "episode.mcap", 6.0)
    for folder in ("1", "2", "3"):
        assert replay(tmp_path / folder / "episode.mcap").equal
    with pytest.raises(EpisodeError, match=r"has no step at 3 s; it lasts from 4 s to 8 s"):
        branch(second.path or "", 3.0)


def test_a_wall_may_be_put_up(small: Path, tmp_path: Path) -> None:
    xml = GOOD.replace('<wall points="-6,2.9 6,2.9"/>', '<wall points="-6,2.9 6,2.9"/><wall points="2,-3 2,3"/>')
    done = branch(small, 1.0, trial=parse_trial(xml.replace('collision="false"', 'collision="true"')), out=tmp_path)
    assert done.outcome in ("timeout", "collision")
    assert len(read_episode(tmp_path / "episode.mcap").walls) == 4
    assert replay(tmp_path / "episode.mcap").equal


def test_an_episode_in_memory_branches_too() -> None:
    episode = run(SMALL)
    later = branch(episode, 2.0, changes={"robot.goal.x": 0.0, "end.collision": True})
    assert later.times[0] == 2.0
    assert np.array_equal(later.position[0], episode.position[20])
    assert later.trial.robots[0].goal.x == 0.0
    assert branch(episode, 2.0).digest == episode.digest
    with pytest.raises(InputError, match="this episode is a branch"):
        branch(later, 3.0)


def test_what_cannot_be_branched_is_said_in_a_sentence(small: Path, flowing: Path, tmp_path: Path) -> None:
    def refused(path: Path, at: float, **more: object) -> str:
        with pytest.raises(InputError) as found:
            branch(path, at, out=tmp_path / "out", **more)  # type: ignore[arg-type]
        assert "\n" not in str(found.value)
        return str(found.value)

    assert refused(small, 1.23).endswith("has no step at 1.23 s: it was recorded every 0.1 s; the nearest is 1.2 s")
    assert '"ro bot/x" does not exist' in refused(small, 2.0, changes={"ro bot/x": 1})
    assert '"robot/x y" is not a path' in refused(small, 2.0, changes={"robot/x y": 1})
    assert "choose one: spawner[" in refused(small, 2.0, changes={"spawner/count": 1})
    assert "has no step at 9 s; it lasts from 0 s to 4 s" in refused(small, 9.0)
    assert refused(small, 2.0, changes={"step": 0.1}).startswith("step cannot change in a branch")
    assert refused(small, 2.0, changes={"spawner[east].count": 1}).startswith("spawners cannot change in a branch")
    assert "x of robot 'robot' cannot change in a branch" in refused(small, 2.0, changes={"robot.x": 1})
    assert "<trial> has 2 <spawner>; choose one" in refused(small, 2.0, changes={"spawner.count": 1})
    assert "<trial> has no element 'robt', did you mean" in refused(small, 2.0, changes={"robt.x": 1})
    assert "does not exist" in refused(small, 2.0, changes={"ro bot.x": 1})
    assert "a duration of 1 s ends before the branch begins at 2 s" in refused(small, 2.0, changes={"duration": 1})
    assert "recording period of 0.3 s has no step at 2 s" in refused(small, 2.0, changes={"recording.period": 0.3})
    assert "goal of source 'north' cannot change" in refused(flowing, 2.0, changes={"source[north].arrival": "stay"})
    fewer = dataclasses.replace(FLOWING, sources=FLOWING.sources[:1])
    assert "the number of sources cannot change" in refused(flowing, 2.0, trial=fewer)
    with pytest.raises(TrialError, match="has no attribute 'spced'"):
        branch(small, 2.0, changes={"robot.navigator.spced": 2})
    with pytest.raises(InputError, match="is the source of the branch; record the branch to another file"):
        branch(small, 2.0, out=small)
    assert os.listdir(tmp_path) == []


def test_an_episode_that_does_not_replay_is_not_branched(small: Path, tmp_path: Path) -> None:
    path = copy_episode(small, tmp_path / "other.mcap", {"seed": "4"})
    with pytest.raises(EpisodeError, match=r"differs from its replay from 0 s on"):
        branch(path, 2.0)


def test_changes_name_things_as_the_xml_does() -> None:
    new = apply_values(
        SMALL, {"crowd.time_horizon": 1, "robot[1].sensor.rays": 30, "spawner[west].speed": "uniform(1, 2)"}
    )
    assert new.crowd.time_horizon == 1  # type: ignore[attr-defined]
    assert new.robots[0].sensors[0].sensor.rays == 30  # type: ignore[attr-defined]
    assert str(new.spawners[1].speed) == "uniform(1, 2)"
    assert apply_values(SMALL, {}) is SMALL
    slashed = {"crowd/time_horizon": 1, "robot[1]/sensor/rays": 30, "spawner[west]/speed": "uniform(1, 2)"}
    assert apply_values(SMALL, slashed) == new
    assert apply_values(SMALL, {"spawner[2]/speed": 1}) == apply_values(SMALL, {"spawner[2].speed": 1})
    assert apply_values(SMALL, {"robot.sensor.x": 0.2}).robots[0].sensors[0].x == 0.2
