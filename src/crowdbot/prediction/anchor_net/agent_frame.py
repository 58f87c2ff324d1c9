"""Agent frames: tracks and neighbors of each person relative to the person's position and heading.

Training and prediction share these features. The origin of the frame is the last observed position, its x axis the
direction of the last motion. All operations are exactly rounded and independent for each row: features do not depend
on the batch, bit for bit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.data import Windows, fill_gaps
from crowdbot.prediction.pretrained_weights import STEP
from crowdbot.typing import Bools, Floats

ROWS = 8
"""Number of observed rows."""
HISTORY = (ROWS - 1) * STEP
"""Observed time [s]."""
PREDICTED_ROWS = 12
"""Number of predicted rows."""
NEAR = 12
"""Number of nearest neighbors."""
LOOKAHEAD_ROWS = (4, 8, 12)
"""Steps ahead at which neighbor positions are extrapolated, from their plan or last velocity."""
AGENT_FEATURES = 7 * 2 + 7 * 2 + 1 + 2 + 7
"""Number of features of a person: positions, displacements, speed, mean velocity, mask of observed rows."""
NEIGHBOR_FEATURES = 2 + 2 + 2 + 1 + 1 + 1 + 1 + 2 * len(LOOKAHEAD_ROWS)
"""Number of features of each neighbor."""
SPEED_CLASSES = (0.03, 0.2, 0.8, 2.0, 3.5)
"""Boundaries of the speed classes: distance walked in 2.8 s [m]."""
REACH = 8.0
"""Largest distance of a neighbor that new weights read [m]."""
LONGEST_PATH = 10.0
"""Limit of own past positions in bounded features [m]."""
LONGEST_STEP = 2.0
"""Limit of displacements in 0.4 s in bounded features [m]."""
MOVED = 0.1
"""Minimum displacement for a heading [m]; below it, earlier rows are used."""
FEW = 64
"""Number of windows per pairwise comparison."""


class AgentHistories(NamedTuple):
    """Histories of N people, in world axes, relative to their last position."""

    past: Floats
    """``[N, 8, 2]`` [m] positions; missing rows are interpolated or extrapolated."""
    seen: Bools
    """``[N, 8]``."""
    noise: Floats
    """``[N, 8]`` [m^2] variance of a measured coordinate, the mean of both; NaN where the tracker does not say."""
    near: Floats
    """``[N, 12, 2]`` [m] positions of neighbors, nearest first; 0 if there is none."""
    pace: Floats
    """``[N, 12, 2]`` [m] last displacements of the neighbors."""
    later: Floats
    """``[N, 12, 3, 2]`` [m] positions of the neighbors at :data:`LOOKAHEAD_ROWS`."""
    known: Bools
    """``[N, 12]``, whether the future is known, as for a robot with a plan."""
    there: Bools
    """``[N, 12]``, whether the neighbor exists."""

    def at(self, rows: NDArray[np.int64] | slice) -> AgentHistories:
        """Return some of the people."""
        return AgentHistories(
            self.past[rows], self.seen[rows], self.noise[rows], self.near[rows], self.pace[rows], self.later[rows],
            self.known[rows], self.there[rows],
        )  # fmt: skip

    def within(self, reach: float) -> AgentHistories:
        """Return the histories without neighbors farther away than ``reach`` [m]."""
        return self._replace(there=np.asarray(self.there & (_length(self.near) <= reach)))


def interpolate_gaps(position: Floats, seen: Bools) -> Floats:
    """Return positions ``[N, T, 2]`` at all rows from those at the ``seen`` rows ``[N, T]``; the last row must be seen.

    Gaps are interpolated linearly; rows before the first seen row are extrapolated with the first velocity. People seen
    at the last row only have a constant position.

    >>> x = np.array([[0.0, 0.0, 2.0, 0.0, 4.0]])
    >>> rows = np.array([[False, False, True, False, True]])
    >>> interpolate_gaps(np.stack([x, 0.0 * x], axis=2), rows)[0, :, 0].tolist()
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


def heading_vectors(past: Floats) -> Floats:
    """Return heading vectors ``[N, 2]`` of tracks ``[N, 8, 2]`` [m].

    The heading is the direction of the last two displacements; if they are shorter than 0.1 m, of the last four or all
    seven. The heading of people who never moved is the x axis.
    """
    heading = past[:, -1] - past[:, 0]
    for back in (4, 2):
        away = past[:, -1] - past[:, -1 - back]
        far = _length(away) > MOVED
        heading = np.where(far[:, None], away, heading)
    length = _length(heading)[:, None]
    return np.where(length > 1e-9, heading / np.where(length > 1e-9, length, 1.0), np.array([1.0, 0.0]))


