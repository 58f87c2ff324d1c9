"""Reference results of searches and of calibrations. To write them: ``python tests/calibration/golden_searches.py``.

Write them again only when a search is changed on purpose, and say so in the commit.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from made_crowds import Shy, shy_crowd

from crowdbot.calibration import (
    Annealing,
    Calibrator,
    Genetic,
    Geometric,
    Greedy,
    PopulationPrior,
    RandomSearch,
    Search,
)
from crowdbot.core import stream

FILE = Path(__file__).with_name("golden") / "searches.npz"
LOW, HIGH = np.array([-2.0, 0.1, 1.0]), np.array([2.0, 1.0, 5.1])
SEARCHES: dict[str, Search] = {
    "random": RandomSearch(batch=30),
    "greedy": Greedy(),
    "greedy-3": Greedy(trials=3, tolerance=0.05),
    "annealing": Annealing(),
    "annealing-hot": Annealing(cooling=Geometric(1.0, 0.2), chains=3, exchange=2, moved=0.7),
    "annealing-one": Annealing(chains=1, exchange=0, patience=40),
    "genetic": Genetic(),
    "genetic-small": Genetic(population=7, memory=2, bred=0.8),
}
BUDGET = 240


def valleys(x: np.ndarray, which: np.ndarray) -> np.ndarray:
    """Return costs with several minima; people influence each other, and one person of problem 2 does not count."""
    place = x - np.array([0.5, 0.25, 2.0]) + 0.1 * which[:, None, None]
    own = np.sum(place**2 + 0.2 * (1.0 - np.cos(6.0 * place)), axis=-1)
    cost = own + 0.1 * np.roll(own, 1, axis=-1)
    cost = np.where(x[..., 0] > 1.9, np.inf, cost)
    absent = (which[:, None] == 2) & (np.arange(x.shape[2]) == 1)
    return np.where(absent, np.nan, cost)


def compute() -> dict[str, np.ndarray]:
    """Return best values, costs and histories of every search, and a fit of parameters of people, by name."""
    start = np.stack([stream(5, "begin", w).uniform(LOW, HIGH, (2, 4, 3)) for w in range(3)], axis=1)
    arrays: dict[str, np.ndarray] = {}
    for name, search in SEARCHES.items():
        rngs = [stream(1, name, w) for w in range(3)]
        found = search.minimize(valleys, LOW, HIGH, rngs, BUDGET, start)
        arrays |= {f"{name}.best": found.best, f"{name}.history": found.history[:, ::8]}
        arrays[f"{name}.evaluations"] = found.evaluations
    past = shy_crowd(Shy(strength=1.5, space=1.2), W=3)
    free = ("strength", "space", "radius", "preferred-speed")
    fit = Calibrator(Shy(), "absolute", Genetic(population=10), budget=80, free=free).fit(past, seed=2)
    prior = PopulationPrior.from_fits(fit, strength=0.3)
    drawn = Calibrator(Shy(), "progressive", Annealing(), budget=60, free=free, prior=prior).fit(
        past, seed=2, start=fit
    )
    shared = Calibrator(Shy(), "inter-pedestrian", Greedy(), budget=40, shared=True).fit([past, past[:2]], seed=2)
    for name, item in (("fit", fit), ("prior", drawn), ("shared", shared)):
        arrays |= {f"{name}.values": item.values, f"{name}.cost": item.cost, f"{name}.given": item.given_cost}
    arrays["prior.covariance"] = prior.covariance
    arrays["fit.predicted"] = fit.predict(past, 4).position
    return arrays


if __name__ == "__main__":
    FILE.parent.mkdir(exist_ok=True)
    np.savez_compressed(FILE, **compute())
    print(FILE, FILE.stat().st_size)
