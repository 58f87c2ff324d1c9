"""Training loop of learned predictors; an interrupted training resumes with bitwise identical results.

The order of an epoch and the random draws of an update come from streams given by the seed and a number. A checkpoint
therefore needs the weights, the optimizer states and two counters only.
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

BEST, LAST, LOG = "best.npz", "last.npz", "log.csv"
"""Files in the folder of a training: best weights, training state, log."""

LogRow = dict[str, float]
"""A row of the log: update, epoch, mean losses since the previous row, validation errors, seconds."""


class Trainable(ABC):
    """A network with its data and optimizers.

    Class attribute:
        kind: name of the predictor, written into checkpoints.
    Attributes:
        config: settings, a frozen dataclass of plain values.
        data: digest of the training and validation data.
        facts: other values that the predictor needs (normalization, time step, names).
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
        """Run one update and return its losses.

        Args:
            batch: one of :meth:`batches`.
            rng: random generator of this update.
            number: number of the update, from 0.
            total: total number of updates.
        """

    @abstractmethod
    def check(self) -> Mapping[str, float]:
        """Return validation errors, always with the same random draws; lower is better."""

    @abstractmethod
    def weights(self) -> Mapping[str, Any]:
        """Return the weights of the predictor: name -> tensor or array."""

    @abstractmethod
    def state(self) -> Mapping[str, Any]:
        """Return the training state: weights, optimizers, averages."""

    @abstractmethod
    def restore(self, state: Mapping[str, Any]) -> None:
        """Restore a result of :meth:`state`; tensors may be given as arrays."""


@dataclass(frozen=True)
class TrainingSchedule:
    """Length of a training and its validation.

    Fields:
        updates: number of updates; or
        epochs: number of epochs.
        check_every: updates between validations, each with a row in the log.
        keep_every: updates between checkpoints; each validation also writes one.
        watch: validation errors whose sum selects the best weights.
        patience: number of validations without improvement before the training stops; None disables early stopping.
        seed: random seed.

    Raises:
        InputError: a number is below 1, or not exactly one of updates and epochs is given.
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
            raise InputError("give either updates or epochs")
        for name in ("updates", "epochs", "check_every", "keep_every", "patience"):
            value = getattr(self, name)
            if value is not None and value < 1:
                raise InputError(f"{name.replace('_', ' ')} = {value} must be at least 1")


@dataclass(frozen=True)
class TrainingResult:
    """Result of a training.

    Fields:
        rows: the log.
        best: index of the best row, None without validation.
        updates: total number of updates, including those before a resume.
        stopped: whether the training stopped early.
        seconds: time of updates and validations [s].
    """

    rows: tuple[LogRow, ...]
    best: int | None
    updates: int
    stopped: bool
    seconds: float


@dataclass
class _TrainingState:
    """Progress of a training."""

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
    """Train a network and write its weights, training state and log to a folder.

    Results are bitwise reproducible on one machine, also after an interruption (except for the seconds in the log). The
    number of updates or epochs may be increased on resume.

    Args:
        model: the network.
        schedule: length and validation.
        folder: output folder; None writes no files.
        resume: continue the training in the folder, if there is one.
        report: called with each row of the log.
        tick: called with the number of completed updates and the total.

    Raises:
        InputError: the folder has a training and ``resume`` is not set, or a training with other settings or data; or a
            loss is not finite.
    """
    course = _begin_or_resume(model, schedule, folder, resume)
    batches = model.batches(stream(schedule.seed, "order", course.epoch))
    if not batches:
        raise InputError("no person is present at all rows of a window: there is no training data")
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
            _validate(model, schedule, course, folder)
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
        raise InputError(f"{folder} already contains a training: resume it with --resume, or choose another folder")
    kept = load_checkpoint(folder / LAST, f"{model.kind} training")
    now = _about(model)
    # the defaults of newer settings reproduce the earlier behavior
    kept["config"] = _merge(_defaults(model.config), kept["config"])
    for word, what in (("config", "settings"), ("data", "data")):
        if kept[word] != now[word]:
            was = _difference(kept[word], now[word])
            raise InputError(f"{folder} contains a training with other {what} ({was}); choose another folder")
    if kept["seed"] != schedule.seed:
        raise InputError(f"{folder} contains a training with seed {kept['seed']}, not {schedule.seed}")
    model.restore(kept["state"])
    course = _TrainingState(**kept["course"])
    _write_log(course, folder)
    return course


def _defaults(config: Any) -> Any:
    """Return the defaults of settings, and those of settings in them."""
    found: dict[str, Any] = {}
    for field in dataclasses.fields(config):
        if field.default is not dataclasses.MISSING:
            found[field.name] = field.default
        elif field.default_factory is not dataclasses.MISSING and dataclasses.is_dataclass(getattr(config, field.name)):
            found[field.name] = dataclasses.asdict(field.default_factory())
    return _plain(found)


def _merge(defaults: dict[str, Any], kept: dict[str, Any]) -> dict[str, Any]:
    """Return ``kept`` with the defaults of settings that it lacks, at every level."""
    both = {name: _merge(defaults[name], value) for name, value in kept.items()
            if isinstance(value, dict) and isinstance(defaults.get(name), dict)}  # fmt: skip
    return defaults | kept | both


def _plain(values: dict[str, Any]) -> Any:
    """Return settings as read from a file."""
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


def _validate(model: Trainable, schedule: TrainingSchedule, course: _TrainingState, folder: Path | None) -> None:
    """Validate, add a row to the log, and save the weights if they are the best."""
    means = {name: value / course.summed for name, value in course.sums.items()}
    errors = {name: float(value) for name, value in model.check().items()}
    course.rows.append({"update": course.update, "epoch": course.epoch, **means, **errors})
    course.sums, course.summed = {}, 0
    new = _watched_error(course.rows[-1], schedule)
    if course.best is None or new < _watched_error(course.rows[course.best], schedule):
        course.best = len(course.rows) - 1
        if folder is not None:
            save_checkpoint(
                folder / BEST,
                model.kind,
                {**_about(model), "weights": dict(model.weights()), "update": course.update, "errors": errors},
            )


def _watched_error(row: LogRow, schedule: TrainingSchedule) -> float:
    unknown = next((name for name in schedule.watch if name not in row), None)
    if unknown is not None:
        raise InputError(f"{unknown} is not measured during training; known are {', '.join(row)}")
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
    """Rewrite the log without rows after the checkpoint."""
    names = list(dict.fromkeys(name for row in course.rows for name in row))
    draft = folder / f"{LOG}.part"
    with draft.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows(course.rows)
    os.replace(draft, folder / LOG)