def speed_class(past: Floats) -> NDArray[np.int64]:
    """Return the speed class ``[N]`` of tracks ``[N, 8, 2]`` [m], from 0 (standing) to ``len(SPEED_CLASSES)`` (fast).

    >>> speed_class(np.linspace(0.0, [[0.0, 0.0], [3.0, 0.0]], 8, axis=1)).tolist()
    [0, 4]
    """
    return np.asarray(np.searchsorted(np.asarray(SPEED_CLASSES), _length(past[:, -1] - past[:, 0])))


def rotate(vector: Floats, heading: Floats, back: bool = False) -> Floats:
    """Rotate vectors ``[N, ..., 2]`` into frames with the x axis along ``heading [N, 2]``, or ``back`` to the world."""
    shape = (len(heading), *(1,) * (vector.ndim - 2))
    c, s = heading[:, 0].reshape(shape), heading[:, 1].reshape(shape)
    s = -s if back else s
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([c * x + s * y, c * y - s * x], axis=-1)


def agent_features(people: AgentHistories, heading: Floats, reach: float = np.inf) -> tuple[Floats, Floats]:
    """Return the features of people ``[N, AGENT_FEATURES]`` and neighbors ``[N, 12, NEIGHBOR_FEATURES]``.

    With a finite ``reach`` [m] all features are bounded: positions and displacements saturate smoothly, those of
    neighbors at ``reach``. An infinite one gives the unbounded features of weights without the array ``reach``.
    """
    past, near, pace, later = (rotate(values, heading) for values in (people.past, people.near, people.pace,
                                                                     people.later))  # fmt: skip
    bounded = np.isfinite(reach)
    step = past[:, 1:] - past[:, :-1]
    mean = (past[:, -1] - past[:, -4]) / 3.0
    if bounded:
        past, step, mean = _saturate(past, LONGEST_PATH), _saturate(step, LONGEST_STEP), _saturate(mean, LONGEST_STEP)
        pace, near = _saturate(pace, LONGEST_STEP), _saturate(near, reach)
    last = step[:, -1]
    N = len(past)
    own = np.concatenate(
        [past[:, :-1].reshape(N, -1), step.reshape(N, -1), _length(last)[:, None], mean,
         people.seen[:, :-1].astype(np.float64)], axis=1,
    )  # fmt: skip
    distance = _length(near)
    closing = pace - last[:, None]
    speed2 = closing[..., 0] * closing[..., 0] + closing[..., 1] * closing[..., 1]
    inward = near[..., 0] * closing[..., 0] + near[..., 1] * closing[..., 1]
    soon = np.clip(-inward / np.maximum(speed2, 1e-9), 0.0, float(PREDICTED_ROWS))
    closest = _length(near + closing * soon[..., None])
    moment = np.asarray(LOOKAHEAD_ROWS, dtype=np.float64)[:, None]
    meant = later - last[:, None, None] * moment
    meant = (_saturate(meant, reach) if bounded else meant) / 5.0
    company = np.concatenate(
        [near / 5.0, pace, near / np.maximum(distance, 1e-9)[..., None],
         np.stack([1.0 / (1.0 + distance), 1.0 / (1.0 + closest), soon / PREDICTED_ROWS, people.known], axis=-1),
         meant.reshape(N, near.shape[1], -1)], axis=2,
    )  # fmt: skip
    return own, np.where(people.there[..., None], company, 0.0)


