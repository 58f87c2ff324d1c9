"""Calibrator: which parameters make a crowd model walk like the people of a recording."""

from __future__ import annotations

import dataclasses
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from crowdbot import models
from crowdbot.core import InputError, Parameter, parameters, stream
from crowdbot.core.plug import find, kebab
from crowdbot.data.forecast import Forecast
from crowdbot.data.windows import Windows
from crowdbot.models import CrowdModel, goals
from crowdbot.models.goals import Goal

from .costs import Cost
from .rollout import Rollout
from .search import Search

__all__ = ["RADIUS", "Calibrator", "Fit", "named_goal", "named_model"]

Floats = NDArray[np.float64]

RADIUS = Parameter("radius", "m", 0.25, 0.1, 0.4, "half the width of shoulders", 0.01)
"""People's radius: it belongs to the scene and not to a model, and is calibrated with the model's parameters."""

AGENTS_AT_ONCE = 200_000
"""About so many agents (candidates x windows x people) are simulated in one batch."""


@dataclass(frozen=True)
class Fit:
    """The result of a calibration, ready to predict.

    Fields:
        rollout: the fitted model with goal, people's radius and time step.
        values: every calibrated parameter by its name.
        cost, default_cost: mean cost over people with the fitted and with the given parameters.
        evaluations: how many candidates were tried, ``history [evaluations]`` the smallest cost so far after each.
        persons: how many people the cost is a mean of, in ``windows`` windows.
        seconds: time of the search.
        scheme: names of model, cost, search and goal.
    """

    rollout: Rollout
    values: dict[str, float]
    cost: float
    default_cost: float
    evaluations: int
    history: Floats = field(repr=False)
    windows: int
    persons: int
    seconds: float
    scheme: str

    @property
    def model(self) -> CrowdModel:
        """The fitted model."""
        return self.rollout.model

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where the fitted crowd goes after the last observed row; deterministic models give K = 1."""
        if steps < 1 or samples < 1:
            raise InputError(f"a prediction needs at least 1 step and 1 sample, not {steps} and {samples}")
        return self.rollout.forecast(past, steps, f"calibrated {self.scheme}", rng)

    def __str__(self) -> str:
        """Return one paragraph: scheme, costs, parameters."""
        values = ", ".join(f"{name} {value:.3g}" for name, value in self.values.items())
        return (
            f"{self.scheme}: cost {self.cost:.4f} m, {self.default_cost:.4f} m before"
            f" ({self.persons} persons in {self.windows} windows, {self.evaluations} evaluations,"
            f" {self.seconds:.1f} s); {values}"
        )


@dataclass(frozen=True)
class Calibrator:
    """Fits one set of parameters, shared by everyone, to the observed rows of windows.

    All parameters in the model's table and the people's radius are searched in their calibration boxes; the given ones
    are tried first, so that a fit is never worse than they are.

    Fields:
        model, cost, search, goal: values, or their names.
        budget: how many parameter sets are tried.
        radius: people's radius before the fit [m].
        substep: longest time step of the simulation [s].

    Raises:
        InputError: a name is unknown, or the budget is below 1.
    """

    model: CrowdModel | str = "orca"
    cost: Cost | str = "absolute-difference"
    search: Search | str = "random-search"
    goal: Goal | str = "current-direction"
    budget: int = 200
    radius: float = RADIUS.default
    substep: float = 0.1

    def __post_init__(self) -> None:
        room = sys.modules[__package__ or ""]
        for name, value in (
            ("model", named_model(self.model)),
            ("cost", _named(self.cost, room, Cost)),
            ("search", _named(self.search, room, Search)),
            ("goal", named_goal(self.goal)),
        ):
            object.__setattr__(self, name, value)
        if self.budget < 1:
            raise InputError(f"calibration: budget = {self.budget} evaluations must be at least 1")

    @property
    def table(self) -> tuple[Parameter, ...]:
        """What is calibrated: the parameters of the model, then the radius."""
        return (*parameters(self.model), RADIUS)

    @property
    def scheme(self) -> str:
        """Names of model, cost, search and goal."""
        return ", ".join(kebab(type(part).__name__) for part in (self.model, self.cost, self.search, self.goal))

    def fit(
        self, past: Windows | Sequence[Windows], seed: int = 0, progress: Callable[[float], None] | None = None
    ) -> Fit:
        """Search the parameters under which the crowd, simulated over the observed rows, is nearest to the recording.

        Args:
            past: windows of at least two rows, of one recording or of several; their future is not looked at, unless
                the goal does.
            seed: of the search.
            progress: told the share that is done, 0 to 1.

        Raises:
            InputError: there are fewer than two rows, nobody can be compared, or a parameter is not one number.
        """
        pasts = [past] if isinstance(past, Windows) else list(past)
        for one in pasts:
            if one.position.shape[1] < 2:
                raise InputError(
                    f"calibration needs at least 2 observed rows, {one.source} has {one.position.shape[1]}"
                )
        table = self.table
        start = self._start()
        low, high = np.array([row.low for row in table]), np.array([row.high for row in table])
        task = _Task(self, pasts, progress)
        default_cost = float(task(start[None])[0])
        if task.persons == 0:
            where = f"{task.windows} windows of {', '.join(one.source for one in pasts) or 'no recording'}"
            raise InputError(f"calibration: nobody in {where} can be compared")
        begin = time.perf_counter()
        rng = stream(seed, "calibrate")
        found = cast(Search, self.search).minimize(task, low, high, rng, self.budget, start[None])
        seconds = time.perf_counter() - begin
        return Fit(
            rollout=self.rollout(found.best[None]),
            values={row.name: float(value) for row, value in zip(table, found.best, strict=True)},
            cost=found.cost,
            default_cost=default_cost,
            evaluations=found.evaluations,
            history=found.history,
            windows=task.windows,
            persons=task.persons,
            seconds=seconds,
            scheme=self.scheme,
        )

    def rollout(self, values: Floats, copies: int = 1) -> Rollout:
        """Return the simulation with parameters ``[P, D]`` of P candidates, each for ``copies`` windows along E."""
        if len(values) * copies == 1:
            numbers: Any = [float(value) for value in values[0]]
        else:
            numbers = [np.repeat(column, copies)[:, None] for column in values.T]
        changed = {row.name: number for row, number in zip(self.table[:-1], numbers, strict=False)}
        model = dataclasses.replace(cast(CrowdModel, self.model), **changed)
        return Rollout(model, cast(Goal, self.goal), numbers[-1], self.substep)

    def _start(self) -> Floats:
        """Return the given parameters ``[D]``."""
        values = [*(getattr(self.model, row.name) for row in self.table[:-1]), self.radius]
        for row, value in zip(self.table, values, strict=True):
            if np.ndim(value) > 0:
                raise InputError(f"calibration: {row.name} of {self.scheme} must be one number, not one for each agent")
        return np.array(values, dtype=float)


class _Task:
    """The function that a search minimises: mean cost over people ``[P]`` of candidates ``[P, D]``."""

    def __init__(self, calibrator: Calibrator, pasts: list[Windows], progress: Callable[[float], None] | None) -> None:
        self.calibrator = calibrator
        self.pasts = pasts
        self.progress = progress
        self.windows = sum(len(past) for past in pasts)
        self.persons = 0
        self.done = 0

    def __call__(self, values: Floats) -> Floats:
        total, persons = np.zeros(len(values)), np.zeros(len(values), dtype=np.int64)
        for past in self.pasts:
            people = max(1, past.position.shape[2])
            windows = max(1, min(len(past), AGENTS_AT_ONCE // people))
            candidates = max(1, AGENTS_AT_ONCE // (people * windows))
            for first in range(0, len(past), windows):
                for begin in range(0, len(values), candidates):
                    some = slice(begin, begin + candidates)
                    cost = self._measured(past[first : first + windows], values[some])
                    total[some] += np.nansum(cost, axis=(1, 2))
                    persons[some] += np.sum(~np.isnan(cost), axis=(1, 2))
                    self._report(cost.shape[0] * cost.shape[1])
        self.persons = int(persons[0])
        return np.asarray(total / np.maximum(persons, 1))

    def _measured(self, past: Windows, values: Floats) -> Floats:
        def simulate(windows: Windows, row: int) -> Floats:
            return self.calibrator.rollout(values, len(windows)).again(windows, row, len(values))

        return cast(Cost, self.calibrator.cost).measure(past, simulate)

    def _report(self, evaluated: int) -> None:
        self.done += evaluated
        if self.progress is not None:
            whole = max(1, self.windows * (self.calibrator.budget + 1))
            self.progress(min(1.0, self.done / whole))


def named_model(value: CrowdModel | str) -> CrowdModel:
    """Return a crowd model from itself, its name or its address, with default parameters."""
    return cast(CrowdModel, _named(value, models, CrowdModel))


def named_goal(value: Goal | str) -> Goal:
    """Return a goal from itself, its name or its address, with default parameters."""
    return cast(Goal, _named(value, goals, Goal))


def _named(value: object, room: ModuleType, contract: type) -> object:
    """Return a value as it is, or an instance of the class that a name means.

    Raises:
        InputError: no class has this name, it cannot be made without arguments, or the value is not of the contract.
    """
    if isinstance(value, str):
        kind = find(value, room, contract)
        try:
            return kind()
        except TypeError:
            raise InputError(
                f"{kebab(kind.__name__)} needs values of its own: pass an instance, not its name"
            ) from None
    if not isinstance(value, contract):
        raise InputError(f"{value!r} is not a {contract.__name__}, nor the name of one")
    return value
