"""Training data of AnchorNet and their augmentation."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data import Trajectories, Windows
from crowdbot.prediction.pretrained_weights import STEP
from crowdbot.prediction.training.samples import Samples
from crowdbot.typing import Floats

from .agent_frame import (
    PREDICTED_ROWS,
    ROWS,
    AgentHistories,
    agent_features,
    agent_histories,
    heading_vectors,
    interpolate_gaps,
    rotate,
)

DRIFT = 0.8
"""Correlation of drifting noise from row to row."""
AT_ONCE = 64
"""Approximate number of scenes of similar size per batch."""


class TrainingSet(NamedTuple):
    """Histories and futures of N people, in world axes, relative to their last position."""

    people: AgentHistories
    planned: AgentHistories
    """The same, with known futures of neighbors, as for robots with a plan."""
    ahead: Floats
    """``[N, 12, 2]`` [m] true futures."""

    def __len__(self) -> int:
        """Return the number of people."""
        return len(self.ahead)

    @property
    def digest(self) -> str:
        """Hash of all arrays; variances of a tracker count where they are known."""
        found = hashlib.blake2b(digest_size=12)
        found.update(np.ascontiguousarray(self.ahead).tobytes())
        for part in (self.people, self.planned):
            for name, array in part._asdict().items():
                if name != "noise" or np.isfinite(array).any():
                    found.update(np.ascontiguousarray(array).tobytes())
        return found.hexdigest()


class TrainingBatch(NamedTuple):
    """Inputs of the network and residuals to constant velocity."""

    own: Floats
    company: Floats
    there: NDArray[np.bool_]
    missed: Floats


@dataclasses.dataclass(frozen=True)
class Augmentation:
    """Data augmentation; shares are probabilities per person and batch.

    Fields:
        mirror: share of mirrored people.
        scale: standard deviation of the logarithm of a scale factor, limited to 0.4 to 2.5.
        grow: mean of this logarithm; values above 0 increase the share of fast people.
        turn: standard deviation of a heading error [rad].
        jitter: maximum standard deviation of the noise of all rows except the last [m]; it is uniformly distributed.
        noisy, noise: share of tracks with noise at every row, and its maximum standard deviation [m].
        correlated: share of tracks with noise that drifts, with a correlation of 0.8 from row to row, as that of
            trackers; its maximum standard deviation is ``noise``.
        holes, hole: share of tracks with missing rows, and the share of missing rows in them.
        late: share of tracks that start late, with 2 to 7 rows.
        switched: share of tracks whose older rows belong to the nearest neighbor.
        planned: share of people for whom the future of some neighbors is known.
        unseen: share of neighbors that are not observed.
        coarse: share of tracks observed at a slower clock, of 0.48 to 0.7 s, and interpolated to 0.4 s.
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
    coarse: float = 0.0
    correlated: float = 0.0


NO_AUGMENTATION = Augmentation(*(0.0,) * 15)
GENERAL = Augmentation(
    scale=0.35, jitter=0.03, noisy=0.35, holes=0.15, late=0.25, unseen=0.1, coarse=0.15, correlated=0.15
)
"""Augmentation of the weights for other places: more noise, shorter histories and other clocks."""


def training_set(recordings: Sequence[Trajectories], reverse: bool = True) -> TrainingSet:
    """Return all people with 8 + 12 rows at 0.4 s, and with ``reverse`` their time-reversed tracks.

    Raises:
        InputError: no recording, or a recording is not in metres at 0.4 s.
    """
    parts = []
    for tracks in recordings:
        if tracks.units != "m" or abs(tracks.dt - STEP) > 1e-6:
            raise InputError(
                f"{tracks.name} has steps of {tracks.dt:.4g} s in {tracks.units}; training requires 0.4 s and metres:"
                " set fps (25 for tracks with 10 frames per row of 0.4 s), or resample"
            )
        for item in (tracks, reverse_time(tracks)) if reverse else (tracks,):
            parts.append(_people(*item.windows()))
    if not parts:
        raise InputError("there is no training recording")
    return _material(parts)


