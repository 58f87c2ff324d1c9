"""Our searches against pymoo on windows of real recordings, at an equal number of evaluations.

ORCA, absolute difference, current direction; six windows of six to twelve people (ETH) and of about thirty (UCY
students). The table for the docs: ``python tests/calibration/test_search_on_recordings.py DATA``.
"""

from __future__ import annotations

import functools
import sys
from pathlib import Path

import numpy as np
import pytest

from crowdbot.calibration import Annealing, Calibrator, Genetic, Greedy, RandomSearch, Search
from crowdbot.calibration.calibrator import _Task
from crowdbot.core import stream
from crowdbot.data import Windows, load

BUDGET = 500
OURS: dict[str, Search] = {
    "random-search": RandomSearch(),
    "greedy": Greedy(),
    "annealing": Annealing(),
    "genetic": Genetic(),
}
PLACES = {"eth_biwi/seq_eth/obsmat.txt": (6, 12), "eth_ucy_splits/all_data/students003.txt": (26, 34)}


@functools.cache
def windows(data: Path, place: str) -> list[Windows]:
    """Return three windows of a recording with a wanted number of people, without empty slots."""
    low, high = PLACES[place]
    tracks = load(data / place)
    frames, count = np.unique(tracks.frame, return_counts=True)
    good = np.flatnonzero((count >= low) & (count <= high) & (np.arange(len(frames)) > 8))
    return [tracks.past(frame=int(frames[k])) for k in good[[len(good) // 4, len(good) // 2, 3 * len(good) // 4]]]


def scheme(search: Search | str = "random-search") -> Calibrator:
    return Calibrator("orca", "absolute", search, budget=BUDGET, substep=0.4)


@functools.cache
def ours(data: Path, place: str, name: str) -> float:
    """Return the mean over the windows of what one of our searches finds."""
    found = [scheme(OURS[name]).fit_each(past, [stream(1, "ours", w)]) for w, past in enumerate(windows(data, place))]
    assert all(fit.evaluations[0] <= BUDGET for fit in found)
    return float(np.mean([fit.cost[0] for fit in found]))


@functools.cache
def theirs(data: Path, place: str) -> float:
    """Return the mean over the windows of what the genetic algorithm of pymoo finds; it sees one mean cost."""
    return float(np.mean([_pymoo(past, w) for w, past in enumerate(windows(data, place))]))


def _pymoo(past: Windows, seed: int) -> float:
    from pymoo.algorithms.soo.nonconvex.ga import GA
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize

    space = scheme().space
    given = space.initial_values(past, scheme().rollout)
    task = _Task(scheme(), past, given, None)
    people = past.present.shape[2]
    best = [np.inf]

    class Whole(Problem):  # type: ignore[misc]
        def _evaluate(self, x: np.ndarray, out: dict[str, np.ndarray], *args: object, **kwargs: object) -> None:
            cost = task(x.reshape(len(x), 1, people, -1), np.array([0]))[:, 0]
            out["F"] = np.nanmean(cost, axis=1)
            best.append(float(out["F"].min()))

    low, high = np.tile(space.low, people), np.tile(space.high, people)
    first = np.clip(given.reshape(1, -1), low, high)
    start = np.concatenate([first, stream(seed, "pymoo").uniform(low, high, (49, len(low)))])
    whole = Whole(n_var=len(low), n_obj=1, xl=low, xu=high)
    minimize(whole, GA(pop_size=50, sampling=start), ("n_eval", BUDGET), seed=seed + 1)
    return min(best)


@pytest.mark.sweep
@pytest.mark.parametrize("place", PLACES, ids=["eth", "students"])
def test_annealing_and_genetic_are_ahead_of_pymoo(recordings: Path, place: str) -> None:
    library = theirs(recordings, place)
    assert ours(recordings, place, "genetic") < library
    assert ours(recordings, place, "annealing") < library
    assert ours(recordings, place, "greedy") < 1.1 * library


@pytest.mark.sweep
@pytest.mark.parametrize("place", PLACES, ids=["eth", "students"])
def test_genetic_and_annealing_are_ahead_of_chance(recordings: Path, place: str) -> None:
    chance = ours(recordings, place, "random-search")
    assert ours(recordings, place, "genetic") < chance
    assert ours(recordings, place, "annealing") < chance


def main(data: Path) -> None:
    print(f"| mean cost [m], {BUDGET} evaluations | " + " | ".join([*OURS, "pymoo GA"]) + " |")
    print("|---" * (len(OURS) + 2) + "|")
    for place in PLACES:
        cells = [ours(data, place, name) for name in OURS] + [theirs(data, place)]
        print(f"| {place} | " + " | ".join(f"{cell:.3f}" for cell in cells) + " |")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
