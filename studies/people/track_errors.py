"""Errors of forecasts of single tracks by crowd models with many parameter sets at once."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.calibration import Rollout
from crowdbot.core import Scene
from crowdbot.data import Windows
from crowdbot.models import CrowdModel, CurrentDirection
from crowdbot.typing import Floats, Ints

from .experiments import RecordedExperiment

__all__ = ["TTC_EDGES", "TrackErrors", "keep_velocity", "measure_tracks", "time_to_collision_counts", "ttc_distance"]


BODY, CART = 0.2, 0.9
"""Radii of people, as in all checks of the validation, and of the golf cart of CITR [m]."""
SUBSTEP = 0.1
TTC_EDGES = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0])
"""Bins of times to collision [s]."""
TTC_ROWS = (2, 5, 8, 11)
"""Predicted rows at which times to collision are counted."""
FEW = 5.0
"""Pairs added to both counts of a bin, against the logarithm of a small number."""
AT_ONCE = 30_000
"""Approximate number of agents in one call."""


@dataclass(frozen=True, eq=False)
class TrackErrors:
    """Errors of S parameter sets in one experiment.

    Fields:
        person: ``[N]`` number of the person of each of N forecasts.
        early: ``[S, N]`` displacement error of the first predicted row, after 0.4 s [m].
        mean: ``[S, N]`` mean displacement error over all predicted rows, 4.8 s [m].
        ttc: ``[S, B]`` numbers of pairs by time to collision, see :data:`TTC_EDGES`.
        ttc_real: ``[B]`` numbers of pairs of the recorded people.
    """

    person: Ints
    early: Floats
    mean: Floats
    ttc: Ints
    ttc_real: Ints


def measure_tracks(
    model: CrowdModel, sets: Sequence[Mapping[str, float]], experiment: RecordedExperiment
) -> TrackErrors:
    """Return the errors of forecasts from the last observed row; people keep their direction and speed if they can.

    Args:
        model: crowd model.
        sets: S parameter sets: values of parameters that differ from those of the model.
        experiment: windows of an experiment.
    """
    rows = [_measure(model, sets, past, future) for past, future in experiment.parts]
    known, people = 0, []
    for row in rows:
        people.append(row.person + known)
        known += int(row.person.max(initial=-1)) + 1
    return TrackErrors(
        np.concatenate(people),
        np.concatenate([row.early for row in rows], axis=1),
        np.concatenate([row.mean for row in rows], axis=1),
        np.sum([row.ttc for row in rows], axis=0),
        np.sum([row.ttc_real for row in rows], axis=0),
    )


def keep_velocity(experiment: RecordedExperiment) -> tuple[float, float]:
    """Return the mean errors after 0.4 s and over all rows if everybody keeps the last velocity [m]."""
    early, mean = [], []
    for past, future in experiment.parts:
        last, steps = past.position[:, -1], np.arange(1, future.present.shape[1] + 1)
        ahead = last[:, None] + (last - past.position[:, -2])[:, None] * steps[None, :, None, None]
        error = np.hypot(*np.moveaxis(ahead - future.position, -1, 0))
        scored = future.scored & ~past.robot
        early.append(error[:, 0][scored])
        mean.append(error.mean(axis=1)[scored])
    return float(np.concatenate(early).mean()), float(np.concatenate(mean).mean())


def ttc_distance(found: Ints, real: Ints) -> Floats:
    """Return the mean absolute logarithm of the ratio of numbers of pairs, over the bins; 0 for equal distributions.

    >>> float(ttc_distance(np.array([[95, 45]]), np.array([95, 45]))[0])
    0.0
    """
    return np.asarray(np.mean(np.abs(np.log((found + FEW) / (real + FEW))), axis=-1))


def _measure(model: CrowdModel, sets: Sequence[Mapping[str, float]], past: Windows, future: Windows) -> TrackErrors:
    W, T, A = future.present.shape
    radius = np.where(past.robot, CART, BODY)
    rollout = Rollout(model, CurrentDirection(), radius, None, SUBSTEP)
    scene = rollout.scene(past, past.position.shape[1] - 1)
    size = max(1, AT_ONCE // max(1, W * A))
    place = np.concatenate([_run(rollout, scene, past, sets[k : k + size], T) for k in range(0, len(sets), size)])
    error = np.hypot(*np.moveaxis(place - future.position, -1, 0))  # [S, W, T, A]
    scored = future.scored & ~past.robot
    _, person = np.unique(future.id[scored], return_inverse=True)
    last = past.position[:, -1]
    people = scored[:, None] & future.present
    ttc = np.stack([time_to_collision_counts(last, item, people, past.dt) for item in place])
    real = time_to_collision_counts(last, future.position, people, past.dt)
    return TrackErrors(person.astype(np.int64), error[:, :, 0][:, scored], error.mean(axis=2)[:, scored], ttc, real)


def _run(rollout: Rollout, scene: Scene, past: Windows, sets: Sequence[Mapping[str, float]], steps: int) -> Floats:
    """Return the predicted positions ``[S, W, steps, A, 2]``; parameter sets are environments."""
    W = len(past)
    crowd = scene.environments(np.tile(np.arange(W), len(sets)))
    values: dict[str, Any] = {}
    for name in sets[0] if sets else ():
        each = np.repeat([float(set_[name]) for set_ in sets], W)
        values[name] = np.ascontiguousarray(np.broadcast_to(each[:, None], crowd.shape))
    taken = dataclasses.replace(rollout, model=dataclasses.replace(rollout.model, **values))
    found = taken.run(crowd, past, steps)
    return found.reshape(len(sets), W, steps, -1, 2)


def time_to_collision_counts(last: Floats, place: Floats, people: NDArray[np.bool_], dt: float) -> Ints:
    """Return the numbers of pairs ``[B]`` by time to collision of bodies of 0.2 m, at some rows.

    Args:
        last: ``[W, A, 2]`` positions before the first row [m].
        place: ``[W, T, A, 2]`` positions [m].
        people: ``[W, T, A]`` people who count.
        dt: time between rows [s].

    >>> here = np.ones((1, 12, 2), dtype=bool)
    >>> x = 9.0 - 0.4 * np.arange(1, 13)
    >>> place = np.zeros((1, 12, 2, 2))
    >>> place[0, :, 1, 0] = x
    >>> time_to_collision_counts(np.array([[[0.0, 0.0], [9.0, 0.0]]]), place, here, 0.4).tolist()
    [0, 0, 0, 0, 0, 1]
    """
    count = np.zeros(len(TTC_EDGES) - 1, dtype=np.int64)
    before = np.concatenate([last[:, None], place[:, :-1]], axis=1)
    one, other = np.triu_indices(place.shape[2], 1)
    for row in TTC_ROWS:
        if row >= place.shape[1]:
            continue
        now, speed = place[:, row], (place[:, row] - before[:, row]) / dt
        pair = people[:, row][:, one] & people[:, row][:, other]
        w, p = np.nonzero(pair)
        away = now[w, other[p]] - now[w, one[p]]
        relative = speed[w, other[p]] - speed[w, one[p]]
        gap = np.sum(away**2, axis=-1) - (2.0 * BODY) ** 2
        nearing = np.sum(away * relative, axis=-1)
        inside = nearing**2 - np.sum(relative**2, axis=-1) * gap
        meets = (nearing < 0.0) & (inside > 0.0) & (gap > 0.0)
        when = gap[meets] / (np.sqrt(inside[meets]) - nearing[meets])
        count += np.histogram(when, TTC_EDGES)[0]
    return count