def training_set_of(samples: Samples, reverse: bool = True) -> TrainingSet:
    """Return all people of the samples with 8 + 12 rows, and with ``reverse`` their time-reversed tracks.

    Raises:
        InputError: nobody with complete tracks, or other rows or units.
    """
    if (samples.observe, samples.predict, samples.units) != (ROWS, PREDICTED_ROWS, "m") or abs(
        samples.dt - STEP
    ) > 0.01 * STEP:
        raise InputError(
            f"anchor-net requires {ROWS} + {PREDICTED_ROWS} rows of {STEP} s in metres, {samples.names[0]} has"
            f" {samples.observe} + {samples.predict} rows of {samples.dt:.4g} s in {samples.units}; resample with"
            f" --step {STEP}"
        )
    if samples.people == 0:
        raise InputError("no person is present at all rows of a window: there is no training data")
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


def reverse_time(tracks: Trajectories) -> Trajectories:
    """Return the time-reversed tracks."""
    last = tracks.frame.max() + tracks.frame.min()
    return Trajectories(
        tracks.id, last - tracks.frame, tracks.x, tracks.y, row_rate=1.0 / tracks.dt, frame_step=tracks.frame_step,
        name=tracks.name,
    )  # fmt: skip


def make_batch(
    material: TrainingSet, rows: NDArray[np.int64], how: Augmentation, rng: np.random.Generator, reach: float = np.inf
) -> TrainingBatch:
    """Return a batch of augmented people, with neighbors within ``reach`` [m] and the features that belong to it."""
    people, ahead, seen_from = augment_people(material, rows, how, rng)
    people = people.within(reach)
    heading = heading_vectors(people.past)
    angle = how.turn * rng.standard_normal(len(rows))
    wrong = np.stack([np.cos(angle), -np.sin(angle)], axis=1)
    heading = rotate(heading, wrong)
    own, company = agent_features(people, heading, reach)
    step = people.past[:, -1] - people.past[:, -2]
    missed = ahead - seen_from - step[:, None] * np.arange(1.0, PREDICTED_ROWS + 1.0)[:, None]
    return TrainingBatch(own, company, people.there, rotate(missed, heading))


def augment_people(
    material: TrainingSet, rows: NDArray[np.int64], how: Augmentation, rng: np.random.Generator
) -> tuple[AgentHistories, Floats, Floats]:
    """Return augmented histories, futures and last positions, relative to the true last position."""
    N = len(rows)
    plain, planned = material.people.at(rows), material.planned.at(rows)
    knows = (rng.random(N) < how.planned)[:, None] & (rng.random(planned.known.shape) < 0.3) & planned.known
    later = np.where(knows[..., None, None], planned.later, plain.later)
    there = plain.there & (rng.random(plain.there.shape) >= how.unseen)
    size = np.clip(np.exp(how.grow + how.scale * rng.standard_normal(N)), 0.4, 2.5)
    factor = np.stack([size, size * np.where(rng.random(N) < how.mirror, -1.0, 1.0)], axis=1)
    past, ahead = plain.past * factor[:, None], material.ahead[rows] * factor[:, None]
    near, pace = plain.near * factor[:, None], plain.pace * factor[:, None]
    past = past if how.coarse == 0.0 else _observe_at_slower_clock(past, how, rng)
    past = past + _noise(N, past.shape[1], how, rng)
    past = _switch_identities(past, near, pace, how, rng)
    seen = _draw_observed_rows(past, plain.seen, how, rng)
    past = interpolate_gaps(past, seen)
    now = past[:, -1:]
    zero = there[..., None]
    people = AgentHistories(
        past - now, seen, plain.noise, np.where(zero, near - now, 0.0), np.where(zero, pace, 0.0),
        np.where(zero[..., None], later * factor[:, None, None] - now[:, None], 0.0), knows & there, there,
    )  # fmt: skip
    return people, ahead, now


def _observe_at_slower_clock(past: Floats, how: Augmentation, rng: np.random.Generator) -> Floats:
    """Return tracks ``[N, 8, 2]``, some of them interpolated between the rows of a slower clock."""
    N, T, _ = past.shape
    slow = np.where(rng.random(N) < how.coarse, rng.uniform(1.2, 1.75, N), 1.0)[:, None]
    back = np.arange(T - 1.0, -1.0, -1.0) / slow
    late = np.floor(back + 1e-9)
    share = (back - late)[..., None]
    return (1.0 - share) * _interpolate(past, late * slow) + share * _interpolate(past, (late + 1.0) * slow)


