"""Processor time of live forecasts of 30 people whose tracker sends 10 rows a second."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

import numpy as np

from crowdbot.core import UnknownName
from crowdbot.data import Trajectories
from crowdbot.models.goals import LearnedDestinations
from crowdbot.prediction import AnchorNet, Live, Simulated
from crowdbot.recording import run

from .measurement import Gauge

PEOPLE = 30
RATE = 0.1
"""Time between rows of the tracker [s]."""
STEP = 0.4
HORIZON = 4.8
FRAMES = 60
WARM_UP = 12
"""Frames that are not counted: they compile kernels and fill the history."""
BUDGET = 0.05
"""Time of a calibrated forecast [s]."""
LIVE_FRAMES: Mapping[str, tuple[float, int, float]] = {
    "live-anchor-net": (STEP, 20, 20.0),
    "live-anchor-net-10hz": (RATE, 20, 20.0),
    "live-orca-budget": (STEP, 1, 1e3 * BUDGET),
}
"""Measurements: time between the rows of the forecast [s], futures, and the goal at p95 [ms]."""


def live_frames(name: str, frames: int = FRAMES, clock: Callable[[], float] = time.process_time) -> Gauge:
    """Return the 95th percentile of the time [ms] of forecasts of 4.8 s, one for each row of the tracker.

    The people are those of the built-in trial crossing-flows, 30 in each row. ORCA with learned destinations starts
    each calibration from the fit of the frame before, and may evaluate 500 crowds within 50 ms.

    Args:
        name: a key of :data:`LIVE_FRAMES`.
        frames: number of forecasts that count.
        clock: returns the time [s].

    Raises:
        UnknownName: there is no such measurement.
    """
    if name not in LIVE_FRAMES:
        raise UnknownName("measurement", name, LIVE_FRAMES)
    dt, samples, goal = LIVE_FRAMES[name]
    tracks = _crowd_tracks(0, RATE)
    if name == "live-orca-budget":
        places = LearnedDestinations.learn(*(_crowd_tracks(seed, STEP) for seed in (1, 2, 3)))
        crowd = Simulated("orca", places, "progressive", "genetic", 500, substep=STEP)
        live = Live(crowd, dt, coast=0.0, budget=BUDGET, clock=clock)
    else:
        live = Live(AnchorNet("open"), dt, coast=0.0, clock=clock)
    people = ~np.isin(tracks.id, [*tracks.robots])
    numbers, count = np.unique(tracks.frame[people], return_counts=True)
    crowded = numbers[count >= PEOPLE]
    times, evaluations = [], []
    for number in range(WARM_UP + frames):
        row = np.flatnonzero(people & (tracks.frame == crowded[number % len(crowded)]))[:PEOPLE]
        live.update(tracks.id[row].tolist(), np.stack([tracks.x[row], tracks.y[row]], axis=1), time=RATE * (number + 1))
        live.predict(round(HORIZON / dt), samples)
        times.append(1e3 * live.report.latency)
        evaluations.append(live.report.evaluations)
    times, evaluations = times[WARM_UP:], evaluations[WARM_UP:]
    searched = f", {np.median(evaluations):.0f} evaluations" if any(evaluations) else ""
    words = (
        f"{goal:g} ms at p95; median {np.median(times):.1f} ms, largest {max(times):.1f} ms, {PEOPLE} people,"
        f" {samples} x {round(HORIZON / dt)} rows{searched}, {frames} frames"
    )
    return Gauge("ms", float(np.quantile(times, 0.95)), words, goal)


def _crowd_tracks(seed: int, dt: float) -> Trajectories:
    """Return the tracks of a run of crossing-flows."""
    from crowdbot.trials import load_trial

    return run(load_trial("crossing-flows", duration=30.0), seed=seed).tracks(dt)
