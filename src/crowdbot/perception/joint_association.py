"""JointProbabilisticDataAssociation: each detection belongs to several tracks, with probabilities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Floats

from .motion_filter import FilterState, Innovation
from .nearest_neighbor_tracker import Association, GlobalNearestNeighbor

ROUNDS = 100
"""Largest number of rounds of belief propagation."""
PRECISION = 1e-6
"""Change of the messages at which belief propagation ends."""


@dataclass(frozen=True, kw_only=True)
class JointProbabilisticDataAssociation(GlobalNearestNeighbor):
    """Joint integrated probabilistic data association.

    Each track is corrected by all detections in its gate, weighted with the probabilities that they belong to it, given
    that each detection belongs to at most one track (Fortmann, Bar-Shalom and Scheffe (1983), Sonar tracking of
    multiple targets using joint probabilistic data association, doi 10.1109/JOE.1983.1145560), with probabilities of
    existence (Musicki and Evans (2004), Joint integrated probabilistic data association: JIPDA, doi
    10.1109/TAES.2004.1337482). The probabilities are computed by belief propagation (Williams and Lau (2014),
    Approximate evaluation of marginal association probabilities with belief propagation, doi
    10.1109/TAES.2014.120568), in a time that grows with the number of pairs only.

    Fields:
        gate: largest squared Mahalanobis distance of a pair.

    >>> from crowdbot.perception import Detections
    >>> tracker = JointProbabilisticDataAssociation()
    >>> state = tracker.begin()
    >>> for k in range(10):
    ...     tracks, state = tracker.update(Detections.of(0.1 * k, [[0.12 * k, 1.0]], 0.05), 0.1 * k, state)
    >>> tracks.ids.tolist(), tracks.velocity.round(1).tolist()
    ([0], [[1.2, 0.0]])
    """

    def associate(self, filters: FilterState, found: Innovation, existence: Floats, seen: Floats) -> Association:
        """Return the filters after the detections, each weighted with its probability."""
        inside = found.distance <= self.gate
        density = np.where(inside, np.exp(np.minimum(found.likelihood, 50.0)), 0.0)
        odds = (existence * self.detection)[:, None] * density / self.clutter / (1.0 - existence * seen)[:, None]
        chance = association_probabilities(odds)
        missed = 1.0 - chance.sum(axis=1)
        hidden = existence * (1.0 - seen) / (1.0 - existence * seen)
        after = np.clip(chance.sum(axis=1) + missed * hidden, 1e-9, 1.0 - 1e-3)
        corrected = _correct(filters, found, chance, inside)
        return Association(corrected, after, chance.sum(axis=1) > 0.5, chance.sum(axis=0) > 0.5)


def association_probabilities(odds: Floats) -> Floats:
    """Return the probability ``[N, D]`` that a detection belongs to a track, by belief propagation.

    Args:
        odds: ``[N, D]`` likelihood that the detection belongs to the track over that of no detection of the track, and
            of a detection of nobody.

    >>> association_probabilities(np.array([[1.0, 0.0], [0.0, 3.0]])).tolist()
    [[0.5, 0.0], [0.0, 0.75]]
    """
    back = np.ones_like(odds)
    for _ in range(ROUNDS):
        product = odds * back
        ahead = odds / (1.0 + product.sum(axis=1, keepdims=True) - product)
        new = 1.0 / (1.0 + ahead.sum(axis=0, keepdims=True) - ahead)
        done = np.abs(new - back).max(initial=0.0) < PRECISION
        back = new
        if done:
            break
    product = odds * back
    return np.asarray(product / (1.0 + product.sum(axis=1, keepdims=True)))


def _correct(filters: FilterState, found: Innovation, chance: Floats, inside: NDArray[np.bool_]) -> FilterState:
    """Return the filters corrected by weighted detections; the covariances contain the spread of the detections."""
    missed = np.maximum(0.0, 1.0 - chance.sum(axis=1))[:, None]
    ratio = np.exp(np.where(inside[..., None], found.log_density - found.likelihood[..., None], 0.0))
    share = chance[..., None] * ratio  # [N, D, M]: the detection belongs to the track, given the motion model
    total = share.sum(axis=1) + missed
    share, missed = share / total[:, None], missed / total
    prior = filters.covariance
    gain = np.einsum("nmij,ndmjk->ndmik", prior[..., :2], found.inverse)
    step = np.einsum("ndmij,ndmj->ndmi", gain, found.residual)
    mean = np.einsum("ndm,ndmi->nmi", share, step)
    after = prior[:, None] - np.einsum("ndmik,nmkl->ndmil", gain, prior[:, :, :2, :])
    spread = np.einsum("ndm,ndmij->nmij", share, after + step[..., :, None] * step[..., None, :])
    covariance = missed[..., None, None] * prior + spread - mean[..., :, None] * mean[..., None, :]
    weight = np.maximum(filters.weight * total, 1e-6)
    return FilterState(
        filters.mean + mean,
        0.5 * (covariance + np.swapaxes(covariance, -1, -2)),
        weight / weight.sum(axis=1, keepdims=True),
    )
