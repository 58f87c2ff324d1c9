"""People whom a robot tracks with its laser scanners, for ``people="tracked"``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Walls
from crowdbot.navigation import AgentsInView
from crowdbot.perception import CloudClusters, Detector, GlobalNearestNeighbor, LidarClusters, Tracks
from crowdbot.sensors import Reading
from crowdbot.simulation.mounted_sensor import MountedSensor

__all__ = ["PerceivedPeople", "begin_tracking", "track_readings", "view_tracks"]

Floats = NDArray[np.float64]
PerceivedPeople = tuple[Any, Tracks]
"""State of the tracker and its latest tracks, in one environment."""

RADIUS = 0.25
"""Radius of a tracked person [m], which a scanner does not measure."""
DETECTORS: tuple[Detector, ...] = (LidarClusters(), CloudClusters())
TRACKER = GlobalNearestNeighbor()


def begin_tracking(count: int) -> list[PerceivedPeople]:
    """Return the states of ``count`` environments before the first reading."""
    return [(TRACKER.begin(), Tracks.none(0.0)) for _ in range(count)]


def track_readings(before: PerceivedPeople, sensors: Sequence[MountedSensor], environment: int, walls: Walls) -> Any:
    """Return the state and the tracks after the latest readings of the laser scanners in an environment.

    Args:
        before: state and tracks until now.
        sensors: sensors of the robot.
        environment: the environment.
        walls: map of the stage.
    """
    state, tracks = before
    last = state.time
    new: list[tuple[float, Detector, Reading]] = []
    for sensor in sensors:
        reading = sensor.reading(environment)
        detector = next((one for one in DETECTORS if isinstance(reading, one.reads)), None)
        if reading is not None and detector is not None and not float(np.max(reading.time)) <= last:
            new.append((float(np.max(reading.time)), detector, reading))
    for time, detector, reading in sorted(new, key=lambda row: row[0]):
        tracks, state = TRACKER.update(detector.detect(reading, walls), time, state)
    return state, tracks


def view_tracks(perceived: Sequence[PerceivedPeople], times: Floats) -> AgentsInView:
    """Return the tracked people of N environments at times ``[N]`` [s], where constant velocities take them."""
    N, A = len(perceived), max((len(tracks) for _, tracks in perceived), default=0)
    position, velocity = np.zeros((N, A, 2)), np.zeros((N, A, 2))
    seen, ids = np.zeros((N, A), dtype=np.bool_), np.zeros((N, A), dtype=np.int64)
    for k, (_, tracks) in enumerate(perceived):
        count = len(tracks)
        position[k, :count], velocity[k, :count] = tracks.at(float(times[k])), tracks.velocity
        seen[k, :count], ids[k, :count] = True, tracks.ids
    return AgentsInView(position, velocity, np.full((N, A), RADIUS), seen, ids)
