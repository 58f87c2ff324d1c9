"""Clearance of people to the outline of a robot that is not a disc."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Floats

from .agent_states import AgentStates

FOOTPRINT_METRICS: dict[str, tuple[str, str]] = {
    "min_footprint_clearance": (
        "m",
        "minimum clearance of people to the outline of the robot at the records; negative if they overlap",
    ),
    "mean_footprint_distance": ("m", "mean clearance of the nearest person to the outline of the robot"),
}
"""Unit and definition of the metrics of robots with a footprint; absent for discs."""


@kernel
def _outline_distance(x: float, y: float, corners: Floats) -> float:
    """Return the distance of a point to a polygon, negative inside."""
    least, inside = math.inf, False
    for k in range(len(corners)):
        ax, ay = corners[k - 1, 0], corners[k - 1, 1]
        bx, by = corners[k, 0], corners[k, 1]
        wx, wy = bx - ax, by - ay
        length2 = wx * wx + wy * wy
        share = min(1.0, max(0.0, ((x - ax) * wx + (y - ay) * wy) / (length2 if length2 > 0.0 else 1.0)))
        dx, dy = x - ax - share * wx, y - ay - share * wy
        least = min(least, math.sqrt(dx * dx + dy * dy))
        if (ay > y) != (by > y) and x < wx * (y - ay) / wy + ax:
            inside = not inside
    return -least if inside else least


@kernel
def _nearest(place: Floats, radius: Floats, own: int, cos: float, sin: float, corners: Floats) -> float:
    least = math.inf
    for n in range(len(place)):
        if n != own:
            dx, dy = place[n, 0] - place[own, 0], place[n, 1] - place[own, 1]
            away = _outline_distance(cos * dx + sin * dy, cos * dy - sin * dx, corners)
            least = min(least, away - radius[n])
    return least


def footprint_clearance(states: AgentStates, own: int, footprint: Floats) -> float:
    """Return the smallest clearance of all other agents, as discs, to the outline of a robot [m].

    It is negative for overlap, and infinite without other agents or with an unknown heading.

    Args:
        states: all agents.
        own: index of the robot.
        footprint: corners ``[N, 2]`` of the outline in the frame of the robot [m].

    >>> place, still = np.array([[0.0, 0.0], [2.0, 0.0]]), np.zeros((2, 2))
    >>> box = np.array([[0.5, 0.2], [-0.5, 0.2], [-0.5, -0.2], [0.5, -0.2]])
    >>> there = AgentStates(0.0, np.arange(2), place, still, np.zeros(2), np.full(2, 0.3))
    >>> round(footprint_clearance(there, 0, box), 3)
    1.2
    """
    heading = float(states.heading[own])
    if not math.isfinite(heading):
        return math.inf
    arrays = np.ascontiguousarray(states.position), np.ascontiguousarray(states.radius)
    corners = np.ascontiguousarray(footprint, dtype=np.float64)
    return float(_nearest(*arrays, own, math.cos(heading), math.sin(heading), corners))
