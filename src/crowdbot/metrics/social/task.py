"""Task metrics: what was touched, progress, and distances to the goal."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.metrics.contacts import contact_stretches
from crowdbot.metrics.outline_clearance import pair_clearance
from crowdbot.metrics.proximity import swept_distance
from crowdbot.typing import Floats

from .robot_log import RobotLog

PROGRESS = 0.2
"""Decrease of the distance to the goal [m] that counts as progress ..."""
PROGRESS_TIME = 5.0
"""... within this time [s]."""


def task_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``task``."""
    touches = {
        "person": float(len(log.contacts)),
        "wall": _wall_contacts(log),
        "object": _object_contacts(log),
        "robot": _robot_contacts(log),
    }
    first = log.contacts[0].cause if log.contacts else ""
    known = log.goal is not None
    obstacle = log.wall_clearance
    return {
        **{f"{kind}_collision": float(count > 0) for kind, count in touches.items()},
        **{f"{kind}_collisions": count for kind, count in touches.items() if kind != "person"},
        "robot_caused_collision": float(first == "robot"),
        "person_caused_collision": float(first == "person"),
        "mutual_collision": float(first == "mutual"),
        "failures_to_progress": count_failures_to_progress(log.times, log.goal_distance) if known else math.nan,
        "final_goal_distance": float(log.goal_distance[-1]),
        "min_goal_distance": float(np.min(log.goal_distance)),
        "mean_wall_clearance": float(np.mean(obstacle)) if len(log.walls) else math.inf,
        "aggregated_time": _aggregated_time(log),
    }


def count_failures_to_progress(times: Floats, distance: Floats) -> float:
    """Return the number of consecutive windows of 5 s in which the distance to the goal falls by less than 0.2 m.

    A last window that is shorter does not count.

    >>> count_failures_to_progress(np.arange(0.0, 11.0), np.full(11, 3.0))
    2.0
    """
    starts = np.arange(times[0], times[-1] - PROGRESS_TIME + 1e-9, PROGRESS_TIME)
    at = np.interp(np.stack([starts, starts + PROGRESS_TIME]), times, distance)
    return float(np.sum(at[0] - at[1] < PROGRESS))


def _wall_contacts(log: RobotLog) -> float:
    if not len(log.walls):
        return 0.0
    return float(len(contact_stretches(log.times, log.least_wall_clearance, log.wall_clearance)))


def _object_contacts(log: RobotLog) -> float:
    count = 0
    for x, y, radius in log.objects:
        place = np.broadcast_to(np.array([x, y]), log.position.shape)
        count += _contacts_with(log, place, np.full(len(log.times), math.nan), float(radius), None)
    return float(count)


def _robot_contacts(log: RobotLog) -> float:
    if log.robots is None:
        return 0.0
    rows = zip(
        np.moveaxis(log.robots.position, 1, 0),
        log.robots.heading.T,
        log.robots.radius,
        log.robots.outlines,
        strict=True,
    )
    return float(sum(_contacts_with(log, place, turn, float(size), shape) for place, turn, size, shape in rows))


def _contacts_with(log: RobotLog, place: Floats, heading: Floats, radius: float, outline: Floats | None) -> int:
    """Return the number of contacts with a body, a disc or an outline, at places ``[T, 2]`` [m], NaN where absent."""
    there = np.isfinite(place[:, 0])
    if log.outline is None and outline is None:
        away = np.where(there[:, None], place - log.position, 1e9)
        before = np.concatenate([away[:1], away[:-1]])
        joined = there & np.concatenate([there[:1], there[:-1]])
        gap = np.hypot(*away.T) - log.radius - radius
        swept = np.where(joined, swept_distance(before, away) - log.radius - radius, gap)
    else:
        headings, sizes = (log.heading, heading), (log.radius, radius)
        swept, gap = pair_clearance((log.position, place), headings, sizes, (log.outline, outline), there)
    return len(contact_stretches(log.times, swept, gap))


def _aggregated_time(log: RobotLog) -> float:
    """Return the time of the robot and of all people who left, from their first to their last sample."""
    there = log.present
    first = np.argmax(there, axis=0)
    last = len(log.times) - 1 - np.argmax(there[::-1], axis=0)
    left = there.any(axis=0) & ~there[-1] if len(there) else np.zeros(0, dtype=np.bool_)
    return log.duration + float(np.sum((log.times[last] - log.times[first])[left]))
