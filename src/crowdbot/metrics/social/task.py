"""Task metrics: what was touched, progress, distances to the goal, and whether the robot does what gestures tell it."""

from __future__ import annotations

import itertools
import math

import numpy as np

from crowdbot.core import GESTURES
from crowdbot.metrics.contacts import contact_stretches
from crowdbot.metrics.motion import STALL_SPEED
from crowdbot.metrics.outline_clearance import pair_clearance
from crowdbot.metrics.proximity import swept_distance
from crowdbot.typing import Floats

from .metric import undefined_metrics
from .robot_log import RobotLog

PROGRESS = 0.2
"""Decrease of the distance to the goal [m] that counts as progress ..."""
PROGRESS_TIME = 5.0
"""... within this time [s]."""
ALLOWANCE = 1.0
"""Time after the beginning of a gesture that does not count [s]: to see it, and to brake or to start."""


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


def gesture_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of gestures by name; NaN where nobody makes one that lasts longer than 1 s.

    >>> from crowdbot.metrics import AgentLog
    >>> place = np.array([[[min(k, 15) / 10.0, 0.0], [3.0, -2.0]] for k in range(31)])
    >>> moving = np.array([[[1.0 * (k < 15), 0.0], [0.0, 0.0]] for k in range(31)])
    >>> agents = AgentLog(np.arange(31) / 10.0, place, moving, np.zeros((31, 2)), np.full((31, 2), 0.3),
    ...     np.ones((31, 2), bool))
    >>> told = np.zeros((31, 2), dtype=np.int8)
    >>> told[:, 1] = GESTURES.index("wait")  # it drives on for 0.4 s of the 2 s that count
    >>> round(gesture_metrics(RobotLog.of(agents, robot=0, gestures=told))["gesture_compliance"], 6)
    0.8
    """
    found = undefined_metrics("gestures")
    if log.gestures is None:
        return found
    stands = log.speed < STALL_SPEED
    step = np.diff(log.times, prepend=log.times[0])
    known = obeyed = 0.0
    for codes in log.gestures.T:
        changes = np.flatnonzero(np.diff(codes, prepend=0) != 0)
        for start, end in itertools.pairwise([*changes.tolist(), len(codes)]):
            if codes[start] == 0:
                continue
            counts = np.where(log.times[start:end] > log.times[start] + ALLOWANCE + 1e-9, step[start:end], 0.0)
            does = stands[start:end] == (codes[start] == GESTURES.index("wait"))
            known += float(counts.sum())
            obeyed += float(counts[does].sum())
    found["gesture_compliance"] = obeyed / known if known > 0.0 else math.nan
    return found
