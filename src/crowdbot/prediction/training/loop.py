"""Training: the loop that every learned predictor shares; it can be killed at any moment and goes on exactly.

Nothing random outlives an update: the order of an epoch and the draws of an update come from streams that are named by
the seed and by their number. So a checkpoint needs the weights, the optimisers and two numbers, and a training that was
killed ends with the same bytes as one that was not.
"""

from __future__ import annotations

import csv
import dataclasses
import json
import math
import os
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from crowdbot.core import InputError, stream

from .checkpoint import load_checkpoint, save_checkpoint

__all__ = ["BEST", "LAST", "LOG", "LogRow", "Trainable", "TrainingResult", "TrainingSchedule", "train"]

BEST, LAST, LOG = "best.npz", "last.npz", "log.csv"
"""Files in the folder of a training: the best weights, all that is needed to go on, and the log."""

LogRow = dict[str, float]
"""A line of the log: update, epoch, means of the losses since the line before, what was watched, seconds."""


class Trainable(ABC):
    """A network with its data and optimisers, as the loop sees it.

    Class attribute:
        kind: name of the predictor, written into checkpoints.
    Attributes:
        config: frozen dataclass of plain values; together with ``data`` it says what is trained on what.
        data: digest of all that is learned from and watched on.
        facts: what a predictor needs to know beside the config, plain values (normalisation, time step, names).
    """

    kind: ClassVar[str]
    config: Any
    data: str
    facts: Mapping[str, Any]

    @abstractmethod
    def batches(self, rng: np.random.Generator) -> list[Any]:
        """Return the batches of an epoch, in order."""

    @abstractmethod
    def update(self, batch: Any, rng: np.random.Generator, number: int, total: int) -> Mapping[str, float]:
        """Do one update and return its losses; all that is random comes from ``rng``.

        Args:
            batch: one of :meth:`batches`.
            rng: of this update alone.
            number: of the update, from 0, for schedules.
            total: how many updates there will be.
        """

    @abstractmethod
    def check(self) -> Mapping[str, float]:
        """Return errors on data that is not learned from, always with the same draws; lower is better."""

    @abstractmethod
    def weights(self) -> Mapping[str, Any]:
        """Return what a predictor needs: name -> tensor or array."""

    @abstractmethod
    def state(self) -> Mapping[str, Any]:
        """Return all that changes while training: weights, optimisers, averages."""

    @abstractmethod
    def restore(self, state: Mapping[str, Any]) -> None:
        """Go back to what :meth:`state` returned; arrays may stand for tensors."""


@dataclass(frozen=True)
class TrainingSchedule:
    """How long is trained, and what is watched.

    Fields:
        updates: at most so many; or
        epochs: at most so many.
        check_every: updates between two lines of the log, each with a check.
        keep_every: updates between two checkpoints; there is always one with a check.
        watch: the error that decides which weights are the best; with several names their sum decides.
        patience: stop after so many checks without a better one; None never stops early.
        seed: of the order and of everything that is drawn.

    Raises:
        InputError: a number is below 1, or neither or both of updates and epochs are given.
    """

    updates: int | None = None
    epochs: int | None = None
    check_every: int = 200
    keep_every: int = 200
    watch: tuple[str, ...] = ("ade",)
    patience: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        if (self.updates is None) == (self.epochs is None):
            raise InputError("give either a number of updates or a number of epochs")
        for name in ("updates", "epochs", "check_every", "keep_every", "patience"):
            value = getattr(self, name)
            if value is not None and value < 1:
                raise InputError(f"{name.replace('_', ' ')} = {value} must be at least 1")


@dataclass(frozen=True)
class TrainingResult:
    """How a training ended.

    Fields:
        rows: the log.
        best: number of the best line, None when nothing was checked.
        updates: how many were done, those before a resume included.
        stopped: whether it stopped early.
        seconds: that were spent on updates and checks.
    """

    rows: tuple[LogRow, ...]
    best: int | None
    updates: int
    stopped: bool
    seconds: float


@dataclass
class _TrainingState:
    """Where a training stands."""

    update: int = 0
    epoch: int = 0
    step: int = 0
    best: int | None = None
    seconds: float = 0.0
    rows: list[LogRow] = dataclasses.field(default_factory=list)
    sums: dict[str, float] = dataclasses.field(default_factory=dict)
    summed: int = 0


