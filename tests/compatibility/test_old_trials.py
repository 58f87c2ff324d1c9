"""Files of an earlier version open and have the same content."""

from __future__ import annotations

import hashlib
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from crowdbot.experiments import read_log
from crowdbot.recording import read_episode
from crowdbot.trials import OldNameWarning, load_trial, parse_trial, trial_xml

FILES = Path(__file__).parent / "files"
EXPECTED: dict[str, Any] = json.loads((FILES / "expected.json").read_text(encoding="utf-8"))
EPISODES = sorted(path.stem for path in (FILES / "episodes").glob("*.mcap"))
TRIALS = sorted(path.name for path in (FILES / "trials").glob("*.xml"))
OLD_WORDS = ("berth=", "symmetry=", "most=", "equipped=", "rates=", "near=", "without=")
OLD_TRIALS = [
    name for name in TRIALS if any(f" {word}" in (FILES / "trials" / name).read_text("utf-8") for word in OLD_WORDS)
]

pytestmark = [
    pytest.mark.filterwarnings("ignore::crowdbot.trials.OldNameWarning"),
    pytest.mark.filterwarnings("ignore:.*is read as rows per second"),
]


def array_hash(*arrays: ArrayLike) -> str:
    """Return the hash of arrays: shapes, and their numbers as little-endian doubles."""
    content = hashlib.blake2b(digest_size=16)
    for array in arrays:
        whole = np.ascontiguousarray(array, dtype="<f8")
        content.update(repr(whole.shape).encode() + whole.tobytes())
    return content.hexdigest()


@pytest.mark.parametrize("name", EPISODES)
def test_an_old_episode_has_the_same_content(name: str) -> None:
    old = EXPECTED[name]
    episode = read_episode(FILES / "episodes" / f"{name}.mcap")
    assert (episode.outcome, len(episode.times), episode.complete) == (old["outcome"], old["instants"], old["complete"])
    assert {key: len(readings) for key, readings in episode.readings.items()} == old["readings"]
    assert episode.version == old["version"]["version"]
    assert array_hash(
        episode.times, episode.position, episode.velocity, episode.heading, episode.radius, episode.active,
        episode.ids, episode.commands,
    ) == old["arrays"]  # fmt: skip


@pytest.mark.parametrize("name", TRIALS)
def test_an_old_trial_loads_with_at_most_one_line_about_names(name: str) -> None:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        trial = load_trial(FILES / "trials" / name)
        lines = [str(one.message) for one in found if one.category is OldNameWarning]
        assert len(lines) == (name in OLD_TRIALS)
        assert all("old names of attributes: " in line and "\n" not in line for line in lines)
        assert parse_trial(trial_xml(trial), folder=FILES / "trials") == trial
    assert len([one for one in found if one.category is OldNameWarning]) == len(lines)


def test_an_old_session_log_is_read() -> None:
    logs = sorted((FILES / "sessions").rglob("session.jsonl"))
    assert len(logs) == 2
    assert all(len(read_log(path)) > 3 for path in logs)
