"""Our searches against pymoo and scipy at an equal number of evaluations.

N people each have a function of D numbers whose smallest value lies elsewhere for every person and problem. The
libraries see one function, the mean over the people, of N * D numbers; ours also see what each person costs.
The table for the docs: ``python tests/calibration/test_search_comparison.py`` (a minute, most of it CMA-ES).
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest

from crowdbot.calibration import CMAES, Annealing, Genetic, Greedy, RandomSearch, Search
from crowdbot.core import stream
from samples import sample

BUDGET = 2000
PROBLEMS = 7
OURS: dict[str, Search] = {
    "random-search": RandomSearch(),
    "greedy": Greedy(),
    "annealing": Annealing(),
    "genetic": Genetic(),
    "cmaes": CMAES(),
}
Values = np.ndarray


def sphere(z: Values) -> Values:
    return np.asarray(np.sum(z**2, axis=-1))


def rastrigin(z: Values) -> Values:
    return np.asarray(np.sum(z**2 + 10.0 - 10.0 * np.cos(2.0 * np.pi * z), axis=-1))


def rosenbrock(z: Values) -> Values:
    z = z + 1.0
    return np.asarray(np.sum(100.0 * (z[..., 1:] - z[..., :-1] ** 2) ** 2 + (1.0 - z[..., :-1]) ** 2, axis=-1))


class Case(NamedTuple):
    """A test function of N people with D numbers each; ``turned``: no number can be found without the others."""

    function: Callable[[Values], Values]
    half: float
    people: int
    dimensions: int
    turned: bool = False

    def __str__(self) -> str:
        name = ("turned " if self.turned else "") + self.function.__name__
        return f"{name}, N = {self.people}, D = {self.dimensions}"


SPHERE, RASTRIGIN, ROSENBROCK = (
    [Case(function, half, N, D) for N, D in ((1, 5), (1, 10), (20, 5))]
    for function, half in ((sphere, 5.12), (rastrigin, 5.12), (rosenbrock, 2.048))
)
TURNED = Case(rastrigin, 5.12, 20, 3, turned=True)
CASES = [*SPHERE, *RASTRIGIN, *ROSENBROCK, TURNED]
SOME = [RASTRIGIN[1]]


@functools.cache
def made(case: Case) -> tuple[Callable[[Values, Values], Values], Values, Values, Values]:
    """Return function, box and start of a case: 7 problems that differ in where the smallest value lies."""
    N, D = case.people, case.dimensions
    moved, turned, start = [], [], []
    for w in range(PROBLEMS):
        rng = stream(0, str(case), w)
        moved.append(rng.uniform(-0.4, 0.4, (N, D)) * case.half * (case.function is not rosenbrock))
        turned.append(np.linalg.qr(rng.standard_normal((N, D, D)))[0] if case.turned else np.tile(np.eye(D), (N, 1, 1)))
        start.append(rng.uniform(-case.half, case.half, (N, D)))
    shift, turn = np.array(moved), np.array(turned)

    def function(x: Values, which: Values) -> Values:
        away = x - shift[which]
        return case.function(np.einsum("plnd,lnde->plne", away, turn[which]) if case.turned else away)

    return function, -case.half * np.ones(D), case.half * np.ones(D), np.array(start)[None]


@functools.cache
def ours(name: str, case: Case) -> float:
    """Return the median over the problems of what one of our searches finds."""
    function, low, high, start = made(case)
    rngs = [stream(1, "ours", w) for w in range(PROBLEMS)]
    found = OURS[name].minimize(function, low, high, rngs, BUDGET, start)
    assert np.all(found.evaluations <= BUDGET)
    return float(np.median(found.cost))


class Counted:
    """A problem as the libraries see it; what is evaluated beyond the budget is not kept."""

    def __init__(self, case: Case, problem: int) -> None:
        self.function, low, high, start = made(case)
        self.case, self.problem = case, problem
        self.low, self.high = np.tile(low, case.people), np.tile(high, case.people)
        self.start = start[0, problem].ravel()
        self.count, self.best = 0, np.inf

    def many(self, x: Values) -> Values:
        crowds = np.asarray(x).reshape(len(x), 1, self.case.people, self.case.dimensions)
        cost = self.function(crowds, np.array([self.problem]))[:, 0].mean(axis=1)
        kept = cost[: max(0, BUDGET - self.count)]
        self.count += len(cost)
        self.best = min(self.best, *kept.tolist(), np.inf)
        return cost

    def one(self, x: Values) -> float:
        return float(self.many(x[None])[0])


def pymoo_ga(task: Counted) -> None:
    from pymoo.algorithms.soo.nonconvex.ga import GA
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize

    class Whole(Problem):  # type: ignore[misc]
        def _evaluate(self, x: Values, out: dict[str, Values], *args: object, **kwargs: object) -> None:
            out["F"] = task.many(x)

    whole = Whole(n_var=len(task.low), n_obj=1, xl=task.low, xu=task.high)
    minimize(whole, GA(pop_size=100), ("n_eval", BUDGET), seed=task.problem + 1)


def scipy_differential_evolution(task: Counted) -> None:
    from scipy.optimize import differential_evolution

    differential_evolution(
        task.one,
        list(zip(task.low, task.high, strict=True)),
        popsize=max(1, 50 // len(task.low)),
        x0=task.start,
        rng=task.problem,
        polish=False,
        tol=0.0,
        callback=lambda intermediate_result: task.count >= BUDGET,
    )


def scipy_dual_annealing(task: Counted, local: bool = False) -> None:
    from scipy.optimize import dual_annealing

    bounds = list(zip(task.low, task.high, strict=True))
    dual_annealing(
        task.one, bounds, maxfun=BUDGET, maxiter=BUDGET, x0=task.start, no_local_search=not local, rng=task.problem
    )


def scipy_dual_annealing_with_descent(task: Counted) -> None:
    scipy_dual_annealing(task, local=True)


THEIRS = {
    "pymoo GA": pymoo_ga,
    "scipy differential_evolution": scipy_differential_evolution,
    "scipy dual_annealing, no local search": scipy_dual_annealing,
    "scipy dual_annealing": scipy_dual_annealing_with_descent,
}


@functools.cache
def theirs(name: str, case: Case) -> float:
    """Return the median over the problems of what a library finds."""
    tasks = [Counted(case, problem) for problem in range(PROBLEMS)]
    for task in tasks:
        THEIRS[name](task)
    return float(np.median([task.best for task in tasks]))


def table() -> str:
    """Return the medians of all searches and libraries in all cases."""
    rows = {name: [ours(name, case) for case in CASES] for name in OURS}
    rows |= {name: [theirs(name, case) for case in CASES] for name in THEIRS}
    lines = [f"Median over {PROBLEMS} problems of the smallest value after {BUDGET} evaluations:", ""]
    lines += ["| function | " + " | ".join(rows) + " |", "|---|" + "---:|" * len(rows)]
    for place, case in enumerate(CASES):
        lines.append(f"| {case} | " + " | ".join(f"{row[place]:.2g}" for row in rows.values()) + " |")
    return "\n".join(lines)


@pytest.mark.parametrize("case", sample(CASES, SOME), ids=str)
def test_genetic_holds_against_the_genetic_algorithm_of_pymoo(case: Case) -> None:
    """With many people it is far better; the narrow valley of Rosenbrock costs it more with one person."""
    allowed = 0.1 if case.people > 1 else 2.0 if case.function is rosenbrock else 1.0
    assert ours("genetic", case) <= allowed * theirs("pymoo GA", case)


@pytest.mark.parametrize("case", sample([SPHERE[1], *RASTRIGIN, ROSENBROCK[1], ROSENBROCK[2], TURNED], SOME), ids=str)
def test_genetic_holds_against_the_differential_evolution_of_scipy(case: Case) -> None:
    """Of one person and 5 parameters, differential evolution is better on the sphere and on Rosenbrock's valley."""
    assert ours("genetic", case) <= (0.1 if case.people > 1 else 1.5) * theirs("scipy differential_evolution", case)


