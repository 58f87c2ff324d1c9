"""Speed of detection, tracking and prediction in planar scans."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.core import Pose, Scene, Walls
from crowdbot.perception import (
    Detector,
    GlobalNearestNeighbor,
    InteractingMultipleModel,
    JointProbabilisticDataAssociation,
    LidarClusters,
    ScanNetwork,
    TrackedScene,
    Tracker,
)
from crowdbot.sensors import Gaussian, Lidar2D, Scan

from .measurement import Measurement

PEOPLE, SCANS, BEAMS, PERIOD = 20, 20, 1080, 0.1
LIMIT = 0.005
"""Time for a scan [s], the reference."""
FUTURE, FORECAST_LIMIT = 10, 0.02
"""Number of future scans, and the time for them [s], the reference."""
TRACKING_PAIRS: dict[str, tuple[type[Detector], type[Tracker]]] = {
    "track-1080": (LidarClusters, GlobalNearestNeighbor),
    "track-1080-multiple": (LidarClusters, InteractingMultipleModel),
    "track-1080-joint": (LidarClusters, JointProbabilisticDataAssociation),
    "track-1080-network": (ScanNetwork, GlobalNearestNeighbor),
    "track-1080-network-multiple": (ScanNetwork, InteractingMultipleModel),
    "track-1080-network-joint": (ScanNetwork, JointProbabilisticDataAssociation),
}
"""Detectors and trackers by the name of their row."""


def tracking(detects: type[Detector], tracks_by: type[Tracker]) -> Measurement:
    """Detect and track 20 people who walk around a scanner of 1080 beams at 10 Hz, inside a room of known walls."""
    scans, walls = _scans()
    detector, tracker = detects(), tracks_by()

    def follow() -> int:
        state: Any = tracker.begin()
        for k, scan in enumerate(scans):
            tracks, state = tracker.update(detector.detect(scan, walls), PERIOD * k, state)
        return len(tracks)

    found = follow()
    words = f"5 ms for a scan (one core, {found} of {PEOPLE} people tracked)"
    return Measurement("scans/s", SCANS, follow, words, 1.0 / LIMIT)


def scan_prediction() -> Measurement:
    """Predict 10 future scans of 1080 beams from the scans of 20 people, without a map."""
    predictor, state = TrackedScene(), TrackedScene().begin()
    for scan in _scans()[0]:
        state = predictor.update(scan, state)
    ahead = PERIOD * np.arange(1.0, FUTURE + 1.0)

    def look_ahead() -> int:
        return len(predictor.forecast(state, ahead).ranges[0])

    look_ahead()
    words = f"20 ms for {FUTURE} future scans (one core, {len(state.tracks)} people tracked)"
    return Measurement("predictions/s", 1, look_ahead, words, 1.0 / FORECAST_LIMIT)


def _scans() -> tuple[list[Scan], Walls]:
    """Return scans of people who walk around the scanner in a room, and the walls of the room."""
    lidar, rng = Lidar2D(rays=BEAMS, range_max=20.0, noise=Gaussian(0.01)), np.random.default_rng(0)
    angle = np.linspace(0.0, 2.0 * np.pi, PEOPLE, endpoint=False)
    radius = np.where(np.arange(PEOPLE) % 2, 3.0, 5.5)
    scans = []
    for k in range(SCANS):
        turn = angle + 1.2 * PERIOD * k / radius
        place = radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        room = [[(-8.0, -8.0), (-8.0, 8.0), (8.0, 8.0), (8.0, -8.0), (-8.0, -8.0)]]
        scene = Scene.of(place, radius=0.25, walls=room).replace(time=PERIOD * k)
        scans.append(lidar.read(scene, Pose.of((0.0, 0.0), 0.0), rng))
    return scans, scene.walls
