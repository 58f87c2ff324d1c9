"""Options about predictors and schemes, shared by the commands that predict."""

from __future__ import annotations

import argparse
import itertools
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from crowdbot.calibration import PopulationPrior, Search
    from crowdbot.models import CrowdModel
    from crowdbot.prediction import Predictor, Recipe

__all__ = ["add_scheme", "assignments", "chosen", "crowd_model", "frame_line", "named_search", "prior", "recipes"]

SCHEME = ("model", "cost", "search", "goal", "free", "prior", "shared")
"""Options that only predictors which simulate a crowd understand."""


def add_scheme(parser: argparse.ArgumentParser, many: bool) -> None:
    """Declare the parts of a scheme; ``many`` lets each be a list, and all combinations are made."""
    several: dict[str, Any] = {"nargs": "+"} if many else {}
    add = parser.add_argument
    add("--model", **several, metavar="NAME", help="crowd model: crowdbot list models (default orca)")
    add("--cost", **several, metavar="NAME", help="cost of a calibration: crowdbot list costs")
    add("--search", **several, metavar="NAME", help="search of a calibration: crowdbot list searches")
    add("--goal", **several, metavar="NAME", help="where people want to go: crowdbot list goals")
    add("--budget", type=int, default=500, metavar="N", help="crowds tried for each window (default 500)")
    add("--tolerance", type=float, metavar="METRES", help="a search stops at this cost (default 0)")
    add("--patience", type=int, metavar="N", help="a search stops when N evaluations brought nothing (default: never)")
    add("--free", nargs="+", default=[], metavar="NAME", help="parameters that are calibrated (default: all)")
    learned = ", or `learn`: from the --learn share of each recording" if many else ""
    add("--prior", metavar="FILE", help=f"what is known of parameters: made by crowdbot calibrate{learned}")
    if many:
        add("--shared", action="store_true", help="one set of parameters, fitted to the --learn share")


def recipes(options: argparse.Namespace) -> tuple[Recipe, ...]:
    """Return the predictors that the options name; those that simulate a crowd in every combination of scheme parts.

    Raises:
        InputError: a name is unknown, or parts of a scheme are given and no predictor simulates a crowd.
    """
    from crowdbot import prediction
    from crowdbot.core import InputError, find_class

    values = assignments(options.set)
    found: list[Recipe] = []
    used = False
    for name in options.predictor:
        kind = find_class(name, prediction, prediction.Predictor)
        if issubclass(kind, prediction.Simulated):
            used = True
            found += _schemes(options, values)
        else:
            found.append(prediction.Recipe(chosen(name, None, values if len(options.predictor) == 1 else {})))
    given = next((part for part in SCHEME if getattr(options, part)), None)
    if given is not None and not used:
        raise InputError(f"--{given} is for predictors that simulate a crowd; {', '.join(options.predictor)} does not")
    return tuple(found)


def frame_line(
    frame: int | None = None, people: int = 0, cost: float = math.nan, evaluations: int = 0, seconds: float = 0.0
) -> str:
    """Return the line about one frame that was calibrated, or the head of these lines."""
    if frame is None:
        return "frame    people  minimum cost [m]  evaluations  seconds"
    least = "-" if math.isnan(cost) else f"{cost:.5f}"
    return f"{frame:<8d} {people:6d}  {least:>16}  {evaluations:11d}  {seconds:7.4f}"


def _schemes(options: argparse.Namespace, values: Mapping[str, str]) -> list[Recipe]:
    from crowdbot.calibration import kind_of_goal
    from crowdbot.prediction import Recipe

    learns = options.prior == "learn"
    own: dict[str, Any] = {"budget": options.budget, "free": tuple(options.free)}
    own["prior"] = None if learns else prior(options.prior)
    made = []
    parts = (options.model or ["orca"], options.cost or [None], options.search or [None], options.goal or [None])
    for model, cost, search, goal in itertools.product(*parts):
        calibrated = cost is not None or search is not None
        fields = {"cost": cost, "search": named_search(search, options), **(own if calibrated else {})}
        predictor = chosen("simulated", model, values, fields)
        kind = kind_of_goal(goal or "current-direction")
        late = kind.knows_future or kind.learns
        if goal is not None and not late:
            predictor = chosen("simulated", model, values, {**fields, "goal": goal})
        made.append(Recipe(predictor, goal if late else None, learns, options.shared))
    return made


def named_search(name: str | None, options: argparse.Namespace) -> Search | None:
    """Return the search by its name, with the tolerance and patience that were given."""
    import dataclasses

    from crowdbot.calibration import named_search as by_name
    from crowdbot.core import InputError

    given = {key: value for key in ("tolerance", "patience") if (value := getattr(options, key)) is not None}
    if name is None and given:
        raise InputError(f"--{next(iter(given))} belongs to a search: name one with --search")
    return None if name is None else dataclasses.replace(by_name(name), **given)


def prior(file: str | None) -> PopulationPrior | None:
    """Return the population prior of a file, or None."""
    from crowdbot.calibration import PopulationPrior

    return None if file is None else PopulationPrior.load(file)


def assignments(words: list[str]) -> dict[str, str]:
    """Return ``name=value`` words as a mapping."""
    from crowdbot.core import InputError

    wrong = next((word for word in words if "=" not in word), None)
    if wrong is not None:
        raise InputError(f"--set takes NAME=VALUE, not {wrong!r}")
    return {name: value for name, _, value in (word.partition("=") for word in words)}


def chosen(
    name: str, model: str | None, values: Mapping[str, str], fields: Mapping[str, Any] | None = None
) -> Predictor:
    """Return the predictor by name with its parameters; the crowd model's own parameters go to the model."""
    import dataclasses

    from crowdbot import prediction
    from crowdbot.core import InputError, find_class, from_attributes, kebab_case

    kind = find_class(name, prediction, prediction.Predictor)
    known = {field.name for field in dataclasses.fields(kind)}
    if "model" not in known:
        if model is not None:
            raise InputError(f"--model is for predictors that simulate a crowd; {kebab_case(kind.__name__)} does not")
        return from_attributes(kind, values)  # type: ignore[no-any-return]
    own = {key: value for key, value in values.items() if key.replace("-", "_") in known}
    rest = {key: value for key, value in values.items() if key not in own}
    crowd = crowd_model(model or "orca", rest)
    return dataclasses.replace(from_attributes(kind, own), model=crowd, **(fields or {}))  # type: ignore[no-any-return]


def crowd_model(name: str, values: Mapping[str, str]) -> CrowdModel:
    """Return a crowd model by name with its parameters."""
    from crowdbot import models
    from crowdbot.core import find_class, from_attributes

    return from_attributes(find_class(name, models, models.CrowdModel), values)  # type: ignore[no-any-return]
