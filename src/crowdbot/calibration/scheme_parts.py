"""Parts of a scheme (model, goal, cost, search), from instances or names."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import cast

from crowdbot import models
from crowdbot.core import InputError, find_class, kebab_case
from crowdbot.data import Recording
from crowdbot.models import CrowdModel, Goal, GroundTruth, goals

from .cost import Cost
from .search import Search

__all__ = ["goal_class", "goal_for", "resolve_cost", "resolve_goal", "resolve_model", "resolve_search"]


def resolve_model(value: CrowdModel | str) -> CrowdModel:
    """Return a crowd model from an instance, a name or an address, with default parameters."""
    return cast(CrowdModel, _resolve(value, models, CrowdModel))


def resolve_goal(value: Goal | str) -> Goal:
    """Return a goal from an instance, a name or an address, with default parameters."""
    return cast(Goal, _resolve(value, goals, Goal))


def goal_class(name: str) -> type[Goal]:
    """Return the class of a goal by its name or address."""
    return cast(type[Goal], find_class(name, goals, Goal))


def goal_for(name: str, recording: Recording) -> Goal:
    """Return a goal for a recording: one that knows the future is given it, one that learns learns from it.

    Raises:
        InputError: the name is unknown, or the goal learns and no part of the recording was kept for it.
    """
    kind = goal_class(name)
    if issubclass(kind, GroundTruth):
        return GroundTruth(*recording.windows)
    if kind.learns:
        return kind.learn(recording.learning_part)
    return resolve_goal(name)


def resolve_cost(value: Cost | str) -> Cost:
    """Return a cost from an instance, a name or an address."""
    return cast(Cost, _resolve(value, sys.modules[__package__ or ""], Cost))


def resolve_search(value: Search | str) -> Search:
    """Return a search from an instance, a name or an address, with default parameters."""
    return cast(Search, _resolve(value, sys.modules[__package__ or ""], Search))


def _resolve(value: object, room: ModuleType, contract: type) -> object:
    """Return a value as it is, or an instance of the class that a name means.

    Raises:
        InputError: no class has this name, it cannot be made without arguments, or the value is not of the contract.
    """
    if isinstance(value, str):
        kind = find_class(value, room, contract)
        try:
            return kind()
        except TypeError:
            raise InputError(
                f"{kebab_case(kind.__name__)} needs values of its own: pass an instance, not its name"
            ) from None
    if not isinstance(value, contract):
        raise InputError(f"{value!r} is not a {contract.__name__}, nor the name of one")
    return value
