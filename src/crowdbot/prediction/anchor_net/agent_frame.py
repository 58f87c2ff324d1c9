"""People in their own frames: where they come from and who is near, seen from where they stand and look.

What learned predictors read and what they were trained on is made here, so that both are the same. The frame of a
person has its origin at the last observed place and its x axis along the last motion. All operations are rounded
exactly and go row by row: a person alone is seen as in any batch, bit for bit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.data import Windows, bridged
from crowdbot.prediction.pretrained_weights import STEP

__all__ = ["AHEAD", "COMPANY", "GAITS", "INPUTS", "MOMENTS", "NEAR", "ROWS", "People", "completed", "features",
           "forward", "gait", "people_of", "turned"]  # fmt: skip

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

ROWS = 8
"""Observed rows."""
AHEAD = 12
"""Predicted rows."""
NEAR = 12
"""So many nearest others are seen."""
MOMENTS = (4, 8, 12)
"""Steps ahead at which it is looked where others will be: as planned, or with their last velocity."""
INPUTS = 7 * 2 + 7 * 2 + 1 + 2 + 7
"""Numbers about a person alone: places, displacements, speed, mean velocity, which rows were seen."""
COMPANY = 2 + 2 + 2 + 1 + 1 + 1 + 1 + 2 * len(MOMENTS)
"""Numbers about each neighbour."""
GAITS = (0.03, 0.2, 0.8, 2.0, 3.5)
"""Distances [m] walked in 2.8 s that part still, standing, shuffling, slow, usual and fast people."""
MOVED = 0.1
"""Less motion than this [m] gives no heading; it is then looked for further back."""
FEW = 64
"""Windows whose pairs are compared at once."""


class People(NamedTuple):
    """N people, in the axes of the world, seen from their last place."""

    past: Floats
    """``[N, 8, 2]`` [m] places; rows that were not seen are bridged, or walked backwards."""
    seen: Bools
    """``[N, 8]``."""
    near: Floats
    """``[N, 12, 2]`` [m] places of the nearest others, nearest first; 0 where there is nobody."""
    pace: Floats
    """``[N, 12, 2]`` [m] last displacements of these others."""
    later: Floats
    """``[N, 12, 3, 2]`` [m] where they will be at :data:`MOMENTS`."""
    known: Bools
    """``[N, 12]``, whether that is known, as of a robot with a plan."""
    there: Bools
    """``[N, 12]``, whether there is such a neighbour."""

    def at(self, rows: NDArray[np.int64] | slice) -> People:
        """Return some of the people."""
        return People(
            self.past[rows], self.seen[rows], self.near[rows], self.pace[rows], self.later[rows], self.known[rows],
            self.there[rows],
        )  # fmt: skip


def completed(position: Floats, seen: Bools) -> Floats:
    """Return places ``[N, T, 2]`` at every row from those at the ``seen`` rows ``[N, T]``, the last of them included.

    Holes are bridged by an even walk; before the first row people walk with their first velocity; who was seen at the
    last row only stood there.

    >>> x = np.array([[0.0, 0.0, 2.0, 0.0, 4.0]])
    >>> rows = np.array([[False, False, True, False, True]])
    >>> completed(np.stack([x, 0.0 * x], axis=2), rows)[0, :, 0].tolist()
    [0.0, 1.0, 2.0, 3.0, 4.0]
    """
    T = seen.shape[1]
    row = np.arange(T)
    before = np.maximum.accumulate(np.where(seen, row, -1), axis=1)
    after = np.minimum.accumulate(np.where(seen, row, T - 1)[:, ::-1], axis=1)[:, ::-1]
    first = np.argmax(seen, axis=1)[:, None]
    second = np.take_along_axis(np.concatenate([after[:, 1:], after[:, -1:]], axis=1), first, axis=1)
    one = np.where(before < 0, first, before)
    other = np.where(before < 0, second, after)
    gap = (other - one)[..., None]
    share = (row - one)[..., None] / np.maximum(gap, 1)
    start = np.take_along_axis(position, one[..., None], axis=1)
    end = np.take_along_axis(position, other[..., None], axis=1)
    return np.where(seen[..., None], position, start + share * (end - start))


def forward(past: Floats) -> Floats:
    """Return the unit vector ``[N, 2]`` along which people with the places ``[N, 8, 2]`` [m] move.

    It is taken from the last two displacements, or where they are shorter than 0.1 m from the last four or all seven.
    Who never moved looks along x.
    """
    heading = past[:, -1] - past[:, 0]
    for back in (4, 2):
        away = past[:, -1] - past[:, -1 - back]
        far = _length(away) > MOVED
        heading = np.where(far[:, None], away, heading)
    length = _length(heading)[:, None]
    return np.where(length > 1e-9, heading / np.where(length > 1e-9, length, 1.0), np.array([1.0, 0.0]))


def gait(past: Floats) -> NDArray[np.int64]:
    """Return how fast people with the places ``[N, 8, 2]`` [m] walk ``[N]``: 0 is still, ``len(GAITS)`` is fast.

    >>> gait(np.linspace(0.0, [[0.0, 0.0], [3.0, 0.0]], 8, axis=1)).tolist()
    [0, 4]
    """
    return np.asarray(np.searchsorted(np.asarray(GAITS), _length(past[:, -1] - past[:, 0])))


def turned(vector: Floats, heading: Floats, back: bool = False) -> Floats:
    """Return vectors ``[N, ..., 2]`` in frames with the x axis along ``heading`` [N, 2], or from there to the world."""
    shape = (len(heading), *(1,) * (vector.ndim - 2))
    c, s = heading[:, 0].reshape(shape), heading[:, 1].reshape(shape)
    s = -s if back else s
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([c * x + s * y, c * y - s * x], axis=-1)


def features(people: People, heading: Floats) -> tuple[Floats, Floats]:
    """Return the numbers of each person ``[N, INPUTS]`` and neighbour ``[N, 12, COMPANY]``, looking along headings."""
    past, near, pace, later = (turned(values, heading) for values in (people.past, people.near, people.pace,
                                                                     people.later))  # fmt: skip
    step = past[:, 1:] - past[:, :-1]
    last = step[:, -1]
    mean = (past[:, -1] - past[:, -4]) / 3.0
    N = len(past)
    own = np.concatenate(
        [past[:, :-1].reshape(N, -1), step.reshape(N, -1), _length(last)[:, None], mean,
         people.seen[:, :-1].astype(np.float64)], axis=1,
    )  # fmt: skip
    distance = _length(near)
    closing = pace - last[:, None]
    speed2 = closing[..., 0] * closing[..., 0] + closing[..., 1] * closing[..., 1]
    inward = near[..., 0] * closing[..., 0] + near[..., 1] * closing[..., 1]
    soon = np.clip(-inward / np.maximum(speed2, 1e-9), 0.0, float(AHEAD))
    closest = _length(near + closing * soon[..., None])
    moment = np.asarray(MOMENTS, dtype=np.float64)[:, None]
    meant = (later - last[:, None, None] * moment) / 5.0
    company = np.concatenate(
        [near / 5.0, pace, near / np.maximum(distance, 1e-9)[..., None],
         np.stack([1.0 / (1.0 + distance), 1.0 / (1.0 + closest), soon / AHEAD, people.known], axis=-1),
         meant.reshape(N, near.shape[1], -1)], axis=2,
    )  # fmt: skip
    return own, np.where(people.there[..., None], company, 0.0)


def people_of(past: Windows) -> tuple[People, NDArray[np.int64], NDArray[np.int64]]:
    """Return everyone who is there at the last row, and the window and slot of each; rows are at steps of 0.4 s.

    Other time steps are interpolated between rows up to the last one. Neighbours are the nearest others who were seen
    at two rows at least, whether or not their future is known.
    """
    position, seen = _at_steps(past)
    window, slot = np.nonzero(past.present[:, -1])
    now = position[window, -1, slot]
    own = seen[window, :, slot]
    track = completed(position[window, :, slot] - now[:, None], own)
    step = np.zeros((len(past), past.present.shape[2], 2))
    step[window, slot] = track[:, -1] - track[:, -2]
    who, there = _nearest(position[:, -1], past.present[:, -1], seen.sum(axis=1) > 1, past.id)
    who, there = who[window, slot], there[window, slot]
    where = window[:, None]
    place = position[where, -1, who] - now[:, None]
    pace = step[where, who]
    moment = np.asarray(MOMENTS, dtype=np.float64)[:, None]
    later = place[:, :, None] + pace[:, :, None] * moment
    known: Bools = np.zeros(who.shape, dtype=np.bool_)
    if past.plan is not None:
        planned = np.stack([_plan_at(past, k)[where, who] for k in MOMENTS], axis=2)
        known = np.asarray(~np.isnan(planned).any(axis=(2, 3)))
        later = np.where(known[..., None, None], planned - now[:, None, None], later)
    zero = there[..., None]
    people = People(
        track, own, np.where(zero, place, 0.0), np.where(zero, pace, 0.0), np.where(zero[..., None], later, 0.0),
        known & there, there,
    )  # fmt: skip
    return people, window, slot


def _plan_at(past: Windows, step: int) -> Floats:
    """Return where planned robots are ``step`` steps of 0.4 s ahead ``[W, A, 2]`` [m]."""
    rows = step * STEP / past.dt
    low = int(np.floor(rows + 1e-9))
    share = max(0.0, rows - low)
    one = past.plan_at(low) if low > 0 else past.position[:, -1]
    return one if share < 1e-6 else one + share * (past.plan_at(low + 1) - one)


def _at_steps(past: Windows) -> tuple[Floats, Bools]:
    """Return places ``[W, 8, A, 2]`` [m] and whether they were seen ``[W, 8, A]``, at steps of 0.4 s up to now."""
    W, T, A, _ = past.position.shape
    position, seen = np.zeros((W, ROWS, A, 2)), np.zeros((W, ROWS, A), dtype=np.bool_)
    if abs(past.dt - STEP) < 1e-6:
        kept = min(T, ROWS)
        position[:, ROWS - kept :], seen[:, ROWS - kept :] = past.position[:, T - kept :], past.present[:, T - kept :]
        return position, seen
    known = bridged(past)
    for back in range(ROWS):
        row = T - 1 - back * STEP / past.dt
        low = int(np.floor(row + 1e-6))
        if low < 0:
            break
        share = max(0.0, row - low)
        high = low if share < 1e-6 else low + 1
        one, other = known.position[:, low], known.position[:, high]
        here = known.present[:, low] & known.present[:, high]
        position[:, -1 - back] = np.where(here[..., None], one + share * (other - one), 0.0)
        seen[:, -1 - back] = here
    return position, seen


def _nearest(place: Floats, here: Bools, walked: Bools, id: NDArray[np.int64]) -> tuple[NDArray[np.int64], Bools]:
    """Return slots ``[W, A, 12]`` of the nearest others, equally near ones by id, and whether they are there."""
    W, A, _ = place.shape
    who, there = np.zeros((W, A, NEAR), dtype=np.int64), np.zeros((W, A, NEAR), dtype=np.bool_)
    order = np.argsort(id, axis=1, kind="stable")
    for first in range(0, W, FEW):
        part = slice(first, first + FEW)
        sorted_place = np.take_along_axis(place[part], order[part, :, None], axis=1)
        counts = np.take_along_axis((here & walked)[part], order[part], axis=1)
        away = place[part, :, None] - sorted_place[:, None]
        distance = away[..., 0] * away[..., 0] + away[..., 1] * away[..., 1]
        itself = order[part, None] == np.arange(A)[:, None]
        distance = np.where(counts[:, None] & ~itself, distance, np.inf)
        nearest = np.argsort(distance, axis=2, kind="stable")[..., :NEAR]
        few = nearest.shape[2]
        there[part, :, :few] = np.isfinite(np.take_along_axis(distance, nearest, axis=2))
        who[part, :, :few] = np.take_along_axis(np.broadcast_to(order[part, None], distance.shape), nearest, axis=2)
    return who, there


def _length(vector: Floats) -> Floats:
    return np.sqrt(vector[..., 0] * vector[..., 0] + vector[..., 1] * vector[..., 1])
