"""GlobalNearestNeighbor and InteractingMultipleModel: Kalman filters with one detection for each track."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError, check_number
from crowdbot.typing import Bools, Floats, Ints

from .detections import Detections
from .motion_filter import FilterState, Innovation, correct, innovation, mix, predict, start
from .predictor_motion import PredictorMotion
from .tracker import Tracker
from .tracker_state import TrackerState
from .tracks import Tracks

FORBIDDEN = 1e6
"""Cost of a pair outside the gate."""


class Association(NamedTuple):
    """N filters after D detections."""

    filters: FilterState
    existence: Floats
    """``[N]`` probability that there is a person."""
    detected: Bools
    """``[N]`` whether the person was detected."""
    used: Bools
    """``[D]`` whether the detection belongs to a track."""


@dataclass(frozen=True, kw_only=True)
class GlobalNearestNeighbor(Tracker):
    """Gated global nearest neighbour with a Kalman filter of constant velocity for each person.

    The assignment of detections to tracks minimizes the sum of squared Mahalanobis distances and log determinants
    (Blackman and Popoli (1999), Design and analysis of modern tracking systems, section 6.5), by the Hungarian method.
    The probability that a person exists follows integrated data association (Musicki, Evans and Stankovic (1994),
    Integrated probabilistic data association, doi 10.1109/9.293185), with the detection probability reduced where the
    coverage of the detections says that a person would be hidden: tracks survive occlusions.

    Fields:
        acceleration: spectral density of the acceleration of people [m^2/s^3].
        gate: largest squared Mahalanobis distance of a pair; 13.8 holds 99.9 %.
        detection: probability that a visible person is detected.
        clutter: density of false detections [1/m^2].
        birth: probability that a new detection is a person.
        confirm: probability of existence from which a track is reported.
        drop: probability of existence below which a track ends.
        coast: time without detection after which a track ends [s].
        apart: distance from a track within which no new track begins [m].
        speed: standard deviation of the speed of a new track, in each direction [m/s].
        motion: predictor whose forecast moves people between detections; default: constant velocity.

    Raises:
        InputError: a value is not allowed.

    >>> tracker = GlobalNearestNeighbor()
    >>> state = tracker.begin()
    >>> for k in range(10):
    ...     tracks, state = tracker.update(Detections.of(0.1 * k, [[0.12 * k, 1.0]], 0.05), 0.1 * k, state)
    >>> tracks.ids.tolist(), tracks.velocity.round(1).tolist()
    ([0], [[1.2, 0.0]])
    """

    acceleration: float = 0.5
    gate: float = 13.8
    detection: float = 0.9
    clutter: float = 0.3
    birth: float = 0.3
    confirm: float = 0.85
    drop: float = 0.05
    coast: float = 2.0
    apart: float = 0.35
    speed: float = 1.0
    motion: PredictorMotion | None = None

    def __post_init__(self) -> None:
        name = type(self).__name__
        check_number(name, "acceleration", self.acceleration, "m^2/s^3", exclusive_min=0.0)
        for word in ("gate", "clutter", "speed"):
            check_number(name, word, getattr(self, word), exclusive_min=0.0)
        for word, unit in (("coast", "s"), ("apart", "m")):
            check_number(name, word, getattr(self, word), unit, min=0.0)
        for word in ("detection", "birth", "confirm", "drop"):
            if not 0.0 < getattr(self, word) < 1.0:
                raise InputError(f"{name}: {word} = {getattr(self, word)} must be above 0 and below 1")

    @property
    def densities(self) -> Floats:
        """Spectral density ``[M]`` of the acceleration of each motion model [m^2/s^3]."""
        return np.array([self.acceleration])

    @property
    def dwell(self) -> float:
        """Mean time until a person changes to another motion model [s]."""
        return math.inf

    def begin(self) -> TrackerState:
        """Return the state without tracks."""
        M = len(self.densities)
        none = np.zeros(0)
        return TrackerState(
            math.nan, 0, np.zeros(0, dtype=np.int64), np.zeros((0, M, 4)), np.zeros((0, M, 4, 4)), np.zeros((0, M)),
            none, np.zeros(0, dtype=np.bool_), none, none, np.zeros((0, 0, 2)),
        )  # fmt: skip

    def update(self, detections: Detections, time: float, state: TrackerState) -> tuple[Tracks, TrackerState]:
        """Return the tracks and the next state."""
        self.check_time(time, state.time)
        dt = 0.0 if math.isnan(state.time) else time - state.time
        filters = predict(mix(self._accelerate(state, dt), dt, self.dwell), dt, self.densities)
        found = innovation(filters, detections.position, detections.covariance)
        seen = np.full(len(state.ids), self.detection)
        if detections.coverage is not None:
            seen = self.detection * np.minimum(1.0, 1.5 * detections.coverage.visible(filters.moments()[0][:, :2]))
        joined = self.associate(filters, found, state.existence, seen)
        last = np.where(joined.detected, float(time), state.last)
        confirmed = state.confirmed | (joined.existence >= self.confirm)
        alive = (joined.existence >= self.drop) & (time - last <= self.coast)
        free = np.flatnonzero(~joined.used)
        free = free[self._is_new(detections.position[free], joined.filters.moments()[0][alive])]
        new = start(detections.position[free], detections.covariance[free], self.speed, len(self.densities))
        place = np.concatenate([joined.filters.moments()[0][alive, :2], detections.position[free]])
        times, places = self._remember(state, float(time), alive, place)
        after = TrackerState(
            float(time),
            state.next_id + len(free),
            np.concatenate([state.ids[alive], state.next_id + np.arange(len(free))]),
            np.concatenate([joined.filters.mean[alive], new.mean]),
            np.concatenate([joined.filters.covariance[alive], new.covariance]),
            np.concatenate([joined.filters.weight[alive], new.weight]),
            np.concatenate([joined.existence[alive], np.full(len(free), self.birth)]),
            np.concatenate([confirmed[alive], np.zeros(len(free), dtype=np.bool_)]),
            np.concatenate([last[alive], np.full(len(free), float(time))]),
            times,
            places,
        )
        return after.confirmed_tracks(), after

    def associate(self, filters: FilterState, found: Innovation, existence: Floats, seen: Floats) -> Association:
        """Return the filters after the detections that belong to them.

        Args:
            filters: predicted filters of N people.
            found: differences between D detections and the filters.
            existence: ``[N]`` probability that there is a person.
            seen: ``[N]`` probability that a person there is detected.
        """
        tracks, targets = self._assign(found.distance, found.likelihood, existence)
        after = existence * (1.0 - seen) / (1.0 - existence * seen)
        ratio = self.detection * np.exp(np.minimum(found.likelihood[tracks, targets], 50.0)) / self.clutter
        odds = existence[tracks] / (1.0 - existence[tracks]) * ratio
        after[tracks] = odds / (1.0 + odds)
        detected, used = np.zeros(found.distance.shape[0], np.bool_), np.zeros(found.distance.shape[1], np.bool_)
        detected[tracks], used[targets] = True, True
        return Association(correct(filters, found, tracks, targets), np.clip(after, 1e-9, 1.0 - 1e-3), detected, used)

    def _accelerate(self, state: TrackerState, dt: float) -> FilterState:
        """Return the filters with the change of velocity that the predictor expects in ``dt`` [s]."""
        if self.motion is None or dt == 0.0 or not state.confirmed.any():
            return state.filters
        return self.motion.apply(state, dt)

    def _remember(self, state: TrackerState, time: float, alive: Bools, place: Floats) -> tuple[Floats, Floats]:
        """Return the times and the positions of the last updates, if a predictor reads them."""
        if self.motion is None:
            return state.times, np.zeros((len(place), 0, 2))
        kept = state.times >= time - self.motion.span
        before = np.full((len(place), int(kept.sum()), 2), np.nan)
        before[: int(alive.sum())] = state.places[alive][:, kept]
        return np.append(state.times[kept], time), np.concatenate([before, place[:, None]], axis=1)

    def _assign(self, distance: Floats, likelihood: Floats, existence: Floats) -> tuple[Ints, Ints]:
        """Return the indices of tracks and detections that belong together."""
        from scipy.optimize import linear_sum_assignment

        inside = distance <= self.gate
        cost = np.full(distance.shape, FORBIDDEN)
        score = -2.0 * (likelihood + np.log(existence)[:, None])
        cost[inside] = score[inside]
        tracks, targets = linear_sum_assignment(cost)
        kept = inside[tracks, targets]
        return tracks[kept], targets[kept]

    def _is_new(self, position: Floats, known: Floats) -> Bools:
        """Return which detections are far enough from all tracks."""
        if not len(known):
            return np.ones(len(position), dtype=np.bool_)
        away = position[:, None] - known[None, :, :2]
        return np.asarray(np.min(np.hypot(away[..., 0], away[..., 1]), axis=1) > self.apart)


@dataclass(frozen=True, kw_only=True)
class InteractingMultipleModel(GlobalNearestNeighbor):
    """Global nearest neighbour with two motion models for each person: walking on, and turning or stopping.

    The models are of constant velocity with small and with large acceleration, mixed before each step (Blom and
    Bar-Shalom (1988), The interacting multiple model algorithm, doi 10.1109/9.1299).

    Fields:
        acceleration: spectral density of the acceleration while walking on [m^2/s^3].
        turning: the same while turning or stopping [m^2/s^3].
        stay: mean time until a person changes to the other motion model [s].

    >>> InteractingMultipleModel().begin().mean.shape
    (0, 2, 4)
    """

    acceleration: float = 0.1
    turning: float = 3.0
    stay: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number(type(self).__name__, "turning", self.turning, "m^2/s^3", exclusive_min=0.0)
        check_number(type(self).__name__, "stay", self.stay, "s", exclusive_min=0.0)

    @property
    def densities(self) -> Floats:
        """Spectral density ``[2]`` of the acceleration of each motion model [m^2/s^3]."""
        return np.array([self.acceleration, self.turning])

    @property
    def dwell(self) -> float:
        """Mean time until a person changes to another motion model [s]."""
        return self.stay
