"""The worker process of a run: predicts window by window and sends what it has."""

from __future__ import annotations

import dataclasses
import time
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.calibration import RecordingCalibration
from crowdbot.core import CrowdbotError, InputError, stream
from crowdbot.data import Degradation, DegradedTracks, Recording, Windows
from crowdbot.evaluation import FrameResults, WindowResults, predict_windows
from crowdbot.metrics import PersonErrors, Score
from crowdbot.prediction import PredictorSpec, Simulated, degraded_windows
from crowdbot.web.jobs.job_process import JobPipe

Floats = NDArray[np.float32]
BATCH = 16
"""Windows that are predicted together where no crowd is calibrated."""
PAUSE = 0.1
"""Time between two messages [s]."""


@dataclass(frozen=True)
class TaskMember:
    """One predictor of a run: its key in the app, its specification, and its number of futures."""

    key: str
    spec: PredictorSpec
    samples: int


@dataclass(frozen=True)
class PredictionTask:
    """A run: predictors on the windows of a recording.

    Fields:
        recording: the recording, cut into windows.
        members: the predictors.
        degradation: degradation of the observed rows, or None.
        seed, best_of, live: see :class:`crowdbot.evaluation.PredictorEvaluation`.
    """

    recording: Recording
    members: tuple[TaskMember, ...]
    degradation: Degradation | None = None
    seed: int = 0
    best_of: str = "person"
    live: bool = False


@dataclass(frozen=True)
class WindowPart:
    """Results of consecutive windows of one predictor, small enough to be kept.

    Fields:
        first: index of the first window.
        frames: results by frame.
        errors: errors of the scored people.
        ids: for each window, ``[n]`` identities of the predicted people.
        paths: for each window, ``[K, T, n, 2]`` predicted positions.
        weight: for each window, ``[K]`` weights of the futures.
        fit: for each window, the fitted and the initial parameters ``[n, D]``; empty without a calibration.
        names: names and units of the parameters.
    """

    first: int
    frames: FrameResults
    errors: PersonErrors
    ids: list[NDArray[np.int64]]
    paths: list[Floats]
    weight: list[Floats]
    fit: list[tuple[NDArray[np.float64], NDArray[np.float64]]]
    names: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(cls, found: WindowResults, past: Windows) -> WindowPart:
        """Return the part of some windows, without padding."""
        forecast, ids, paths, fits = found.forecast, [], [], []
        for w in range(len(forecast)):
            who = np.flatnonzero(forecast.valid[w])
            ids.append(past.id[found.first + w, who])
            paths.append(forecast.position[w][:, :, who].astype(np.float32))
            if found.fit is not None:
                fits.append((found.fit.values[w, who], found.fit.given[w, who]))
        names = () if found.fit is None else tuple((row.name, row.unit) for row in found.fit.space.table)
        weight = [row.astype(np.float32) for row in forecast.weight]
        return cls(found.first, found.frames, found.errors, ids, paths, weight, fits, names)


def input_windows(recording: Recording, degradation: Degradation | None, seed: int) -> tuple[Windows, Windows]:
    """Return past and future of the windows that are predicted; of degraded rows, with the true future."""
    past, future = recording.windows
    if degradation is None or degradation.neutral:
        return past, future
    degradation.check(recording.rest)
    degraded: DegradedTracks = degradation.apply(recording.rest, stream(seed, "degrade", 0))
    seen = degraded_windows(past, future, degraded)
    if seen.predictable == 0:
        raise InputError(f"nobody can be predicted in {recording.name} after {degradation}; lower its level")
    return seen.past, seen.future


def run_task(pipe: JobPipe, task: PredictionTask) -> None:
    """Predict all windows with all predictors and send messages ``(kind, key, content)``.

    Kinds are ``begin`` (number of windows), ``part`` (:class:`WindowPart`), ``score`` and ``failed`` (sentence).

    Raises:
        InputError: the rows cannot be degraded so.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".* is used instead$")
        past, future = input_windows(task.recording, task.degradation, task.seed)
        for member in task.members:
            pipe.send(("begin", member.key, len(past)))
            try:
                _run_member(task, member, past, future, pipe)
            except CrowdbotError as error:
                pipe.send(("failed", member.key, str(error)))
            except (ArithmeticError, LookupError, MemoryError, TypeError, ValueError) as error:
                pipe.send(("failed", member.key, f"{type(error).__name__}: {error}; this is a bug in crowdbot"))


def _run_member(
    task: PredictionTask,
    member: TaskMember,
    past: Windows,
    future: Windows,
    pipe: JobPipe,
) -> None:
    member.spec.check(task.recording, task.live)
    predictor = member.spec.build(task.recording)
    note = predictor.note(past)
    if note:
        pipe.send(("note", member.key, note))
    single = task.live or getattr(predictor, "calibrator", None) is not None
    size = 1 if single else BATCH
    waiting: list[WindowPart] = []
    errors, seconds, samples, sent = [], [], 1, time.monotonic()
    for found in predict_windows(predictor, past, future, member.samples, task.best_of, task.seed, task.live, size):
        errors.append(found.errors)
        seconds.append(found.frames.seconds)
        samples = max(samples, found.forecast.samples)
        waiting.append(WindowPart.of(found, past))
        if time.monotonic() - sent > PAUSE:
            pipe.send(("part", member.key, waiting))
            waiting, sent = [], time.monotonic()
    pipe.send(("part", member.key, waiting))
    name = predictor.name if task.degradation is not None else member.spec.name
    score = Score.of(PersonErrors.concatenate(errors), name, samples, future, task.best_of)
    score = dataclasses.replace(score, seconds_per_window=float(np.concatenate(seconds).mean()))
    pipe.send(("score", member.key, score))


def run_calibration(pipe: JobPipe, task: PredictionTask) -> None:
    """Calibrate the crowds of the members on all windows, as `crowdbot calibrate`; sends ``share`` and ``fit``."""
    for member in task.members:
        _calibrate_member(task, member, pipe)


def _calibrate_member(task: PredictionTask, member: TaskMember, pipe: JobPipe) -> None:
    crowd = member.spec.predictor
    if not isinstance(crowd, Simulated) or crowd.calibrator is None:
        raise InputError(f"{member.spec.name} has no cost and no search, so there is nothing to calibrate")
    campaign = RecordingCalibration(task.recording, crowd.calibrator, member.spec.goal, task.seed)
    chunks, whole, done = [], len(campaign.past), 0
    for chunk in campaign.run():
        chunks.append(chunk)
        done += chunk.last - chunk.first
        pipe.send(("share", member.key, done / whole))
    fit = campaign.merge(chunks)
    if fit.persons == 0:
        raise InputError(f"nobody in {fit.windows} windows of {task.recording.name} can be scored by the cost")
    units = {row.name: row.unit for row in fit.space.table}
    rows = [
        {"name": name, "median": median, "sd": spread, "unit": "" if units[name] == "1" else units[name]}
        for name, (median, spread) in fit.table().items()
    ]
    pipe.send(("fit", member.key, {
        "scheme": fit.scheme, "cost": float(np.nanmean(fit.cost)), "given_cost": float(np.nanmean(fit.given_cost)),
        "persons": fit.persons, "windows": fit.windows, "evaluations": int(fit.evaluations.sum()),
        "seconds": fit.seconds, "parameters": rows,
    }))  # fmt: skip
