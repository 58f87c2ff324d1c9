"""Metrics of the decisions of a robot: their compute time in real time, and missed deadlines."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.simulation import Episode

DECISION_METRICS = ("decision_time", "decision_time_p99", "missed_deadlines")
"""Metrics of real time, which differ between equal runs."""


def decision_metrics(episode: Episode) -> dict[str, float]:
    """Return the compute times and missed deadlines of the first robot; empty if its decisions are not measured.

    Measured are the decisions of a robot with a ``deadline``, of robot software that is connected over a bridge, and of
    a navigator in a process of its own. The definitions are those of the family ``decisions`` of
    :func:`crowdbot.metrics.metric_families`.

    >>> from crowdbot.simulation import simulate
    >>> from crowdbot.trials import load_trial
    >>> decision_metrics(simulate(load_trial("frontal", duration=1.0), 0))
    {}
    """
    if not episode.trial.robots:
        return {}
    robot = episode.trial.robots[0]
    times = np.array(episode.decision_times.get(robot.name, ()), dtype=np.float64)
    if not len(times):
        return {}
    missed = math.nan if robot.deadline is None else float(np.mean(times > robot.deadline))
    values = float(np.median(times)), float(np.percentile(times, 99)), missed
    return dict(zip(DECISION_METRICS, values, strict=True))
