"""TrackingRun: a detector and a tracker on the readings of one sensor, and their scores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crowdbot.evaluation.intervals import Estimate, bootstrap_estimate
from crowdbot.metrics import TRACKING_SCORES, TrackComparison, tracking_scores
from crowdbot.perception import Detections, Detector, Tracker, Tracks

from .reading_log import ReadingLog


@dataclass(frozen=True)
class TrackingRun:
    """Detections and tracks of one log.

    Fields:
        log: the readings and the true people.
        detections: detections of each reading.
        tracks: tracks after each reading.
    """

    log: ReadingLog
    detections: tuple[Detections, ...]
    tracks: tuple[Tracks, ...]

    def table(self) -> TrackComparison:
        """Return people and tracks at the instants of the readings; hidden people and other robots do not count."""
        truth = [{**row.people, **row.others} for row in self.log.rows]
        found = [dict(zip(track.ids.tolist(), track.position.tolist(), strict=True)) for track in self.tracks]
        return TrackComparison.of(truth, found, [row.hidden_ids() for row in self.log.rows])

    def scores(self, reach: float = 0.5) -> dict[str, float]:
        """Return the scores of the tracks, see :data:`crowdbot.metrics.TRACKING_SCORES`."""
        return tracking_scores(self.table(), [row.time for row in self.log.rows], reach)


def track_people(log: ReadingLog, detector: Detector, tracker: Tracker, use_map: bool = True) -> TrackingRun:
    """Return the tracks of people in a log.

    Args:
        log: the readings.
        detector, tracker: what finds and follows people.
        use_map: whether the detector knows the walls of the stage.
    """
    state = tracker.begin()
    detections, tracks = [], []
    for row in log.rows:
        found = detector.detect(row.reading, log.walls if use_map else None)
        known, state = tracker.update(found, row.time, state)
        detections.append(found)
        tracks.append(known)
    return TrackingRun(log, tuple(detections), tuple(tracks))


def estimate_scores(runs: Sequence[TrackingRun], reach: float = 0.5, seed: int = 0) -> dict[str, Estimate]:
    """Return the mean of each score over runs, with 95 % intervals by bootstrap over the runs.

    Runs without a value, such as a latency without anybody tracked, are left out of the mean.

    Args:
        runs: runs of one detector and tracker with different seeds.
        reach: largest distance of a person and a track [m].
        seed: seed of the bootstrap.
    """
    rows = [run.scores(reach) for run in runs]
    return {name: bootstrap_estimate(np.array([row[name] for row in rows]), seed=seed) for name in TRACKING_SCORES}
