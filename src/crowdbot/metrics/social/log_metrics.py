"""Metrics of a robot among people from its log: all families, or some."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from crowdbot.core import InputError, did_you_mean

from .comfort import comfort_metrics, conflict_metrics, force_metrics
from .group_intrusion import group_metrics
from .path_quality import legibility_metrics, motion_metrics, path_metrics
from .robot_log import RobotLog
from .severity import severity_metrics
from .surroundings import density_metrics, person_metrics
from .task import gesture_metrics, task_metrics

LOG_FAMILIES: dict[str, Callable[[RobotLog], dict[str, float]]] = {
    "task": task_metrics,
    "path": path_metrics,
    "motion": motion_metrics,
    "comfort": comfort_metrics,
    "conflict": conflict_metrics,
    "groups": group_metrics,
    "gestures": gesture_metrics,
    "force": force_metrics,
    "severity": severity_metrics,
    "density": density_metrics,
    "people": person_metrics,
    "legibility": legibility_metrics,
}
"""Families of metrics that need one log only."""


def log_metrics(log: RobotLog, families: Iterable[str] | None = None) -> dict[str, float]:
    """Return the metrics of a log by name; :func:`metric_table` has their units, formulas and sources.

    Args:
        log: the log.
        families: names in :data:`LOG_FAMILIES` (default: all).

    Raises:
        InputError: there is no such family.

    >>> import numpy as np
    >>> from crowdbot.metrics import AgentLog
    >>> place = np.array([[[0.5 * k, 0.0], [5.0, 3.0]] for k in range(11)])
    >>> agents = AgentLog(np.arange(11.0), place, np.gradient(place, axis=0), np.zeros((11, 2)), np.full((11, 2), 0.3),
    ...     np.ones((11, 2), bool))
    >>> values = log_metrics(RobotLog.of(agents, robot=0, goal=(5.0, 0.0)), ["task", "motion"])
    >>> values["failures_to_progress"], values["mean_speed"]
    (0.0, 0.5)
    """
    found: dict[str, float] = {}
    for name in LOG_FAMILIES if families is None else families:
        if name not in LOG_FAMILIES:
            known = ", ".join(LOG_FAMILIES)
            raise InputError(f"no family of metrics {name!r}{did_you_mean(name, LOG_FAMILIES)}; known are {known}")
        found |= LOG_FAMILIES[name](log)
    return found
