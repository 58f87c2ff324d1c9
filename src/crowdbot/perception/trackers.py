"""Trackers of people with Kalman filters, predictors or crowd models as their motion model."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, check_number
from crowdbot.data import Windows
from crowdbot.prediction import Predictor, Simulated
from crowdbot.typing import Bools, Floats, Ints

from .detector import Detections
from .tracker import FilterState, Innovation, Tracker, TrackerState, Tracks, correct, innovation, mix, predict, start

ROWS = 8
"""Number of rows of predictors without a history in seconds."""
STRONGEST = 3.0
"""Largest acceleration that a forecast gives [m/s^2]."""


@dataclass(frozen=True, kw_only=True)
class PredictorMotion:
    """A predictor, or a crowd model by :class:`crowdbot.prediction.Simulated`, as the motion model of a tracker.

    All confirmed people are predicted one ``step`` ahead, together, from their tracks. The distance d of the forecast
    from constant velocity gives each the acceleration 2 d / step^2 until the next detections; the covariances grow as
    with constant velocity. Constant velocity as the predictor changes nothing. Hidden people are moved in the same way:
    they avoid others who are tracked.

    Fields:
        predictor: the predictor; default: simulated people of ORCA who keep their direction. The crowd model alone
            (``contact=0``): two tracks of one person stay together.
        step: time of the forecast, and between the rows that the predictor reads [s].

    Raises:
        InputError: the step is not above 0.

    >>> from crowdbot.perception import Detections, GlobalNearestNeighbor
    >>> tracker = GlobalNearestNeighbor(motion=PredictorMotion())
    >>> state = tracker.begin()
    >>> for k in range(10):
    ...     found = Detections.of(0.1 * k, [[0.12 * k, 0.0], [4.0 - 0.12 * k, 0.1]], 0.05)
    ...     tracks, state = tracker.update(found, 0.1 * k, state)
    >>> tracks.ids.tolist()
    [0, 1]
    """

    predictor: Predictor = field(default_factory=lambda: Simulated(contact=0.0))
    step: float = 0.4

    def __post_init__(self) -> None:
        check_number("PredictorMotion", "step", self.step, "s", exclusive_min=0.0)

    @property
    def rows(self) -> int:
        """Number of rows that the predictor reads."""
        return max(ROWS, math.ceil(self.predictor.history / self.step - 1e-9) + 1)

    @property
    def span(self) -> float:
        """Time of the rows before the last one [s]."""
        return (self.rows - 1) * self.step

    def apply(self, state: TrackerState, dt: float) -> FilterState:
        """Return the filters with half the shift and the whole change of velocity of an acceleration over ``dt`` [s].

        A prediction with constant velocity over ``dt`` then adds the other half of the shift.
        """
        past = self.windows(state)
        forecast = self.predictor.predict(past, 1)
        ahead = np.einsum("k,kai->ai", forecast.weight[0], forecast.position[0, :, 0])
        here = past.position[0, -1]
        steady = 2.0 * here - past.position[0, -2]
        acceleration = 2.0 * (ahead - steady) / self.step**2
        size = np.linalg.norm(acceleration, axis=-1, keepdims=True)
        acceleration *= np.minimum(1.0, STRONGEST / np.maximum(size, 1e-12))
        mean = state.mean.copy()
        mean[state.confirmed, :, 2:] += dt * acceleration[:, None]
        mean[state.confirmed, :, :2] -= 0.5 * dt**2 * acceleration[:, None]
        return FilterState(mean, state.covariance, state.weight)

    def windows(self, state: TrackerState) -> Windows:
        """Return the confirmed tracks as one window; the row before the last one has the velocity of the filter."""
        kept = state.confirmed
        mean = state.filters.moments()[0][kept]
        wanted = state.time - self.step * np.arange(self.rows - 1, -1, -1.0)
        place = _interpolate(state.times, state.places[kept], wanted)
        place[:, -1] = mean[:, :2]
        place[:, -2] = mean[:, :2] - self.step * mean[:, 2:]
        place = np.swapaxes(place, 0, 1)[None]
        present = ~np.isnan(place[..., 0])
        nobody = np.zeros((1, place.shape[2]), dtype=np.bool_)
        frame = np.arange(self.rows, dtype=np.int64)[None]
        return Windows(
            np.where(present[..., None], place, 0.0), present, nobody, nobody, state.ids[kept][None], frame, self.step,
            "tracks", "tracker",
        )  # fmt: skip


def _interpolate(times: Floats, places: Floats, wanted: Floats) -> Floats:
    """Return positions ``[N, T, 2]`` at times ``[T]`` of tracks ``[N, H, 2]``; NaN before their first position."""
    after = np.clip(np.searchsorted(times, wanted - 1e-9), 0, len(times) - 1)
    before = np.maximum(after - 1, 0)
    gap = np.where(after > before, times[after] - times[before], 1.0)
    share = np.clip((wanted - times[before]) / gap, 0.0, 1.0)[:, None]
    found = places[:, before] * (1.0 - share) + places[:, after] * share
    return np.where((wanted >= times[0] - 1e-9)[:, None], found, np.nan)


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
        M = len(self.densities)
        none = np.zeros(0)
        return TrackerState(
            math.nan, 0, np.zeros(0, dtype=np.int64), np.zeros((0, M, 4)), np.zeros((0, M, 4, 4)), np.zeros((0, M)),
            none, np.zeros(0, dtype=np.bool_), none, none, np.zeros((0, 0, 2)),
        )  # fmt: skip

    def update(self, detections: Detections, time: float, state: TrackerState) -> tuple[Tracks, TrackerState]:
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
        return np.array([self.acceleration, self.turning])

    @property
    def dwell(self) -> float:
        return self.stay


ROUNDS = 100
"""Largest number of rounds of belief propagation."""
PRECISION = 1e-6
"""Change of the messages at which belief propagation ends."""


@dataclass(frozen=True, kw_only=True)
class JointProbabilisticDataAssociation(GlobalNearestNeighbor):
    """Joint integrated probabilistic data association.

    Each track is corrected by all detections in its gate, weighted with the probabilities that they belong to it, given
    that each detection belongs to at most one track (Fortmann, Bar-Shalom and Scheffe (1983), Sonar tracking of
    multiple targets using joint probabilistic data association, doi 10.1109/JOE.1983.1145560), with probabilities of
    existence (Musicki and Evans (2004), Joint integrated probabilistic data association: JIPDA, doi
    10.1109/TAES.2004.1337482). The probabilities are computed by belief propagation (Williams and Lau (2014),
    Approximate evaluation of marginal association probabilities with belief propagation, doi
    10.1109/TAES.2014.120568), in a time that grows with the number of pairs only.

    Fields:
        gate: largest squared Mahalanobis distance of a pair.

    >>> from crowdbot.perception import Detections
    >>> tracker = JointProbabilisticDataAssociation()
    >>> state = tracker.begin()
    >>> for k in range(10):
    ...     tracks, state = tracker.update(Detections.of(0.1 * k, [[0.12 * k, 1.0]], 0.05), 0.1 * k, state)
    >>> tracks.ids.tolist(), tracks.velocity.round(1).tolist()
    ([0], [[1.2, 0.0]])
    """

    def associate(self, filters: FilterState, found: Innovation, existence: Floats, seen: Floats) -> Association:
        # filters after the detections, each weighted with its probability
        inside = found.distance <= self.gate
        density = np.where(inside, np.exp(np.minimum(found.likelihood, 50.0)), 0.0)
        odds = (existence * self.detection)[:, None] * density / self.clutter / (1.0 - existence * seen)[:, None]
        chance = association_probabilities(odds)
        missed = 1.0 - chance.sum(axis=1)
        hidden = existence * (1.0 - seen) / (1.0 - existence * seen)
        after = np.clip(chance.sum(axis=1) + missed * hidden, 1e-9, 1.0 - 1e-3)
        corrected = _correct(filters, found, chance, inside)
        return Association(corrected, after, chance.sum(axis=1) > 0.5, chance.sum(axis=0) > 0.5)


def association_probabilities(odds: Floats) -> Floats:
    """Return the probability ``[N, D]`` that a detection belongs to a track, by belief propagation.

    Args:
        odds: ``[N, D]`` likelihood that the detection belongs to the track over that of no detection of the track, and
            of a detection of nobody.

    >>> association_probabilities(np.array([[1.0, 0.0], [0.0, 3.0]])).tolist()
    [[0.5, 0.0], [0.0, 0.75]]
    """
    back = np.ones_like(odds)
    for _ in range(ROUNDS):
        product = odds * back
        ahead = odds / (1.0 + product.sum(axis=1, keepdims=True) - product)
        new = 1.0 / (1.0 + ahead.sum(axis=0, keepdims=True) - ahead)
        done = np.abs(new - back).max(initial=0.0) < PRECISION
        back = new
        if done:
            break
    product = odds * back
    return np.asarray(product / (1.0 + product.sum(axis=1, keepdims=True)))


def _correct(filters: FilterState, found: Innovation, chance: Floats, inside: NDArray[np.bool_]) -> FilterState:
    """Return the filters corrected by weighted detections; the covariances contain the spread of the detections."""
    missed = np.maximum(0.0, 1.0 - chance.sum(axis=1))[:, None]
    ratio = np.exp(np.where(inside[..., None], found.log_density - found.likelihood[..., None], 0.0))
    share = chance[..., None] * ratio  # [N, D, M]: the detection belongs to the track, given the motion model
    total = share.sum(axis=1) + missed
    share, missed = share / total[:, None], missed / total
    prior = filters.covariance
    gain = np.einsum("nmij,ndmjk->ndmik", prior[..., :2], found.inverse)
    step = np.einsum("ndmij,ndmj->ndmi", gain, found.residual)
    mean = np.einsum("ndm,ndmi->nmi", share, step)
    after = prior[:, None] - np.einsum("ndmik,nmkl->ndmil", gain, prior[:, :, :2, :])
    spread = np.einsum("ndm,ndmij->nmij", share, after + step[..., :, None] * step[..., None, :])
    covariance = missed[..., None, None] * prior + spread - mean[..., :, None] * mean[..., None, :]
    weight = np.maximum(filters.weight * total, 1e-6)
    return FilterState(
        filters.mean + mean,
        0.5 * (covariance + np.swapaxes(covariance, -1, -2)),
        weight / weight.sum(axis=1, keepdims=True),
    )
