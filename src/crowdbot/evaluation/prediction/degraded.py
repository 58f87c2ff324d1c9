"""Evaluation of predictors on degraded recordings: degraded observations, clean ground truth."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError, stream
from crowdbot.data import Trajectories, Windows
from crowdbot.data.degrade import Chain, Degradation, EmptyRecordingError
from crowdbot.metrics import Score
from crowdbot.prediction import Predictor, degraded_windows

from .predictor_score import score_predictor


@dataclass(frozen=True)
class DegradedTask:
    """Evaluation settings of a degradation sweep.

    Fields:
        observe, predict, protocol, near: see :meth:`Trajectories.windows`; applied to the clean recording.
        samples, best_of, seed: see :func:`evaluate`; the seed is also used for the degradation.
        carry: number of rows for which lost tracks are extrapolated, see :func:`degraded_windows`.
        draws: number of random draws of the degradation; scores are means over all draws.
        every: only every n-th window is predicted.
    """

    observe: int = 8
    predict: int = 12
    protocol: str = "all"
    near: float | None = None
    samples: int = 1
    best_of: str = "person"
    seed: int = 0
    carry: int = 0
    draws: int = 1
    every: int = 1

    def __post_init__(self) -> None:
        if self.carry < 0:
            raise InputError(f"carry = {self.carry} must be at least 0 rows")
        if self.draws < 1:
            raise InputError(f"draws = {self.draws} must be at least 1")
        if self.every < 1:
            raise InputError(f"every = {self.every} must be at least 1")


@dataclass(frozen=True)
class DegradedScore:
    """The score of one predictor at one level of a degradation, over all recordings and draws.

    Fields:
        degradation: degradation at this level.
        predictor: name of the predictor.
        level: value of the varied parameter.
        asked: number of scored persons of the clean protocol.
        draws: number of random draws.
        score: errors of all predicted persons in all draws; None if there are none.
        low, high: smallest and largest ADE [m] of the draws; NaN without predicted persons.
    """

    degradation: Degradation | Chain
    predictor: str
    level: float
    asked: int
    draws: int
    score: Score | None
    low: float
    high: float

    @property
    def coverage(self) -> float:
        """Share of the scored persons that could be predicted."""
        return (self.score.persons if self.score else 0) / (self.asked * self.draws)

    def as_dict(self) -> dict[str, Any]:
        """Return the numbers by their names, for JSON."""
        own = {
            name: getattr(self, name) for name in ("predictor", "level", "coverage", "asked", "draws", "low", "high")
        }
        return {**own, "score": self.score.as_dict() if self.score else None}


def sweep_degradations(
    recordings: Sequence[Trajectories],
    degradations: Sequence[Degradation | Chain],
    predictors: Sequence[Predictor],
    levels: Sequence[float] | None = None,
    task: DegradedTask | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Iterator[list[DegradedScore]]:
    """Yield the scores of all predictors, level by level.

    The scored people and their ground truth come from the clean recordings, observations from the degraded ones. A
    level without degradation equals :func:`evaluate` and is computed once for all degradations.

    Args:
        recordings: clean recordings.
        degradations: degradations, applied separately.
        predictors: predictors.
        levels: levels of the degradations (default: those of each degradation).
        task: settings (default: ``DegradedTask()``).
        progress: called with the degradation and its completed fraction, 0 to 1.

    Raises:
        InputError: a level is not allowed, or does not apply to a recording.
    """
    task = task or DegradedTask()
    steps = [
        (degradation, [(v, degradation.at(v)) for v in (degradation.levels if levels is None else levels)])
        for degradation in degradations
    ]
    for tracks in recordings:
        for _, ladder in steps:
            for _, item in ladder:
                if not item.neutral:
                    item.check(tracks)
    whole = [tracks.windows(task.observe, task.predict, task.protocol, task.near) for tracks in recordings]
    cuts = [(past[:: task.every], future[:: task.every]) for past, future in whole]
    clean: list[DegradedScore] = []
    for degradation, ladder in steps:
        for done, (level, item) in enumerate(ladder):
            if progress is not None:
                progress(degradation.name, done / len(ladder))
            found = clean if item.neutral else []
            found = found or _level(item, level, recordings, cuts, predictors, task)
            if item.neutral:
                clean = found = [dataclasses.replace(score, degradation=item, level=level) for score in found]
            yield found
        if progress is not None:
            progress(degradation.name, 1.0)


def _level(
    degradation: Degradation | Chain,
    level: float,
    recordings: Sequence[Trajectories],
    cuts: Sequence[tuple[Windows, Windows]],
    predictors: Sequence[Predictor],
    task: DegradedTask,
) -> list[DegradedScore]:
    """Return the scores of all predictors at one level."""
    draws = 1 if degradation.neutral else task.draws
    scores: list[list[list[Score]]] = [[[] for _ in range(draws)] for _ in predictors]
    for draw in range(draws):
        for tracks, (past, future) in zip(recordings, cuts, strict=True):
            try:
                degraded = degradation.apply(tracks, stream(task.seed, "degrade", draw))
            except EmptyRecordingError:  # not an error: the coverage is 0
                continue
            seen = degraded_windows(past, future, degraded, task.carry)
            if seen.predictable == 0:
                continue
            for predictor, own in zip(predictors, scores, strict=True):
                score = score_predictor(predictor, seen.past, seen.future, task.samples, task.best_of, task.seed)
                own[draw].append(score)
    asked = sum(int(future.scored.sum()) for _, future in cuts)
    return [
        _merge_scores(degradation, predictor.name, level, asked, own)
        for predictor, own in zip(predictors, scores, strict=True)
    ]


def _merge_scores(
    degradation: Degradation | Chain, predictor: str, level: float, asked: int, draws: list[list[Score]]
) -> DegradedScore:
    every = [score for draw in draws for score in draw]
    means = [Score.total(draw).ade for draw in draws if draw]
    if not every:
        return DegradedScore(degradation, predictor, level, asked, len(draws), None, math.nan, math.nan)
    total = dataclasses.replace(Score.total(every), source=" + ".join(dict.fromkeys(s.source for s in every)))
    return DegradedScore(degradation, predictor, level, asked, len(draws), total, min(means), max(means))
