"""Energy of interactions by time to collision: recorded people, and crowd models that walk in their place.

Karamouzas, Skinner, Guy 2014, Universal power law governing pedestrian interactions,
doi 10.1103/PhysRevLett.113.238701: ``E(tau) = ln(1 / g(tau))`` is proportional to ``tau^-2`` from about 0.2 s, the
reaction time, up to a screening time of 1 to 3 s, beyond which g is 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, Scene, stream
from crowdbot.data import Trajectories, load
from crowdbot.measurement import (
    compute_encounters,
    compute_individual_speed,
    expected_times,
    fit_interaction_energy,
    time_edges,
)
from crowdbot.models import CrowdModel

__all__ = ["EnergyCounts", "EnergyFit", "count_energy", "find_companions", "fit_energy", "read_streets", "walk_again"]

Floats = NDArray[np.float64]
Pair = tuple[int, int]

STREETS = (
    "eth_biwi/seq_eth/obsmat.txt",
    "ucy/students03/obsmat.txt",
    "ucy/zara01/obsmat.txt",
    "ucy/zara02/obsmat.txt",
)
"""The outdoor recordings of the paper."""
STEP, MODEL_STEP = 0.4, 0.1
"""Time between rows, and time step of the models [s]."""
BODY = 0.2
"""Radius of the people of models [m]."""
ARRIVAL = 0.3
"""People of models leave at this distance from the end of the recorded track [m]."""
PATIENCE = 3.0
"""People of models leave at the latest after this multiple of the recorded time."""
FIT_RANGE = (0.2, 2.5)
"""Times to collision of the fit [s]."""
FAR = (4.0, 8.0)
"""Times to collision [s] at which people do not react: g is 1 there."""
BIN, LONGEST, SHUFFLES = 0.1, 8.0, 4
PIECES = 10
"""Parts of a recording that the bootstrap draws from."""
RESAMPLES = 500
COMPANY, SIDE_BY_SIDE = 2.0, 0.9
"""Companions are within this distance [m] for this share of the rows, at least :data:`TOGETHER`, that both are seen."""
TOGETHER = 6


class EnergyCounts(NamedTuple):
    """Pairs by time to collision in P parts of a recording: ``found`` and ``free``, without interaction, ``[P, N]``."""

    found: Floats
    free: Floats


@dataclass(frozen=True)
class EnergyFit:
    """Power law of an energy.

    Fields:
        ttc, energy, low, high: ``[N]`` middle of the bins [s], energy with its 95 % interval; NaN without pairs.
        count: ``[N]`` number of pairs.
        exponent, exponent_low, exponent_high: n of ``E = k tau^-n`` if E is 0 from 4 to 8 s, and its 95 % interval.
        free, free_low, free_high: n of ``E = k tau^-n + c``, with c from the fit.
    """

    ttc: Floats
    energy: Floats
    low: Floats
    high: Floats
    count: Floats
    exponent: float
    exponent_low: float
    exponent_high: float
    free: float
    free_low: float
    free_high: float


def read_streets(folder: Path) -> tuple[Trajectories, ...]:
    """Return the outdoor recordings of the paper, with rows every 0.4 s.

    Raises:
        DataError: the folder contains none of them.
    """
    found = tuple(load(folder / name).resample(STEP) for name in STREETS if (folder / name).is_file())
    if not found:
        raise DataError(f"{folder} contains none of the recordings, such as {STREETS[0]}")
    return found


def find_companions(tracks: Trajectories) -> frozenset[Pair]:
    """Return the pairs of identities who walk together: their times to collision say nothing about avoidance.

    >>> rows = np.arange(8)
    >>> tracks = Trajectories([1] * 8 + [2] * 8, [*rows, *rows], [*rows, *rows], [0.0] * 8 + [0.7] * 8, row_rate=2.5)
    >>> find_companions(tracks)
    frozenset({(1, 2)})
    """
    pairs = compute_encounters(tracks, compute_individual_speed(tracks, tracks.frame_step, border="single-sided"), 1e-3)
    near = (pairs.clearance < COMPANY).groupby([pairs.id, pairs.other_id]).agg(["mean", "size"])
    kept = near[(near["mean"] >= SIDE_BY_SIDE) & (near["size"] >= TOGETHER)]
    return frozenset((int(a), int(b)) for a, b in kept.index)


def walk_again(tracks: Trajectories, model: CrowdModel, seed: int = 0) -> Trajectories:
    """Return the people of a recording as a model moves them: from their first position straight to their last one.

    People appear when they do in the recording, with their recorded velocity, walk at their mean recorded speed, and
    leave near their last position.

    Args:
        tracks: people with rows at equal times.
        model: crowd model.
        seed: seed of the model.
    """
    ids = tracks.ids
    order = np.lexsort((tracks.frame, tracks.id))
    first = np.searchsorted(tracks.id[order], ids)
    last = np.append(first[1:], len(order)) - 1
    place, frame = tracks.position[order], tracks.frame[order]
    kept = last > first
    ids, first, last = ids[kept], first[kept], last[kept]
    way = np.array([np.hypot(*np.diff(place[a : b + 1], axis=0).T).sum() for a, b in zip(first, last, strict=True)])
    speed = np.maximum(way / (STEP * (last - first)), 0.1)
    enter = (frame[first] - tracks.frame.min()) // tracks.frame_step
    latest = enter + np.ceil(PATIENCE * (last - first)).astype(np.int64)
    scene = Scene.of(
        place[first], (place[first + 1] - place[first]) / STEP, radius=BODY, goal=place[last], preferred_speed=speed,
        max_speed=np.maximum(1.3 * speed, 1.7), active=False,
    )  # fmt: skip
    rng = stream(seed, "energy law")
    gone = np.zeros(len(ids), dtype=np.bool_)
    rows: list[tuple[NDArray[np.int64], Floats]] = []
    for row in range(int(latest.max()) + 1):
        away = scene.position[0] - place[last]
        gone |= scene.active[0] & (np.hypot(away[:, 0], away[:, 1]) < ARRIVAL) | (row > latest)
        here = (enter <= row) & ~gone
        scene = scene.replace(active=here[None])
        rows.append((np.flatnonzero(here), scene.position[0, here]))
        for _ in range(round(STEP / MODEL_STEP)):
            scene = model.step(scene, MODEL_STEP, rng)
        if not np.any(here) and row > enter.max():
            break
    number = np.repeat(np.arange(len(rows)), [len(who) for who, _ in rows])
    who, where = np.concatenate([one for one, _ in rows]), np.concatenate([one for _, one in rows])
    return Trajectories(ids[who], number, where[:, 0], where[:, 1], row_rate=1.0 / STEP, frame_step=1, name=tracks.name)


def count_energy(tracks: Trajectories, radius: float, companions: frozenset[Pair] = frozenset()) -> EnergyCounts:
    """Return the pairs by time to collision in equal parts of the time, companions left out.

    Args:
        tracks: people.
        radius: radius of the discs that collide [m].
        companions: result of :func:`find_companions`.
    """
    velocity = compute_individual_speed(tracks, tracks.frame_step, border="adaptive")
    edges = time_edges(BIN, LONGEST, SHUFFLES)
    pairs = compute_encounters(tracks, velocity, radius, reach=1e3)
    apart = np.array([pair not in companions for pair in zip(pairs.id, pairs.other_id, strict=True)], dtype=np.bool_)
    frame, when = pairs.frame.to_numpy()[apart], pairs.ttc.to_numpy()[apart]
    part = (frame - frame.min()) * PIECES // (int(np.ptp(frame)) + 1)
    found = np.stack([np.histogram(when[(when > 0.0) & (part == k)], edges)[0] for k in range(PIECES)])
    share = expected_times(tracks, velocity, radius, edges, SHUFFLES, 0)
    return EnergyCounts(found.astype(np.float64), share * np.bincount(part, minlength=PIECES)[:, None])


def fit_energy(counts: tuple[EnergyCounts, ...]) -> EnergyFit:
    """Return the energy over the parts of all recordings together, with 95 % intervals by the bootstrap over parts."""
    found = np.concatenate([one.found for one in counts])
    free = np.concatenate([one.free for one in counts])
    tau: Floats = np.asarray(BIN * (np.arange(found.shape[1]) + 0.5), dtype=np.float64)
    drawn = stream(0, "energy law", "bootstrap").integers(0, len(found), (RESAMPLES, len(found)))
    energy, *exponents = _fit(tau, found.sum(axis=0), free.sum(axis=0))
    draws = [_fit(tau, found[one].sum(axis=0), free[one].sum(axis=0)) for one in drawn]
    low, high = _ends(np.stack([one[0] for one in draws]))
    ends = [_ends(np.array([one[k] for one in draws])[:, None]) for k in (1, 2)]
    return EnergyFit(
        tau, energy, low, high, found.sum(axis=0),
        exponents[0], float(ends[0][0][0]), float(ends[0][1][0]),
        exponents[1], float(ends[1][0][0]), float(ends[1][1][0]),
    )  # fmt: skip


def _fit(tau: Floats, found: Floats, free: Floats) -> tuple[Floats, float, float]:
    """Return the energy, and the exponents with a constant of 0 and with a fitted one."""
    far = (tau >= FAR[0]) & (tau <= FAR[1])
    level = found[far].sum() / max(free[far].sum(), 1e-300)
    g = np.where(free > 0.0, found / np.where(free > 0.0, free, 1.0), np.nan) / max(level, 1e-300)
    energy = np.where(g > 0.0, -np.log(np.where(g > 0.0, g, 1.0)), np.nan)
    return (
        energy,
        fit_interaction_energy(tau, g, found, FIT_RANGE, offset=0.0)[0],
        fit_interaction_energy(tau, g, found, FIT_RANGE)[0],
    )


def _ends(draws: Floats) -> tuple[Floats, Floats]:
    """Return the 2.5 and 97.5 percentiles of each column, NaN if more than a tenth of the draws has no value."""
    known = np.mean(np.isnan(draws), axis=0) <= 0.1
    ends = np.full((2, draws.shape[1]), np.nan)
    if np.any(known):
        ends[:, known] = np.nanpercentile(draws[:, known], (2.5, 97.5), axis=0)
    return ends[0], ends[1]
