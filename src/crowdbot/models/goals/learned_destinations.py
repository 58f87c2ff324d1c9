"""LearnedDestinations: goal estimator learned from recordings of the same place."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, check_parameters, kernel, parameter
from crowdbot.data import Trajectories, Windows
from crowdbot.typing import Floats, Ints

from .exits import clusters, track_ends
from .goal import Choices, Goal
from .headings import MOVING, angle_between, extrapolate, length, rotate, unit
from .learned_velocity import LearnedVelocity, mean_velocity, pairs_of

WIDEST = math.pi / 2
"""Largest turn in the histogram [rad]."""
BINS = 61
"""Number of bins, 3 degrees apart; a sample is split between the two nearest bins."""


class TurnSamples(NamedTuple):
    """M rows of recordings as samples of the histogram.

    Fields:
        place: position ``[M, 2]`` [m].
        heading: unit vector of the velocity ``[M, 2]``.
        turn: turn after ``lookahead`` ``[M]`` [rad].
        worth: weight of the sample ``[M]``.
        straight: fraction of the sample that counts as straight on ``[M]``.
        exit: index of the exit at the end of the track ``[M]``, or the number of exits if unknown.
    """

    place: Floats
    heading: Floats
    turn: Floats
    worth: Floats
    straight: Floats
    exit: Ints


@kernel
def accumulate(
    place: Floats, heading: Floats, samples: TurnSamples, exits: int, reach: float, spread: float, histogram: Floats
) -> None:
    """Fill ``histogram [P, exits + 2, BINS]`` for people ``[P, 2]``: straight on, each exit, exit unknown.

    The weight of a sample is (1 - d/8)^4, d the squared distance in units of ``reach`` [m] plus the squared difference
    of headings in units of ``spread``. This approximates a Gaussian, and is 0 beyond d = 8.
    """
    step = 2.0 * WIDEST / (BINS - 1)
    farthest = 8.0 * reach * reach
    for person in range(place.shape[0]):
        for sample in range(samples.place.shape[0]):
            dx = samples.place[sample, 0] - place[person, 0]
            dy = samples.place[sample, 1] - place[person, 1]
            apart = dx * dx + dy * dy
            if apart >= farthest:
                continue
            hx = samples.heading[sample, 0] - heading[person, 0]
            hy = samples.heading[sample, 1] - heading[person, 1]
            near = 1.0 - (apart / (reach * reach) + (hx * hx + hy * hy) / (spread * spread)) / 8.0
            if near <= 0.0:
                continue
            weight = near * near * near * near * samples.worth[sample]
            at = (min(WIDEST, max(-WIDEST, samples.turn[sample])) + WIDEST) / step
            low = min(int(at), BINS - 2)
            share = at - low
            for layer, part in (
                (0, samples.straight[sample]),
                (1 + samples.exit[sample], 1.0 - samples.straight[sample]),
            ):
                histogram[person, layer, low] += weight * part * (1.0 - share)
                histogram[person, layer, low + 1] += weight * part * share


def median_turn(histogram: Floats, doubt: float = 0.0) -> Floats:
    """Return the median turn [rad] of ``histogram [..., BINS]`` plus a weight ``doubt`` for no turn; 0 if empty.

    >>> import numpy as np
    >>> histogram = np.zeros(BINS)
    >>> histogram[40] = 3.0
    >>> [round(float(np.degrees(median_turn(histogram, doubt))), 1) for doubt in (0.0, 1.0, 3.0, 30.0)]
    [30.0, 29.0, 3.0, 0.3]
    """
    counted = histogram.copy()
    counted[..., BINS // 2] += doubt
    total = np.cumsum(counted, axis=-1)
    # weights are spread uniformly within a bin, which makes the median continuous
    middle = total - 0.5 * counted
    half = 0.5 * total[..., -1:]
    above = np.clip(np.sum(middle < half, axis=-1, keepdims=True), 1, BINS - 1)
    start = np.take_along_axis(middle, above - 1, axis=-1)
    end = np.take_along_axis(middle, above, axis=-1)
    share = np.clip((half - start) / np.where(end > start, end - start, 1.0), 0.0, 1.0)
    turn = (above - 1 + share)[..., 0] * (2.0 * WIDEST / (BINS - 1)) - WIDEST
    return np.where(total[..., -1] > 0.0, turn, 0.0)


BENNEWITZ = Paper(
    "Bennewitz, Burgard, Cielniak, Thrun",
    2005,
    "Learning motion patterns of people for compliant robot motion",
    "International Journal of Robotics Research 24(1)",
)
STRAIGHT = np.radians(15.0)
"""Turns below this angle [rad] count partly as straight on."""
RAREST = 0.02
"""Minimum fraction of all track ends at an exit; at least two."""
MOST_VOTERS = 20_000
"""Maximum number of stored rows; above it, every k-th row is stored."""
CHUNK_PEOPLE = 512
"""Number of people processed at the same time."""


@dataclass(frozen=True, eq=False)
class LearnedDestinations(Goal):
    """Destinations of recorded people with a similar position and heading.

    Created by :meth:`learn`. The ends of the recorded tracks are clustered into exits. Each recorded row is a sample
    with position, heading, turn after ``lookahead`` and exit. The samples are weighted by the similarity of position
    and heading. Their weights for each exit (and for straight on) are the weights of :meth:`choices`, and their median
    turn is the direction to that exit. :meth:`resolve` returns the median turn of all samples and a prior for no turn;
    without samples, people walk straight on. The velocity is also learned, as a weighted mean of displacements.

    All goals are ``horizon`` ahead in the predicted direction, since crowd models walk straight to a goal. Positions of
    exits are in ``exits``.

    Fields:
        exits: positions of exits ``[G, 2]`` [m].
        samples: rows of the recordings.
        pace: learned velocity.
        reach: standard deviation of the distance of samples [m].
        spread: standard deviation of the heading difference [rad].
        doubt: weight of the prior for no turn [m/s].
        horizon: distance of the goals as time at the learned velocity [s].

    Raises:
        InputError: a value is not allowed; on use, windows are in pixels.

    Source: based on Bennewitz et al. (2005), who cluster whole tracks.
    """

    exits: Floats
    samples: TurnSamples
    pace: LearnedVelocity
    reach: float = parameter(1.5, unit="m", low=0.5, high=3.0, source="crowdbot", min=0.05)
    spread: float = parameter(0.15, unit="rad", low=0.05, high=0.6, source="crowdbot", min=0.01)
    doubt: float = parameter(5.0, unit="m/s", low=0.0, high=50.0, source="crowdbot", min=0.0)
    horizon: float = parameter(20.0, unit="s", low=5.0, high=60.0, source="crowdbot", min=0.1)

    learns: ClassVar[bool] = True
    paper: ClassVar[Paper] = BENNEWITZ

    def __post_init__(self) -> None:
        check_parameters(self)

    @classmethod
    def learn(
        cls,
        *recordings: Trajectories,
        observe: int = 8,
        lookahead: float = 1.6,
        width: float = 3.0,
        **values: Any,
    ) -> Self:
        """Return the goal learned from recordings of one place.

        Args:
            recordings: recordings of the place, in metres, with one time step; exclude the test data.
            observe: maximum number of rows for the learned velocity.
            lookahead: time for which the direction is learned [s]; from a third of the prediction time to all of it.
            width: width of an exit [m].
            values: fields ``reach``, ``spread``, ``doubt`` and ``horizon``.

        Raises:
            InputError: no recording is given, they are in pixels or differ in time step, or a value is not allowed.
            DataError: a recording has no window of sufficient length.
        """
        if not 0.0 < width < np.inf:
            raise InputError(f"learned-destinations: width = {width} m must be finite and above 0")
        pairs = pairs_of(recordings, observe, lookahead)
        pace = LearnedVelocity.fit(pairs)
        ends = [track_ends(tracks) for tracks in recordings]
        left = np.concatenate([place[gone] for _, place, gone in ends])
        exits = clusters(left, width, max(2, round(RAREST * len(left)))) if len(left) else np.zeros((0, 2))
        parts = [
            _turn_samples(past, future, pace, _exit_of(past.id, *end, exits, width))
            for (past, future), end in zip(pairs, ends, strict=True)
        ]
        every = max(1, -(-sum(len(part.turn) for part in parts) // MOST_VOTERS))
        samples = TurnSamples(
            *(np.ascontiguousarray(np.concatenate(column)[::every]) for column in zip(*parts, strict=True))
        )
        return cls(exits, samples, pace, **values)

    @property
    def history(self) -> float:
        return self.pace.history

    def velocity(self, past: Windows) -> Floats:
        return self.pace.velocity(past)

    def resolve(self, past: Windows) -> Floats:
        velocity, here = self.velocity(past), past.present[:, -1]
        moving = here & (length(velocity) > MOVING)
        turn = np.zeros(here.shape)
        if np.any(moving):
            turn[moving] = self._turn_histograms(past.position[:, -1][moving], velocity[moving], False)[0]
        return extrapolate(past.position[:, -1], here, rotate(velocity, turn), self.horizon)

    def choices(self, past: Windows) -> Choices:
        # straight on (slot 0) and the direction to each exit (slots 1 to G), weighted by the samples
        velocity, here = self.velocity(past), past.present[:, -1]
        weight = np.zeros((*here.shape, len(self.exits) + 1))
        turn = np.zeros(weight.shape)
        weight[here, 0] = 1.0
        moving = here & (length(velocity) > MOVING)
        if np.any(moving):
            _, weight[moving], turn[moving] = self._turn_histograms(
                past.position[:, -1][moving], velocity[moving], True
            )
        place = np.where(here[..., None], past.position[:, -1], 0.0)
        way = np.where(here[..., None, None], rotate(velocity[:, :, None], turn), 0.0)
        return Choices(place[:, :, None] + self.horizon * way, weight)

    def _turn_histograms(self, place: Floats, velocity: Floats, by_exit: bool) -> tuple[Floats, Floats, Floats]:
        """Return the median turn ``[P]``, and weight and turn by exit ``[P, G + 1]``, of people ``[P, 2]``."""
        count, ways = len(place), len(self.exits) + 1
        heading = unit(velocity)
        middle, weight, turn = np.zeros(count), np.zeros((count, ways)), np.zeros((count, ways))
        for first in range(0, count, CHUNK_PEOPLE):
            part = slice(first, min(first + CHUNK_PEOPLE, count))
            histogram = np.zeros((part.stop - first, ways + 1, BINS))
            people = np.ascontiguousarray(place[part]), heading[part]
            accumulate(*people, self.samples, len(self.exits), self.reach, self.spread, histogram)
            middle[part] = median_turn(np.sum(histogram, axis=1), self.doubt)
            if by_exit:
                known = np.sum(histogram[:, :ways], axis=2)
                known[:, 0] += max(self.doubt, 1e-9)
                weight[part] = known / np.sum(known, axis=1, keepdims=True)
                turn[part] = median_turn(histogram[:, :ways])
                turn[part, 0] = median_turn(histogram[:, 0], self.doubt)
        return middle, weight, turn


def _exit_of(
    id: NDArray[np.int64],
    people: NDArray[np.int64],
    place: Floats,
    gone: NDArray[np.bool_],
    exits: Floats,
    width: float,
) -> NDArray[np.int64]:
    """Return the index of the exit ``[W, A]`` where each person's track ends, or the number of exits if unknown."""
    known = np.full(len(people), len(exits))
    if len(exits):
        away = length(place[:, None] - exits)
        nearest = np.argmin(away, axis=1)
        known = np.where(gone & (away.min(axis=1) <= width), nearest, known)
    return np.asarray(known[np.clip(np.searchsorted(people, id), 0, len(people) - 1)], dtype=np.int64)


def _turn_samples(past: Windows, future: Windows, pace: LearnedVelocity, exit: NDArray[np.int64]) -> TurnSamples:
    velocity, after = pace.velocity(past), mean_velocity(past, future)
    voting = future.scored & (length(velocity) > MOVING)
    turn = np.where(length(after) > MOVING, angle_between(velocity, after), 0.0)[voting]
    return TurnSamples(
        past.position[:, -1][voting],
        unit(velocity[voting]),
        turn,
        length(velocity[voting]),
        np.maximum(0.0, 1.0 - np.abs(turn) / STRAIGHT),
        exit[voting],
    )
