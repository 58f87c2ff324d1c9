"""Distance between predicted and true positions: ADE, FDE, the best of K samples, misses, collisions.

A person counts when the protocol scores them; a future that ends early counts for the steps that exist. ADE is the mean
over these steps, FDE the distance at the last of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data.forecast import Forecast
from crowdbot.data.windows import Windows

__all__ = [
    "PersonErrors",
    "ade",
    "best_of",
    "collided",
    "collision_share",
    "distances",
    "error_over_horizon",
    "fde",
    "miss_rate",
    "person_errors",
]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

RULES = ("person", "scene", "same")
MISS = 2.0
"""A person is missed when no sample ends within this distance [m] of the truth."""
CONTACT = 0.2
"""Two people closer than this [m] have collided (TrajNet++)."""


def distances(forecast: Forecast, future: Windows) -> tuple[Floats, Bools]:
    """Return the distance to the truth ``[W, K, T, A]`` [m] and which steps count ``[W, T, A]``.

    Steps that do not count have the distance 0.

    Raises:
        InputError: forecast and future do not belong together, or a scored person was not predicted.
    """
    _check(forecast, future)
    counted = future.present & future.scored[:, None]
    away = forecast.position - future.position[:, None]
    length = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
    return np.where(counted[:, None], length, 0.0), counted


def ade(forecast: Forecast, future: Windows) -> Floats:
    """Return the average displacement error ``[W, K, A]`` [m] over the steps that exist; NaN for who is not scored."""
    return _mean(*distances(forecast, future))


def fde(forecast: Forecast, future: Windows) -> Floats:
    """Return the displacement error ``[W, K, A]`` [m] at the last step that exists; NaN for who is not scored."""
    return _final(*distances(forecast, future))


def best_of(ade: Floats, fde: Floats, rule: str = "person") -> tuple[Floats, Floats]:
    """Return ADE and FDE ``[W, A]`` [m] of the best of K samples, from those of every sample ``[W, K, A]``.

    Args:
        ade, fde: errors of every sample, NaN for people who are not scored.
        rule: ``person``: the smallest over the samples for each person, ADE and FDE on their own (Social-STGCNN,
            Trajectron++); ``scene``: the sample with the smallest sum over the people of a window, ADE and FDE on
            their own (SGAN); ``same``: for each person the sample with the smallest ADE, which also gives the FDE
            (TrajNet++).

    >>> import numpy as np
    >>> a, f = np.array([[[1.0, 4.0], [2.0, 2.0]]]), np.array([[[3.0, 6.0], [1.0, 5.0]]])
    >>> [[v.tolist() for v in best_of(a, f, rule)] for rule in ("person", "scene", "same")]
    [[[[1.0, 2.0]], [[1.0, 5.0]]], [[[2.0, 2.0]], [[1.0, 5.0]]], [[[1.0, 2.0]], [[3.0, 5.0]]]]
    """
    if rule == "scene":
        return _sample(ade, _of_scene(ade)), _sample(fde, _of_scene(fde))
    chosen = _choice(ade, rule)
    return _sample(ade, chosen), _sample(fde, chosen if rule == "same" else _of_person(fde))


def miss_rate(fde: Floats, limit: float = MISS) -> float:
    """Return the share of scored people whose (best) FDE ``[W, A]`` is above ``limit`` [m]; NaN when there are none."""
    known = fde[~np.isnan(fde)]
    return float(np.mean(known > limit)) if len(known) else float("nan")


def error_over_horizon(forecast: Forecast, future: Windows, rule: str = "person") -> Floats:
    """Return the mean error ``[T]`` [m] at each future step over the people still there; NaN when nobody is.

    Of K samples it follows the one with the best ADE, by person or by scene as ``rule`` says.
    """
    return person_errors(forecast, future, rule).over_horizon()


def collided(forecast: Forecast, future: Windows, limit: float = CONTACT) -> Bools:
    """Return ``[W, K, A]``: scored people who come closer than ``limit`` [m] to another scored person at any step.

    Both are at their predicted positions of the same sample; a step counts while both are truly still there.
    """
    _check(forecast, future)
    W, K, _, A, _ = forecast.position.shape
    hit = np.zeros((W, K, A), dtype=np.bool_)
    for window in np.flatnonzero(future.scored.sum(axis=1) > 1):  # one by one: most of the padded pairs are nobody
        who = np.flatnonzero(future.scored[window])
        here = future.present[window][:, who]
        x, y = np.moveaxis(forecast.position[window][:, :, who], -1, 0)
        dx, dy = x[..., :, None] - x[..., None, :], y[..., :, None] - y[..., None, :]
        pair = here[:, :, None] & here[:, None, :] & ~np.eye(len(who), dtype=np.bool_)
        hit[window][:, who] = np.any(pair & (dx * dx + dy * dy < limit * limit), axis=(1, 3))
    return hit


def collision_share(forecast: Forecast, future: Windows, limit: float = CONTACT) -> float:
    """Return the share of people in windows with at least two who come closer than ``limit`` [m] to another one.

    It is a mean over people and (by their weight) samples; NaN when no window has two people.
    """
    together = future.scored & (future.scored.sum(axis=1) > 1)[:, None]
    if not np.any(together):
        return float("nan")
    share = np.sum(collided(forecast, future, limit) * forecast.weight[:, :, None], axis=1)
    return float(share[together].mean())


@dataclass(frozen=True)
class PersonErrors:
    """Errors of N scored people, one row a person, of the best sample.

    Fields:
        ade, fde: ``[N]`` [m].
        distance: ``[N, T]`` [m] of the sample with the best ADE; 0 where there is no true position.
        exists: ``[N, T]``, where there is one.
        collided: ``[N]``, share of the samples in which the person comes within 0.2 m of another.
        together: ``[N]``, whether the window has another scored person.
    """

    ade: Floats
    fde: Floats
    distance: Floats
    exists: Bools
    collided: Floats
    together: Bools

    def over_horizon(self) -> Floats:
        """Return the mean distance ``[T]`` [m] at each step over the people still there; NaN when nobody is."""
        count = self.exists.sum(axis=0)
        total = self.distance.sum(axis=0)
        return np.where(count > 0, total / np.maximum(count, 1), np.nan)

    @classmethod
    def joined(cls, parts: list[PersonErrors]) -> PersonErrors:
        """Return the people of several parts, in order."""
        names = ("ade", "fde", "distance", "exists", "collided", "together")
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def person_errors(forecast: Forecast, future: Windows, rule: str = "person") -> PersonErrors:
    """Return the errors of every scored person under the rule of :func:`best_of`, window by window."""
    distance, counted = distances(forecast, future)
    every = _mean(distance, counted)
    best = best_of(every, _final(distance, counted), rule)
    chosen = _choice(every, rule)
    who = future.scored
    index = np.broadcast_to(chosen, (len(who), 1, who.shape[1]))[:, :, None]
    kept = np.take_along_axis(distance, index, axis=1)[:, 0]
    hit = np.sum(collided(forecast, future) * forecast.weight[:, :, None], axis=1)
    together = np.broadcast_to((who.sum(axis=1) > 1)[:, None], who.shape)
    by_person = np.swapaxes(kept, 1, 2)[who], np.swapaxes(counted, 1, 2)[who]
    return PersonErrors(best[0][who], best[1][who], *by_person, hit[who], together[who])


def _check(forecast: Forecast, future: Windows) -> None:
    W, _, T, A, _ = forecast.position.shape
    if future.present.shape != (W, T, A):
        raise InputError(
            f"forecast of {forecast.predictor} has W, T, A = {(W, T, A)}, the future has {future.present.shape};"
            " predict the past of the same windows with as many steps"
        )
    if abs(forecast.dt - future.dt) > 1e-9:
        raise InputError(f"forecast has steps of {forecast.dt} s, the future of {future.dt} s; they must be equal")
    missing = future.scored & ~forecast.valid
    if np.any(missing):
        window, person = np.argwhere(missing)[0]
        raise InputError(
            f"{forecast.predictor} did not predict person {future.id[window, person]} of window {window},"
            f" whom protocol {future.protocol!r} scores"
        )
    unseen = future.scored & ~future.present.any(axis=1)
    if np.any(unseen):
        window, person = np.argwhere(unseen)[0]
        raise InputError(f"person {future.id[window, person]} of window {window} is scored but has no future")


def _mean(distance: Floats, counted: Bools) -> Floats:
    count = counted.sum(axis=1)[:, None]
    return np.where(count > 0, distance.sum(axis=2) / np.maximum(count, 1), np.nan)


def _final(distance: Floats, counted: Bools) -> Floats:
    steps = counted.shape[1]
    last = steps - 1 - np.argmax(counted[:, ::-1], axis=1)
    end = np.take_along_axis(distance, last[:, None, None], axis=2)[:, :, 0]
    there = np.asarray(counted.any(axis=1))
    return np.where(there[:, None], end, np.nan)


def _choice(error: Floats, rule: str) -> NDArray[np.int64]:
    """Return the sample ``[W, 1, A]`` (or ``[W, 1, 1]`` for a scene) with the smallest error."""
    if rule not in RULES:
        raise InputError(f"best-of rule {rule!r} is unknown, it must be one of {', '.join(RULES)}")
    return _of_scene(error) if rule == "scene" else _of_person(error)


def _of_person(error: Floats) -> NDArray[np.int64]:
    return np.asarray(np.argmin(np.where(np.isnan(error), np.inf, error), axis=1)[:, None])


def _of_scene(error: Floats) -> NDArray[np.int64]:
    return np.asarray(np.argmin(np.nansum(error, axis=2), axis=1)[:, None, None])


def _sample(error: Floats, chosen: NDArray[np.int64]) -> Floats:
    return np.take_along_axis(error, np.broadcast_to(chosen, (error.shape[0], 1, error.shape[2])), axis=1)[:, 0]
