"""A training of the navigator that is killed at random moments ends with the same weights, log and score."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from crowdbot.gym import CHECKPOINT, POLICY_FILE, PPOSettings, TrainingTask, train_navigator
from crowdbot.navigation import PolicyWeights
from killed_runs import FEW, MANY, run_killed

WORDS = [
    "train", "navigator", "--trials", "crowdnav-circle-5 people=1", "--environments", "6", "--rounds", "5",
    "--set", "steps=8", "updates=2", "batches=2",
]  # fmt: skip


@pytest.mark.live
@pytest.mark.parametrize(
    "kills", [FEW, pytest.param(8, marks=pytest.mark.sweep), pytest.param(MANY, marks=pytest.mark.soak)]
)
def test_a_killed_training_ends_with_the_same_weights(tmp_path: Path, kills: int) -> None:
    run_killed(tmp_path, WORDS, kills, seed=kills, resume=(CHECKPOINT, "--resume"))
    whole, killed = (PolicyWeights.read(tmp_path / name / POLICY_FILE) for name in ("whole", "killed"))
    assert [value.tobytes() for value in killed[0]] == [value.tobytes() for value in whole[0]]
    assert killed[1] == whole[1]
    assert whole[1]["score"]
    logs = []
    for name in ("whole", "killed"):
        with (tmp_path / name / "log.csv").open() as file:
            rows = list(csv.DictReader(file))
        logs.append([{key: value for key, value in row.items() if "seconds" not in key} for row in rows])
    assert logs[0] == logs[1]
    assert len(logs[0]) == 5


def test_weights_that_are_older_than_the_state_are_written_again(tmp_path: Path) -> None:
    task = TrainingTask("crowdnav-circle-5", 3, {"people": 1})
    settings = PPOSettings(rounds=2, updates=1, steps=4, batches=2)
    train_navigator([task], settings, tmp_path, cases=0)
    last = (tmp_path / POLICY_FILE).read_bytes()
    (tmp_path / POLICY_FILE).unlink()  # as if killed between the state of the last round and its weights
    train_navigator([task], settings, tmp_path, resume=True, cases=0)
    assert (tmp_path / POLICY_FILE).read_bytes() == last