@pytest.mark.parametrize("case", sample(CASES, SOME), ids=str)
def test_annealing_holds_against_the_annealing_of_scipy(case: Case) -> None:
    """Both without descents along a gradient."""
    allowed = 0.1 if case.people > 1 else 2.0
    assert ours("annealing", case) <= allowed * theirs("scipy dual_annealing, no local search", case)


@pytest.mark.parametrize("case", sample([*SPHERE, *RASTRIGIN], SOME), ids=str)
def test_greedy_is_good_where_one_parameter_at_a_time_is_enough(case: Case) -> None:
    assert ours("greedy", case) <= theirs("pymoo GA", case)


def test_genetic_and_annealing_leave_the_valleys_in_which_greedy_is_caught() -> None:
    function, low, high, start = made(Case(rastrigin, 5.12, 6, 3, turned=True))
    cost = {}
    for name in ("greedy", "annealing", "genetic"):
        for budget in (BUDGET, 2 * BUDGET):
            rngs = [stream(2, name, w) for w in range(PROBLEMS)]
            found = OURS[name].minimize(function, low, high, rngs, budget, start)
            cost[name, budget] = float(np.median(found.cost))
    assert cost["annealing", BUDGET] < 0.6 * cost["greedy", BUDGET]
    assert cost["genetic", BUDGET] < 0.6 * cost["greedy", BUDGET]
    assert cost["greedy", 2 * BUDGET] > 0.9 * cost["greedy", BUDGET]  # it is caught: more evaluations do not help


@pytest.mark.parametrize("name", [name for name in OURS if name != "random-search"])
@pytest.mark.parametrize("case", sample([SPHERE[1], RASTRIGIN[1], ROSENBROCK[1]], SOME), ids=str)
def test_every_search_is_better_than_chance(name: str, case: Case) -> None:
    assert ours(name, case) < 0.3 * ours("random-search", case)


if __name__ == "__main__":
    print(table())
