"""Keyframes in episode files: branches, replays and instants from them equal those from the beginning."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.recording import (
    KeyframeWarning,
    RecordedSimulation,
    branch,
    keyframe_ticks,
    open_run,
    read_episode,
    record,
    replay,
    run,
)
from crowdbot.recording.keyframes import Keyframe
from crowdbot.simulation import (
    AddPersonOrder,
    EpisodeDigest,
    MoveOrder,
    ParameterOrder,
    Simulation,
    VelocityOrder,
    encode_state,
    state_of,
)
from crowdbot.trials import parse_trial
from space_trials import LEAN, room
from trial_texts import FLOW

TRIAL = parse_trial(FLOW.replace('duration="20"', 'duration="13"'))


class Steering:
    """Steers and edits the run."""

    def orders(self, simulation: Simulation) -> list[Any]:
        tick = simulation.tick
        robot = simulation.robots[0].robot.name
        result: list[Any] = []
        if tick % 7 == 0:
            result.append(VelocityOrder(robot=robot, forward=0.1 + 0.01 * (tick % 5), turn=0.1))
        if tick in (30, 150):
            result.append(ParameterOrder(path="limits/max-speed", value=f"{2.0 + tick / 1000}"))
        if tick in (40, 41, 170):
            result.append(AddPersonOrder(x=1.0, y=0.2 + 0.01 * tick, goal_x=3.0, goal_y=1.0))
        if tick == 50:
            result.append(MoveOrder(person=simulation.trial.people, x=0.5, y=0.5))
        return result


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plain") / "episode.mcap"
    record(TRIAL, 5, out=path)
    return path


@pytest.fixture(scope="module")
def edited(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("edited") / "episode.mcap"
    with open_run(TRIAL, 5, out=path, sources=[Steering()]) as running:
        running.advance()
    return path


def check_exact(source: Path, at: float, out: Path, **changes: Any) -> None:
    """Check that a branch from a keyframe has the bytes of one from the beginning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        first = branch(source, at, out=out / "first.mcap", force=True, **changes)
        second = branch(source, at, out=out / "second.mcap", force=True, keyframes=False, **changes)
    assert first.digest == second.digest
    assert (out / "first.mcap").read_bytes() == (out / "second.mcap").read_bytes()


def test_a_file_has_a_keyframe_every_5_s_and_its_digest_is_that_of_a_run_in_memory(plain: Path) -> None:
    step = TRIAL.step
    steps = read_episode(plain).steps
    assert [tick * step for tick in keyframe_ticks(plain)] == pytest.approx(
        [5.0 * k for k in range(1, 9) if 5.0 * k < steps * step]
    )
    assert len(keyframe_ticks(plain)) >= 2
    assert read_episode(plain).digest == run(TRIAL, 5).digest


