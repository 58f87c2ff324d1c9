"""The contract of metrics of users: a number from the log of a robot."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError
from crowdbot.metrics.agent_states import AgentLog

from .robot_log import RobotLog


@dataclass(frozen=True)
class LogMetric(ABC):
    """A metric of one robot among people, from its log.

    >>> import numpy as np
    >>> @dataclass(frozen=True)
    ... class TimeNear(LogMetric):
    ...     distance: float = 1.0
    ...     def measure(self, log):
    ...         near = (log.gap < self.distance).any(axis=1)
    ...         return float(np.sum(near[1:] * np.diff(log.times)))
    >>> check_log_metric(TimeNear())
    """

    @abstractmethod
    def measure(self, log: RobotLog) -> float:
        """Return the value of a log; NaN if the log does not have what the metric needs."""

    def value(self, log: RobotLog) -> float:
        """Return the value of a log as a number.

        Raises:
            InputError: :meth:`measure` raised, or did not return a number.
        """
        name = type(self).__name__
        try:
            found = self.measure(log)
        except Exception as error:  # code of users may raise anything
            raise InputError(f"metric {name}: {type(error).__name__}: {error}") from error
        if isinstance(found, bool | np.bool_) or not isinstance(found, int | float | np.integer | np.floating):
            raise InputError(f"metric {name} returned a {type(found).__name__}, it must return a number")
        return float(found)


def check_log_metric(metric: LogMetric) -> None:
    """Check that a metric keeps its contract on small logs with and without people.

    Raises:
        InputError: the first violated rule.
    """
    name = type(metric).__name__
    if not isinstance(metric, LogMetric):
        raise InputError(f"{name} is not a LogMetric")
    parameters = getattr(metric, "__dataclass_params__", None)
    if parameters is None or not parameters.frozen:
        raise InputError(f"{name} is not frozen; decorate the class with @dataclass(frozen=True)")
    for people in (0, 1, 3):
        log, again = _log(people), _log(people)
        first, second = metric.value(log), metric.value(again)
        if first != second and not (np.isnan(first) and np.isnan(second)):
            raise InputError(f"{name} is not deterministic: the same log gave {first} and {second}")
        for field in ("position", "people_position", "times"):
            if not np.array_equal(getattr(log, field), getattr(_log(people), field), equal_nan=True):
                raise InputError(f"{name}.measure changes the log; it must only read it")


def _log(people: int) -> RobotLog:
    """Return a log of 3 s in which people pass a robot."""
    times = np.linspace(0.0, 3.0, 31)
    position = np.zeros((31, people + 1, 2))
    position[:, 0, 0] = times
    for k in range(people):
        position[:, k + 1] = np.stack([4.0 - 1.2 * times, np.full(31, 0.8 + k)], axis=1)
    velocity = np.zeros(position.shape)
    velocity[:, 0, 0], velocity[:, 1:, 0] = 1.0, -1.2
    heading = np.zeros((31, people + 1))
    agents = AgentLog(times, position, velocity, heading, np.full(heading.shape, 0.3), np.ones(heading.shape, bool))
    return RobotLog.of(agents, robot=0, goal=(6.0, 0.0))
