"""Scores of tracks by distance from the robot, by density and by occlusion."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.evaluation.intervals import Estimate, bootstrap_estimate
from crowdbot.metrics import TRACKING_SCORES, TrackComparison, count_occlusions, tracking_scores
from crowdbot.typing import Bools, Floats

from .tracking_run import TrackingRun

DISTANCES: tuple[float, ...] = (0.0, 3.0, 6.0, 9.0, math.inf)
"""Limits of the distance from the robot [m]."""
DENSITIES: tuple[float, ...] = (0.0, 0.15, 0.3, math.inf)
"""Limits of the density around a person [1/m^2]."""
AROUND = 2.0
"""Radius of the disc in which people count for the density [m]."""
STRATA = ("distance", "density", "occlusion")
"""What scores can be divided by."""


def estimate_strata(
    runs: Sequence[TrackingRun], by: str, reach: float = 0.5, seed: int = 0
) -> dict[str, dict[str, Estimate]]:
    """Return the scores of each part of the people, by the name of the part.

    The distance is that from the robot; the density counts the other people within 2 m; ``occlusion`` divides people
    into those who are hidden once for at least 0.3 s between two times of being visible, and the others. A track within
    reach of a person belongs to the part of the person; other tracks belong to the part at their place, and to both
    parts of ``occlusion``.

    Args:
        runs: runs of one detector and tracker with different seeds.
        by: one of :data:`STRATA`.
        reach: largest distance of a person and a track [m].
        seed: seed of the bootstrap.

    Raises:
        InputError: ``by`` is unknown.
    """
    if by not in STRATA:
        raise InputError(f"scores by {by!r}{did_you_mean(by, STRATA)}; known are {', '.join(STRATA)}")
    parts: dict[str, list[dict[str, float]]] = {}
    for run in runs:
        table, times = run.table(), [row.time for row in run.log.rows]
        for name, people, tracks in _parts(run, table, by, reach):
            parts.setdefault(name, []).append(tracking_scores(table.subset(people, tracks, reach), times, reach))
    return {
        name: {
            score: bootstrap_estimate(np.array([row[score] for row in rows]), seed=seed) for score in TRACKING_SCORES
        }
        for name, rows in parts.items()
    }


def _parts(run: TrackingRun, table: TrackComparison, by: str, reach: float) -> list[tuple[str, Bools, Bools]]:
    """Return name, people ``[T, A]`` and tracks ``[T, B]`` of each part."""
    if by == "occlusion":
        times = [row.time for row in run.log.rows]
        marked = np.broadcast_to(count_occlusions(table, times, reach).people, table.truth.shape[:2])
        everything = np.ones(table.estimate.shape[:2], dtype=np.bool_)
        return [("with an occlusion", marked, everything), ("without", ~marked, everything)]
    if by == "distance":
        robot = np.array([row.robot for row in run.log.rows])[:, None]
        values = [np.linalg.norm(item - robot, axis=-1) for item in (table.truth, table.estimate)]
        limits, unit = DISTANCES, "m"
    else:
        values = [_density(table.truth, table.truth, 1), _density(table.estimate, table.truth, 0)]
        limits, unit = DENSITIES, "/m2"
    return [
        (f"{low:g} to {high:g} {unit}" if high < math.inf else f"above {low:g} {unit}",
         *((low <= value) & (value < high) for value in values))
        for low, high in itertools.pairwise(limits)
    ]  # fmt: skip


def _density(place: Floats, people: Floats, own: int) -> Floats:
    """Return the density of people around places ``[T, N]`` [1/m^2], less ``own`` at each."""
    away = np.linalg.norm(place[:, :, None] - people[:, None], axis=-1)
    return np.asarray(((away <= AROUND).sum(axis=-1) - own) / (math.pi * AROUND**2))
