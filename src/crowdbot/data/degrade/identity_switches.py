"""Identity switches: two tracks near each other exchange their ids."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import parameter
from crowdbot.data.trajectories import Trajectories
from crowdbot.typing import Ints

from .degradation import Degradation, DegradedTracks


class Encounter(NamedTuple):
    """An encounter of two tracks: the frame of their smallest distance, and their ids, the lower one first."""

    frame: int
    one: int
    other: int


def encounters(tracks: Trajectories, distance: float) -> list[Encounter]:
    """Return every encounter: consecutive frames in which two people are nearer than ``distance`` [m], by frame.

    An encounter ends at a frame where they are farther apart or one is absent.

    >>> tracks = Trajectories([1, 2, 1, 2, 1, 2], [0, 0, 1, 1, 2, 2], [0, 5, 2, 3, 5, 0], [0.0] * 6, row_rate=2.5)
    >>> encounters(tracks, 1.5)
    [Encounter(frame=1, one=1, other=2)]
    """
    close = [_close(tracks, begin, end, instant, distance) for instant, (begin, end) in enumerate(_frames(tracks))]
    instant, one, other, away = (np.concatenate(part) for part in zip(*close, strict=True))
    order = np.lexsort((instant, other, one))
    instant, one, other, away = instant[order], one[order], other[order], away[order]
    goes_on = (np.diff(instant) == 1) & (np.diff(one) == 0) & (np.diff(other) == 0)
    stretch = np.concatenate([[0], np.cumsum(~goes_on)])[: len(instant)]
    nearest = np.lexsort((instant, away, stretch))
    nearest = nearest[np.unique(stretch[nearest], return_index=True)[1]]
    frames = np.unique(tracks.frame)[instant[nearest].astype(np.int64)]
    return sorted(map(Encounter, frames.tolist(), one[nearest].tolist(), other[nearest].tolist()))


def _frames(tracks: Trajectories) -> list[tuple[int, int]]:
    first = np.unique(tracks.frame, return_index=True)[1].tolist()
    return list(zip(first, [*first[1:], len(tracks)], strict=True))


def _close(
    tracks: Trajectories, begin: int, end: int, instant: int, distance: float
) -> tuple[Ints, Ints, Ints, NDArray[np.float64]]:
    """Return instant, both ids and the squared distance of every close pair of the rows ``begin`` to ``end``."""
    id, place = tracks.id[begin:end], tracks.position[begin:end]
    people = ~np.isin(id, np.asarray(sorted(tracks.robots), dtype=np.int64))
    id, place = id[people], place[people]
    apart = place[:, None] - place
    away = apart[..., 0] ** 2 + apart[..., 1] ** 2
    one, other = np.nonzero(np.triu(away < distance * distance, k=1))
    return np.full(len(one), instant), id[one], id[other], away[one, other]


@dataclass(frozen=True)
class IdentitySwitches(Degradation):
    """Swaps the ids of two tracks near each other, from the frame of their smallest distance on.

    There is one random decision per encounter. A track can be swapped several times.

    Fields:
        probability: probability of a swap per encounter [1]; the level.
        distance: distance [m] below which two people encounter each other.
    """

    probability: float = parameter(0.1, unit="1", low=0.0, high=1.0, source="ours")
    distance: float = parameter(0.8, unit="m", low=0.3, high=2.0, source="ours: two people who walk side by side")

    level: ClassVar[str] = "probability"
    levels: ClassVar[tuple[float, ...]] = (0.0, 0.1, 0.25, 0.5, 1.0)

    def degrade(self, seen: DegradedTracks, rng: np.random.Generator) -> DegradedTracks:
        tracks = seen.tracks
        met = encounters(tracks, self.distance)
        swapped = rng.random(len(met)) < self.probability
        id = tracks.id.copy()
        order = np.lexsort((tracks.frame, tracks.id))
        ids, begins = np.unique(tracks.id[order], return_index=True)
        rows_of = dict(zip(ids.tolist(), np.split(order, begins[1:]), strict=True))
        for (frame, *pair), swap in zip(met, swapped.tolist(), strict=True):
            if swap:
                one, other = (
                    rows[np.searchsorted(tracks.frame[rows], frame) :] for rows in map(rows_of.__getitem__, pair)
                )
                id[one], id[other] = id[other[0]], id[one[0]]
        return seen.relabel(id)
