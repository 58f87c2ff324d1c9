"""Robots commanded from outside: sources of their orders, and a warning about runs in which nobody commands them."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from crowdbot.core import InputError
from crowdbot.navigation import ExternalNavigator
from crowdbot.trials import Trial

if TYPE_CHECKING:
    from .orders.order import Order


@runtime_checkable
class OwnSource(Protocol):
    """A source of orders that a navigator of a trial opens itself, such as a connection to a robot software."""

    def orders(self, simulation: Any) -> Iterable[Order]:
        """Return the orders for this step."""

    def close(self) -> None:
        """End the connection; without effect the second time."""

    def hold(self, stop: bool, reason: str) -> str:
        """Let the robots of the source stand, or release them; return why they are not released. From any thread."""

    def problems(self) -> list[str]:
        """Return why robots of the source stand, for people. From any thread."""


def has_own_source(trial: Trial) -> bool:
    """Return whether a navigator of the trial opens the source of its orders itself."""
    return any(isinstance(robot.navigator, ExternalNavigator) and robot.navigator.source for robot in trial.robots)


def open_own_sources(simulation: Any) -> tuple[OwnSource, ...]:
    """Open the sources of orders of the navigators of a simulation, one for all robots with equal navigators.

    The navigator names a function in a higher room by its address, so that this room imports none of them.

    Raises:
        InputError: the simulation has several environments, or a source cannot be opened.
    """
    groups: dict[ExternalNavigator, list[str]] = {}
    for control in simulation.robots:
        navigator = control.robot.navigator
        if isinstance(navigator, ExternalNavigator) and navigator.source:
            groups.setdefault(navigator, []).append(control.robot.name)
    if groups and simulation.count > 1:
        raise InputError(f"navigator {next(iter(groups)).title()} drives one environment, not {simulation.count}")
    opened: list[OwnSource] = []
    try:
        for navigator, names in groups.items():
            module, _, function = navigator.source.partition(":")
            opened.append(getattr(importlib.import_module(module), function)(navigator, tuple(names), simulation))
    except BaseException:
        for item in opened:
            item.close()
        raise
    return tuple(opened)


class UncommandedRobotWarning(UserWarning):
    """A robot waits for orders from outside in a run without a source of orders."""


def warn_of_missing_source(trial: Trial, sources: Sequence[object], levels: int = 0) -> None:
    """Issue an :class:`UncommandedRobotWarning` if a robot waits for orders and there is no source of orders."""
    names = [
        repr(robot.name)
        for robot in trial.robots
        if isinstance(robot.navigator, ExternalNavigator)
        and not robot.navigator.source
        and (robot.pose is None or robot.pose.source == "external")
    ]
    if names and not sources:
        robots, verb = ("robot", "stands") if len(names) == 1 else ("robots", "stand")
        sentence = (
            f"trial {trial.name!r}: {robots} {', '.join(names)} {verb} still, since the navigator is external and this"
            " run has no source of orders"
        )
        warnings.warn(sentence, UncommandedRobotWarning, stacklevel=3 + levels)
