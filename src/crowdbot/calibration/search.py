"""Searches: minimise the cost of a crowd over the parameters of all people, within bounds and an evaluation budget.

A problem is one window of N people with D parameters each. Many problems are searched in lock-step and their
candidates are simulated as one batch. The result of a problem does not depend on the others.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats, Ints

from .search_state import SearchState
from .time_limit import TimeLimit

Function = Callable[[Floats, Ints], Floats]
"""From candidates ``[P, L, N, D]`` of the problems ``which [L]`` (numbers below W) to the cost of each person,
``[P, L, N]``, as one batch; NaN if a person does not count."""


@dataclass(frozen=True)
class SearchResult:
    """The result of a search of W problems.

    Fields:
        best: ``[W, N, D]``, the candidates with the smallest cost, evaluated as a whole crowd.
        cost: ``[W]``, their costs: means over the people who count; NaN where nobody does, infinite where no candidate
            has a finite cost. In both cases ``best`` is the first start.
        evaluations: ``[W]``, number of whole-crowd candidates evaluated.
        history: ``[W, budget]``, smallest cost after each evaluation; the last value is repeated after a stop.
    """

    best: Floats
    cost: Floats
    evaluations: Ints
    history: Floats = field(repr=False)


@dataclass(frozen=True)
class Search(ABC):
    """Contract of a search for the parameters ``[N, D]`` of a crowd with the smallest cost, for many crowds at once.

    Fields:
        tolerance: a problem is done when its smallest cost is at or below this [unit of the cost]; costs that may be
            negative need ``-math.inf``.
        patience: a problem is done after this number of evaluations without improvement, checked after each batch;
            0: never.
    """

    tolerance: float = 0.0
    patience: int = 0

    def __post_init__(self) -> None:
        if math.isnan(self.tolerance):
            raise InputError("search: tolerance = nan must be a number")
        if self.patience < 0:
            raise InputError(f"search: patience = {self.patience} evaluations must be at least 0 (0: never stop early)")

    def minimize(
        self,
        function: Function,
        low: Floats,
        high: Floats,
        rngs: Sequence[np.random.Generator],
        budget: int,
        start: Floats,
        limit: TimeLimit | None = None,
    ) -> SearchResult:
        """Return the best candidate of every problem among at most ``budget`` evaluations.

        Args:
            function: cost of each person. People whose cost is NaN in all starts are ignored and keep the parameters of
                the first start. A cost of another person that is not finite counts as infinite.
            low, high: ``[D]``, the box.
            rngs: one random generator for each of W problems.
            budget: maximum number of whole-crowd candidates evaluated in each problem.
            start: ``[S, W, N, D]``, S >= 1, evaluated first, even outside the box; candidates derived from them lie in
                the box.
            limit: time at which the search stops; the starts are always evaluated.

        Raises:
            InputError: the box is empty or not finite, the budget is below 1, or shapes do not fit.
        """
        low, high, start = (np.asarray(values, dtype=float) for values in (low, high, start))
        check_box(low, high, budget)
        check_start(start, len(low), len(rngs))
        state = SearchState(function, low, high, rngs, budget, start[0], self.tolerance, self.patience, limit)
        if state.remaining:
            cost = state.evaluate(start)
            population, cost = state.prune(start[: len(cost)], cost)
        if state.remaining:
            self.search(state, population, cost)
        return SearchResult(state.best, state.cost, state.evaluations, state.history)

    @abstractmethod
    def search(self, state: SearchState, population: Floats, cost: Floats) -> None:
        """Evaluate candidates until the budget is spent; the state keeps the best.

        Args:
            state: state of the search: evaluation, bounds, random generators and remaining budget.
            population: ``[S, L, N, D]``, starts of the L unfinished problems.
            cost: ``[S, L, N]``, costs of each person in the starts.
        """


def check_box(low: Floats, high: Floats, budget: int) -> None:
    """Raise :class:`InputError` unless the box is finite and not empty and the budget is positive."""
    if budget < 1:
        raise InputError(f"search: budget = {budget} evaluations must be at least 1")
    if low.shape != high.shape or low.ndim != 1 or not np.all(np.isfinite([low, high])):
        raise InputError(f"search: the box from {low} to {high} must be two lists of finite numbers of equal length")
    if not len(low):
        raise InputError("search: the box has no dimensions; at least one parameter must be free")
    if np.any(low > high):
        raise InputError(f"search: the box is empty: its lower end {low} is above its upper end {high}")


def check_start(start: Floats, dimensions: int, problems: int) -> None:
    """Raise :class:`InputError` unless there is a finite start ``[S, W, N, D]`` for each of the problems."""
    if start.ndim != 4 or start.shape[0] < 1 or start.shape[1] != problems or start.shape[3] != dimensions:
        raise InputError(
            f"search: start of shape {start.shape} must be [S, W, N, D] with at least one start, W = {problems} streams"
            f" of randomness and D = {dimensions} sides of the box"
        )
    if not np.all(np.isfinite(start)):
        raise InputError("search: start must be finite, but has NaN or infinity")
