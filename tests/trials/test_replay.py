"""Replay: the trial, seed and digest in the file are enough to get the same bytes again."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from trial_texts import GOOD, SHY, changed, written

import crowdbot
from crowdbot.core import EpisodeError, TrialError
from crowdbot.trials import Trial, load_trial, replay


def rewritten(source: Path, target: Path, **changes: str) -> Path:
    """Copy an episode with other metadata."""
    with source.open("rb") as old, target.open("wb") as new:
        reader, writer = make_reader(old), Writer(new)
        writer.start(profile="ros2")
        schemas: dict[int, int] = {}
        channels: dict[int, int] = {}
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema is not None
            if schema.id not in schemas:
                schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
            if channel.id not in channels:
                channels[channel.id] = writer.register_channel(channel.topic, "cdr", schemas[schema.id])
            writer.add_message(channels[channel.id], message.log_time, message.data, message.publish_time)
        metadata = next(reader.iter_metadata()).metadata
        writer.add_metadata("crowdbot", metadata | changes)
        writer.finish()
    return target


def test_a_replay_gives_the_same_digest(tmp_path: Path) -> None:
    episode = Trial.parse(GOOD).run(seed=11, out=tmp_path)
    shares: list[float] = []
    done = replay(tmp_path / "episode.mcap", progress=shares.append)
    assert done.equal
    assert done.recorded == done.replayed == episode.digest
    assert (done.seed, done.outcomes) == (11, (episode.outcome, episode.outcome))
    assert str(done).endswith(f"small with seed 11 replays to the same bytes, digest {episode.digest}")
    assert done.as_dict()["equal"] is True
    assert shares[-1] == 1.0


def test_an_interrupted_episode_replays_as_far_as_it_went(tmp_path: Path) -> None:
    pressed: list[float] = []

    def press(share: float) -> None:
        if share > 0.5 and not pressed:
            pressed.append(share)
            signal.raise_signal(signal.SIGINT)

    episode = Trial.parse(GOOD).run(out=tmp_path, progress=press)
    assert episode.outcome == "interrupted"
    done = replay(tmp_path / "episode.mcap")
    assert done.equal
    assert done.outcomes == ("interrupted", "interrupted")


def test_a_difference_is_said_with_the_versions(tmp_path: Path) -> None:
    Trial.parse(GOOD).run(out=tmp_path)
    other = replay(rewritten(tmp_path / "episode.mcap", tmp_path / "seed.mcap", seed="4"))
    assert not other.equal
    assert str(other).endswith("the versions are the same")
    old = replay(rewritten(tmp_path / "episode.mcap", tmp_path / "old.mcap", digest="0" * 32, version="0.0.9"))
    assert not old.equal
    assert f"it was written with other versions: version 0.0.9 then, {crowdbot.__version__} now" in str(old)
    assert replay(rewritten(tmp_path / "episode.mcap", tmp_path / "new.mcap", version="0.0.9")).equal


def test_a_trial_of_another_version_that_cannot_be_read_is_said(tmp_path: Path) -> None:
    Trial.parse(GOOD).run(out=tmp_path)
    strange = GOOD.replace("<crowd ", "<weather/><crowd ")
    path = rewritten(tmp_path / "episode.mcap", tmp_path / "x.mcap", trial=strange, version="9.9")
    with pytest.raises(TrialError, match=r"x.mcap \(trial, written by crowdbot 9.9\):7: <weather> is no element"):
        replay(path)


def test_code_of_a_recorded_trial_is_loaded_from_its_folder_only(tmp_path: Path) -> None:
    (tmp_path / "shy.py").write_text(SHY)
    trial = load_trial(written(tmp_path, changed('type="straight"', 'type="shy.py:Shy"')))
    episode = trial.run(out=tmp_path / "out")
    with pytest.raises(TrialError, match=r"there is no file .*shy.py"):
        replay(tmp_path / "out" / "episode.mcap")
    assert replay(tmp_path / "out" / "episode.mcap", folder=tmp_path).replayed == episode.digest


def test_a_truncated_file_is_refused(tmp_path: Path) -> None:
    Trial.parse(GOOD).run(out=tmp_path)
    path = tmp_path / "episode.mcap"
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(EpisodeError, match=r"episode.mcap is cut off: its end is missing"):
        replay(path)
