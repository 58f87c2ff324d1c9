"""Searches: where in a box a function is smallest, with a budget of evaluations."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

__all__ = ["Found", "RandomSearch", "Search"]

Floats = NDArray[np.float64]
Function = Callable[[Floats], Floats]
"""From candidates ``[P, D]`` to their costs ``[P]``, all as one batch."""


@dataclass(frozen=True)
class Found:
    """What a search found.

    Fields:
        best: ``[D]``, the candidate with the smallest cost.
        cost: its cost.
        evaluations: how many candidates were evaluated.
        history: ``[evaluations]``, the smallest cost so far after each of them.
    """

    best: Floats
    cost: float
    evaluations: int
    history: Floats


@dataclass(frozen=True)
class Search(ABC):
    """A way to look for the smallest value of a function of D numbers in a box."""

    @abstractmethod
    def minimize(
        self,
        function: Function,
        low: Floats,
        high: Floats,
        rng: np.random.Generator,
        budget: int,
        start: Floats | None = None,
    ) -> Found:
        """Return the best candidate among at most ``budget`` evaluations.

        Args:
            function: from ``[P, D]`` to ``[P]``; what is not finite counts as worst.
            low, high: ``[D]``, the box.
            rng: source of randomness.
            budget: how many candidates may be evaluated.
            start: ``[S, D]`` candidates that are evaluated first, also when they lie outside the box.

        Raises:
            InputError: the box is empty, the budget is below 1 or no candidate has a finite cost.
        """


@dataclass(frozen=True)
class RandomSearch(Search):
    """Candidates uniformly at random in the box, all in one batch.

    >>> low, high = np.array([-1.0, -1.0]), np.array([2.0, 2.0])
    >>> found = RandomSearch().minimize(lambda x: (x**2).sum(axis=1), low, high, np.random.default_rng(0), 500)
    >>> found.evaluations, found.cost < 0.05
    (500, True)
    """

    def minimize(
        self,
        function: Function,
        low: Floats,
        high: Floats,
        rng: np.random.Generator,
        budget: int,
        start: Floats | None = None,
    ) -> Found:
        """Return the best of ``budget`` candidates, see :meth:`Search.minimize`."""
        check_box(low, high, budget)
        first = np.zeros((0, len(low))) if start is None else np.asarray(start, dtype=float)[:budget]
        drawn = low + (high - low) * rng.random((budget - len(first), len(low)))
        candidates = np.concatenate([first, drawn])
        cost = np.asarray(function(candidates), dtype=float)
        cost = np.where(np.isfinite(cost), cost, np.inf)
        best = int(np.argmin(cost))
        if not np.isfinite(cost[best]):
            raise InputError(f"none of {budget} candidates has a finite cost; widen the box or check the recording")
        return Found(candidates[best].copy(), float(cost[best]), budget, np.minimum.accumulate(cost))


def check_box(low: Floats, high: Floats, budget: int) -> None:
    """Raise :class:`InputError` unless the box has an inside and there is something to spend."""
    if budget < 1:
        raise InputError(f"search: budget = {budget} evaluations must be at least 1")
    if low.shape != high.shape or low.ndim != 1 or not (np.all(np.isfinite(low)) and np.all(np.isfinite(high))):
        raise InputError(f"search: the box from {low} to {high} must be two lists of as many finite numbers")
    if np.any(low > high):
        raise InputError(f"search: the box is empty, its lower end {low} lies above its upper end {high}")
