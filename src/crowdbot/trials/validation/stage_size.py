"""Remarks on stages that are implausibly small or large: as a rule their numbers are not metres."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.trials.trial import Trial

SMALLEST_EXTENT = 2.0
LARGEST_EXTENT = 2000.0
"""Plausible extents of a stage, the longer side of the box around it [m]."""

SMALL = (
    "coordinates are in metres, and these may be degrees or kilometres, or metres that were read as millimetres (for a"
    " drawing, import it with --unit m)"
)
LARGE = "coordinates are in metres, and these may be millimetres, or pixels of an image"
LARGE_MAP = "the resolution of its map is in metres per pixel"


def stage_size_remarks(trial: Trial) -> list[str]:
    """Return a sentence if the stage is implausibly small or large.

    Without a walkable area, walls that are small may be obstacles on open ground: nothing is said if somebody starts
    outside the box around them.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Stage
    >>> small = Stage(walkable="0,0 0.02,0 0.02,0.008 0,0.008")
    >>> stage_size_remarks(Trial(name="t", duration=1, crowd=ORCA(), stage=small))[0][:53]
    'the walkable area is 0.02 m x 0.008 m, below 2 m in e'
    """
    stage = trial.stage
    if stage.bounded:
        what, bounds = "the walkable area", np.array(stage.shapes[1].bounds)
    else:
        rings = stage.rings[: len(stage.rings) - len(stage.props)]
        if not rings:
            return []
        corners = np.concatenate(rings)
        what, bounds = "the box around the walls", np.array([*corners.min(axis=0), *corners.max(axis=0)])
    size = bounds[2:] - bounds[:2]
    words = f"{what} is {size_text(*size)}"
    if size.max() > LARGEST_EXTENT:
        cause = LARGE_MAP if stage.map and not stage.bounded else LARGE
        return [f"{words}, above {LARGEST_EXTENT:g} m: {cause}"]
    if size.max() < SMALLEST_EXTENT and (stage.bounded or not _starts_outside(trial, bounds)):
        return [f"{words}, below {SMALLEST_EXTENT:g} m in each direction: {SMALL}"]
    return []


def size_text(width: float, height: float) -> str:
    """Return a size in words, with three digits.

    >>> size_text(20_000.0, 0.12345)
    '20000 m x 0.123 m'
    """
    return " x ".join(f"{float(f'{side:.3g}'):g} m" for side in (width, height))


def _starts_outside(trial: Trial, bounds: NDArray[Any]) -> bool:
    """Return whether a person or a robot starts outside a box, or may do so."""
    spots = [point for spawner in trial.spawners for point in spawner.zone]
    spots += [point for source in trial.sources for point in source.zone]
    spots += [(agent.x, agent.y) for agent in trial.agents]
    spots += [(robot.x, robot.y) for robot in trial.robots]
    places = np.array(spots, dtype=np.float64).reshape(-1, 2)
    return bool(trial.recorded) or bool(np.any((places < bounds[:2]) | (places > bounds[2:])))
