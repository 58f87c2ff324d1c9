"""Options of predictors and calibration schemes, shared by several commands."""

from __future__ import annotations

import argparse
import itertools
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from .settings import parse_settings

if TYPE_CHECKING:
    from crowdbot.calibration import PopulationPrior, Search
    from crowdbot.models import CrowdModel
    from crowdbot.prediction import Predictor, PredictorSpec

    from .parser import CommandParser


SCHEME = ("model", "cost", "search", "goal", "free", "prior", "shared")
"""Options that apply to simulated predictors only."""


def add_scheme(parser: CommandParser, many: bool) -> None:
    """Declare the options of a scheme; with ``many``, options accept lists and all combinations are evaluated."""
    several: dict[str, Any] = {"nargs": "+"} if many else {}
    add = parser.add_argument_group(
        "simulated people", "names are in `crowdbot list models`, costs, searches and goals"
    ).add_argument
    add("--model", **several, metavar="NAME", help="crowd model (default: orca)")
    add(
        "--cost",
        **several,
        metavar="NAME",
        help="calibration cost (default: progressive with --search)",
    )
    add(
        "--search",
        **several,
        metavar="NAME",
        help="calibration search (default: genetic with --cost)",
    )
    add(
        "--goal",
        **several,
        metavar="NAME",
        help="goals of people (default: current-direction)",
    )
    add = parser.add_rare_group("search of parameters").add_argument
    add("--budget", type=int, default=500, metavar="N", help="evaluations per window (default: 500)")
    add("--tolerance", type=float, metavar="METRES", help="cost at which a search stops (default: 0)")
    add(
        "--patience",
        type=int,
        metavar="N",
        help="evaluations without improvement after which a search stops (default: none)",
    )
    add("--free", nargs="+", default=[], metavar="NAME", help="calibrated parameters (default: all)")
    learned = ", or `learn`: estimated from the --learn share of each recording" if many else ""
    add("--prior", metavar="FILE", help=f"population prior, a file of `crowdbot calibrate`{learned} (default: none)")
    if many:
        add("--shared", action="store_true", help="one common set of parameters, fitted to the --learn share")


def predictor_specs(options: argparse.Namespace) -> tuple[PredictorSpec, ...]:
    """Return the predictors of the options; simulated predictors in every combination of scheme options.

    Raises:
        InputError: unknown name, or scheme options without a simulated predictor.
    """
    from crowdbot import prediction
    from crowdbot.core import InputError, find_class

    values = parse_settings(options.set)
    specs: list[PredictorSpec] = []
    used = False
    for name in options.predictor:
        kind = find_class(name, prediction, prediction.Predictor)
        if issubclass(kind, prediction.Simulated):
            used = True
            specs += _schemes(options, values)
        else:
            specs.append(
                prediction.PredictorSpec(build_predictor(name, None, values if len(options.predictor) == 1 else {}))
            )
    given = next((part for part in SCHEME if getattr(options, part)), None)
    if given is not None and not used:
        raise InputError(f"--{given} requires the predictor simulated, not {', '.join(options.predictor)}")
    return tuple(specs)


def frame_line(
    frame: int | None = None, people: int = 0, cost: float = math.nan, evaluations: int = 0, seconds: float = 0.0
) -> str:
    """Return the line of one calibrated frame, or the header line."""
    if frame is None:
        return "frame    people  minimum cost [m]  evaluations  seconds"
    least = "-" if math.isnan(cost) else f"{cost:.5f}"
    return f"{frame:<8d} {people:6d}  {least:>16}  {evaluations:11d}  {seconds:7.4f}"


def _schemes(options: argparse.Namespace, values: Mapping[str, str]) -> list[PredictorSpec]:
    from crowdbot.calibration import goal_class
    from crowdbot.prediction import PredictorSpec

    learns = options.prior == "learn"
    own: dict[str, Any] = {"budget": options.budget, "free": tuple(options.free)}
    own["prior"] = None if learns else prior(options.prior)
    made = []
    parts = (options.model or ["orca"], options.cost or [None], options.search or [None], options.goal or [None])
    for model, cost, search, goal in itertools.product(*parts):
        calibrated = cost is not None or search is not None
        fields = {"cost": cost, "search": named_search(search, options), **(own if calibrated else {})}
        predictor = build_predictor("simulated", model, values, fields)
        kind = goal_class(goal or "current-direction")
        late = kind.knows_future or kind.learns
        if goal is not None and not late:
            predictor = build_predictor("simulated", model, values, {**fields, "goal": goal})
        made.append(PredictorSpec(predictor, goal if late else None, learns, options.shared))
    return made


def named_search(name: str | None, options: argparse.Namespace) -> Search | None:
    """Return a search by name, with the options --tolerance and --patience."""
    import dataclasses

    from crowdbot.calibration import resolve_search as by_name
    from crowdbot.core import InputError

    given = {key: value for key in ("tolerance", "patience") if (value := getattr(options, key)) is not None}
    if name is None and given:
        raise InputError(f"--{next(iter(given))} requires --search")
    return None if name is None else dataclasses.replace(by_name(name), **given)


def prior(file: str | None) -> PopulationPrior | None:
    """Return the population prior from a file, or None."""
    from crowdbot.calibration import PopulationPrior

    return None if file is None else PopulationPrior.load(file)


def build_predictor(
    name: str, model: str | None, values: Mapping[str, str], fields: Mapping[str, Any] | None = None
) -> Predictor:
    """Return a predictor by name; parameters that it does not have go to its crowd model."""
    import dataclasses

    from crowdbot import prediction
    from crowdbot.core import InputError, find_class, from_attributes, kebab_case

    kind = find_class(name, prediction, prediction.Predictor)
    known = {field.name for field in dataclasses.fields(kind)}
    if "model" not in known:
        if model is not None:
            raise InputError(f"--model requires the predictor simulated, not {kebab_case(kind.__name__)}")
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
