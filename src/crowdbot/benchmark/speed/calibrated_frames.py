"""Frames: how long a calibrated crowd of about 30 people takes from observation to forecast, frame by frame."""

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

__all__ = ["scheme_frames"]

PEOPLE = 30
"""Frames whose number of people is nearest to this are taken."""
FRAMES = 15
STEPS = 12
COLD, WARM = (2000, 300.0), (500, 100.0)
"""Candidate evaluations and the time [ms] that they may take, from nothing and from the fit of the frame before."""


def scheme_frames(warm: bool, recording: Path | None) -> Gauge:
    """Return the median time [ms] of a frame: 8 observed rows, ORCA, genetic search, a forecast of 12 steps.

    Args:
        warm: begin with the fit of the frame before, and try 500 crowds instead of 2000.
        recording: where the frames are from; None takes the built-in crossing flows.

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
    start = "from the fit of the frame before" if warm else "from nothing"
    words = f"{limit:g} ms; {budget} crowds of {people:g} people {start}, {len(pairs)} frames of {source}"
    return Gauge("ms", 1e3 * statistics.median(seconds[1:]), words, limit)


def _pairs(recording: Path | None) -> list[tuple[Windows, Windows]]:
    """Return windows of two frames in a row with as nearly 30 people as there are; the first pair warms up."""
    tracks = _tracks(recording)
    frames, count = np.unique(tracks.frame, return_counts=True)
    if len(frames) < 9:
        raise InputError(f"{tracks.name} has {len(frames)} frames; a frame of a calibrated crowd needs 9 at least")
    away = np.abs(count[8:] - PEOPLE)
    chosen = 8 + np.sort(np.argsort(away, kind="stable")[: FRAMES + 1])
    return [(tracks.past(frame=int(frames[k - 1])), tracks.past(frame=int(frames[k]))) for k in chosen]


def _tracks(recording: Path | None) -> Trajectories:
    if recording is not None:
        return load(recording, fps=None)
    from crowdbot.trials import load_trial

    return run(load_trial("crossing-flows")).tracks(0.4)