def train(
    model: Trainable,
    schedule: TrainingSchedule,
    folder: Path | None = None,
    resume: bool = False,
    report: Callable[[LogRow], None] | None = None,
    tick: Callable[[int, int], None] | None = None,
) -> TrainingResult:
    """Train a network; the folder holds what is needed to go on, the best weights and the log.

    The same model, schedule and data give the same bytes on one machine, whether or not the training was interrupted
    (the seconds in the log apart). More updates or epochs may be asked for when it goes on.

    Args:
        model: what is trained.
        schedule: how long, and what is watched.
        folder: where files go; None keeps none.
        resume: go on from the folder when it holds a training.
        report: told each line of the log.
        tick: told the number of updates done and of all.

    Raises:
        InputError: the folder holds a training and ``resume`` is not set, or one of other settings or data; or a loss
            is no longer a finite number.
    """
    course = _begin_or_resume(model, schedule, folder, resume)
    batches = model.batches(stream(schedule.seed, "order", course.epoch))
    if not batches:
        raise InputError("nobody is there at all rows of any window: there is nothing to learn from")
    total = schedule.updates or (schedule.epochs or 1) * len(batches)
    stopped = _out_of_patience(course, schedule)
    while course.update < total and not stopped:
        begin = time.perf_counter()
        if course.step == len(batches):
            course.epoch, course.step = course.epoch + 1, 0
            batches = model.batches(stream(schedule.seed, "order", course.epoch))
        losses = model.update(
            batches[course.step], stream(schedule.seed, "update", course.update), course.update, total
        )
        _add_losses(course, losses)
        last = course.update == total
        checked = last or course.update % schedule.check_every == 0
        if checked:
            _checked(model, schedule, course, folder)
        course.seconds += time.perf_counter() - begin
        if checked:
            course.rows[-1]["seconds"] = round(course.seconds, 3)
            stopped = _out_of_patience(course, schedule)
        if folder is not None and (checked or course.update % schedule.keep_every == 0):
            _save(model, schedule, course, folder)
        if checked and report is not None:
            report(course.rows[-1])
        if tick is not None:
            tick(course.update, total)
    return TrainingResult(tuple(course.rows), course.best, course.update, stopped, course.seconds)


def _about(model: Trainable) -> dict[str, Any]:
    return {"config": _plain(dataclasses.asdict(model.config)), "data": model.data, "facts": dict(model.facts)}


def _begin_or_resume(model: Trainable, schedule: TrainingSchedule, folder: Path | None, resume: bool) -> _TrainingState:
    if folder is None or not (folder / LAST).exists():
        return _TrainingState()
    if not resume:
        raise InputError(f"{folder} holds a training already: go on with --resume, or choose another folder")
    kept = load_checkpoint(folder / LAST, f"{model.kind} training")
    now = _about(model)
    kept["config"] = _defaults(model.config) | kept["config"]  # a setting that came later began as what was done before
    for word, what in (("config", "settings"), ("data", "data")):
        if kept[word] != now[word]:
            was = _difference(kept[word], now[word])
            raise InputError(f"{folder} holds a training with other {what} ({was}); choose another folder")
    if kept["seed"] != schedule.seed:
        raise InputError(f"{folder} holds a training with seed {kept['seed']}, not {schedule.seed}")
    model.restore(kept["state"])
    course = _TrainingState(**kept["course"])
    _write_log(course, folder)
    return course


def _defaults(config: Any) -> Any:
    fields = dataclasses.fields(config)
    return _plain({field.name: field.default for field in fields if field.default is not dataclasses.MISSING})


def _plain(values: dict[str, Any]) -> Any:
    """Return settings as they come back from a file."""
    return json.loads(json.dumps(values))


def _difference(was: Any, now: Any) -> str:
    if not isinstance(was, dict) or not isinstance(now, dict):
        return f"{was}, now {now}"
    name = next((key for key in {**was, **now} if was.get(key) != now.get(key)), "")
    return f"{name} = {was.get(name)}, now {now.get(name)}"


def _add_losses(course: _TrainingState, losses: Mapping[str, float]) -> None:
    for name, value in losses.items():
        if not math.isfinite(value):
            raise InputError(
                f"the loss {name} is {value} at update {course.update + 1}: try lower learning rates, or look for"
                " tracks with huge jumps in the data"
            )
        course.sums[name] = course.sums.get(name, 0.0) + value
    course.summed += 1
    course.update += 1
    course.step += 1


def _checked(model: Trainable, schedule: TrainingSchedule, course: _TrainingState, folder: Path | None) -> None:
    """Write a line of the log, and keep the weights when they are the best."""
    means = {name: value / course.summed for name, value in course.sums.items()}
    errors = {name: float(value) for name, value in model.check().items()}
    course.rows.append({"update": course.update, "epoch": course.epoch, **means, **errors})
    course.sums, course.summed = {}, 0
    new = _watched(course.rows[-1], schedule)
    if course.best is None or new < _watched(course.rows[course.best], schedule):
        course.best = len(course.rows) - 1
        if folder is not None:
            save_checkpoint(
                folder / BEST,
                model.kind,
                {**_about(model), "weights": dict(model.weights()), "update": course.update, "errors": errors},
            )


def _watched(row: LogRow, schedule: TrainingSchedule) -> float:
    unknown = next((name for name in schedule.watch if name not in row), None)
    if unknown is not None:
        raise InputError(f"{unknown} is not measured while training; there are {', '.join(row)}")
    return sum(row[name] for name in schedule.watch)


def _out_of_patience(course: _TrainingState, schedule: TrainingSchedule) -> bool:
    if schedule.patience is None or course.best is None:
        return False
    return len(course.rows) - 1 - course.best >= schedule.patience


def _save(model: Trainable, schedule: TrainingSchedule, course: _TrainingState, folder: Path) -> None:
    save_checkpoint(
        folder / LAST,
        f"{model.kind} training",
        {**_about(model), "seed": schedule.seed, "state": dict(model.state()), "course": dataclasses.asdict(course)},
    )
    _write_log(course, folder)


def _write_log(course: _TrainingState, folder: Path) -> None:
    """Write the log anew, so that it never holds a line that the checkpoint does not know."""
    names = list(dict.fromkeys(name for row in course.rows for name in row))
    draft = folder / f"{LOG}.part"
    with draft.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows(course.rows)
    os.replace(draft, folder / LOG)
