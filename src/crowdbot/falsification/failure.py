"""FailureCriterion: when a run counts as a failure, how far it is from one, and what happens in it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, did_you_mean, wrap_angle
from crowdbot.evaluation import Requirement, parse_requirement
from crowdbot.simulation import WALL, Episode

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


SIDES = ("ahead", "left", "behind", "right")


def describe_event(episode: Episode) -> str:
    """Return what a failure is, such as ``collision, person left``.

    The side is where the other body is, in the frame of the first robot, in quarters of 90 degrees: ahead is 45 degrees
    to the left to 45 degrees to the right.

    >>> from crowdbot.simulation import simulate
    >>> from crowdbot.trials import load_trial
    >>> describe_event(simulate(load_trial("frontal", duration=1.0)))
    'timeout'
    """
    if episode.outcome == "error":
        return "error" if episode.failure is None else f"error: {str(episode.failure)[:60]}"
    robot = episode.robots[0]
    own = int(episode.ids[robot])
    touched = next(((time, item) for time, item in episode.contacts if own in (item.robot, item.other)), None)
    if touched is None or not episode.metrics.get("collision"):
        return episode.outcome
    time, contact = touched
    other = contact.other if contact.robot == own else contact.robot
    if other == WALL:
        return f"{episode.outcome}, wall"
    kind = "robot" if other in [int(episode.ids[k]) for k in episode.robots] else "person"
    row = min(int(np.searchsorted(episode.times, time - 1e-9)), len(episode.times) - 1)
    column = np.flatnonzero(episode.ids == other)
    if not len(column) or not episode.active[row, column[0]]:
        return f"{episode.outcome}, {kind}"
    away = episode.position[row, column[0]] - episode.position[row, robot]
    angle = wrap_angle(math.atan2(away[1], away[0]) - float(episode.heading[row, robot]))
    side = SIDES[round(angle / (math.pi / 2.0)) % 4]
    return f"{episode.outcome}, {kind} {side}"


FADE = 1.0
"""Time to collision [s] at which the urgency is 1/e."""


def collision_urgency(episode: Episode) -> float:
    """Return the time integral [s] of the urgency of the first robot: exp(-TTC / 1 s) of its most urgent neighbour.

    TTC is the time to collision of two circles that keep their present velocities; it is infinite if they miss each
    other. A method that holds a margin keeps its smallest clearance there in nearly every run; this integral still
    differs from run to run.

    Source: after the time integrated time-to-collision of Minderhoud & Bovy 2001, doi:10.1016/S0001-4575(00)00019-1.

    >>> from crowdbot.simulation import simulate
    >>> from crowdbot.trials import load_trial
    >>> 0.0 < collision_urgency(simulate(load_trial("frontal", duration=4.0), 0)) < 4.0
    True
    """
    robot = episode.robots[0]
    others = np.delete(np.arange(len(episode.ids)), robot)
    if not len(others) or len(episode.times) < 2:
        return 0.0
    away = episode.position[:, others] - episode.position[:, [robot]]
    speed = episode.velocity[:, others] - episode.velocity[:, [robot]]
    square = np.maximum(np.sum(speed**2, axis=2), 1e-12)
    approach = -np.sum(away * speed, axis=2)
    gap = np.maximum(np.sum(away**2, axis=2) - (episode.radius[others] + episode.radius[robot]) ** 2, 0.0)
    root = approach**2 - square * gap
    meets = (root >= 0.0) & (approach > 0.0) & episode.active[:, others]
    time = np.where(meets, (approach - np.sqrt(np.maximum(root, 0.0))) / square, np.inf)
    urgency = np.exp(-time / FADE).max(axis=1)
    return float(np.sum(urgency[:-1] * np.diff(episode.times)))
