"""TrackedScene: people tracked in the scans walk on, and the scene is scanned again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from crowdbot.core import Pose, check_number, stream
from crowdbot.perception.detector import Detector
from crowdbot.perception.scan_network import ScanNetwork
from crowdbot.perception.tracker import Tracker, Tracks
from crowdbot.perception.trackers import GlobalNearestNeighbor
from crowdbot.sensors import Scan, cast_plane
from crowdbot.typing import Floats

from .last_scan import static_segments
from .scan_predictor import ScanForecast, ScanPredictor, continue_motion

MARGIN = 0.15
"""Points this far [m] outside the body of a person still belong to the person."""


@dataclass(frozen=True)
class SceneState:
    """State of a :class:`TrackedScene`.

    Fields:
        scans: last scans.
        tracker: state of the tracker.
        tracks: people at the last scan.
    """

    scans: tuple[Scan, ...]
    tracker: Any
    tracks: Tracks


@dataclass(frozen=True, kw_only=True)
class TrackedScene(ScanPredictor):
    """Tracked people walk on with their velocities; everything else stays; rays are cast from the future poses.

    Surfaces that people hide in the last scan are taken from earlier scans. With several samples, the state of each
    person is drawn from the covariance of the track, except for the first future.

    Fields:
        detector, tracker: what finds and follows people; no map is used.
        memory: number of scans of which surfaces are remembered.
        body: radius of a person [m].
        slow_down: time constant with which velocities fade [s]; infinite for constant velocity.
        range_max: largest range [m]; farther surfaces give no return.

    Raises:
        InputError: a value is not allowed.

    >>> TrackedScene().begin().scans
    ()
    """

    detector: Detector = field(default_factory=lambda: ScanNetwork(deviation=0.06))
    tracker: Tracker = field(default_factory=lambda: GlobalNearestNeighbor(acceleration=0.01))
    memory: int = 10
    body: float = 0.25
    slow_down: float = np.inf
    range_max: float = 30.0

    def __post_init__(self) -> None:
        check_number("TrackedScene", "memory", self.memory, min=1, whole=True)
        check_number("TrackedScene", "body", self.body, "m", exclusive_min=0.0)
        check_number("TrackedScene", "range_max", self.range_max, "m", exclusive_min=0.0)

    def begin(self) -> SceneState:
        return SceneState((), self.tracker.begin(), Tracks.none(0.0))

    def update(self, scan: Scan, state: SceneState) -> SceneState:
        found = self.detector.detect(scan)
        tracks, tracker = self.tracker.update(found, found.time, state.tracker)
        return SceneState((*state.scans, scan)[-self.memory :], tracker, tracks)

    def forecast(
        self,
        state: SceneState,
        ahead: Floats,
        pose: Pose | None = None,
        samples: int = 1,
        rng: np.random.Generator | None = None,
    ) -> ScanForecast:
        tracks = state.tracks
        place = np.concatenate([tracks.position, tracks.velocity], axis=-1)[None].repeat(samples, axis=0)
        if samples > 1 and len(tracks):
            source = stream(0, "predict") if rng is None else rng
            root = np.linalg.cholesky(tracks.covariance)
            place[1:] += np.einsum("nij,knj->kni", root, source.standard_normal((samples - 1, len(tracks), 4)))
        paths = walk_straight(place[..., :2], place[..., 2:], ahead, self.slow_down) + self.correct(state, ahead)
        return self.render(state.scans, tracks.position, tracks.velocity, paths, ahead, pose)

    def correct(self, state: SceneState, ahead: Floats) -> Floats:
        """Return what is added ``[T, A, 2]`` to the straight paths of the tracks [m]: nothing."""
        return np.zeros((len(ahead), len(state.tracks), 2))

    def render(
        self, scans: Sequence[Scan], position: Floats, velocity: Floats, paths: Floats, ahead: Floats, pose: Pose | None
    ) -> ScanForecast:
        """Return scans of people on given paths, before the surfaces of the last scans.

        Args:
            scans: past scans.
            position, velocity: ``[A, 2]`` of the people at the last scan [m], [m/s].
            paths: ``[K, T, A, 2]`` future positions of the people [m].
            ahead: ``[T]`` times after the last scan [s].
            pose: T future poses of the sensor, or None.
        """
        there = continue_motion(scans[-5:], ahead) if pose is None else pose
        now, angles = float(np.max(scans[-1].time)), scans[-1].angles
        before = [position + (float(np.max(scan.time)) - now) * velocity for scan in scans]
        segments = static_segments(scans, before, self.body + MARGIN)
        K, T, A = paths.shape[:3]
        poses = Pose(np.tile(there.position, (K, 1)), np.tile(there.heading, K))
        radius = np.full((K * T, A), self.body)
        ranges, _ = cast_plane(poses, angles, paths.reshape(K * T, A, 2), radius, segments, self.range_max)
        return ScanForecast(ahead, there, angles, ranges.reshape(K, T, -1), np.full(K, 1.0 / K))


def walk_straight(position: Floats, velocity: Floats, ahead: Floats, slow_down: float = np.inf) -> Floats:
    """Return paths ``[..., T, A, 2]`` of people ``[..., A, 2]`` whose velocities fade with a time constant [s].

    >>> walk_straight(np.zeros((1, 2)), np.ones((1, 2)), np.array([2.0])).tolist()
    [[[2.0, 2.0]]]
    """
    passed = ahead if np.isinf(slow_down) else slow_down * (1.0 - np.exp(-ahead / slow_down))
    return np.asarray(position[..., None, :, :] + passed[:, None, None] * velocity[..., None, :, :])
