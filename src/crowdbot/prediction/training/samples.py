"""Samples: training windows of several recordings, and padded batches of them."""

from __future__ import annotations

import dataclasses
import hashlib
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crowdbot.core import DataError, InputError, did_you_mean
from crowdbot.data import NoWindowError, Recording, Windows
from crowdbot.typing import Bools, Floats, Ints

FOLDS = {
    "eth": ("biwi_eth",),
    "hotel": ("biwi_hotel",),
    "univ": ("students001", "students003"),
    "zara1": ("crowds_zara01",),
    "zara2": ("crowds_zara02",),
}
"""Held-out files of each scene of the leave-one-out protocol (Gupta et al. 2018)."""
ENOUGH = 180.0
"""Minimum duration of a training recording in the report [s]."""
WATCHED = 5
"""How many times smaller the limit of a data set is in its validation."""
BUCKET = 16
"""Number of batches whose scenes are sorted by size together, to reduce padding."""


class DataSet(NamedTuple):
    """A name that several recordings share, and the largest number of scored futures of all of them; None: all."""

    name: str
    limit: int | None = None


class Scenes(NamedTuple):
    """A batch of S scenes, padded to A people.

    Fields:
        position: ``[S, T, A, 2]`` [m], observed rows first, then the future; 0 where a person is absent.
        there: ``[S, T, A]`` bool.
        scored: ``[S, A]`` bool: people with complete tracks, who count in losses and errors.
        here: ``[S, A]`` bool: people who are present at the last observed row.
    """

    position: Floats
    there: Bools
    scored: Bools
    here: Bools