def agent_histories(past: Windows) -> tuple[AgentHistories, NDArray[np.int64], NDArray[np.int64]]:
    """Return the histories of all agents present at the last row at steps of 0.4 s, with their windows and slots.

    Other time steps are interpolated. Neighbors are the nearest agents that were observed at two rows or more.
    """
    position, seen, noise = _at_steps(past)
    window, slot = np.nonzero(past.present[:, -1])
    now = position[window, -1, slot]
    own = seen[window, :, slot]
    track = interpolate_gaps(position[window, :, slot] - now[:, None], own)
    step = np.zeros((len(past), past.present.shape[2], 2))
    step[window, slot] = track[:, -1] - track[:, -2]
    who, there = _nearest(position[:, -1], past.present[:, -1], seen.sum(axis=1) > 1, past.id)
    who, there = who[window, slot], there[window, slot]
    where = window[:, None]
    place = position[where, -1, who] - now[:, None]
    pace = step[where, who]
    moment = np.asarray(LOOKAHEAD_ROWS, dtype=np.float64)[:, None]
    later = place[:, :, None] + pace[:, :, None] * moment
    known: Bools = np.zeros(who.shape, dtype=np.bool_)
    if past.plan is not None:
        planned = np.stack([planned_positions(past, k)[where, who] for k in LOOKAHEAD_ROWS], axis=2)
        known = np.asarray(~np.isnan(planned).any(axis=(2, 3)))
        later = np.where(known[..., None, None], planned - now[:, None, None], later)
    zero = there[..., None]
    people = AgentHistories(
        track, own, noise[window, :, slot], np.where(zero, place, 0.0), np.where(zero, pace, 0.0),
        np.where(zero[..., None], later, 0.0), known & there, there,
    )  # fmt: skip
    return people, window, slot


def planned_positions(past: Windows, step: int) -> Floats:
    """Return planned positions ``[W, A, 2]`` [m] after ``step`` steps of 0.4 s."""
    rows = step * STEP / past.dt
    low = int(np.floor(rows + 1e-9))
    share = max(0.0, rows - low)
    one = past.plan_at(low) if low > 0 else past.position[:, -1]
    return one if share < 1e-6 else one + share * (past.plan_at(low + 1) - one)


def _at_steps(past: Windows) -> tuple[Floats, Bools, Floats]:
    """Return positions ``[W, 8, A, 2]`` [m] at steps of 0.4 s, the mask ``[W, 8, A]`` of observed ones, and variances.

    The variances ``[W, 8, A]`` [m^2] are those of a measured coordinate, NaN where they are unknown.
    """
    W, T, A, _ = past.position.shape
    position, seen = np.zeros((W, ROWS, A, 2)), np.zeros((W, ROWS, A), dtype=np.bool_)
    noise = np.full((W, ROWS, A), np.nan)
    own = None if past.covariance is None else 0.5 * (past.covariance[..., 0, 0] + past.covariance[..., 1, 1])
    if abs(past.dt - STEP) < 1e-6:
        kept = min(T, ROWS)
        position[:, ROWS - kept :], seen[:, ROWS - kept :] = past.position[:, T - kept :], past.present[:, T - kept :]
        if own is not None:
            noise[:, ROWS - kept :] = own[:, T - kept :]
        return position, seen, noise
    known = fill_gaps(past)
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
        if own is not None:
            noise[:, -1 - back] = (1.0 - share) ** 2 * own[:, low] + share**2 * own[:, high]
    _extend_short_tracks(known, position, seen)
    return position, seen, noise


def _extend_short_tracks(known: Windows, position: Floats, seen: Bools) -> None:
    """Set the second last row of people observed for less than 0.4 s from their mean velocity, in place.

    Otherwise two people with 0.35 s of rows, one walking and one standing, would look the same.
    """
    T = known.present.shape[1]
    first = np.argmax(known.present, axis=1)
    time = (T - 1 - first) * known.dt
    short = known.present[:, -1] & (time > 0.0) & (time < STEP - 1e-6)
    start = np.take_along_axis(known.position, first[:, None, :, None], axis=1)[:, 0]
    now = known.position[:, -1]
    before = now - (now - start) * (STEP / np.where(short, time, 1.0))[..., None]
    position[:, -2] = np.where(short[..., None], before, position[:, -2])
    seen[:, -2] |= short


def _nearest(place: Floats, here: Bools, walked: Bools, id: NDArray[np.int64]) -> tuple[NDArray[np.int64], Bools]:
    """Return slots ``[W, A, 12]`` of the nearest neighbors (ties by id), and whether they exist."""
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


def _saturate(vector: Floats, limit: float) -> Floats:
    """Return vectors ``[..., 2]`` with lengths below ``limit``, almost unchanged if they are short."""
    square = vector[..., 0] * vector[..., 0] + vector[..., 1] * vector[..., 1]
    return np.asarray(vector / np.sqrt(1.0 + square / (limit * limit))[..., None])


def _length(vector: Floats) -> Floats:
    return np.sqrt(vector[..., 0] * vector[..., 0] + vector[..., 1] * vector[..., 1])
