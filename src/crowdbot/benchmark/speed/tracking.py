"""Speed of detection and tracking in planar scans."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.core import Pose, Scene
from crowdbot.perception import GlobalNearestNeighbor, LidarClusters
from crowdbot.sensors import Gaussian, Lidar2D

from .measurement import Measurement

__all__ = ["tracking"]

PEOPLE, SCANS, BEAMS, PERIOD = 20, 20, 1080, 0.1
LIMIT = 0.005
"""Time for a scan [s], the reference."""


def tracking() -> Measurement:
    """Detect and track 20 people who walk around a scanner of 1080 beams at 10 Hz, inside a room of known walls."""
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
    detector, tracker, walls = LidarClusters(), GlobalNearestNeighbor(), scene.walls

    def follow() -> int:
        state: Any = tracker.begin()
        for k, scan in enumerate(scans):
            tracks, state = tracker.update(detector.detect(scan, walls), PERIOD * k, state)
        return len(tracks)

    found = follow()
    words = f"5 ms for a scan (one core, {found} of {PEOPLE} people tracked)"
    return Measurement("scans/s", SCANS, follow, words, 1.0 / LIMIT)
