"""Gestures of people to the robot: whether it does what they say."""

from __future__ import annotations

import itertools
import math

import numpy as np

from crowdbot.core import GESTURES
from crowdbot.metrics.motion import STALL_SPEED

from .metric import undefined_metrics
from .robot_log import RobotLog

ALLOWANCE = 1.0
"""Time after the beginning of a gesture that does not count [s]: to see it, and to brake or to start."""


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
