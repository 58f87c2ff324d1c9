"""Markers of people, robots, goals and walls as ``visualization_msgs/MarkerArray``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene

from .cdr import Shape, marker_bytes

KIND = "visualization_msgs/msg/MarkerArray"
BODY_HEIGHT, ROBOT_HEIGHT, GOAL_HEIGHT = 1.7, 0.8, 0.02
ORANGE, BLUE, GREEN = (0.9, 0.6, 0.0), (0.0, 0.45, 0.7), (0.0, 0.62, 0.45)
"""Colours that are distinguishable with colour blindness (Okabe & Ito)."""
Goal = tuple[float, float, float]
SPHERE, CYLINDER, LINE_LIST, DELETE_ALL = 2, 3, 5, 3
"""Types and an action of ``visualization_msgs/Marker``."""


def markers(nanoseconds: int, scene: Scene, ids: NDArray[np.int64], goals: Sequence[Goal]) -> bytes:
    """Return markers of all objects as CDR bytes; the first marker deletes previous ones.

    Args:
        nanoseconds: simulated time [ns].
        scene: scene, E = 1; external agents are robots.
        ids: ids of the agents ``[A]``.
        goals: goal x, y and tolerance [m] of each robot.
    """
    return marker_bytes(nanoseconds, _shapes(scene, ids, goals))


def _shapes(scene: Scene, ids: NDArray[np.int64], goals: Sequence[Goal]) -> Iterator[Shape]:
    yield Shape("clear", 0, SPHERE, action=DELETE_ALL)
    there = np.flatnonzero(scene.active[0])
    rows = (ids[there], scene.position[0, there], scene.radius[0, there], scene.external[0, there])
    for number, (x, y), radius, robot in zip(*(row.tolist() for row in rows), strict=True):
        if robot:
            yield _disc("robots", number, x, y, radius, ROBOT_HEIGHT, BLUE)
        else:
            yield _disc("people", number, x, y, radius, BODY_HEIGHT, ORANGE)
    for number, (x, y, tolerance) in enumerate(goals):
        yield _disc("goals", number, x, y, tolerance, GOAL_HEIGHT, GREEN)
    ends = scene.walls.segments().reshape(-1, 2).tolist()
    if ends:  # RViz takes a list of lines without points for an error
        yield Shape("walls", 0, LINE_LIST, size=(0.05, 0.0, 0.0), points=tuple((x, y) for x, y in ends))


def _disc(
    group: str, number: int, x: float, y: float, radius: float, height: float, color: tuple[float, float, float]
) -> Shape:
    return Shape(group, number, CYLINDER, 0, (x, y, height / 2.0), (2.0 * radius, 2.0 * radius, height), color)
