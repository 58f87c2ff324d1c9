"""TrackBatch: the past positions of people around a robot in several environments, as padded arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np

from crowdbot.core import InputError, kernel, storable, tree
from crowdbot.typing import Bools, Floats, Ints

from .track_history import LENGTH, TrackHistory


@storable
@dataclass(frozen=True, eq=False)
class TrackBatch(Sequence[TrackHistory]):
    """Positions of at most A people at the last T instants in each of N environments.

    Element k is the :class:`TrackHistory` of environment k, equal to the last bit to one that is updated alone.

    Fields:
        times: ``[N, T]`` increasing [s], newest row last; NaN for rows before the first.
        ids: ``[N, A]`` increasing identities of everybody in these rows; arbitrary for further places.
        people: ``[N]`` number of people; their places come first.
        position: ``[N, T, A, 2]`` [m]; NaN where a person was not seen.

    >>> tracks = TrackBatch.empty(2, length=2)
    >>> seen = np.array([[True], [False]])
    >>> for k in range(3):
    ...     place = np.array([[[0.2 * k, 0.0]], [[0.0, 0.0]]])
    ...     tracks = tracks.update(np.full(2, 0.1 * k), np.array([[7], [7]]), place, seen)
    >>> tracks.position[0, :, 0].tolist(), tracks.valid.shape, len(tracks[1].ids)
    ([[0.2, 0.0], [0.4, 0.0]], (2, 2, 1), 0)
    """

    times: Floats
    ids: Ints
    people: Ints
    position: Floats

    @classmethod
    def empty(cls, count: int, length: int = LENGTH) -> TrackBatch:
        """Return ``count`` histories without rows.

        Raises:
            InputError: ``length`` is below 1.
        """
        TrackHistory.empty(length)
        none = np.zeros((count, 0), dtype=np.int64)
        return cls(
            np.full((count, length), np.nan), none, np.zeros(count, dtype=np.int64), np.zeros((count, length, 0, 2))
        )

    @classmethod
    def of(cls, histories: Sequence[TrackHistory]) -> TrackBatch:
        """Return histories of equal length as a batch.

        Raises:
            InputError: their lengths differ.
        """
        lengths = {history.length for history in histories}
        if len(lengths) > 1:
            raise InputError(f"tracks: the histories have different lengths: {sorted(lengths)} rows")
        T, A = max(lengths, default=LENGTH), max((len(history.ids) for history in histories), default=0)
        N = len(histories)
        track_batch = cls(
            np.full((N, T), np.nan),
            np.zeros((N, A), dtype=np.int64),
            np.array([len(history.ids) for history in histories], dtype=np.int64),
            np.full((N, T, A, 2), np.nan),
        )
        for k, history in enumerate(histories):
            rows, people = len(history.times), len(history.ids)
            track_batch.times[k, T - rows :], track_batch.ids[k, :people] = history.times, history.ids
            track_batch.position[k, T - rows :, :people] = history.position
        return track_batch

    @property
    def length(self) -> int:
        """Largest number of rows T."""
        return int(self.times.shape[1])

    @property
    def valid(self) -> Bools:
        """Whether a person was seen, ``[N, T, A]``."""
        return ~np.isnan(self.position[..., 0])

    def __len__(self) -> int:
        """Return the number of environments."""
        return len(self.times)

    @overload
    def __getitem__(self, k: int) -> TrackHistory: ...
    @overload
    def __getitem__(self, k: slice) -> Sequence[TrackHistory]: ...
    def __getitem__(self, k: int | slice) -> TrackHistory | Sequence[TrackHistory]:
        """Return the history of environment ``k``, or of several."""
        if isinstance(k, slice):
            return [self[e] for e in range(*k.indices(len(self)))]
        begin, people = int(np.isnan(self.times[k]).sum()), int(self.people[k])
        place = self.position[k, begin:, :people].copy()
        return TrackHistory(self.times[k, begin:].copy(), self.ids[k, :people].copy(), place, self.length)

    def update(self, time: Floats, ids: Ints, position: Floats, seen: Bools, chosen: Bools | None = None) -> TrackBatch:
        """Return the histories with one more row, as :meth:`TrackHistory.update` of each.

        Args:
            time: ``[N]`` time of the row [s], after the newest row.
            ids: ``[N, P]`` identities.
            position: ``[N, P, 2]`` [m].
            seen: ``[N, P]`` who is seen.
            chosen: ``[N]`` environments with a new row; the others stay as they are (default: all).

        Raises:
            InputError: a time is not after the newest row, or a position or identity is not allowed.
        """
        N, T = self.times.shape
        rows = np.ones(N, dtype=np.bool_) if chosen is None else chosen
        row: tuple[Any, ...] = tuple(map(np.ascontiguousarray, (ids, position, seen)))
        wide = self.ids.shape[1] + ids.shape[1]
        old, new = (np.full((N, wide), -1, dtype=np.int64) for _ in range(2))
        count = np.zeros(N, dtype=np.int64)
        wrong = _merge(
            self.times, self.ids, self.people, self.position, rows, time, row[0], row[1], row[2], old, new, count
        )
        if wrong >= 0:
            self[wrong].update(float(time[wrong]), ids[wrong, seen[wrong]], position[wrong, seen[wrong]])
        A = int(count.max(initial=0))
        whole = np.full((N, T, A, 2), np.nan)
        times, names = self.times.copy(), np.zeros((N, A), dtype=np.int64)
        _fill(self.ids, self.position, rows, time, row[0], row[1], old, new, count, times, names, whole)
        return TrackBatch(times, names, count, whole)

    def put(self, environments: Ints, other: TrackBatch) -> TrackBatch:
        """Return the histories with some environments replaced by those of another batch of the same length."""
        people = max(self.ids.shape[1], other.ids.shape[1])
        return tree.put(self._padded(people), environments, other._padded(people), len(self))

    def _padded(self, people: int) -> TrackBatch:
        """Return the histories with places for a number of people."""
        more = (0, people - self.ids.shape[1])
        position = np.pad(self.position, ((0, 0), (0, 0), more, (0, 0)), constant_values=np.nan)
        return TrackBatch(self.times, np.pad(self.ids, ((0, 0), more)), self.people, position)


@kernel
def _merge(
    times: Floats, ids: Ints, count: Ints, position: Floats, chosen: Bools, now: Floats, new_ids: Ints,
    new_position: Floats, seen: Bools, old: Ints, new: Ints, out_count: Ints,
) -> int:  # fmt: skip
    """Write the places of the people of each environment after a new row, in the order of their identities.

    Args:
        times, ids, count, position: the batch before.
        chosen: ``[N]`` environments with a new row.
        now, new_ids, new_position, seen: the new row.
        old, new: ``[N, W]`` place of each person before and in the new row, -1 for none.
        out_count: ``[N]`` number of people.

    Returns:
        The first environment with a value that is not allowed, or -1.
    """
    T = times.shape[1]
    order = np.empty(new_ids.shape[1], dtype=np.int64)
    for e in range(len(times)):
        if not chosen[e]:
            for a in range(count[e]):
                old[e, a] = a
            out_count[e] = count[e]
            continue
        if not np.isfinite(now[e]) or now[e] <= times[e, T - 1]:
            return e
        size = 0
        for p in range(new_ids.shape[1]):
            if not seen[e, p]:
                continue
            if not (np.isfinite(new_position[e, p, 0]) and np.isfinite(new_position[e, p, 1])):
                return e
            place = size
            while place > 0 and new_ids[e, order[place - 1]] > new_ids[e, p]:
                order[place] = order[place - 1]
                place -= 1
            if place > 0 and new_ids[e, order[place - 1]] == new_ids[e, p]:
                return e
            order[place] = p
            size += 1
        found, p = 0, 0
        for a in range(count[e]):
            there = False
            for t in range(1, T):
                there = there or not np.isnan(position[e, t, a, 0])
            while p < size and new_ids[e, order[p]] < ids[e, a]:
                new[e, found] = order[p]
                found, p = found + 1, p + 1
            if p < size and new_ids[e, order[p]] == ids[e, a]:
                old[e, found], new[e, found] = a, order[p]
                found, p = found + 1, p + 1
            elif there:
                old[e, found] = a
                found += 1
        while p < size:
            new[e, found] = order[p]
            found, p = found + 1, p + 1
        out_count[e] = found
    return -1


@kernel
def _fill(
    ids: Ints, position: Floats, chosen: Bools, now: Floats, new_ids: Ints, new_position: Floats, old: Ints, new: Ints,
    count: Ints, times: Floats, out_ids: Ints, out_position: Floats,
) -> None:  # fmt: skip
    """Write the batch after a new row; ``times`` are those before, and modified in place."""
    T = times.shape[1]
    for e in range(len(times)):
        shift = 1 if chosen[e] else 0
        for t in range(T - shift):
            times[e, t] = times[e, t + shift]
        if chosen[e]:
            times[e, T - 1] = now[e]
        for a in range(count[e]):
            before, latest = old[e, a], new[e, a]
            out_ids[e, a] = new_ids[e, latest] if latest >= 0 else ids[e, before]
            if before >= 0:
                for t in range(T - shift):
                    for c in range(2):
                        out_position[e, t, a, c] = position[e, t + shift, before, c]
            if latest >= 0:
                for c in range(2):
                    out_position[e, T - 1, a, c] = new_position[e, latest, c]
