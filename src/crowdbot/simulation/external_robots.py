"""Robots commanded from outside: warning about runs in which nobody commands them."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

from crowdbot.navigation import ExternalNavigator
from crowdbot.trials import Trial

__all__ = ["UncommandedRobotWarning", "warn_of_missing_source"]


class UncommandedRobotWarning(UserWarning):
    """A robot waits for orders from outside in a run without a source of orders."""


def warn_of_missing_source(trial: Trial, sources: Sequence[object], levels: int = 0) -> None:
    """Issue an :class:`UncommandedRobotWarning` if a robot waits for orders and there is no source of orders."""
    names = [
        repr(robot.name)
        for robot in trial.robots
        if isinstance(robot.navigator, ExternalNavigator) and (robot.pose is None or robot.pose.source == "external")
    ]
    if names and not sources:
        robots, verb = ("robot", "stands") if len(names) == 1 else ("robots", "stand")
        sentence = (
            f"trial {trial.name!r}: {robots} {', '.join(names)} {verb} still, since the navigator is external and this"
            " run has no source of orders"
        )
        warnings.warn(sentence, UncommandedRobotWarning, stacklevel=3 + levels)
