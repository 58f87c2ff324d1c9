"""Validation context: the elements of a trial, complete or partial, for its checks."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from crowdbot.core import InputError, UnreadableValue, nearest_name
from crowdbot.trials.agent import Agent
from crowdbot.trials.crowd import Crowd
from crowdbot.trials.fields import outline
from crowdbot.trials.partial_element import PartialElement, fill_defaults, kind_of, readable
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.trials.stage import Stage
from crowdbot.trials.trial import Trial
from crowdbot.world import Router

Problems = Iterator[tuple[Any, str]]
"""Elements with a problem, each with the end of a sentence about it."""


class DeclaredNames(NamedTuple):
    """The names of all elements of a kind.

    Fields:
        known: the readable names.
        doubtful: the names that are invalid or duplicate, and None for each name that is missing.
    """

    known: list[str]
    doubtful: list[str | None]

    @classmethod
    def of(cls, things: Sequence[Any]) -> DeclaredNames:
        """Return the names of elements."""
        known, doubtful = list[str](), list[str | None]()
        for thing in things:
            part = next(part for part in outline(kind_of(thing)) if part.name == "name")
            name = next((name for _, name in readable([thing], "name") if name), None)
            if name is None or name in known or part.wrong(name):
                doubtful.append(name)
            known += [name] if name else []
        return cls(known, doubtful)

    def lack(self, name: str) -> bool:
        """Return whether no element has a name, and none with a doubtful name can be meant."""
        sure = [one for one in self.known if one not in self.doubtful]
        return name not in self.known and (not self.doubtful or bool(nearest_name(name, sure)))


@dataclass(frozen=True)
class ValidationContext:
    """A trial, partial if it has a problem, and the crowds in its file."""

    trial: Trial
    crowds: Sequence[Crowd]
    given_seed: int | None = None

    @property
    def seed(self) -> int:
        """Random seed, 0 if it could not be read."""
        if self.given_seed is not None:
            return self.given_seed
        return next((seed for _, seed in readable([self.trial], "seed")), 0)

    @property
    def people(self) -> tuple[Agent | Spawner | SourceSpec, ...]:
        """Agents, spawners and sources."""
        return (*self.trial.agents, *self.trial.spawners, *self.trial.sources)

    @property
    def crowd_names(self) -> DeclaredNames:
        """Names of the crowds; a single crowd needs none."""
        if len(self.crowds) == 1 and not self.crowds[0].name:
            return DeclaredNames([], [])
        return DeclaredNames.of(self.crowds) if self.crowds else DeclaredNames([], [None])

    @functools.cached_property
    def stage(self) -> Stage:
        """The stage without its unreadable parts, which can only add problems of places."""
        stage = self.trial.stage
        if not all(readable([stage], name) for name in ("offset", "rotation")):  # its files may be anywhere
            stage = _without(stage, {id(stage): {"area", "map"}})
        whole: Stage = fill_defaults(stage)
        return whole

    @property
    def router(self) -> Router | None:
        """The router of the stage, None without routing.

        Raises:
            UnreadableValue: routing is impossible.
        """
        if self.trial.routing is None:
            return None
        if isinstance(self._routing, str):
            raise UnreadableValue(self._routing)
        return self._routing

    @property
    def no_routing(self) -> str:
        """Why routing on this stage is impossible, empty if it is possible."""
        return self._routing if self.trial.routing is not None and isinstance(self._routing, str) else ""

    @functools.cached_property
    def _routing(self) -> Router | str:
        assert self.trial.routing is not None
        try:
            return self.trial.routing.router(self.stage.walking_walls())
        except InputError as error:
            return str(error).removeprefix("Router: ")

    def without(self, wrong: Mapping[int, set[str]]) -> ValidationContext:
        """Return a context in which wrong fields of elements, given by their ``id``, are unreadable."""
        return dataclasses.replace(self, trial=_without(self.trial, wrong)) if wrong else self


def _without(thing: Any, wrong: Mapping[int, set[str]]) -> Any:
    """Return an element, or a partial copy without its wrong fields."""
    if isinstance(thing, tuple):
        new = tuple(_without(one, wrong) for one in thing)
        return thing if all(a is b for a, b in zip(thing, new, strict=True)) else new
    if thing is None:
        return None
    cls, lost = kind_of(thing), wrong.get(id(thing), set())
    nested = [part.name for part in outline(cls) if part.role in ("child", "children") and part.into is None]
    values = {f.name: value for f in dataclasses.fields(cls) for _, value in readable([thing], f.name)}
    inner = {name: _without(values[name], wrong) for name in nested if name in values}
    if not lost and all(values[name] is value for name, value in inner.items()):
        return thing
    kept = {name: value for name, value in (values | inner).items() if name not in lost}
    return PartialElement(cls, kept, {field.name for field in dataclasses.fields(cls)} - {*kept}, origin=thing)
