"""Runs that are killed: the file opens with every reader, and at most the last second is missing."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from crowdbot import data
from crowdbot.core import EpisodeError
from crowdbot.recording import iterate_steps, read_episode, repair, replay, run
from crowdbot.trials import parse_trial
from samples import sizes
from trial_texts import BRIEF_FLOW, GOOD, changed, written

LONG = changed('duration="4"', 'duration="4000"').replace("<end ", '<end goal="false" ')
RUN = """import sys
from crowdbot.trials import parse_trial
from crowdbot.recording import open_run
with open_run(parse_trial(sys.stdin.read()), out=sys.argv[1]) as running:
    while running.step() is None:
        print(running.simulation.world.clock.time, flush=True)
"""


def started(folder: Path) -> subprocess.Popen[bytes]:
    """Return a process that runs, tells the time [s] of every step, and has recorded two instants."""
    process = subprocess.Popen(
        [sys.executable, "-c", RUN, str(folder / "out")], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(LONG.encode())
    process.stdin.close()
    while float(process.stdout.readline()) < 0.25:  # two instants are recorded
        pass
    os.set_blocking(process.stdout.fileno(), False)
    return process


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[Path, float]]:
    """Kill one run at several random moments, and return copies of the file with the last time [s] that was told.

    The process is stopped while its file is copied, which is what ``kill -9`` at that moment leaves; at last it is
    really killed. (tools/kill.py kills 50 processes.)
    """
    folder = tmp_path_factory.mktemp("killed")
    process = started(folder)
    assert process.stdout is not None
    chance = random.Random(0)
    found, told = [], 0.0
    try:
        for number in range(8):
            pause = time.monotonic() + chance.uniform(0.02, 0.2)
            while time.monotonic() < pause:
                told = float(([told, *(process.stdout.read() or b"").split()])[-1])
                time.sleep(0.005)
            process.send_signal(signal.SIGSTOP if number < 7 else signal.SIGKILL)
            time.sleep(0.05)
            assert sorted(os.listdir(folder / "out")) == [".episode.mcap.lock", "episode.mcap"]
            found.append((folder / f"{number}.mcap", told))
            found[-1][0].write_bytes((folder / "out" / "episode.mcap").read_bytes())
            process.send_signal(signal.SIGCONT)
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
    assert sorted(os.listdir(folder)) == [*(f"{k}.mcap" for k in range(8)), "out"]
    return found


@pytest.mark.live
def test_every_file_opens_and_at_most_the_last_second_is_missing(killed: list[tuple[Path, float]]) -> None:
    for path, told in killed:
        read = read_episode(path)
        assert (read.complete, read.outcome) == (False, "interrupted")
        assert read.times[-1] > told - 1.0
        assert np.allclose(np.diff(read.times), 0.1, atol=1e-9)
        assert read.steps == round(read.times[-1] / 0.05)
        tracks = data.load(path)
        assert len(tracks) == int(read.active.sum())
        assert tracks.note == "the run was killed before its end"
        assert len(list(iterate_steps(path))) == len(read.times)


@pytest.mark.live
def test_other_tools_open_the_file_as_it_is(killed: list[tuple[Path, float]]) -> None:
    for path, _ in killed:
        count = len(read_episode(path).times)
        with AnyReader([path]) as reader:
            stamps = [stamp for connection, stamp, _ in reader.messages() if connection.topic == "/people"]
        assert stamps == [k * 10**8 for k in range(count)]
        with path.open("rb") as stream:
            alone = make_reader(stream)
            assert sum(1 for _ in alone.iter_messages(topics=["/clock"])) == count


@pytest.mark.live
def test_what_is_left_replays_to_the_same_bytes(killed: list[tuple[Path, float]]) -> None:
    done = replay(killed[0][0])
    assert done.equal
    assert not done.complete


@pytest.mark.live
def test_repair_gives_the_file_that_an_interrupt_at_its_last_instant_gives(
    killed: list[tuple[Path, float]], tmp_path: Path
) -> None:
    path = tmp_path / "episode.mcap"
    path.write_bytes(killed[2][0].read_bytes())
    before = read_episode(path)
    assert repair(path) == before.times[-1]
    after = read_episode(path)
    assert after.complete
    assert (after.digest, after.steps, after.outcome) == (before.digest, before.steps, "interrupted")
    assert np.array_equal(after.position, before.position)
    assert json.loads(after.metadata["metrics"]) == json.loads(before.metadata["metrics"])
    whole = path.read_bytes()
    assert repair(path) is None
    assert path.read_bytes() == whole
    with path.open("rb") as stream:
        summary = make_reader(stream, validate_crcs=True).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_start_time == 0
    assert summary.statistics.message_end_time == round(before.times[-1] * 1e9)


@pytest.mark.parametrize("cuts", sizes(8, 25))
def test_a_file_that_is_cut_anywhere_opens_or_says_that_nothing_was_recorded(tmp_path: Path, cuts: int) -> None:
    episode = run(parse_trial(BRIEF_FLOW), out=tmp_path)
    path, cut = tmp_path / "episode.mcap", tmp_path / "cut.mcap"
    whole = path.read_bytes()
    chance = np.random.default_rng(0)
    opened, refused = 0, list[str]()
    for size in sorted(chance.integers(8, len(whole) - 1, cuts).tolist()):
        cut.write_bytes(whole[:size])
        try:
            read = read_episode(cut)
        except EpisodeError as error:
            refused.append(str(error))
            continue
        opened += 1
        count = len(read.times)
        assert np.array_equal(read.times, episode.times[:count])
        repaired = repair(cut)
        assert repaired in (None, read.times[-1])
        again = read_episode(cut)
        assert again.complete
        assert again.digest == read.digest
        with AnyReader([cut]) as reader:
            assert reader.message_count > 0
    assert opened > cuts // 2
    assert all("no recorded steps" in sentence or "not an episode" in sentence for sentence in refused)


def test_a_new_run_takes_the_place_of_an_old_file_only_when_it_has_something(tmp_path: Path) -> None:
    (tmp_path / "episode.mcap").write_text("old")
    with pytest.raises(EpisodeError, match="is not an MCAP file"):
        repair(tmp_path / "episode.mcap")
    seen: list[int] = []

    def look(share: float) -> None:
        seen.append(len(read_episode(tmp_path / "episode.mcap").times))

    run(parse_trial(GOOD), out=tmp_path, progress=look, force=True)
    assert seen[0] == 1
    assert seen == sorted(seen)
    assert seen[-2] > 30


@pytest.mark.live
def test_the_program_keeps_the_file_when_it_is_killed(tmp_path: Path) -> None:
    trial = written(tmp_path / "in", LONG)
    process = subprocess.Popen(
        [sys.executable, "-m", "crowdbot", "run", str(trial), "--out", str(tmp_path / "out"), "--pace", "20"],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
    )
    assert process.stderr is not None
    deadline = time.monotonic() + 60.0
    while not (tmp_path / "out" / "episode.mcap").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    begin = time.monotonic()
    time.sleep(0.5)
    process.kill()
    ran = (time.monotonic() - begin) * 20.0
    process.wait()
    process.stderr.close()
    read = read_episode(tmp_path / "out" / "episode.mcap")
    assert 0.2 < read.times[-1] < ran + 21.0
    assert sorted(os.listdir(tmp_path)) == ["in", "out"]
    assert os.listdir(tmp_path / "in") == ["trial.xml"]


def test_repair_of_damaged_bytes_is_one_sentence(tmp_path: Path) -> None:
    run(parse_trial(GOOD), out=tmp_path)
    whole = (tmp_path / "episode.mcap").read_bytes()
    data = whole[: len(whole) * 3 // 4]  # as after a kill: without summary and ending
    path, rng, said = tmp_path / "damaged.mcap", np.random.default_rng(4), set()
    for _ in range(40):
        damaged = bytearray(data)
        for at in rng.integers(8, len(data), 12):
            damaged[at] ^= 0xFF
        path.write_bytes(damaged)
        try:
            assert repair(path) is not None
        except EpisodeError as error:
            said.add(str(error))
    assert all(str(path) in sentence for sentence in said)
    assert any("is damaged" in sentence for sentence in said)
