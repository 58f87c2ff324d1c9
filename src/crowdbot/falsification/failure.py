"""FailureCriterion: when a run counts as a failure, and how far it is from one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from crowdbot.core import InputError, did_you_mean
from crowdbot.evaluation import Requirement, parse_requirement

FAILURES = ("collision", "timeout", "severity", "any")
"""Kinds of failures with a name."""
SAFE = 1e-6
"""Least robustness of a run without a failure."""


@dataclass(frozen=True)
class FailureCriterion:
    """When a run fails, with its robustness: above 0 without a failure, at most 0 for a failure.

    A run whose navigator raises, hangs or returns NaN always fails, with robustness -1.

    ============= ======================================= =============================== ===========================
    kind          failure                                 robustness without a failure    robustness of a failure
    ============= ======================================= =============================== ===========================
    collision     a person, robot or wall is touched      exp(-urgency / 1 s)             -impact speed [m/s]
    timeout       the goal is not reached in time         rest of the time [s]            -share of the way left
    severity      an impact above the limit (physics)     1 - severity                    1 - severity
    any           the goal is not reached                 the smaller of the first two    of its kind
    a requirement the requirement does not hold           distance to its bound           distance to its bound
    ============= ======================================= =============================== ===========================

    The urgency is that of :func:`collision_urgency`. The smallest clearance to a wall [m] counts where it is smaller.

    Fields:
        kind: one of :data:`FAILURES`, or ``requirement``.
        requirement: the requirement on a metric of one run.

    >>> clearance = {"collision": 0.0, "min_clearance": 0.3, "min_wall_clearance": 0.2}
    >>> parse_failure("collision").robustness("success", clearance, 40.0, 0.5)
    0.2
    >>> parse_failure("min-clearance>0.5").robustness("success", clearance, 40.0, 0.5)
    -0.2
    """

    kind: str
    requirement: Requirement | None = None

    @property
    def text(self) -> str:
        """The criterion as text that :func:`parse_failure` reads."""
        return self.kind if self.requirement is None else self.requirement.text

    def robustness(self, outcome: str, metrics: Mapping[str, float], duration: float, urgency: float) -> float:
        """Return the robustness of a run.

        Args:
            outcome: outcome of the episode.
            metrics: its metrics.
            duration: duration of the trial [s].
            urgency: urgency of the run [s].

        Raises:
            InputError: the runs do not have the metric.
        """
        if outcome == "error" or (outcome == "fall" and self.kind == "any"):
            return -1.0
        if self.requirement is not None:
            return self._margin(self.requirement, metrics)
        if self.kind == "severity":
            if "max_severity" not in metrics:
                raise InputError('failure "severity" needs world="physics", which measures forces')
            severity = metrics["max_severity"]
            return 1.0 if math.isnan(severity) else 1.0 - severity
        if self.kind == "collision":
            return _margin_of_contact(metrics, urgency)
        rest = _rest(metrics, duration)
        return rest if self.kind == "timeout" else min(_margin_of_contact(metrics, urgency), rest)

    @staticmethod
    def _margin(requirement: Requirement, metrics: Mapping[str, float]) -> float:
        name = requirement.statistic.metric
        if name not in metrics:
            raise InputError(f"requirement {requirement.text!r}: the runs have no metric {name.replace('_', '-')!r}")
        value = metrics[name]
        if math.isnan(value):
            return -1.0
        sign = 1.0 if requirement.comparison in (">", ">=") else -1.0
        margin = round(sign * (value - requirement.bound), 12)
        return SAFE if margin == 0.0 and requirement.comparison.endswith("=") else margin


def _margin_of_contact(metrics: Mapping[str, float], urgency: float) -> float:
    if metrics["collision"] > 0.5:
        speed = metrics.get("max_impact_speed", 0.0)
        return -max(SAFE, 0.0 if math.isnan(speed) else speed)
    wall = metrics.get("min_wall_clearance", math.inf)
    return max(SAFE, min(math.exp(-urgency), math.inf if math.isnan(wall) else wall))


def _rest(metrics: Mapping[str, float], duration: float) -> float:
    if metrics["timeout"] > 0.5:
        return -max(SAFE, 1.0 - metrics.get("goal_progress", 0.0))
    time = metrics.get("time_to_goal", math.nan)
    return max(SAFE, duration if math.isnan(time) else duration - time)


def parse_failure(text: str) -> FailureCriterion:
    """Return the criterion of a text: a name, or a requirement whose breach is the failure.

    Args:
        text: ``collision``, ``timeout``, ``severity``, ``any``, or a bound such as ``min-clearance>0.2``.

    Raises:
        InputError: there is no such failure, or the requirement is about many runs.
    """
    word = text.strip()
    if word in FAILURES:
        return FailureCriterion(word)
    if not any(sign in word for sign in "<>"):
        raise InputError(
            f"failure {text!r} is unknown{did_you_mean(word, FAILURES)}; known are {', '.join(FAILURES)}, and"
            " requirements such as min-clearance>0.2"
        )
    requirement = parse_requirement(word)
    if requirement.confidence is not None or requirement.statistic.kind != "mean":
        raise InputError(f"failure {text!r} must bound a metric of one run, such as min-clearance>0.2")
    return FailureCriterion("requirement", requirement)
