"""The tracker of Stone Soup as a tracker of crowdbot: global nearest neighbour with Kalman filters.

    pip install stonesoup
    crowdbot track crossing-flows --tracker global-nearest-neighbor examples/public_tracker/stone_soup.py:StoneSoup

Stone Soup: Barr et al. (2022), Stone Soup open source framework for tracking and state estimation: enhancements and
applications, https://doi.org/10.1117/12.2618495.
"""

import copy
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import NamedTuple

import numpy as np
from stonesoup.dataassociator.neighbour import GNNWith2DAssignment
from stonesoup.deleter.error import CovarianceBasedDeleter
from stonesoup.hypothesiser.distance import DistanceHypothesiser
from stonesoup.initiator.simple import MultiMeasurementInitiator
from stonesoup.measures import Mahalanobis
from stonesoup.models.measurement.linear import LinearGaussian
from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, ConstantVelocity
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.types.detection import Detection
from stonesoup.types.state import GaussianState
from stonesoup.types.update import Update
from stonesoup.updater.kalman import KalmanUpdater

from crowdbot.perception import Tracker, Tracks

BEGIN = datetime(2000, 1, 1)
ORDER = [0, 2, 1, 3]
"""x, y, vx, vy of crowdbot in the state x, vx, y, vy of Stone Soup."""


class State(NamedTuple):
    """Tracks of Stone Soup with the initiator, and the numbers of the tracks."""

    time: float
    tracks: frozenset
    initiator: MultiMeasurementInitiator
    numbers: dict


@dataclass(frozen=True, kw_only=True)
class StoneSoup(Tracker):
    """Global nearest neighbour of Stone Soup with the motion of `global-nearest-neighbor`.

    Fields:
        acceleration: spectral density of the acceleration of people [m^2/s^3].
        gate: largest Mahalanobis distance of a pair.
        lost: sum of the variances of a track at which it ends.
        points: number of detections of a new track.
        deviation: standard deviation of a detection [m].
    """

    acceleration: float = 0.5
    gate: float = 3.7
    lost: float = 4.0
    points: int = 3
    deviation: float = 0.06

    def _parts(self):
        motion = CombinedLinearGaussianTransitionModel([ConstantVelocity(self.acceleration)] * 2)
        model = LinearGaussian(4, (0, 2), self.deviation**2 * np.eye(2))
        predictor, updater = KalmanPredictor(motion), KalmanUpdater(model)
        hypothesiser = DistanceHypothesiser(predictor, updater, Mahalanobis(), missed_distance=self.gate)
        return model, updater, GNNWith2DAssignment(hypothesiser), CovarianceBasedDeleter(self.lost)

    def begin(self):
        """Return the state without tracks."""
        _, updater, associator, deleter = self._parts()
        prior = GaussianState([0.0, 0.0, 0.0, 0.0], np.diag([0.0, 1.0, 0.0, 1.0]), BEGIN)
        initiator = MultiMeasurementInitiator(
            prior_state=prior, deleter=deleter, data_associator=associator, updater=updater, min_points=self.points
        )
        return State(float("nan"), frozenset(), initiator, {})

    def update(self, detections, time, state):
        """Return the tracks and the next state."""
        self.check_time(time, state.time)
        _, updater, associator, deleter = self._parts()
        now = BEGIN + timedelta(seconds=time)
        found = {
            Detection(place[:, None], timestamp=now, measurement_model=LinearGaussian(4, (0, 2), spread))
            for place, spread in zip(detections.position, detections.covariance, strict=True)
        }
        tracks, initiator = copy.deepcopy((set(state.tracks), state.initiator))
        used = set()
        for track, hypothesis in associator.associate(tracks, found, now).items():
            if hypothesis:
                track.append(updater.update(hypothesis))
                used.add(hypothesis.measurement)
            else:
                track.append(hypothesis.prediction)
        tracks -= deleter.delete_tracks(tracks)
        tracks |= initiator.initiate(found - used, now)
        numbers = dict(state.numbers)
        for track in sorted(tracks, key=lambda one: float(one.state_vector[0, 0])):
            numbers.setdefault(track.id, len(numbers))
        reported = self._reported(tracks, numbers, time)
        for track in tracks:  # a state refers to all before it, and copies of them take time
            last = track.state
            track.states[:] = [GaussianState(last.state_vector, last.covar, timestamp=last.timestamp)]
        return reported, State(float(time), frozenset(tracks), initiator, numbers)

    def _reported(self, tracks, numbers, time):
        rows = sorted(tracks, key=lambda one: numbers[one.id])
        if not rows:
            return Tracks.none(time)
        mean = np.array([np.asarray(one.state_vector, dtype=float)[ORDER, 0] for one in rows])
        spread = np.array([np.asarray(one.covar, dtype=float)[np.ix_(ORDER, ORDER)] for one in rows])
        ids = np.array([numbers[one.id] for one in rows], dtype=np.int64)
        seen = np.array([isinstance(one.state, Update) for one in rows])
        return Tracks(time, ids, mean[:, :2], mean[:, 2:], spread, np.ones(len(rows)), seen)
