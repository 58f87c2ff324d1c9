"""Thumbnail of a trial: its walls, people and robots at the start, drawn for a small picture."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np

from crowdbot.core import (
    PERSON_COLOR,
    ROBOT_COLOR,
    WALL_COLOR,
    CrowdbotError,
    Disc,
    Path2D,
    draw_svg,
    without_running_code,
)
from crowdbot.trials import Trial, load_builtin_trial, load_trial, trial_titles

from .trial_preview import trial_preview

__all__ = ["thumbnail", "trial_thumbnail"]

SMALLEST = 0.012
"""Smallest radius of a disc as a share of the size of the trial."""
WAY = "#9aa7b5"
"""Colour of the straight line from a robot to its goal."""


def trial_thumbnail(trial: Trial) -> str:
    """Return an SVG drawing that can be read at a width of 70 px.

    >>> trial_thumbnail(load_trial("frontal")).count("<circle")
    2
    """
    found = trial_preview(trial)
    left, low, right, high = found["bounds"]
    least = SMALLEST * max(right - left, high - low)
    ways = [Path2D(np.array([(one.x, one.y), one.goal.position], dtype=np.float64), WAY, 5.0) for one in trial.robots]
    walls = [Path2D(np.asarray(ring, dtype=np.float64), WALL_COLOR, 7.0) for ring in found["walls"]]
    discs = [
        Disc(x, y, max(radius, 1.7 * least if robot else least), ROBOT_COLOR if robot else PERSON_COLOR)
        for x, y, _, _, radius, robot in found["discs"]
    ]
    return draw_svg([*ways, *walls], discs)


def thumbnail(name: str, file: Path | None) -> bytes:
    """Return the thumbnail of a built-in trial, or of a trial file, whose code is not run.

    Args:
        name: name of the trial.
        file: its file, or None for a built-in trial.

    Raises:
        KeyError: there is no such built-in trial.
    """
    if file is None:
        return _builtin(name)
    try:
        with without_running_code():
            return trial_thumbnail(load_trial(file)).encode()
    except (CrowdbotError, OSError, ValueError):  # an error in the file is told when it is opened
        return draw_svg([]).encode()


@functools.lru_cache(maxsize=256)
def _builtin(name: str) -> bytes:
    if name not in trial_titles():
        raise KeyError(name)
    return trial_thumbnail(load_builtin_trial(name)).encode()
