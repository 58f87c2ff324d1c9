"""Time of a forecast of about 30 people in one frame: with a calibration, and live while a tracker sends rows."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError, UnknownName, stream
from crowdbot.data import Trajectories, Windows, load
from crowdbot.models.goals import LearnedDestinations
from crowdbot.prediction import AnchorNet, Live, Simulated
from crowdbot.recording import run

from .measurement import Gauge

PEOPLE = 30
"""Number of people; calibrated frames are those with the closest number."""
STEP = 0.4
"""Time between observed rows and between rows of a forecast [s]."""
FRAMES = 15
"""Number of calibrated frames."""
STEPS = 12
"""Number of rows of a forecast after a calibration."""
COLD, WARM = (2000, 300.0), (500, 100.0)
"""Candidate evaluations and time limit [ms]: without, and with the fit of the previous frame."""
RATE = 0.1
"""Time between rows of the tracker [s]."""
HORIZON = 4.8
"""Time of a live forecast [s]."""
LIVE_COUNT = 60
"""Number of live forecasts that count."""
WARM_UP = 12
"""Frames that are not counted: they compile kernels and fill the history."""
BUDGET = 0.05
"""Time of a calibrated live forecast [s]."""
LIVE_FRAMES: Mapping[str, tuple[float, int, float]] = {
    "live-anchor-net": (STEP, 20, 20.0),
    "live-anchor-net-10hz": (RATE, 20, 20.0),
    "live-orca-budget": (STEP, 1, 1e3 * BUDGET),
}
"""Measurements: time between the rows of the forecast [s], futures, and the goal at p95 [ms]."""


def scheme_frames(warm: bool, recording: Path | None) -> Gauge:
    """Return the median time [ms] of a frame: 8 observed rows, ORCA, genetic search, a forecast of 12 steps.

    Args:
        warm: start from the fit of the previous frame, with 500 evaluations instead of 2000.
        recording: source of the frames (default: the built-in trial crossing-flows).

    Raises:
        InputError: the recording is shorter than nine frames.
    """
    budget, limit = WARM if warm else COLD
    pairs = _pairs(recording)
    crowd = Simulated("orca", cost="progressive", search="genetic", budget=budget, substep=STEP)
    seconds = []
    for number, (before, now) in enumerate(pairs):
        memory: Any = crowd.follow(before, STEPS, 1, stream(number, "before"))[1] if warm else None
        begin = time.perf_counter()
        crowd.follow(now, STEPS, 1, stream(number, "frame"), memory)
        seconds.append(time.perf_counter() - begin)
    people = statistics.median(int(now.present[0, -1].sum()) for _, now in pairs)
    source = "built-in crossing flows" if recording is None else recording.name
    start = "starting from the previous fit" if warm else "without a previous fit"
    words = f"{limit:g} ms; {budget} candidate crowds of {people:g} people {start}, {len(pairs)} frames of {source}"
    return Gauge("ms", 1e3 * statistics.median(seconds[1:]), words, limit)


def _pairs(recording: Path | None) -> list[tuple[Windows, Windows]]:
    """Return pairs of consecutive frames with the closest number of people to 30; the first pair is for warm-up."""
    tracks = _crowd_tracks() if recording is None else load(recording, fps=None)
    frames, count = np.unique(tracks.frame, return_counts=True)
    if len(frames) < 9:
        raise InputError(f"{tracks.name} has {len(frames)} frames; a calibrated frame needs at least 9")
    away = np.abs(count[8:] - PEOPLE)
    chosen = 8 + np.sort(np.argsort(away, kind="stable")[: FRAMES + 1])
    return [(tracks.past(frame=int(frames[k - 1])), tracks.past(frame=int(frames[k]))) for k in chosen]


def live_frames(name: str, frames: int = LIVE_COUNT, clock: Callable[[], float] = time.process_time) -> Gauge:
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
    tracks = _crowd_tracks(0, RATE, 30.0)
    if name == "live-orca-budget":
        places = LearnedDestinations.learn(*(_crowd_tracks(seed, STEP, 30.0) for seed in (1, 2, 3)))
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


def _crowd_tracks(seed: int | None = None, dt: float = STEP, duration: float | None = None) -> Trajectories:
    """Return the tracks of a run of crossing-flows."""
    from crowdbot.trials import load_trial

    trial = load_trial("crossing-flows") if duration is None else load_trial("crossing-flows", duration=duration)
    return run(trial, seed=seed).tracks(dt)
