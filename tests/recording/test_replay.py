"""Replay: the trial, seed and digest in the file are enough to get the same bytes again."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

import crowdbot
from crowdbot.core import EpisodeError, TrialError
from crowdbot.recording import read_episode, replay, run
from crowdbot.trials import load_trial, parse_trial
from episode_copies import copy_episode
from trial_texts import GOOD, SHY, changed, written


def test_a_replay_gives_the_same_digest(tmp_path: Path) -> None:
    episode = run(parse_trial(GOOD), seed=11, out=tmp_path)
    shares: list[float] = []
    done = replay(tmp_path / "episode.mcap", progress=shares.append)
    assert done.equal
    assert done.recorded == done.replayed == episode.digest
    assert (done.seed, done.outcomes) == (11, (episode.outcome, episode.outcome))
    made = f"crowdbot {crowdbot.__version__}"
    assert str(done).endswith(f"small with seed 11 (made with {made}) replays with the same digest {episode.digest}")
    assert done.as_dict()["equal"] is True
    assert done.as_dict()["software"] == read_episode(tmp_path / "episode.mcap").software == made
    assert shares[-1] == 1.0


def test_an_interrupted_episode_replays_as_far_as_it_went(tmp_path: Path) -> None:
    pressed: list[float] = []

    def press(share: float) -> None:
        if share > 0.5 and not pressed:
            pressed.append(share)
            signal.raise_signal(signal.SIGINT)

    episode = run(parse_trial(GOOD), out=tmp_path, progress=press)
    assert episode.outcome == "interrupted"
    done = replay(tmp_path / "episode.mcap")
    assert done.equal
    assert done.outcomes == ("interrupted", "interrupted")


def test_a_difference_is_said_with_the_versions(tmp_path: Path) -> None:
    run(parse_trial(GOOD), out=tmp_path)
    other = replay(copy_episode(tmp_path / "episode.mcap", tmp_path / "seed.mcap", {"seed": "4"}))
    assert not other.equal
    assert str(other).endswith("the versions and the processor are equal")
    old = replay(
        copy_episode(tmp_path / "episode.mcap", tmp_path / "old.mcap", {"digest": "0" * 32, "version": "0.0.9"})
    )
    assert not old.equal
    assert f"it was recorded with version 0.0.9 (now {crowdbot.__version__})" in str(old)
    new = replay(copy_episode(tmp_path / "episode.mcap", tmp_path / "new.mcap", {"version": "0.0.9"}))
    assert new.equal
    assert "(made with crowdbot 0.0.9) replays with the same digest" in str(new)
    assert read_episode(tmp_path / "new.mcap").software == new.software == "crowdbot 0.0.9"


def test_a_trial_of_another_version_that_cannot_be_read_is_said(tmp_path: Path) -> None:
    run(parse_trial(GOOD), out=tmp_path)
    strange = GOOD.replace("<crowd ", "<weather/><crowd ")
    path = copy_episode(tmp_path / "episode.mcap", tmp_path / "x.mcap", {"trial": strange, "version": "9.9"})
    with pytest.raises(TrialError, match=r"x.mcap \(trial, written by crowdbot 9.9\):7: <weather> is not an element"):
        replay(path)


def test_code_of_a_recorded_trial_is_loaded_from_its_folder_only(tmp_path: Path) -> None:
    (tmp_path / "shy.py").write_text(SHY)
    trial = load_trial(written(tmp_path, changed('type="straight"', 'type="shy.py:Shy"')))
    episode = run(trial, out=tmp_path / "out")
    with pytest.raises(EpisodeError, match=r"needs the code 'shy.py', which does not exist .*--folder, or use --trust"):
        replay(tmp_path / "out" / "episode.mcap")
    assert replay(tmp_path / "out" / "episode.mcap", folder=tmp_path).replayed == episode.digest


def test_a_truncated_file_replays_as_far_as_it_goes(tmp_path: Path) -> None:
    run(parse_trial(GOOD), out=tmp_path)
    path = tmp_path / "episode.mcap"
    whole = path.read_bytes()
    for share in (0.3, 0.5, 0.7):
        path.write_bytes(whole[: int(share * len(whole))])
        done = replay(path)
        assert done.equal
        assert not done.complete
        assert "killed before its end) replays with the same digest" in str(done)
    path.write_bytes(whole[:3000])
    with pytest.raises(EpisodeError, match="has no recorded steps: the run was killed before the first one"):
        replay(path)


def test_a_replay_says_from_where_on_it_differs(tmp_path: Path) -> None:
    run(parse_trial(GOOD), out=tmp_path)
    assert replay(tmp_path / "episode.mcap").differs is None
    other = changed('tolerance="0.3"', 'tolerance="0.3" ').replace('navigator type="straight"', 'navigator type="orca"')
    path = copy_episode(tmp_path / "episode.mcap", tmp_path / "other.mcap", {"trial": other})
    done = replay(path)
    assert not done.equal
    assert done.differs is not None
    assert f"does NOT replay from {done.differs:g} s on" in str(done)


def test_an_episode_of_another_format_is_rejected(tmp_path: Path) -> None:
    run(parse_trial(GOOD), out=tmp_path)
    path = copy_episode(tmp_path / "episode.mcap", tmp_path / "other.mcap", {"format": "2"})
    with pytest.raises(EpisodeError, match="has the episode format '2' of crowdbot .*; this version reads '3'"):
        read_episode(path)
    with pytest.raises(EpisodeError, match="record it again"):
        replay(path)
