"""Time per frame of calibration and forecast for about 30 people."""

from __future__ import annotations

import statistics
import time
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError, stream
from crowdbot.data import Trajectories, Windows, load
from crowdbot.prediction import Simulated
from crowdbot.recording import run

from .measurement import Gauge

PEOPLE = 30
"""The frames with the closest number of people are used."""
FRAMES = 15
STEPS = 12
COLD, WARM = (2000, 300.0), (500, 100.0)
"""Candidate evaluations and time limit [ms]: without, and with the fit of the previous frame."""


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
    crowd = Simulated("orca", cost="progressive", search="genetic", budget=budget, substep=0.4)
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
    tracks = _tracks(recording)
    frames, count = np.unique(tracks.frame, return_counts=True)
    if len(frames) < 9:
        raise InputError(f"{tracks.name} has {len(frames)} frames; a calibrated frame needs at least 9")
    away = np.abs(count[8:] - PEOPLE)
    chosen = 8 + np.sort(np.argsort(away, kind="stable")[: FRAMES + 1])
    return [(tracks.past(frame=int(frames[k - 1])), tracks.past(frame=int(frames[k]))) for k in chosen]


def _tracks(recording: Path | None) -> Trajectories:
    if recording is not None:
        return load(recording, fps=None)
    from crowdbot.trials import load_trial

    return run(load_trial("crossing-flows")).tracks(0.4)