@pytest.mark.parametrize("kind", ["plain", "edited"])
@pytest.mark.parametrize("at", [2.0, 5.0, 5.2, 9.6, 11.0])
def test_a_branch_from_a_keyframe_has_the_bytes_of_one_from_the_beginning(
    kind: str, at: float, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    check_exact(request.getfixturevalue(kind), at, tmp_path)


def test_a_branch_with_changes_and_a_branch_of_it_too(edited: Path, tmp_path: Path) -> None:
    check_exact(edited, 6.0, tmp_path, seed=9, changes={"limits.max-speed": 1.5})
    middle = tmp_path / "first.mcap"
    assert min(keyframe_ticks(middle)) * TRIAL.step == pytest.approx(10.0)
    (tmp_path / "again").mkdir()
    check_exact(middle, 10.6, tmp_path / "again")
    assert replay(tmp_path / "again" / "first.mcap").equal
    assert (replay(middle, begin=11.0).equal, replay(middle, begin=11.0).begin) == (True, 10.0)


def test_a_physics_trial_branches_from_a_keyframe(tmp_path: Path) -> None:
    trial = parse_trial(room("physics", LEAN).replace('duration="1"', 'duration="6"'))
    record(trial, out=tmp_path / "episode.mcap")
    assert len(keyframe_ticks(tmp_path / "episode.mcap")) == 1
    check_exact(tmp_path / "episode.mcap", 5.4, tmp_path)


@pytest.mark.parametrize("kind", ["plain", "edited"])
def test_a_replay_begins_at_the_latest_keyframe(kind: str, request: pytest.FixtureRequest) -> None:
    path = request.getfixturevalue(kind)
    whole, late = replay(path), replay(path, begin=7.3)
    assert whole.equal
    assert late.equal
    assert (whole.begin, late.begin) == (0.0, 5.0)
    assert late.replayed == whole.replayed
    assert "simulated from its keyframe at 5 s on" in str(late)
    assert late.as_dict()["begin"] == 5.0


@pytest.mark.parametrize("begin", [-1.0, float("nan"), float("inf")])
def test_a_wrong_begin_is_refused(plain: Path, begin: float) -> None:
    with pytest.raises(InputError, match="must be finite and at least 0"):
        replay(plain, begin=begin)


def test_a_replay_before_the_first_keyframe_says_that_it_begins_at_0(plain: Path) -> None:
    with pytest.warns(KeyframeWarning, match="has no keyframe of this version from 0 s to 2 s"):
        assert replay(plain, begin=2.0).equal


@given(seconds=st.lists(st.integers(0, 115), min_size=1, max_size=4))
@settings(max_examples=4, deadline=None)
def test_any_instant_has_the_state_of_the_run(edited: Path, seconds: list[int]) -> None:
    with RecordedSimulation(edited) as recorded:
        for tenth in seconds:
            found = recorded.at(tenth / 10)
            with open_run(TRIAL, 5, sources=[Steering()]) as running:
                running.advance(round(tenth / 10 / TRIAL.step))
                running.flush()
                assert encode_state(state_of(found)) == encode_state(state_of(running.simulation))


def test_an_instant_is_independent_and_must_be_recorded(plain: Path) -> None:
    with RecordedSimulation(plain) as recorded:
        first = recorded.at(6.0)
        before = encode_state(state_of(first))
        recorded.at(7.0).advance()
        assert encode_state(state_of(first)) == before == encode_state(state_of(recorded.at(6.0)))
        with pytest.raises(InputError, match="has no instant 999 s; it lasts from 0 s to"):
            recorded.at(999.0)
    with pytest.raises(InputError, match="as a context manager"):
        RecordedSimulation(plain).at(1.0)


def test_a_run_with_an_unknown_memory_has_no_keyframes_and_the_file_says_why(tmp_path: Path) -> None:
    (tmp_path / "keeper.py").write_text(KEEPER)
    text = FLOW.replace('duration="20"', 'duration="13"')
    trial = parse_trial(
        text.replace('<navigator type="orca"/>', '<navigator type="keeper.py:Keeper"/>'), folder=tmp_path, trust=True
    )
    record(trial, 5, out=tmp_path / "episode.mcap")
    assert keyframe_ticks(tmp_path / "episode.mcap") == {}
    reason = read_episode(tmp_path / "episode.mcap").metadata["no_keyframes"]
    assert reason == "simulation/robots/0/memories/0 is a Diary, which cannot be stored; plain values can"
    branch(tmp_path / "episode.mcap", 6.0, folder=tmp_path, trust=True)


KEEPER = """
from dataclasses import dataclass
from crowdbot.core import Twist
from crowdbot.navigation import Action, Navigator

class Diary:
    pass

@dataclass(frozen=True)
class Keeper(Navigator):
    def begin(self, observation):
        return Diary()

    def act(self, observation, memory):
        return Action(Twist(0.1, 0.0)), memory
"""


def shift(state: dict[str, Any]) -> bytes:
    """Return a keyframe in which somebody stands elsewhere."""
    place = state["simulation/world/_previous/position"].copy() + 0.01
    return encode_state({**state, "simulation/world/scene/position": place})


def strange(state: dict[str, Any]) -> bytes:
    return encode_state({**state, "simulation/more": 1})


def stale(state: dict[str, Any]) -> bytes:
    return encode_state({**state, "digest/length": 0})


WRONG = {
    "differs after its keyframe; the episode is simulated from its beginning": shift,
    "'simulation/more', which this trial does not have; the episode is simulated from its beginning": strange,
    "a state is damaged": lambda state: b"not a state",
    "differs from the digest of its step": stale,
}


@pytest.mark.parametrize("sentence", WRONG)
def test_a_wrong_keyframe_is_not_used_and_a_warning_says_so(
    sentence: str, plain: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "episode.mcap"
    monkeypatch.setattr("crowdbot.recording.keyframes.encode_state", WRONG[sentence])
    wrong = record(TRIAL, 5, out=path)
    with pytest.warns(KeyframeWarning, match=sentence), RecordedSimulation(path) as recorded:
        found = recorded.at(6.4)
    with RecordedSimulation(plain) as recorded:
        assert encode_state(state_of(found)) == encode_state(state_of(recorded.at(6.4)))
    with pytest.warns(KeyframeWarning, match=sentence):
        assert branch(path, 6.4).digest == wrong.digest == read_episode(plain).digest


def test_a_keyframe_of_another_step_or_digest_is_refused() -> None:
    state = state_of(Simulation(TRIAL, 5))
    with pytest.raises(InputError, match="the keyframe of step 100 holds step 0"):
        Keyframe(100, state).restore(Simulation(TRIAL, 5))
    with pytest.raises(InputError, match="the state of a hash needs words"):
        _ = Keyframe(100, {"digest/words": 1}).digest
    assert Keyframe(100, {}).digest.hexdigest("") == EpisodeDigest().hexdigest("")
