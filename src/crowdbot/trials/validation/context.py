"""Validation context: a trial whose values are allowed one by one, for the checks of what they mean together."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from crowdbot.core import InputError, UnreadableValue
from crowdbot.trials.agent import Agent
from crowdbot.trials.crowd import Crowd, Crowds
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.trials.trial import Trial
from crowdbot.world import Router

Problems = Iterator[tuple[Any, str]]
"""Elements with a problem, each with the end of a sentence about it."""
T = TypeVar("T")


def skip_unreadable(*checks: Iterator[T]) -> Iterator[T]:
    """Yield the results of several checks; a check ends where it needs code of the user that must not run."""
    for check in checks:
        try:
            yield from check
        except UnreadableValue:
            continue


@dataclass(frozen=True)
class ValidationContext:
    """A trial, and the seed with which its people are placed (default: that of the trial)."""

    trial: Trial
    given_seed: int | None = None

    @property
    def seed(self) -> int:
        """Random seed."""
        return self.trial.seed if self.given_seed is None else self.given_seed

    @property
    def people(self) -> tuple[Agent | Spawner | SourceSpec, ...]:
        """Agents, spawners and sources."""
        return (*self.trial.agents, *self.trial.spawners, *self.trial.sources)

    @functools.cached_property
    def crowds(self) -> tuple[Crowd, ...]:
        """Crowds of the trial."""
        return Crowds.spread(self.trial.crowd)

    @property
    def router(self) -> Router | None:
        """The router of the stage, None without routing or if it is impossible."""
        return None if isinstance(self._routing, str) else self._routing

    @property
    def no_routing(self) -> str:
        """Why routing on this stage is impossible, empty if it is possible."""
        return self._routing if isinstance(self._routing, str) else ""

    @functools.cached_property
    def _routing(self) -> Router | str | None:
        if self.trial.routing is None:
            return None
        try:
            return self.trial.routing.router(self.trial.stage.walking_walls())
        except InputError as error:
            return str(error).removeprefix("Router: ")
