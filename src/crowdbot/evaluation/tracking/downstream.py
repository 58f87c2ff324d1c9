"""What tracking costs predictors: forecasts from tracks against forecasts from the true past of the same people."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows
from crowdbot.evaluation.intervals import Estimate, bootstrap_estimate
from crowdbot.perception import predict_uncertain
from crowdbot.prediction import Predictor
from crowdbot.typing import Floats

from .tracking_run import TrackingRun

STEP, OBSERVE, AHEAD = 0.4, 8, 8
"""Time between rows [s], and numbers of observed and predicted rows."""
DOWNSTREAM_INPUTS = ("true", "tracked", "tracked, uncertain")
"""What the predictor reads: true rows, tracks, and samples of the past from the covariances of the tracks."""
DOWNSTREAM_SCORES = {"ade": "m", "fde": "m", "inside_90": ""}
"""Errors of the mean of the forecast over all rows and at the last one; share of people inside the 90 % region of the
forecast at the last row, NaN without a distribution."""
SAMPLES = 20
LARGE = 4.605170185988092
"""Squared Mahalanobis distance that holds 90 % in two dimensions."""
ROBOT = 1 << 50
"""Identity of the robot in windows."""


class _Case(NamedTuple):
    """One instant: windows of true and tracked people, and the future ``[T, P, 2]`` of the people in both.

    ``true_slot`` and ``track_slot`` ``[P]`` are their slots, ``covariance`` ``[A, 4, 4]`` that of the tracks.
    """

    true: Windows
    tracked: Windows
    covariance: Floats
    future: Floats
    true_slot: NDArray[np.int64]
    track_slot: NDArray[np.int64]


def estimate_downstream(
    runs: Sequence[TrackingRun], predictor: Predictor, reach: float = 0.5, seed: int = 0
) -> dict[str, dict[str, Estimate]]:
    """Return the scores of the forecasts by input, with 95 % intervals by bootstrap over runs.

    Forecasts of 3.2 s begin every 0.4 s. The same people count for all inputs: those who are there at all future rows,
    and have a track within reach at the last observed row. Their observed rows are what the tracker reported; the
    row before the last one comes from the velocity of the track if the track is shorter than 0.4 s.

    Args:
        runs: runs of one detector and tracker with different seeds.
        predictor: any predictor.
        reach: largest distance of a person and a track [m].
        seed: seed of samples and of the bootstrap.

    Raises:
        InputError: no run has enough rows with tracked people.
    """
    rows: dict[str, list[list[float]]] = {name: [] for name in DOWNSTREAM_INPUTS}
    for run in runs:
        scores = _score_run(run, predictor, reach, seed)
        for name, score in scores.items():
            rows[name].append(score)
    if not any(np.isfinite(item[0]) for item in rows["true"]):
        least = (OBSERVE + AHEAD) * STEP
        raise InputError(f"{runs[0].log.name}: nobody is tracked and seen on for {least:g} s; take longer runs")
    return {
        name: {
            score: bootstrap_estimate(np.array([item[k] for item in some]), seed=seed)
            for k, score in enumerate(DOWNSTREAM_SCORES)
        }
        for name, some in rows.items()
    }


def _score_run(run: TrackingRun, predictor: Predictor, reach: float, seed: int) -> dict[str, list[float]]:
    """Return the means of the scores of one run by input."""
    rng = stream(seed, "downstream")
    found: dict[str, list[Floats]] = {name: [] for name in DOWNSTREAM_INPUTS}
    for case in _cases(run, reach):
        answers = (
            (predictor.predict(case.true, AHEAD, SAMPLES, rng), case.true_slot),
            (predictor.predict(case.tracked, AHEAD, SAMPLES, rng), case.track_slot),
            (predict_uncertain(predictor, case.tracked, case.covariance, AHEAD, SAMPLES, rng), case.track_slot),
        )
        for name, (forecast, slot) in zip(DOWNSTREAM_INPUTS, answers, strict=True):
            found[name].append(_errors(forecast, slot, case.future))
    means = {}
    for name, parts in found.items():
        table = np.concatenate(parts) if parts else np.zeros((0, 3))
        known = np.isfinite(table)
        total = np.where(known, table, 0.0).sum(axis=0)
        count = known.sum(axis=0)
        means[name] = np.where(count > 0, total / np.maximum(count, 1), np.nan).tolist()
    return means


def _errors(forecast: Forecast, slot: NDArray[np.int64], future: Floats) -> Floats:
    """Return ADE, FDE [m] and whether the end is inside the 90 % region, ``[P, 3]``."""
    place, weight = forecast.position[0][:, :, slot], forecast.weight[0]
    mean = np.einsum("k,ktpi->tpi", weight, place)
    away = np.linalg.norm(mean - future, axis=-1)
    offset = place[:, -1] - mean[-1]
    spread = np.einsum("k,kpi,kpj->pij", weight, offset, offset)
    if forecast.covariance is not None:
        spread = spread + forecast.covariance[0, -1][slot]
    miss = future[-1] - mean[-1]
    wide = np.linalg.det(spread) > 1e-12
    safe = np.where(wide[:, None, None], spread, np.eye(2))
    square = np.einsum("pi,pij,pj->p", miss, np.linalg.inv(safe), miss)
    inside = np.where(wide, (square <= LARGE).astype(np.float64), np.nan)
    return np.stack([away.mean(axis=0), away[-1], inside], axis=-1)


def _cases(run: TrackingRun, reach: float) -> Iterator[_Case]:
    """Yield the instants at which somebody can be scored."""
    rows = run.log.rows
    time = np.array([row.time for row in rows])
    if len(time) < 2:
        return
    every = max(1, round(STEP / float(np.median(np.diff(time)))))
    table = run.table()
    people = sorted({who for row in rows for who in {**row.people, **row.others}})
    tracks = sorted({who for track in run.tracks for who in track.ids.tolist()})
    robot = np.array([row.robot for row in rows])
    for now in range((OBSERVE - 1) * every, len(rows) - AHEAD * every, every):
        past = now - every * np.arange(OBSERVE - 1, -1, -1)
        later = now + every * np.arange(1, AHEAD + 1)
        here = np.flatnonzero(np.isfinite(table.truth[now, :, 0]))
        known = np.flatnonzero(np.isfinite(table.estimate[now, :, 0]))
        if not len(here) or not len(known):
            continue
        distance = np.linalg.norm(table.truth[now, here][:, None] - table.estimate[now, known][None], axis=-1)
        stay = np.isfinite(table.truth[later][:, here, 0]).all(axis=0)
        stay &= np.array([people[a] in rows[now].people for a in here])
        nearest = distance.argmin(axis=1)
        scored = np.flatnonzero(stay & (distance.min(axis=1) <= reach))
        if not len(scored):
            continue
        order = {who: k for k, who in enumerate(run.tracks[now].ids.tolist())}
        slots = [order[tracks[b]] for b in known]
        spread = run.tracks[now].covariance[slots]
        seen = table.estimate[past][:, known]
        back = seen[-1] - STEP * run.tracks[now].velocity[slots]
        seen[-2] = np.where(np.isfinite(seen[-2]), seen[-2], back)
        yield _Case(
            _window(table.truth[past][:, here], np.array(people)[here], robot[past]),
            _window(seen, np.array(tracks)[known], robot[past]),
            np.concatenate([spread, np.zeros((1, 4, 4))]),
            table.truth[later][:, here[scored]],
            scored,
            nearest[scored],
        )


def _window(place: Floats, ids: NDArray[np.int64], robot: Floats) -> Windows:
    """Return one window of people ``[T, A, 2]`` and, as the last agent, the robot ``[T, 2]``."""
    whole = np.concatenate([place, robot[:, None]], axis=1)[None]
    present = np.isfinite(whole[..., 0])
    machine = np.zeros((1, whole.shape[2]), dtype=np.bool_)
    machine[0, -1] = True
    frame = np.arange(len(place), dtype=np.int64)[None]
    return Windows(
        np.where(present[..., None], whole, 0.0), present, np.zeros_like(machine), machine,
        np.append(ids, ROBOT)[None], frame, STEP, "tracks", "tracking run",
    )  # fmt: skip
