"""Windows of degraded recordings: observations as a tracker sees them, ground truth as future."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.data import Windows
from crowdbot.data.degrade import GHOST, DegradedTracks
from crowdbot.typing import Bools, Ints


@dataclass(frozen=True)
class DegradedWindows:
    """Windows of a degraded recording with the ground truth of the clean recording.

    Fields:
        past: rows of the degraded recording, in slots sorted by the ids of the degraded tracks.
        future: ground truth of the person at the position of each slot; false tracks have none.
        asked: number of scored persons in the clean windows.
        predictable: number of these persons that are observed at the last row.
    """

    past: Windows
    future: Windows
    asked: int
    predictable: int


def degraded_windows(past: Windows, future: Windows, degraded: DegradedTracks, carry: int = 0) -> DegradedWindows:
    """Return the windows of a degraded recording that correspond to clean windows.

    A window contains the people that are observed at its last row, and all false tracks at that row. A track keeps the
    rows under its id, regardless of whom they belong to. It is scored against the person at its position at the last
    row. People who are not observed at the last row are not predicted; they count in ``asked`` only.

    With ``carry``, tracks that end at most that many rows before the last row are extrapolated with the velocity of
    their last two observed rows. False tracks are not extrapolated.

    Args:
        past, future: windows of the clean recording.
        degraded: the degraded recording.
        carry: maximum number of extrapolated rows.

    >>> from crowdbot.data import Trajectories
    >>> from crowdbot.data.degrade import LateStart
    >>> tracks = Trajectories([7] * 4, range(4), range(4), [0.0] * 4, row_rate=2.5)
    >>> clean = tracks.windows(observe=2, predict=2)
    >>> seen = degraded_windows(*clean, LateStart(1).apply(tracks))
    >>> seen.past.present[:, :, 0].tolist(), seen.predictable, seen.asked
    ([[False, True]], 1, 1)
    """
    table = _Table.of(past, degraded)
    window, row, clean = table.tracks_at_last_row(carry)
    order = np.lexsort((degraded.tracks.id[row], window))
    window, row, clean = window[order], row[order], clean[order]
    slot = np.arange(len(window)) - np.searchsorted(window, window)
    shape = len(past), int(slot.max(initial=-1)) + 1
    id = np.full(shape, -1, dtype=np.int64)
    id[window, slot] = degraded.tracks.id[row]
    robot = np.isin(id, np.asarray(sorted(degraded.tracks.robots), dtype=np.int64))
    position, present = table.rows(window, slot, degraded.tracks.id[row], shape[1])
    if carry:
        _coast(position, present, window, slot)
    then = np.zeros((*future.present.shape[:2], shape[1], 2))
    there = np.zeros(then.shape[:3], dtype=np.bool_)
    scored = np.zeros(shape, dtype=np.bool_)
    real = clean >= 0
    who = window[real], slot[real]
    then[who[0], :, who[1]] = future.position[who[0], :, clean[real]]
    there[who[0], :, who[1]] = future.present[who[0], :, clean[real]]
    scored[who] = future.scored[who[0], clean[real]]
    seen: dict[str, Any] = {"id": id, "robot": robot}
    return DegradedWindows(
        dataclasses.replace(past, position=position, present=present, scored=np.zeros_like(scored), **seen),
        dataclasses.replace(future, position=then, present=there, scored=scored, **seen),
        asked=int(future.scored.sum()),
        predictable=int(scored.sum()),
    )


@dataclass(frozen=True)
class _Table:
    """Index of a degraded recording by frame and id, with the people of the clean windows."""

    degraded: DegradedTracks
    past: Windows
    frames: Ints
    first: Ints
    ids: Ints
    key: Ints

    @classmethod
    def of(cls, past: Windows, degraded: DegradedTracks) -> _Table:
        tracks = degraded.tracks
        frames, first, place = np.unique(tracks.frame, return_index=True, return_inverse=True)
        ids, number = np.unique(tracks.id, return_inverse=True)
        key = place * len(ids) + number  # ascending: rows are sorted by frame, then id
        return cls(degraded, past, frames, np.append(first, len(tracks)), ids, key)

    def tracks_at_last_row(self, carry: int) -> tuple[Ints, Ints, Ints]:
        """Return window, last observed row and clean slot (-1 for a false track) of all tracks in the windows."""
        window, row, clean = self._at(0)
        for back in range(1, min(carry, self.past.position.shape[1] - 1) + 1):
            more, older, person = self._at(back)
            known = set(zip(window.tolist(), self.degraded.tracks.id[row].tolist(), strict=True))
            people = set(zip(window.tolist(), clean.tolist(), strict=True))
            found = zip(more.tolist(), self.degraded.tracks.id[older].tolist(), person.tolist(), strict=True)
            new = np.array([p >= 0 and (w, i) not in known and (w, p) not in people for w, i, p in found], np.bool_)
            window, row = np.append(window, more[new]), np.append(row, older[new])
            clean = np.append(clean, person[new])
        return window, row, clean

    def _at(self, back: int) -> tuple[Ints, Ints, Ints]:
        """Return the same for the tracks observed ``back`` rows before the last row."""
        frame = self.past.frame[:, -1 - back]
        place = np.minimum(np.searchsorted(self.frames, frame), len(self.frames) - 1)
        count = np.where(self.frames[place] == frame, self.first[place + 1] - self.first[place], 0)
        window = np.repeat(np.arange(len(frame)), count)
        row = np.arange(len(window)) - np.repeat(np.cumsum(count) - count, count) + self.first[place][window]
        truth = self.degraded.truth[row]
        clean = self._slots(window, truth)
        kept = (clean >= 0) | (truth == GHOST)
        return window[kept], row[kept], clean[kept]

    def _slots(self, window: Ints, truth: Ints) -> Ints:
        """Return the slots of people in the clean windows, -1 if absent."""
        member, slot = np.nonzero(self.past.present[:, -1])
        people = np.unique(np.concatenate([self.past.id[member, slot], truth]))
        known = member * len(people) + np.searchsorted(people, self.past.id[member, slot])
        order = np.argsort(known)
        asked = window * len(people) + np.searchsorted(people, truth)
        place = np.minimum(np.searchsorted(known[order], asked), len(known) - 1)
        return np.where(known[order][place] == asked, slot[order][place], -1)

    def rows(self, window: Ints, slot: Ints, id: Ints, people: int) -> tuple[NDArray[np.float64], Bools]:
        """Return position ``[W, T, A, 2]`` [m] and present ``[W, T, A]`` of the tracks of these ids."""
        W, T = self.past.frame.shape
        position = np.zeros((W, T, people, 2))
        present = np.zeros((W, T, people), dtype=np.bool_)
        number = np.searchsorted(self.ids, id)
        for step in range(T):
            frame = self.past.frame[window, step]
            place = np.minimum(np.searchsorted(self.frames, frame), len(self.frames) - 1)
            key = place * len(self.ids) + number
            row = np.minimum(np.searchsorted(self.key, key), len(self.key) - 1)
            there = (self.frames[place] == frame) & (self.key[row] == key)
            position[window[there], step, slot[there]] = self.degraded.tracks.position[row[there]]
            present[window[there], step, slot[there]] = True
        return position, present


def _coast(position: NDArray[np.float64], present: Bools, window: Ints, slot: Ints) -> None:
    """Extrapolate tracks to the last row with the velocity of their last two rows."""
    T = position.shape[1]
    for w, a in zip(window.tolist(), slot.tolist(), strict=True):
        if present[w, -1, a]:
            continue
        seen = np.flatnonzero(present[w, :, a])
        last = seen[-1]
        step = np.zeros(2)
        if len(seen) > 1:
            step = (position[w, last, a] - position[w, seen[-2], a]) / (last - seen[-2])
        ahead = np.arange(1, T - last)
        position[w, last + 1 :, a] = position[w, last, a] + ahead[:, None] * step
        present[w, last + 1 :, a] = True
