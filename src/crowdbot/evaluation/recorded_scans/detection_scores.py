"""DetectionScores: detectors and trackers on recorded scans with annotated people."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import DataError
from crowdbot.metrics import match_nearest
from crowdbot.perception import Detections, Detector, ScanOdometry, ScanOdometryState, Tracker, Tracks
from crowdbot.sensors import planar_pose
from crowdbot.typing import Floats

from .annotated_scan import AnnotatedScan

LONGEST_GAP = 1.0
"""After a longer time without a scan [s], trackers and the odometry begin again."""


class DetectionScores(NamedTuple):
    """Scores of the positions of a detector or a tracker, at its own threshold; NaN without people, positions or scans.

    Fields:
        precision, recall, f1: of the pairs within reach.
        error: mean distance of the pairs [m].
        people, detections: numbers in all annotated scans.
        false_rate: detections of nobody in an annotated scan.
    """

    precision: float
    recall: float
    f1: float
    error: float
    people: int
    detections: int
    false_rate: float


@dataclass
class _Count:
    """Counts of one detector or tracker."""

    reach: float
    scans: int = 0
    people: int = 0
    detections: int = 0
    right: int = 0
    distance: float = 0.0

    def add(self, place: Floats, row: AnnotatedScan) -> None:
        """Count the positions ``[N, 2]`` in the world [m] in an annotated scan."""
        assert row.people is not None
        pose = planar_pose(row.scan.pose)
        cosine, sine = math.cos(float(pose.heading[0])), math.sin(float(pose.heading[0]))
        place = (place - pose.position[0]) @ np.array([[cosine, -sine], [sine, cosine]])
        away = np.linalg.norm(row.people[:, None] - place[None], axis=-1)
        a, b = match_nearest(away, self.reach)
        box = row.ignored[:, None]
        inside = ((place >= box[..., :2]) & (place <= box[..., 2:])).all(axis=-1)
        left_out = np.asarray(inside.any(axis=0), dtype=np.bool_)
        if row.sector is not None:
            half, reach = row.sector
            left_out |= np.abs(np.arctan2(place[:, 1], place[:, 0])) > half
            left_out |= np.hypot(place[:, 0], place[:, 1]) > reach
        left_out[b] = False
        self.scans += 1
        self.right += len(a)
        self.distance += float(away[a, b].sum())
        self.people += len(row.people)
        self.detections += int((~left_out).sum())

    def scores(self) -> DetectionScores:
        """Return the scores."""
        both = self.people + self.detections
        return DetectionScores(
            self.right / self.detections if self.detections else math.nan,
            self.right / self.people if self.people else math.nan,
            2.0 * self.right / both if both else math.nan,
            self.distance / self.right if self.right else math.nan,
            self.people,
            self.detections,
            (self.detections - self.right) / self.scans if self.scans else math.nan,
        )


@dataclass
class _Following:
    """A tracker behind a detector, with its state; identities go on after it has begun again."""

    tracker: Tracker
    count: _Count
    state: Any = field(init=False)
    time: float = -math.inf
    first: int = 0
    used: int = 0

    def __post_init__(self) -> None:
        self.state = self.tracker.begin()

    def update(self, found: Detections, time: float) -> Tracks:
        """Return the tracks after the detections of the next scan."""
        if not _follows(time, self.time):
            self.state, self.first = self.tracker.begin(), self.used
        tracks, self.state = self.tracker.update(found, time, self.state)
        tracks = replace(tracks, ids=tracks.ids + self.first)
        self.time, self.used = time, max(self.used, 1 + int(tracks.ids.max(initial=-1)))
        return tracks


def score_positions(
    rows: Iterable[AnnotatedScan], detectors: Mapping[str, Detector], trackers: Mapping[str, Tracker],
    reach: float = 0.5, odometry: ScanOdometry | None = None, note: Callable[[str, Tracks], None] | None = None,
) -> dict[str, DetectionScores]:  # fmt: skip
    """Return the scores of each detector, and of each tracker behind each detector, in one pass over the scans.

    Trackers follow all scans; scans without annotations do not count. Without odometry the scanner stands still for
    them: its motion adds to that of people. They begin again if the time steps back or by more than 1 s.

    Args:
        rows: scans in the order of their recording.
        detectors: detectors by name.
        trackers: trackers by name.
        reach: largest distance of a person and a position [m]; 0.5 m as in the work on DROW and FROG.
        odometry: estimates the motion of a planar scanner from the scans.
        note: called with ``detector, tracker`` and the tracks after each scan; scans may then all be unlabelled.

    Returns:
        Scores by ``detector`` and by ``detector, tracker``.

    Raises:
        DataError: no scan is annotated, and no ``note`` is given.
        InputError: a detector does not read such scans.
    """
    counts = {name: _Count(reach) for name in detectors}
    following = {
        (name, label): _Following(tracker, _Count(reach)) for name in detectors for label, tracker in trackers.items()
    }
    annotated = 0
    for row in rows if odometry is None else place_scans(rows, odometry):
        annotated += row.people is not None
        time = float(np.max(row.scan.time))
        for name, detector in detectors.items():
            if row.people is None and not trackers:
                continue
            found = detector.detect(row.scan)
            if row.people is not None:
                counts[name].add(found.position, row)
            for label in trackers:
                tracks = following[name, label].update(found, time)
                if note is not None:
                    note(f"{name}, {label}", tracks)
                if row.people is not None:
                    following[name, label].count.add(tracks.position, row)
    if not annotated and note is None:
        raise DataError("no scan has annotated people")
    scores = {}
    for name, count in counts.items():
        scores[name] = count.scores()
        scores |= {f"{name}, {label}": following[name, label].count.scores() for label in trackers}
    return scores


def _follows(time: float, before: float) -> bool:
    """Return whether a scan is the next one of a recording without a gap."""
    return before < time <= before + LONGEST_GAP


def place_scans(rows: Iterable[AnnotatedScan], odometry: ScanOdometry) -> Iterator[AnnotatedScan]:
    """Yield the scans with the poses of the odometry, which begins again at the origin after a gap of 1 s."""
    state: ScanOdometryState | None = None
    before = -math.inf
    for row in rows:
        time = float(np.max(row.scan.time))
        pose, state = odometry.update(row.scan, state if _follows(time, before) else None)
        before = time
        yield row._replace(scan=replace(row.scan, pose=pose))


def score_detections(rows: Iterable[AnnotatedScan], detector: Detector, reach: float = 0.5) -> DetectionScores:
    """Return the scores of one detector, see :func:`score_positions`."""
    return score_positions(rows, {"": detector}, {}, reach)[""]
