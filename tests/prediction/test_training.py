"""The loop of training, with a tiny model that needs no torch: exact resume, early stop, logs, wrong folders."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.prediction.training.checkpoint import load_checkpoint, save_checkpoint
from crowdbot.prediction.training.loop import BEST, LAST, LOG, Trainable, TrainingSchedule, train


@dataclass(frozen=True)
class Settings:
    rate: float = 0.1
    widths: tuple[int, ...] = (1, 2)


class Mean(Trainable):
    """Learns the mean of numbers, with momentum and noise; dies at a wanted call."""

    kind = "mean"

    def __init__(self, config: Settings = Settings(), die_at: int = -1, data: str = "numbers") -> None:
        self.config, self.data, self.facts = config, data, {"dt": 0.4}
        self.value, self.speed = np.zeros(3), np.zeros(3)
        self.numbers = np.arange(30.0).reshape(10, 3)
        self.calls, self.die_at = 0, die_at

    def _called(self) -> None:
        self.calls += 1
        if self.calls == self.die_at:
            raise KeyboardInterrupt

    def batches(self, rng: np.random.Generator) -> list[Any]:
        return list(rng.permutation(10).reshape(5, 2))

    def update(self, batch: Any, rng: np.random.Generator, number: int, total: int) -> Mapping[str, float]:
        self._called()
        away = self.value - self.numbers[batch].mean(axis=0) + rng.normal(0.0, 0.1, 3)
        self.speed = 0.5 * self.speed - self.config.rate * (1.0 - number / total) * away
        self.value = self.value + self.speed
        return {"loss": float(np.sum(away**2))}

    def check(self) -> Mapping[str, float]:
        self._called()
        return {"ade": float(np.abs(self.value - self.numbers.mean(axis=0)).sum())}

    def weights(self) -> Mapping[str, Any]:
        self._called()
        return {"value": self.value}

    def state(self) -> Mapping[str, Any]:
        self._called()
        return {"value": self.value, "speed": self.speed}

    def restore(self, state: Mapping[str, Any]) -> None:
        self.value, self.speed = state["value"], state["speed"]


PLAN = TrainingSchedule(updates=23, check_every=5, keep_every=3, seed=4)


def lines(folder: Path) -> list[dict[str, str]]:
    with (folder / LOG).open() as file:
        return [{key: word for key, word in row.items() if key != "seconds"} for row in csv.DictReader(file)]


def state(folder: Path, name: str) -> dict[str, Any]:
    kept = load_checkpoint(folder / name)
    for row in (kept.get("course") or {"rows": []})["rows"]:
        row.pop("seconds")
    if "course" in kept:
        kept["course"].pop("seconds")
    return kept


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole")
    train(Mean(), PLAN, folder)
    return folder


@settings(max_examples=12)
@given(deaths=st.lists(st.integers(1, 40), min_size=1, max_size=4))
def test_a_training_killed_at_any_moment_ends_with_the_same_bytes(
    whole: Path, tmp_path_factory: pytest.TempPathFactory, deaths: list[int]
) -> None:
    folder = tmp_path_factory.mktemp("killed")
    for die_at in deaths:
        try:
            train(Mean(die_at=die_at), PLAN, folder, resume=True)
        except KeyboardInterrupt:
            continue
    train(Mean(), PLAN, folder, resume=True)
    assert lines(folder) == lines(whole)
    assert (folder / BEST).read_bytes() == (whole / BEST).read_bytes()
    assert str(state(folder, LAST)) == str(state(whole, LAST))


def test_epochs_are_counted_and_the_best_weights_are_kept(tmp_path: Path) -> None:
    said: list[tuple[int, int]] = []
    done = train(
        Mean(), TrainingSchedule(epochs=4, check_every=1), tmp_path, tick=lambda now, total: said.append((now, total))
    )
    assert (done.updates, done.rows[-1]["epoch"], said[-1]) == (20, 3.0, (20, 20))
    best = min(done.rows, key=lambda row: row["ade"])
    assert done.best is not None
    assert done.rows[done.best] is best
    kept = load_checkpoint(tmp_path / BEST, "mean")
    assert (kept["update"], kept["errors"]["ade"], kept["facts"]) == (best["update"], best["ade"], {"dt": 0.4})
    assert kept["config"] == {"rate": 0.1, "widths": [1, 2]}


def test_it_stops_when_nothing_gets_better_and_stays_stopped(tmp_path: Path) -> None:
    plan = TrainingSchedule(updates=500, check_every=1, patience=6)
    done = train(Mean(), plan, tmp_path)
    assert done.stopped
    assert done.best is not None
    assert len(done.rows) - 1 - done.best == 6
    again = train(Mean(), plan, tmp_path, resume=True)
    assert (again.stopped, again.updates) == (True, done.updates)


def test_more_updates_may_be_asked_for_later(tmp_path: Path) -> None:
    train(Mean(), TrainingSchedule(updates=10, check_every=5), tmp_path)
    done = train(Mean(), TrainingSchedule(updates=20, check_every=5), tmp_path, resume=True)
    assert [row["update"] for row in done.rows] == [5, 10, 15, 20]


def test_folders_of_other_trainings_are_left_alone(tmp_path: Path) -> None:
    train(Mean(), PLAN, tmp_path)
    with pytest.raises(InputError, match="already contains a training: resume it with --resume"):
        train(Mean(), PLAN, tmp_path)
    with pytest.raises(InputError, match=r"other settings \(rate = 0.1, now 0.2\)"):
        train(Mean(Settings(0.2)), PLAN, tmp_path, resume=True)
    with pytest.raises(InputError, match=r"other data \(numbers, now others\)"):
        train(Mean(data="others"), PLAN, tmp_path, resume=True)
    with pytest.raises(InputError, match="with seed 4, not 0"):
        train(Mean(), TrainingSchedule(updates=23), tmp_path, resume=True)


def test_a_training_that_began_before_a_setting_was_known_goes_on(tmp_path: Path) -> None:
    once = train(Mean(), PLAN, tmp_path / "once")
    with pytest.raises(KeyboardInterrupt):
        train(Mean(die_at=14), PLAN, tmp_path / "old")
    kept = load_checkpoint(tmp_path / "old" / LAST)
    del kept["config"]["widths"]
    save_checkpoint(tmp_path / "old" / LAST, f"{Mean.kind} training", kept)
    assert train(Mean(), PLAN, tmp_path / "old", resume=True).rows[-1]["ade"] == once.rows[-1]["ade"]
    save_checkpoint(tmp_path / "old" / LAST, f"{Mean.kind} training", kept)
    with pytest.raises(InputError, match="other settings"):
        train(Mean(Settings(widths=(3,))), PLAN, tmp_path / "old", resume=True)


def test_wrong_schedules_and_losses_are_said() -> None:
    with pytest.raises(InputError, match="either updates or epochs"):
        TrainingSchedule()
    with pytest.raises(InputError, match="check every = 0 must be at least 1"):
        TrainingSchedule(updates=1, check_every=0)
    with pytest.raises(InputError, match="speed is not measured during training; known are update"):
        train(Mean(), TrainingSchedule(updates=1, watch=("speed",)))
    wild = Mean(Settings(1e200))
    with pytest.raises(InputError, match="the loss loss is .* at update"), np.errstate(over="ignore", invalid="ignore"):
        train(wild, TrainingSchedule(updates=20))


def test_checkpoints_hold_trees_and_say_what_is_wrong(tmp_path: Path) -> None:
    file = tmp_path / "one.npz"
    tree = {"a": [1, 2.5, None, "x", True], "b": {3: np.arange(3, dtype=np.uint8)}, "big": 2**90}
    save_checkpoint(file, "toy", tree)
    assert str(load_checkpoint(file)) == str(tree)
    with pytest.raises(InputError, match="is a checkpoint of toy, not of mean"):
        load_checkpoint(file, "mean")
    with pytest.raises(InputError, match="there is no checkpoint"):
        load_checkpoint(tmp_path / "none.npz")
    with pytest.raises(InputError, match="cannot contain a set"):
        save_checkpoint(tmp_path / "set.npz", "toy", {"a": {1}})
    whole = file.read_bytes()
    for number, spoilt in enumerate((whole[: len(whole) // 2], b"", whole[:200] + b"?" * 40 + whole[240:])):
        (tmp_path / f"{number}.npz").write_bytes(spoilt)
        with pytest.raises(InputError, match=r"is no checkpoint of crowdbot or is damaged \(.*train again"):
            load_checkpoint(tmp_path / f"{number}.npz")


def test_a_checkpoint_with_pickled_objects_is_not_run(tmp_path: Path) -> None:
    class Bomb:
        def __reduce__(self) -> tuple[Any, ...]:
            return Path.touch, (tmp_path / "exploded",)

    np.savez(tmp_path / "bomb.npz", content=np.array([Bomb()], dtype=object))
    with pytest.raises(InputError, match="is no checkpoint"):
        load_checkpoint(tmp_path / "bomb.npz")
    assert not (tmp_path / "exploded").exists()
