"""Searches: which values of everyone's parameters, in a box, make a crowd cost least, with a budget of evaluations.

A problem is one window of N people with D parameters each. Many problems are searched in lock-step, so that their
candidates are simulated as one batch; what is found for one of them does not depend on the others.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .search_state import SearchState

__all__ = ["Floats", "Function", "Integers", "Search", "SearchResult", "check_box"]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Function = Callable[[Floats, Integers], Floats]
"""From candidates ``[P, L, N, D]`` of the problems ``which [L]`` (numbers below W) to what everyone costs,
``[P, L, N]``, all as one batch; NaN: this person does not count."""


@dataclass(frozen=True)
class SearchResult:
    """What a search found in W problems.

    Fields:
        best: ``[W, N, D]``, the candidates with the smallest cost, evaluated as a whole crowd.
        cost: ``[W]``, their costs: means over the people who count; NaN where nobody does, infinite where no candidate
            has a finite cost. In both cases ``best`` is the first start.
        evaluations: ``[W]``, how many whole-crowd candidates were evaluated.
        history: ``[W, budget]``, the smallest cost so far after each evaluation; after a stop its last value goes on.
    """

    best: Floats
    cost: Floats
    evaluations: Integers
    history: Floats = field(repr=False)


@dataclass(frozen=True)
class Search(ABC):
    """A way to look for the parameters ``[N, D]`` of a crowd that cost least, for many crowds at once.

    Fields:
        tolerance: a problem is done when its smallest cost is at or below this [unit of the cost]; costs that may be
            negative need ``-math.inf``.
        patience: a problem is done when so many evaluations brought nothing; 0: never. Looked at after each batch.
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
    ) -> SearchResult:
        """Return the best candidate of every problem among at most ``budget`` evaluations.

        Args:
            function: what everyone costs. People whose cost is NaN in all starts do not count and keep the parameters
                of the first start; a person who counts and has a cost that is not finite makes a candidate worst.
            low, high: ``[D]``, the box.
            rngs: one source of randomness for each of W problems.
            budget: how many whole-crowd candidates may be evaluated in each problem.
            start: ``[S, W, N, D]``, S >= 1, evaluated first, also when they lie outside the box; what is bred from
                them lies in it.

        Raises:
            InputError: the box is empty or not finite, the budget is below 1, or shapes do not fit.
        """
        low, high, start = (np.asarray(values, dtype=float) for values in (low, high, start))
        check_box(low, high, budget)
        check_start(start, len(low), len(rngs))
        state = SearchState(function, low, high, rngs, budget, start[0], self.tolerance, self.patience)
        if state.left:
            cost = state.evaluate(start)
            population, cost = state.drop_finished(start[: len(cost)], cost)
        if state.left:
            self.search(state, population, cost)
        return SearchResult(state.best, state.cost, state.evaluations, state.history)

    @abstractmethod
    def search(self, state: SearchState, population: Floats, cost: Floats) -> None:
        """Evaluate candidates until nothing is left; the ledger keeps the best.

        Args:
            ledger: evaluates candidates and knows the box, the streams of randomness and what is left of the budget.
            pool: ``[S, L, N, D]``, the starts of the L problems that are not done yet.
            cost: ``[S, L, N]``, what everyone costs there.
        """


def check_box(low: Floats, high: Floats, budget: int) -> None:
    """Raise :class:`InputError` unless the box has an inside and there is something to spend."""
    if budget < 1:
        raise InputError(f"search: budget = {budget} evaluations must be at least 1")
    if low.shape != high.shape or low.ndim != 1 or not np.all(np.isfinite([low, high])):
        raise InputError(f"search: the box from {low} to {high} must be two lists of as many finite numbers")
    if not len(low):
        raise InputError("search: the box has no sides; there must be at least one parameter to search")
    if np.any(low > high):
        raise InputError(f"search: the box is empty, its lower end {low} lies above its upper end {high}")


def check_start(start: Floats, dimensions: int, problems: int) -> None:
    """Raise :class:`InputError` unless there is a finite start ``[S, W, N, D]`` for each of the problems."""
    if start.ndim != 4 or start.shape[0] < 1 or start.shape[1] != problems or start.shape[3] != dimensions:
        raise InputError(
            f"search: start of shape {start.shape} must be [S, W, N, D] with at least one start, W = {problems} streams"
            f" of randomness and D = {dimensions} sides of the box"
        )
    if not np.all(np.isfinite(start)):
        raise InputError("search: start must be finite, it holds NaN or an infinity")
