"""State of a search: unfinished problems, evaluations and best candidates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.typing import Floats, Ints

from .time_limit import TimeLimit


class SearchState:
    """State of one run of a search: evaluates whole-crowd candidates of W problems and keeps the best of each.

    Arrays of a search have the unfinished problems L on axis 1; ``live [L]`` are their numbers. After each
    :meth:`evaluate`, :meth:`prune` removes finished problems from the arrays.

    Fields:
        low, high, span: ``[D]``, the bounds and their differences.
        best, cost, evaluations, history: as in :class:`~crowdbot.calibration.SearchResult`.
    """

    def __init__(
        self,
        function: Callable[[Floats, Ints], Floats],
        low: Floats,
        high: Floats,
        rngs: Sequence[np.random.Generator],
        budget: int,
        first: Floats,
        tolerance: float,
        patience: int,
        limit: TimeLimit | None = None,
    ) -> None:
        W, N, _ = first.shape
        self.limit = limit
        self._affordable = budget
        self._pace = 0.0  # seconds for each candidate
        self.function, self.rngs, self.budget = function, rngs, budget
        self.low, self.high, self.span = low, high, high - low
        self.tolerance, self.patience = tolerance, patience
        self.live: Ints = np.arange(W)
        self.best = first.copy()
        self.cost = np.full(W, np.inf)
        self.evaluations: Ints = np.zeros(W, dtype=np.int64)
        self._history = np.full((W, budget), np.inf)
        self._first, self._spent = first, 0
        self._gained: Ints = np.zeros(W, dtype=np.int64)
        self._counts: NDArray[np.bool_] = np.ones((W, N), dtype=bool)

    @property
    def remaining(self) -> int:
        """Remaining evaluations of each unfinished problem; 0 if all are finished or the time is over.

        With a time limit, it is an estimate by the speed so far, which changes after evaluations only.
        """
        return min(self.budget - self._spent, self._affordable) if len(self.live) else 0

    def evaluate(self, candidates: Floats) -> Floats:
        """Return the cost of each person, ``[P, L, N]``, in candidates ``[P, L, N, D]``.

        Candidates beyond the budget are dropped. Those for which there is no time are not evaluated; their cost is
        infinite.

        The cost of people who do not count is 0, and they keep the parameters of the first start; a cost that is not
        finite is infinite.

        Raises:
            InputError: the function returns another shape.
        """
        candidates = candidates[: self.budget - self._spent]
        if self.limit is None:
            return self._evaluate(candidates)
        parts, first = [], 0
        while first < len(candidates):
            size = len(candidates) if self._spent == 0 else min(len(candidates) - first, (self._affordable + 1) // 2)
            if size == 0:
                parts.append(np.full((len(candidates) - first, *candidates.shape[1:3]), np.inf))
                break
            begin = self.limit.clock()
            parts.append(self._evaluate(candidates[first : first + size]))
            first += size
            self._pace = max(1e-9, self.limit.clock() - begin) / size
            self._affordable = min(self.budget, int(self.limit.remaining / self._pace))
        return np.concatenate(parts)

    def _evaluate(self, candidates: Floats) -> Floats:
        P, L, N, _ = candidates.shape
        counts = self.counts
        if not counts.all():
            candidates = np.where(counts[..., None], candidates, self._first[self.live])
        cost = np.ascontiguousarray(self.function(candidates, self.live), dtype=float)
        if cost.shape != (P, L, N):
            raise InputError(f"search: the costs of {P} candidates have shape {cost.shape}, not {(P, L, N)}")
        if self._spent == 0:
            counts = self._counts = ~np.isnan(cost).all(axis=0)
        cost = np.where(np.isfinite(cost), cost, np.inf)
        if not counts.all():
            cost = np.where(counts, cost, 0.0)
        self._write(candidates, cost.sum(axis=2) / np.maximum(counts.sum(axis=1), 1))
        return cost

    def _write(self, candidates: Floats, total: Floats) -> None:
        P, live = len(total), self.live
        row, column = np.argmin(total, axis=0), np.arange(len(live))
        gain = total[row, column] < self.cost[live]
        so_far = np.minimum(np.minimum.accumulate(total, axis=0), self.cost[live])
        self._history[live, self._spent : self._spent + P] = so_far.T
        self.best[live[gain]] = candidates[row[gain], column[gain]]
        self._gained[live[gain]] = self._spent + 1 + row[gain]
        self.cost[live] = so_far[-1]
        self._spent += P
        self.evaluations[live] = self._spent

    def prune(self, *arrays: Floats) -> tuple[Floats, ...]:
        """Remove finished problems, and return the arrays ``[_, L, ...]`` without them."""
        live = self.live
        nobody = ~self.counts.any(axis=1)
        self.cost[live[nobody]] = np.nan
        self._history[live[nobody]] = np.nan
        done = nobody | (self.cost[live] <= self.tolerance)
        if self.patience:
            done |= self._spent - self._gained[live] >= self.patience
        if not done.any():
            return arrays
        self.live = live[~done]
        return tuple(array[:, ~done] for array in arrays)

    @property
    def history(self) -> Floats:
        """Lowest cost after each evaluation, ``[W, budget]``; finished problems repeat the last one."""
        after = np.arange(self.budget) >= self.evaluations[:, None]
        return np.where(after, self.cost[:, None], self._history)

    def draw(self, how: Callable[[np.random.Generator], NDArray[Any]]) -> NDArray[Any]:
        """Return the draws ``[P, ...]`` of ``how`` for every unfinished problem, stacked along axis 1."""
        if len(self.live) == 1:
            return how(self.rngs[self.live[0]])[:, None]
        return np.stack([how(self.rngs[number]) for number in self.live], axis=1)

    @property
    def counts(self) -> NDArray[np.bool_]:
        """Whether each person counts in the unfinished problems, ``[L, N]``."""
        return self._counts[self.live]

    @property
    def progress(self) -> float:
        """Share of the budget, or of the time, that is spent, 0 to 1."""
        return self._spent / min(self.budget, self._spent + self._affordable)

    def incumbent(self) -> Floats:
        """Return the best whole-crowd candidates so far, ``[1, L, N, D]``, moved into the box."""
        return np.clip(self.best[self.live], self.low, self.high)[None]

    def scale_to_box(self, place: Floats) -> Floats:
        """Return values for relative positions ``[..., D]`` in the box, 0 to 1, clipped to the bounds."""
        return np.clip(self.low + self.span * place, self.low, self.high)

    def fold(self, values: Floats) -> Floats:
        """Return values reflected at the bounds into the box."""
        side = np.clip(values, self.low, self.high)
        return np.clip(2.0 * side - values, self.low, self.high)

    def sample_uniform(self, count: int) -> Floats:
        """Return ``count`` candidates ``[count, L, N, D]`` uniformly at random in the box."""
        shape = (count, *self.best.shape[1:])
        return self.scale_to_box(self.draw(lambda rng: rng.random(shape)))


def own_best(population: Floats, cost: Floats) -> tuple[Floats, Floats]:
    """Return the best parameters of each person in a population, as one candidate ``[1, L, N, D]``.

    The costs of people depend on each other: the cost of this candidate is known only after its evaluation. Also
    returns the cost ``[1, L, N]`` of each person in the best candidate of that person.
    """
    row = np.argmin(cost, axis=0)[None]
    return np.take_along_axis(population, row[..., None], axis=0), np.take_along_axis(cost, row, axis=0)
