"""Clusters of failures: runs in which the same happens with similar values."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Floats

from .sample import Sample

MOST = 2000
"""Failures of one event that are compared with each other; others join the nearest cluster."""
CUT = 1.1
"""Distance of two clusters, relative to that of two random points."""


@dataclass(frozen=True)
class FailureCluster:
    """Failures with the same event and similar factors.

    Fields:
        event: what happens.
        members: indices of the failures among the samples.
        share: share of the failure probability, or of the failures found if no probability is estimated.
        likely: index of the failure with the most likely values.
        worst: index of the failure with the smallest robustness.
        shifts: ``[D]`` mean coordinate of each factor; 0 for a factor that has no influence.
    """

    event: str
    members: tuple[int, ...]
    share: float
    likely: int
    worst: int
    shifts: tuple[float, ...]


def find_clusters(samples: Sequence[Sample], weights: Floats) -> list[FailureCluster]:
    """Return the clusters of the failures, by their share of the probability.

    Failures with one event are divided by average linkage at 1.1 times the distance that two random points have.

    Args:
        samples: all samples of a search.
        weights: ``[N]`` weight of each sample; if no failure has one, all count the same.
    """
    failed = [k for k, sample in enumerate(samples) if sample.fails]
    total = float(sum(weights[k] for k in failed))
    mass = np.array(weights) / total if total > 0.0 else np.full(len(samples), 1.0 / max(1, len(failed)))
    found = []
    for event in dict.fromkeys(samples[k].event for k in failed):
        own = [k for k in failed if samples[k].event == event]
        labels = _labels(np.array([samples[k].point for k in own]).reshape(len(own), -1))
        for label in dict.fromkeys(labels.tolist()):
            found.append(
                _cluster(samples, event, [k for k, one in zip(own, labels, strict=True) if one == label], mass)
            )
    return sorted(found, key=lambda one: (-one.share, samples[one.worst].robustness, one.members))


def _cluster(samples: Sequence[Sample], event: str, members: list[int], mass: Floats) -> FailureCluster:
    share = float(sum(mass[k] for k in members))
    part = mass[members] if share > 0.0 else np.ones(len(members))
    points = np.array([samples[k].point for k in members]).reshape(len(members), -1)
    return FailureCluster(
        event,
        tuple(members),
        share,
        max(members, key=lambda k: (samples[k].log_density, -k)),
        min(members, key=lambda k: (samples[k].robustness, k)),
        tuple((part @ points / part.sum()).tolist()),
    )


def _labels(points: Floats) -> NDArray[np.int64]:
    """Return ``[N]`` the cluster of each point."""
    count, dimensions = points.shape
    if count < 2 or not dimensions:
        return np.zeros(count, dtype=np.int64)
    chosen = np.unique(np.linspace(0, count - 1, min(count, MOST)).astype(np.int64))
    from scipy.cluster import hierarchy  # takes longer to import than the rest

    tree = hierarchy.linkage(points[chosen], "average")
    own = hierarchy.fcluster(tree, CUT * math.sqrt(2.0 * dimensions), "distance")
    if len(chosen) == count:
        return np.asarray(own, dtype=np.int64)
    centers = np.array([points[chosen][own == label].mean(axis=0) for label in range(1, own.max() + 1)])
    away = np.stack([np.sum((points - center) ** 2, axis=1) for center in centers])
    return np.asarray(np.argmin(away, axis=0) + 1, dtype=np.int64)