@dataclass(frozen=True, eq=False)
class Samples:
    """S scenes (windows) with P people in total, ordered by scene.

    Fields:
        position: ``[P, T, 2]`` [m], observed rows first, then the future; 0 where a position is unknown.
        there: ``[P, T]`` bool.
        scored: ``[P]`` bool.
        first: ``[S + 1]`` the first person of each scene, then P.
        source: ``[S]`` index of the recording of each scene.
        names: names of the recordings.
        observe: number of observed rows, out of T.
        dt: time step [s].
        units: ``m`` or ``px``.
    """

    position: Floats
    there: Bools
    scored: Bools
    first: Ints
    source: Ints
    names: tuple[str, ...]
    observe: int
    dt: float
    units: str = "m"

    @classmethod
    def of(cls, recordings: Sequence[Recording]) -> Samples:
        """Return the samples of all windows of the recordings.

        Raises:
            InputError: there is no recording, or they differ in time step, units or rows.
            NoWindowError: a recording has no window, see :func:`recordings_with_windows`.
        """
        if not recordings:
            raise InputError("there is no training recording")
        return cls.concatenate([cls.from_windows(*recording.windows, recording.name) for recording in recordings])

    @classmethod
    def from_windows(cls, past: Windows, future: Windows, name: str = "") -> Samples:
        """Return the scenes of windows, with all people who are present at the last observed row."""
        window, person = np.nonzero(past.present[:, -1])
        place = np.concatenate([past.position, future.position], axis=1)
        there = np.concatenate([past.present, future.present], axis=1)
        return cls(
            position=place[window, :, person],
            there=there[window, :, person],
            scored=future.scored[window, person] & there[window, :, person].all(axis=1),
            first=np.searchsorted(window, np.arange(len(past) + 1)).astype(np.int64),
            source=np.zeros(len(past), dtype=np.int64),
            names=(name or past.source,),
            observe=past.position.shape[1],
            dt=past.dt,
            units=past.units,
        )

    @classmethod
    def concatenate(cls, parts: Sequence[Samples]) -> Samples:
        """Return the scenes of several samples, in order.

        Raises:
            InputError: they differ in time step, units or rows.
        """
        begin = parts[0]
        for part in parts[1:]:
            for what in ("units", "observe", "rows"):
                one, other = getattr(begin, what), getattr(part, what)
                if one != other:
                    raise InputError(f"{begin.names[0]} has {what} {one}, {part.names[0]} has {other}; make them equal")
            if abs(part.dt - begin.dt) > 0.01 * begin.dt:
                raise InputError(
                    f"{begin.names[0]} has a row every {begin.dt:.4g} s, {part.names[0]} every {part.dt:.4g} s;"
                    " resample them to the same time step with --step"
                )
        people = np.cumsum([0, *(len(part.position) for part in parts)])
        kinds = np.cumsum([0, *(len(part.names) for part in parts)])
        return dataclasses.replace(
            begin,
            position=np.concatenate([part.position for part in parts]),
            there=np.concatenate([part.there for part in parts]),
            scored=np.concatenate([part.scored for part in parts]),
            first=np.concatenate([*(p.first[:-1] + n for p, n in zip(parts, people, strict=False)), people[-1:]]),
            source=np.concatenate([part.source + n for part, n in zip(parts, kinds, strict=False)]),
            names=tuple(name for part in parts for name in part.names),
        )

    def __len__(self) -> int:
        """Return the number of scenes."""
        return len(self.first) - 1

    @property
    def rows(self) -> int:
        """Number T of observed and future rows."""
        return int(self.position.shape[1])

    @property
    def predict(self) -> int:
        """Number of future rows."""
        return self.rows - self.observe

    @property
    def people(self) -> int:
        """Number of people with a scored future."""
        return int(self.scored.sum())

    @property
    def digest(self) -> str:
        """Hash of the samples."""
        found = hashlib.blake2b(repr((self.names, self.observe, self.dt, self.units)).encode(), digest_size=12)
        for array in (self.position, self.there, self.scored, self.first, self.source):
            found.update(np.ascontiguousarray(array).tobytes())
        return found.hexdigest()

    def select(self, scenes: Ints | Bools) -> Samples:
        """Return some of the scenes."""
        number = np.arange(len(self))[scenes]
        count = np.diff(self.first)[number]
        first = np.concatenate([[0], np.cumsum(count)])
        person = np.repeat(self.first[number] - first[:-1], count) + np.arange(first[-1])
        arrays = {name: getattr(self, name)[person] for name in ("position", "there", "scored")}
        return dataclasses.replace(self, **arrays, first=first, source=self.source[number])

    def subsample(self, most: int) -> Samples:
        """Return at most ``most`` evenly spaced scenes."""
        return self if len(self) <= most else self.select(np.linspace(0, len(self) - 1, most).round().astype(np.int64))

    def limit(self, people: int) -> Samples:
        """Return evenly spaced scenes with about ``people`` scored people; all scenes if there are not more."""
        if self.people <= people:
            return self
        return self.subsample(max(1, round(len(self) * people / self.people)))

    def balance(self, sets: Sequence[DataSet], watched: bool = False) -> Samples:
        """Return evenly spaced scenes of each data set, with about as many scored people as its limit at most.

        Limits that are the same for several data sets balance a training on all of them.

        Args:
            sets: the data set of each recording, one for each of ``names``.
            watched: validation samples: a fifth of the limits.
        """
        parts = []
        for data_set in dict.fromkeys(sets):
            own = self.select(np.isin(self.source, [place for place, other in enumerate(sets) if other == data_set]))
            limit = data_set.limit
            parts.append(own if limit is None else own.limit(max(1, limit // (WATCHED if watched else 1))))
        source = np.concatenate([part.source for part in parts])
        return dataclasses.replace(Samples.concatenate(parts), source=source, names=self.names)

    def batch(self, scenes: Ints) -> Scenes:
        """Return some scenes as padded arrays."""
        start, count = self.first[scenes], np.diff(self.first)[scenes]
        slot = np.arange(max(1, int(count.max(initial=1))))
        here = slot < count[:, None]
        person = np.where(here, start[:, None] + slot, 0)
        there = self.there[person] & here[..., None]
        place = np.where(there[..., None], self.position[person], 0.0)
        return Scenes(place.swapaxes(1, 2), there.swapaxes(1, 2), self.scored[person] & here, here)

    def batches(self, rng: np.random.Generator, people: int) -> list[Ints]:
        """Return random batches of approximately the given number of scored people; each scene is used once.

        Scenes without scored people are skipped. Batches contain scenes of similar size, which reduces padding.
        """
        counted = np.add.reduceat(np.append(self.scored, False).astype(np.int64), self.first[:-1])
        counted[np.diff(self.first) == 0] = 0
        order = rng.permutation(np.flatnonzero(counted > 0))
        found: list[Ints] = []
        bucket = np.cumsum(counted[order]) // max(1, BUCKET * people)
        for part in np.split(order, np.flatnonzero(np.diff(bucket)) + 1):
            ranked = part[np.argsort(np.diff(self.first)[part], kind="stable")]
            from_windows = (np.cumsum(counted[ranked]) - 1) // max(1, people)
            found += np.split(ranked, np.flatnonzero(np.diff(from_windows)) + 1)
        return [found[number] for number in rng.permutation(len(found))]


def leave_out(recordings: Sequence[Recording], name: str) -> tuple[list[Recording], list[Recording]]:
    """Return the training recordings and the held-out recordings.

    Args:
        recordings: all recordings.
        name: a scene of the leave-one-out protocol (eth, hotel, univ, zara1, zara2), or the beginning or a word of a
            file name; if no file matches, of a folder name.

    Raises:
        InputError: no recording has this name, or none is left.
    """
    begins = tuple(begin.lower() for begin in (*FOLDS.get(name, ()), name))
    stems = [Path(recording.path).stem.lower() for recording in recordings]
    folders = [Path(recording.path).parent.name.lower() for recording in recordings]
    named = [_is_named(stem, begins) for stem in stems]
    if not any(named):  # obsmat.txt is in a folder with the name of the scene
        named = [_is_named(folder, begins) for folder in folders]
    out = [recording for recording, is_out in zip(recordings, named, strict=True) if is_out]
    kept = [recording for recording, is_out in zip(recordings, named, strict=True) if not is_out]
    if not out:
        near = did_you_mean(name, [*FOLDS, *stems])
        raise InputError(f"no recording matches {name!r}{near}; known are {', '.join(sorted(set(stems)))}")
    if not kept:
        raise InputError(f"{name!r} excludes all {len(out)} recordings; no training recording is left")
    return kept, out


def _is_named(text: str, begins: tuple[str, ...]) -> bool:
    words = re.split(r"[^a-z0-9]+", text)
    return any(text.startswith(begin) or begin in words for begin in begins)


def recordings_with_windows(recordings: Sequence[Recording]) -> tuple[list[Recording], list[Recording]]:
    """Return the recordings that have a window, and those that have none, for example because they are too short.

    Raises:
        NoWindowError: no recording has a window.
        DataError: a recording cannot be read.
    """
    kept, left, reason = list[Recording](), list[Recording](), ""
    for recording in recordings:
        try:
            _ = recording.windows
        except NoWindowError as error:
            left.append(recording)
            reason = reason or str(error)
        else:
            kept.append(recording)
    if left and not kept:
        others = f"; nor has any other of {len(left)} recordings" if len(left) > 1 else ""
        raise NoWindowError(f"{reason}{others}")
    return kept, left


class TimeSplit(NamedTuple):
    """Training and validation samples without common rows.

    Fields:
        training, validation: the samples.
        whole_training, whole_validation: names of the recordings that are too short to be cut, and therefore in one of
            the two as a whole.
    """

    training: Samples
    validation: Samples
    whole_training: tuple[str, ...] = ()
    whole_validation: tuple[str, ...] = ()


def split_in_time(recordings: Sequence[Recording], share: float, sets: Sequence[DataSet] = ()) -> TimeSplit:
    """Split recordings in time into training scenes and validation scenes without common rows.

    The last ``share`` of the windows of each recording is for validation. A recording that is too short for that is
    used as a whole: with a share of 0.2, every fifth of them for validation; the last one if there is no other
    validation.

    Args:
        recordings: the recordings.
        share: share of the windows of each for validation.
        sets: the data set of each recording, see :meth:`Samples.balance`; validation has a fifth of the limits.

    Raises:
        InputError: the share is not between 0 and 1.
        NoWindowError: a recording has no window.
        DataError: no scene is left on one side.
    """
    if not 0.0 < share < 1.0:
        raise InputError(f"the validation share {share} must be above 0 and below 1")
    sides: dict[int, tuple[Samples | None, Samples | None]] = {}
    whole: list[tuple[int, Samples]] = []
    for place, recording in enumerate(recordings):
        past, future = recording.windows
        border = past.frame[min(len(past) - 1, int(len(past) * (1.0 - share))), 0]
        before, after = future.frame[:, -1] < border, past.frame[:, 0] >= border
        if before.any() and after.any():
            early = Samples.from_windows(past[before], future[before], recording.name)
            sides[place] = early, Samples.from_windows(past[after], future[after], recording.name)
        else:
            whole.append((place, Samples.from_windows(past, future, recording.name)))
    if whole and len(recordings) == 1:
        raise DataError(
            f"{recordings[0].path}: {len(whole[0][1])} windows are too few for a validation share of {share:.0%}"
        )
    late = {place for rank, (place, _) in enumerate(whole) if _is_due(rank, share)}
    if not sides and not late:
        late = {whole[-1][0]}
    sides |= {place: (None, part) if place in late else (part, None) for place, part in whole}

    def joined(side: int) -> Samples:
        kept = [place for place in range(len(recordings)) if sides[place][side] is not None]
        samples = Samples.concatenate([part for place in kept if (part := sides[place][side]) is not None])
        return samples.balance([sets[place] for place in kept], bool(side)) if sets else samples

    return TimeSplit(
        joined(0),
        joined(1),
        tuple(recordings[place].name for place, _ in whole if place not in late),
        tuple(recordings[place].name for place, _ in whole if place in late),
    )


def _is_due(rank: int, share: float) -> bool:
    """Return whether the number of validation recordings grows at this one: every fifth with a share of 0.2."""
    return math.floor((rank + 1) * share + 1e-9) > math.floor(rank * share + 1e-9)


def short_recordings(recordings: Sequence[Recording]) -> list[str]:
    """Return a warning for each recording shorter than 3 minutes; one for all if more than three are."""
    found = [(recording.name, float(recording.rest.time[-1] - recording.rest.time[0])) for recording in recordings]
    short = [(name, seconds) for name, seconds in found if seconds < ENOUGH]
    if len(short) > 3:
        low, high = min(short, key=lambda one: one[1])[1], max(short, key=lambda one: one[1])[1]
        return [
            f"{len(short)} of {len(found)} recordings have {low:.0f} to {high:.0f} s;"
            " more than 3 minutes are recommended for training"
        ]
    return [f"{name} has {seconds:.0f} s; more than 3 minutes are recommended for training" for name, seconds in short]
