"""What the anchor network learns from: people of training recordings, and how each is varied before it is seen."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data import Trajectories, Windows
from crowdbot.prediction.pretrained_weights import STEP
from crowdbot.prediction.training.samples import Samples

from .agent_frame import AHEAD, ROWS, People, completed, features, forward, people_of, turned

__all__ = ["Batch", "Material", "Variation", "backwards", "batch", "gathered", "material_of"]

Floats = NDArray[np.float64]

AT_ONCE = 64
"""About so many scenes, of nearly the same size, are laid out together."""


class Material(NamedTuple):
    """N people to learn from, in the axes of the world, seen from their last place."""

    people: People
    planned: People
    """The same with the neighbours whose future is known walking there, as a robot with a plan does."""
    ahead: Floats
    """``[N, 12, 2]`` [m] where they went."""

    def __len__(self) -> int:
        """Return the number of people."""
        return len(self.ahead)

    @property
    def digest(self) -> str:
        """Hash of where everyone was, went, and who was near."""
        found = hashlib.blake2b(digest_size=12)
        for array in (self.ahead, *self.people, *self.planned):
            found.update(np.ascontiguousarray(array).tobytes())
        return found.hexdigest()


class Batch(NamedTuple):
    """What the network is shown: own numbers, neighbours, and what constant velocity misses."""

    own: Floats
    company: Floats
    there: NDArray[np.bool_]
    missed: Floats


@dataclasses.dataclass(frozen=True)
class Variation:
    """How people are varied; a share is a probability for each person and batch.

    Fields:
        mirror: share of mirrored people.
        scale: standard deviation of the logarithm of a common factor, kept within 0.4 to 2.5.
        grow: mean of that logarithm; above 0 fast walkers are shown more often.
        turn: standard deviation of an error of the heading [rad].
        jitter: noise of each row but the last, uniform up to this standard deviation [m].
        noisy, noise: share of tracks with noise at every row, and its largest standard deviation [m].
        holes, hole: share of tracks with rows missing, and the share of their rows.
        late: share of tracks that begin late, with 2 to 7 rows.
        switched: share of tracks whose older rows belong to the nearest neighbour.
        planned: share of people who know where some neighbours go.
        unseen: share of neighbours that are not seen.
    """

    mirror: float = 0.5
    scale: float = 0.3
    grow: float = 0.0
    turn: float = 0.1
    jitter: float = 0.02
    noisy: float = 0.1
    noise: float = 0.1
    holes: float = 0.1
    hole: float = 0.3
    late: float = 0.08
    switched: float = 0.03
    planned: float = 0.1
    unseen: float = 0.05


NONE = Variation(*(0.0,) * 13)


def gathered(recordings: Sequence[Trajectories], reverse: bool = True) -> Material:
    """Return everyone who is seen over 8 + 12 rows at 0.4 s, and with ``reverse`` also as if time ran backwards.

    Raises:
        InputError: there is nobody, or a recording is not in metres at 0.4 s.
    """
    parts = []
    for tracks in recordings:
        if tracks.units != "m" or abs(tracks.dt - STEP) > 1e-6:
            raise InputError(
                f"{tracks.name} has steps of {tracks.dt:.4g} s in {tracks.units}; learning needs 0.4 s in metres:"
                " give fps (0.4 s are 10 frames at fps=25), or resample"
            )
        for one in (tracks, backwards(tracks)) if reverse else (tracks,):
            parts.append(_people(*one.windows()))
    if not parts:
        raise InputError("there is no recording to learn from")
    return _material(parts)


def material_of(samples: Samples, reverse: bool = True) -> Material:
    """Return everyone of the samples who is seen over 8 + 12 rows, and with ``reverse`` also as if time ran backwards.

    Backwards, only those are near who were there at both ends of the observed rows.

    Raises:
        InputError: there is nobody, or rows or units do not fit.
    """
    if (samples.observe, samples.predict, samples.units) != (ROWS, AHEAD, "m") or abs(samples.dt - STEP) > 0.01 * STEP:
        raise InputError(
            f"anchor-net learns {ROWS} + {AHEAD} rows of {STEP} s in metres, {samples.names[0]} is cut into"
            f" {samples.observe} + {samples.predict} rows of {samples.dt:.4g} s in {samples.units}; resample with"
            f" --step {STEP}"
        )
    if samples.people == 0:
        raise InputError("nobody is there at all rows of any window: there is nothing to learn from")
    parts = []
    size = np.diff(samples.first)
    for scenes in np.array_split(np.argsort(size, kind="stable"), max(1, len(samples) // AT_ONCE)):
        place, there, scored, _ = samples.batch(scenes)
        for way in (1, -1) if reverse else (1,):
            parts.append(_people(*_windows(place[:, ::way], there[:, ::way], scored, samples.names[0])))
    return _material(parts)


def _windows(place: Floats, there: NDArray[np.bool_], scored: NDArray[np.bool_], name: str) -> tuple[Windows, Windows]:
    S, T, A, _ = place.shape
    id, nobody = np.tile(np.arange(A), (S, 1)), np.zeros((S, A), dtype=np.bool_)
    past, future = (
        Windows(place[:, rows], there[:, rows], who, nobody, id, np.tile(np.arange(T)[rows], (S, 1)), STEP, "all", name)
        for rows, who in ((slice(0, ROWS), nobody), (slice(ROWS, T), scored))
    )
    return past, future


def backwards(tracks: Trajectories) -> Trajectories:
    """Return the tracks as if time ran backwards; people walk alike."""
    last = tracks.frame.max() + tracks.frame.min()
    return Trajectories(
        tracks.id, last - tracks.frame, tracks.x, tracks.y, row_rate=1.0 / tracks.dt, frame_step=tracks.frame_step,
        name=tracks.name,
    )  # fmt: skip


def batch(material: Material, rows: NDArray[np.int64], how: Variation, rng: np.random.Generator) -> Batch:
    """Return the people ``rows`` of the material, varied."""
    people, ahead, seen_from = _varied(material, rows, how, rng)
    heading = forward(people.past)
    angle = how.turn * rng.standard_normal(len(rows))
    wrong = np.stack([np.cos(angle), -np.sin(angle)], axis=1)
    heading = turned(heading, wrong)
    own, company = features(people, heading)
    step = people.past[:, -1] - people.past[:, -2]
    missed = ahead - seen_from - step[:, None] * np.arange(1.0, AHEAD + 1.0)[:, None]
    return Batch(own, company, people.there, turned(missed, heading))


def _varied(
    material: Material, rows: NDArray[np.int64], how: Variation, rng: np.random.Generator
) -> tuple[People, Floats, Floats]:
    """Return people, where they went, and where they were seen last, all from the true last place."""
    N = len(rows)
    plain, planned = material.people.at(rows), material.planned.at(rows)
    knows = (rng.random(N) < how.planned)[:, None] & (rng.random(planned.known.shape) < 0.3) & planned.known
    later = np.where(knows[..., None, None], planned.later, plain.later)
    there = plain.there & (rng.random(plain.there.shape) >= how.unseen)
    size = np.clip(np.exp(how.grow + how.scale * rng.standard_normal(N)), 0.4, 2.5)
    factor = np.stack([size, size * np.where(rng.random(N) < how.mirror, -1.0, 1.0)], axis=1)
    past, ahead = plain.past * factor[:, None], material.ahead[rows] * factor[:, None]
    near, pace = plain.near * factor[:, None], plain.pace * factor[:, None]
    past = past + _noise(N, past.shape[1], how, rng)
    past = _switched(past, near, pace, how, rng)
    seen = _rows_seen(past, plain.seen, how, rng)
    past = completed(past, seen)
    now = past[:, -1:]
    zero = there[..., None]
    people = People(
        past - now, seen, np.where(zero, near - now, 0.0), np.where(zero, pace, 0.0),
        np.where(zero[..., None], later * factor[:, None, None] - now[:, None], 0.0), knows & there, there,
    )  # fmt: skip
    return people, ahead, now


def _noise(count: int, rows: int, how: Variation, rng: np.random.Generator) -> Floats:
    """Return ``[N, 8, 2]`` [m]; most tracks are right at the last row."""
    small = how.jitter * rng.random(count)[:, None, None] * rng.standard_normal((count, rows, 2))
    small[:, -1] = 0.0
    large = how.noise * rng.random(count)[:, None, None] * rng.standard_normal((count, rows, 2))
    return np.where((rng.random(count) < how.noisy)[:, None, None], large, small)


def _switched(past: Floats, near: Floats, pace: Floats, how: Variation, rng: np.random.Generator) -> Floats:
    """Return tracks, some with the older rows of the nearest neighbour, who walked evenly."""
    N, T, _ = past.shape
    row = np.arange(1.0 - T, 1.0)[:, None]
    other = near[:, :1] + pace[:, :1] * row
    close = np.hypot(near[:, 0, 0], near[:, 0, 1])
    from_row = rng.integers(1, T, size=(N, 1))
    chosen = (rng.random((N, 1)) < how.switched) & ((close > 0.0) & (close < 1.5))[:, None]
    return np.where((chosen & (np.arange(T) < from_row))[..., None], other, past)


def _rows_seen(past: Floats, seen: NDArray[np.bool_], how: Variation, rng: np.random.Generator) -> NDArray[np.bool_]:
    N, T = seen.shape
    hole = (rng.random((N, 1)) < how.holes) & (rng.random((N, T)) < how.hole)
    begin = np.where(rng.random((N, 1)) < how.late, T - rng.integers(2, T, size=(N, 1)), 0)
    kept = np.asarray(seen & ~hole & (np.arange(T) >= begin), dtype=np.bool_)
    kept[:, -1] = True
    few = kept.sum(axis=1) < 2
    kept[few, -2] = True
    return kept


def _people(past: Windows, future: Windows) -> Material:
    whole = np.asarray(future.present.all(axis=1))
    known = np.where(whole[:, None, :, None], future.position, np.nan)
    people, window, slot = people_of(past)
    planned, _, _ = people_of(dataclasses.replace(past, plan=known))
    kept = np.flatnonzero(future.scored[window, slot])
    window, slot = window[kept], slot[kept]
    ahead = future.position[window, :, slot] - past.position[window, -1, slot][:, None]
    return Material(people.at(kept), planned.at(kept), ahead)


def _material(parts: Sequence[Material]) -> Material:
    return Material(
        _joined([part.people for part in parts]),
        _joined([part.planned for part in parts]),
        np.concatenate([part.ahead for part in parts]),
    )


def _joined(parts: Sequence[People]) -> People:
    columns: list[Any] = [np.concatenate(values) for values in zip(*parts, strict=True)]
    return People(*columns)
