"""The contract of searches, their state and time limit.

A problem is one window of N people with D parameters each. Many problems are searched in lock-step and their
candidates are simulated as one batch. The result of a problem does not depend on the others.
"""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.typing import Floats, Ints


@dataclass(frozen=True)
class TimeLimit:
    """Time at which a search stops, whatever its budget of evaluations.

    The starts of a search are always evaluated. After them it evaluates candidates in parts that fit into half of the
    remaining time, by the speed of the part before. Results depend on the speed of the computer, therefore.

    Fields:
        end: reading of the clock at which the search stops [s].
        clock: returns the time [s].

    Raises:
        InputError: ``end`` is not a number.

    >>> now = iter([10.0, 10.5])
    >>> limit = TimeLimit(10.4, lambda: next(now))
    >>> round(limit.remaining, 3), limit.remaining
    (0.4, 0.0)
    """

    end: float
    clock: Callable[[], float] = time.perf_counter

    def __post_init__(self) -> None:
        if self.end != self.end:
            raise InputError("time limit: end = nan must be a number of seconds on its clock")

    @property
    def remaining(self) -> float:
        """Time that is left [s], 0 after the end."""
        return max(0.0, self.end - self.clock())

    def share(self, parts: int) -> TimeLimit:
        """Return the limit of the next of ``parts`` searches that have the same time each."""
        if parts == 1:
            return self
        now = self.clock()
        return TimeLimit(now + max(0.0, self.end - now) / parts, self.clock)


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
