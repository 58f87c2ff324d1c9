"""Measures the processor time of live forecasts of 30 people whose tracker sends 10 rows a second, and prints a table.

    OMP_NUM_THREADS=1 NUMBA_NUM_THREADS=1 python studies/prediction_latency.py --frames 150

The people are those of the built-in trial crossing-flows, 30 in each row. AnchorNet predicts 20 futures of 4.8 s, in 12
rows of 0.4 s and in 48 rows of 0.1 s. ORCA with learned destinations is calibrated in each frame, from the fit of
the frame before, with several numbers of evaluated crowds, and with a budget of 50 ms of processor time.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import crowdbot as cb
from crowdbot.data import Trajectories
from crowdbot.models.goals import LearnedDestinations
from crowdbot.prediction import AnchorNet, Live, Predictor, Simulated

PEOPLE = 30
RATE = 0.1
"""Time between rows of the tracker [s]."""
STEP = 0.4
HORIZON = 4.8
WARM_UP = 12
"""Frames that are not counted: they compile kernels and fill the history."""
BUDGETS = (20, 50, 100, 200)
BUDGET = "50 ms"


def crowd_tracks(seed: int, dt: float, duration: float = 30.0) -> Trajectories:
    """Return the tracks of a run of crossing-flows."""
    return cb.run(cb.load_trial("crossing-flows", duration=duration), seed=seed).tracks(dt)


def frame_times(
    live: Live, tracks: Trajectories, frames: int, steps: int, samples: int
) -> tuple[np.ndarray, list[int]]:
    """Return the processor time of each prediction [ms], and how many crowds each evaluated."""
    found, evaluations = [], []
    numbers = np.unique(tracks.frame)
    crowded = [k for k in numbers if np.sum((tracks.frame == k) & ~np.isin(tracks.id, [*tracks.robots])) >= PEOPLE]
    for number in range(WARM_UP + frames):
        row = np.flatnonzero(tracks.frame == crowded[number % len(crowded)])
        row = row[~np.isin(tracks.id[row], [*tracks.robots])][:PEOPLE]
        live.update(tracks.id[row].tolist(), np.stack([tracks.x[row], tracks.y[row]], axis=1), time=RATE * (number + 1))
        begin = time.process_time()
        live.predict(steps, samples)
        found.append(1e3 * (time.process_time() - begin))
        evaluations.append(live.report.evaluations)
    return np.array(found[WARM_UP:]), evaluations[WARM_UP:]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=150)
    options = parser.parse_args()
    tracks = crowd_tracks(0, RATE)
    goal = LearnedDestinations.learn(*(crowd_tracks(seed, STEP) for seed in (1, 2, 3)))
    print("| predictor | evaluations | median [ms] | p95 [ms] | largest [ms] |\n|---|---|---|---|---|")

    def row(name: str, predictor: Predictor, dt: float, samples: int, budget: str | None = None) -> None:
        live = Live(predictor, dt, coast=0.0, budget=budget, clock=time.process_time)
        times, evaluations = frame_times(live, tracks, options.frames, round(HORIZON / dt), samples)
        counts = f"{int(np.median(evaluations))}" if any(evaluations) else ""
        cells = (f"{value:.1f}" for value in (np.median(times), np.quantile(times, 0.95), times.max()))
        print(f"| {name} | {counts} | {' | '.join(cells)} |", flush=True)

    row("AnchorNet, 20 futures, 12 rows", AnchorNet("open"), STEP, 20)
    row("AnchorNet, 20 futures, 48 rows", AnchorNet("open"), RATE, 20)
    for budget in BUDGETS:
        crowd = Simulated("orca", goal, "progressive", "genetic", budget, substep=STEP)
        row(f"ORCA, learned destinations, {budget}", crowd, STEP, 1)
    crowd = Simulated("orca", goal, "progressive", "genetic", 500, substep=STEP)
    row(f"ORCA, learned destinations, budget {BUDGET}", crowd, STEP, 1, BUDGET)


if __name__ == "__main__":
    main()
