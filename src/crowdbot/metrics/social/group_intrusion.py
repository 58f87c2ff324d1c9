"""Group metrics: intrusion of a robot into groups of people."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from crowdbot.metrics.proximity import ZONES
from crowdbot.typing import Floats

from .metric import undefined_metrics
from .robot_log import RobotLog

TOGETHER = 1.5
"""Mean distance of two members of a group [m] at most ..."""
ALIKE = 0.3
"""... with a mean difference of their velocities [m/s] at most ..."""
LONG = 2.0
"""... for at least this time together [s]."""


def group_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``groups``; shares are NaN without a group."""
    groups = detect_groups(log) if log.groups is None else log.groups
    groups = [list(group) for group in groups if len(group) > 1]
    if not groups:
        return undefined_metrics("groups") | {"groups": 0.0, "group_collision": 0.0}
    hull, space, centre = (np.full((len(groups), len(log.times)), np.inf) for _ in range(3))
    for k, members in enumerate(groups):
        hull[k], space[k], centre[k] = _group_distances(log, members)
    near, inside = centre.min(axis=0), hull.min(axis=0) < 0.0
    return {
        "groups": float(len(groups)),
        "group_intrusion": float(np.mean(inside)),
        "group_collision": float(inside.any()),
        "group_space_share": float(np.mean(space.min(axis=0) < 0.0)),
        "group_intimate_share": float(np.mean(near < ZONES["intimate"])),
        "group_personal_share": float(np.mean((near >= ZONES["intimate"]) & (near < ZONES["personal"]))),
        "group_social_share": float(np.mean((near >= ZONES["personal"]) & (near < ZONES["social"]))),
        "min_group_distance": float(np.min(near)),
    }


def detect_groups(log: RobotLog) -> list[list[int]]:
    """Return the groups in a log, as indices of people.

    Two people belong together if they are on average at most 1.5 m apart (between centres), with velocities that
    differ by at most 0.3 m/s on average, for at least 2 s; groups are connected sets of such pairs.

    >>> place = np.array([[[9.0, 9.0], [k, 0.0], [k, 1.0], [-k, 5.0]] for k in range(4)])
    >>> from crowdbot.metrics.agent_states import AgentLog
    >>> agents = AgentLog(np.arange(4.0), place, np.gradient(place, axis=0), np.zeros((4, 4)), np.full((4, 4), 0.3),
    ...     np.ones((4, 4), bool))
    >>> detect_groups(RobotLog.of(agents, robot=0))
    [[0, 1]]
    """
    people = log.present.shape[1]
    leader = list(range(people))
    steps = np.diff(log.times, prepend=log.times[0])
    for a in range(people - 1):
        both = log.present[:, a : a + 1] & log.present[:, a + 1 :]
        count = np.maximum(1, both.sum(axis=0))
        away = np.hypot(*np.moveaxis(log.people_position[:, a + 1 :] - log.people_position[:, a : a + 1], -1, 0))
        drift = np.hypot(*np.moveaxis(log.people_velocity[:, a + 1 :] - log.people_velocity[:, a : a + 1], -1, 0))
        pair = (steps @ both >= LONG) & (np.where(both, away, 0.0).sum(axis=0) / count <= TOGETHER)
        pair &= np.where(both, drift, 0.0).sum(axis=0) / count <= ALIKE
        for b in (a + 1 + np.flatnonzero(pair)).tolist():
            old, new = leader[b], leader[a]
            leader = [new if item == old else item for item in leader]
    sets = [[k for k in range(people) if leader[k] == first] for first in dict.fromkeys(leader)]
    return [set_ for set_ in sets if len(set_) > 1]


def _group_distances(log: RobotLog, members: Sequence[int]) -> tuple[Floats, Floats, Floats]:
    """Return the clearance of the robot to the hull of a group, and the distances of its centre to the edge of the
    circle of members and to the centre ``[T]``.

    Infinite while fewer than two members are present; the first two are negative inside.
    """
    here = log.present[:, members]
    place = log.people_position[:, members]
    count = here.sum(axis=1)
    ok = count > 1
    centre = np.where(here[..., None], place, 0.0).sum(axis=1) / np.maximum(1, count)[:, None]
    ring = np.where(here, np.hypot(*np.moveaxis(place - centre[:, None], -1, 0)), 0.0)
    away = np.hypot(*(log.position - centre).T)
    edge = away - ring.sum(axis=1) / np.maximum(1, count)
    hull = np.full(len(log.times), np.inf)
    for k in np.flatnonzero(ok & (away < ring.max(axis=1) + log.radius)).tolist():
        hull[k] = _hull_clearance(log, k, place[k, here[k]])
    return hull, np.where(ok, edge, np.inf), np.where(ok, away, np.inf)


def _hull_clearance(log: RobotLog, row: int, members: Floats) -> float:
    """Return the clearance [m] of the robot to the hull of the centres of members ``[N, 2]``; negative if they meet."""
    if log.outline is None or not math.isfinite(log.heading[row]):
        return distance_to_hull(log.position[row], members) - log.radius
    cos, sin = math.cos(log.heading[row]), math.sin(log.heading[row])
    corners = log.position[row] + log.outline @ np.array([[cos, sin], [-sin, cos]])
    # two convex shapes are as far apart as the origin is from the hull of the differences of their corners
    away = distance_to_hull(np.zeros(2), (members[:, None] - corners).reshape(-1, 2))
    return away if away > 0.0 else -1.0


def distance_to_hull(point: Floats, corners: Floats) -> float:
    """Return the distance [m] of a point ``[2]`` to the convex hull of points ``[N, 2]``; 0 inside.

    >>> distance_to_hull(np.array([2.0, 0.0]), np.array([[0.0, -1.0], [0.0, 1.0], [1.0, 0.0]]))
    1.0
    """
    ring = _hull(sorted(map(tuple, (corners - point).tolist())))
    inside = len(ring) > 2
    least = math.inf
    for k, (ax, ay) in enumerate(ring):
        bx, by = ring[(k + 1) % len(ring)]
        wx, wy = bx - ax, by - ay
        inside = inside and wx * -ay - wy * -ax >= 0.0
        length2 = wx * wx + wy * wy
        share = min(1.0, max(0.0, -(ax * wx + ay * wy) / length2)) if length2 > 0.0 else 0.0
        least = min(least, math.hypot(ax + share * wx, ay + share * wy))
    return 0.0 if inside else least


def _hull(points: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """Return the corners of the convex hull of sorted points, counter-clockwise (monotone chain)."""

    def chain(row: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
        kept: list[tuple[float, ...]] = []
        for p in row:
            while len(kept) > 1 and _turn(kept[-2], kept[-1], p) <= 0.0:
                kept.pop()
            kept.append(p)
        return kept[:-1]

    return points if len(points) < 3 else chain(points) + chain(points[::-1])


def _turn(a: tuple[float, ...], b: tuple[float, ...], c: tuple[float, ...]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