def _interpolate(past: Floats, back: Floats) -> Floats:
    """Return positions ``[N, M, 2]`` of tracks at times ``back [N, M]`` before the last row, in rows."""
    T = past.shape[1]
    row = np.clip(T - 1.0 - back, 0.0, T - 1.0)
    low = np.minimum(row.astype(np.int64), T - 2)
    share = (row - low)[..., None]
    one, other = (np.take_along_axis(past, (low + step)[..., None], axis=1) for step in (0, 1))
    return np.asarray(one + share * (other - one))


def _noise(count: int, rows: int, how: Augmentation, rng: np.random.Generator) -> Floats:
    """Return noise ``[N, 8, 2]`` [m]; for most tracks it is 0 at the last row."""
    small = how.jitter * rng.random(count)[:, None, None] * rng.standard_normal((count, rows, 2))
    small[:, -1] = 0.0
    large = how.noise * rng.random(count)[:, None, None] * rng.standard_normal((count, rows, 2))
    noise = np.where((rng.random(count) < how.noisy)[:, None, None], large, small)
    if how.correlated == 0.0:
        return noise
    drift = rng.standard_normal((count, rows, 2))
    for row in range(1, rows):
        drift[:, row] = DRIFT * drift[:, row - 1] + math.sqrt(1.0 - DRIFT**2) * drift[:, row]
    drift = how.noise * rng.random(count)[:, None, None] * drift
    return np.where((rng.random(count) < how.correlated)[:, None, None], drift, noise)


def _switch_identities(past: Floats, near: Floats, pace: Floats, how: Augmentation, rng: np.random.Generator) -> Floats:
    """Return tracks, some with an identity switch: earlier rows come from the nearest neighbor."""
    N, T, _ = past.shape
    row = np.arange(1.0 - T, 1.0)[:, None]
    other = near[:, :1] + pace[:, :1] * row
    close = np.hypot(near[:, 0, 0], near[:, 0, 1])
    from_row = rng.integers(1, T, size=(N, 1))
    chosen = (rng.random((N, 1)) < how.switched) & ((close > 0.0) & (close < 1.5))[:, None]
    return np.where((chosen & (np.arange(T) < from_row))[..., None], other, past)


def _draw_observed_rows(
    past: Floats, seen: NDArray[np.bool_], how: Augmentation, rng: np.random.Generator
) -> NDArray[np.bool_]:
    N, T = seen.shape
    hole = (rng.random((N, 1)) < how.holes) & (rng.random((N, T)) < how.hole)
    begin = np.where(rng.random((N, 1)) < how.late, T - rng.integers(2, T, size=(N, 1)), 0)
    kept = np.asarray(seen & ~hole & (np.arange(T) >= begin), dtype=np.bool_)
    kept[:, -1] = True
    few = kept.sum(axis=1) < 2
    kept[few, -2] = True
    return kept


def _people(past: Windows, future: Windows) -> TrainingSet:
    whole = np.asarray(future.present.all(axis=1))
    known = np.where(whole[:, None, :, None], future.position, np.nan)
    people, window, slot = agent_histories(past)
    planned, _, _ = agent_histories(dataclasses.replace(past, plan=known))
    kept = np.flatnonzero(future.scored[window, slot])
    window, slot = window[kept], slot[kept]
    ahead = future.position[window, :, slot] - past.position[window, -1, slot][:, None]
    return TrainingSet(people.at(kept), planned.at(kept), ahead)


def _material(parts: Sequence[TrainingSet]) -> TrainingSet:
    return TrainingSet(
        _concatenate([part.people for part in parts]),
        _concatenate([part.planned for part in parts]),
        np.concatenate([part.ahead for part in parts]),
    )


def _concatenate(parts: Sequence[AgentHistories]) -> AgentHistories:
    columns: list[Any] = [np.concatenate(values) for values in zip(*parts, strict=True)]
    return AgentHistories(*columns)
