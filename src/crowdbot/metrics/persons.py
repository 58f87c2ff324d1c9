"""Errors of scored people, one row per person and window."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from crowdbot.data import Forecast, Windows
from crowdbot.typing import Bools, Floats

from .collisions import CONTACT, collision_mask, mean_over_samples, neighbor_mask, swept_collisions
from .displacement import best_of, chosen_sample, distances, mean_and_final
from .energy import energy_score
from .likelihood import kde_nll

MOST_FOR_ENERGY = 100
"""Maximum number of samples for the energy score, whose computing time grows with their square."""


@dataclass(frozen=True)
class PersonErrors:
    """Errors of N scored people, one row per person and window; errors are those of the best sample.

    Fields:
        person: ``[N]`` identity in the recording; the windows of one person overlap.
        ade, fde: ``[N]`` [m].
        distance: ``[N, T]`` [m] of the sample with the best ADE; 0 where there is no true position.
        exists: ``[N, T]``, whether there is a true position.
        collided: ``[N]``, share of the samples in which the person comes within 0.2 m of another predicted person.
        together: ``[N]``, whether the window has another scored person.
        true_collided: ``[N]``, the same share with true positions of others, including robots.
        accompanied: ``[N]``, whether anyone else is present in the ground truth.
        swept, true_swept: ``[N, 2]``, shares of the samples in which the person comes closer than 0.2 m, and than the
            sum of the radii, to another scored person, also between rows; and whether this is true. See
            :func:`~crowdbot.metrics.swept_collisions`; NaN without a past or another scored person.
        nll: ``[N]`` [nat], see :func:`~crowdbot.metrics.kde_nll`; NaN if the samples have no density.
        energy: ``[N]`` [m], see :func:`~crowdbot.metrics.energy_score`, over steps; NaN for more than 100 samples.
    """

    person: NDArray[np.int64]
    ade: Floats
    fde: Floats
    distance: Floats
    exists: Bools
    collided: Floats
    together: Bools
    true_collided: Floats
    accompanied: Bools
    swept: Floats
    true_swept: Floats
    nll: Floats
    energy: Floats

    def over_horizon(self) -> Floats:
        """Return the mean distance ``[T]`` [m] at each step over the people still present; NaN without people."""
        count = self.exists.sum(axis=0)
        total = self.distance.sum(axis=0)
        return np.where(count > 0, total / np.maximum(count, 1), np.nan)

    @classmethod
    def concatenate(cls, parts: list[PersonErrors]) -> PersonErrors:
        """Return the people of several parts of one recording, in order."""
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))


def person_errors(
    forecast: Forecast, future: Windows, rule: str = "person", past: Windows | None = None
) -> PersonErrors:
    """Return the errors of every scored person under the rule of :func:`best_of`, window by window.

    Swept collisions start at the last observed row: they need ``past``.
    """
    distance, counted = distances(forecast, future)
    ade, fde = mean_and_final(forecast, distance, counted)
    best = best_of(ade, fde, rule)
    who = future.scored
    kept = np.swapaxes(_best_sample(distance, ade, rule), 1, 2)
    hit = [
        mean_over_samples(forecast, collision_mask(forecast, future, neighbors=word)) for word in ("predicted", "true")
    ]
    swept = np.full((2, 2, int(who.sum())), np.nan)
    if past is not None:
        swept = np.array(
            [[each[who] for each in swept_collisions(forecast, past, future, at)] for at in (CONTACT, None)]
        )
    few = forecast.samples <= MOST_FOR_ENERGY
    return PersonErrors(
        person=future.id[who],
        ade=best[0][who],
        fde=best[1][who],
        distance=kept[who],
        exists=np.swapaxes(counted, 1, 2)[who],
        collided=hit[0][who],
        together=neighbor_mask(future)[who],
        true_collided=hit[1][who],
        accompanied=neighbor_mask(future, "true")[who],
        swept=swept[:, 0].T,
        true_swept=swept[:, 1].T,
        nll=kde_nll(forecast, future)[who],
        energy=energy_score(forecast, future)[who] if few else np.full(int(who.sum()), np.nan),
    )


def error_over_horizon(forecast: Forecast, future: Windows, rule: str = "person") -> Floats:
    """Return the mean error ``[T]`` [m] at each future step over the people still present; NaN without people.

    Of K samples, the one with the best ADE is used, by person or by scene according to ``rule``.
    """
    distance, counted = distances(forecast, future)
    kept = _best_sample(distance, mean_and_final(forecast, distance, counted)[0], rule)
    count = counted.sum(axis=(0, 2))
    return np.where(count > 0, kept.sum(axis=(0, 2)) / np.maximum(count, 1), np.nan)


def _best_sample(distance: Floats, ade: Floats, rule: str) -> Floats:
    """Return the distance ``[W, T, A]`` of the sample with the best ADE."""
    W, _, _, A = distance.shape
    index = np.broadcast_to(chosen_sample(ade, rule), (W, 1, A))[:, :, None]
    return np.take_along_axis(distance, index, axis=1)[:, 0]
