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
    """Return a goal for a recording: with its true future, fitted to its learning part, or for its layout.

    Raises:
        InputError: the name is unknown, or the goal is learned and the recording has no learning part.
    """
    kind = goal_class(name)
    if issubclass(kind, GroundTruth):
        return GroundTruth(*recording.windows)
    if kind.learns:
        known = recording.layout is not None and recording.learn == 0.0
        return kind.at(recording.layout) if known and recording.layout else kind.learn(recording.learning_part)
    return resolve_goal(name)


def resolve_cost(value: Cost | str) -> Cost:
    """Return a cost from an instance, a name or an address."""
    return cast(Cost, _resolve(value, sys.modules[__package__ or ""], Cost))


def resolve_search(value: Search | str) -> Search:
    """Return a search from an instance, a name or an address, with default parameters."""
    return cast(Search, _resolve(value, sys.modules[__package__ or ""], Search))


def _resolve(value: object, room: ModuleType, contract: type) -> object:
    """Return the value itself, or an instance of the class with this name.

    Raises:
        InputError: the name is unknown, the class has no default values, or the value does not fulfil the contract.
    """
    if isinstance(value, str):
        kind = find_class(value, room, contract)
        try:
            return kind()
        except TypeError:
            raise InputError(
                f"{kebab_case(kind.__name__)} has no default values; pass an instance instead of the name"
            ) from None
    if not isinstance(value, contract):
        raise InputError(f"{value!r} is not a {contract.__name__} or the name of one")
    return value
