"""Shared parts of all checks: bodies, speeds, initial positions, walls, periodic and open tracks."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import InputError, stream
from crowdbot.data import Trajectories
from crowdbot.models import CrowdModel
from crowdbot.trials import model_range
from crowdbot.typing import Bools, Floats

RADIUS = 0.2
"""Radius of all bodies [m]: the default of JuPedSim; shoulders are about 0.4 to 0.5 m wide."""
FREE_SPEED = 1.34
"""Mean speed of free walking [m/s]: Weidmann 1993, Transporttechnik der Fussgaenger, ETH Zurich."""
SPREAD = 0.26
"""Standard deviation of free speeds [m/s], same source."""
STEP = 0.05
"""Time step of all runs [s]; models that are made for shorter steps take substeps (:func:`substeps`)."""
SEEN = 6.0
"""Range [m] of the copies of people beyond the ends of a periodic track."""
SEED = 20250

Solid = tuple[float, float, float, float]
"""A solid rectangle x0, y0, x1, y1 [m]."""
Report = Callable[[float], None]
"""Progress callback: called with the completed fraction, 0 to 1."""
Row = dict[str, Any]
"""Numbers of one start."""


class Verdict(NamedTuple):
    """Result of a check: a short value, whether the criterion holds, and a description of a failure."""

    value: str
    passed: bool
    words: str = ""


class Check(NamedTuple):
    """One test of the page.

    Fields:
        name: name on the command line and in the cache.
        title: title of its column and section.
        criterion: criterion of success, one sentence.
        run: function of model, numbers of the starts, quick mode and progress callback that returns one row of numbers
            for JSON for each start.
        summarize: function of the rows of all starts that returns the result of the check.
        judge: function of this result that returns the verdict.
        most: largest number of starts; 1 for a test without chance.
    """

    name: str
    title: str
    criterion: str
    run: Callable[[CrowdModel, Sequence[int], bool, Report], list[Row]]
    summarize: Callable[[Sequence[Row]], dict[str, Any]]
    judge: Callable[[dict[str, Any]], Verdict]
    most: int = 1_000


class CrowdTracks(NamedTuple):
    """Tracks of people.

    Fields:
        times: times ``[T]`` [s].
        position: ``[T, E, A, 2]`` [m]; on a periodic track, it increases with each round.
        present: ``[T, E, A]``; whether the person is present.
    """

    times: Floats
    position: Floats
    present: Bools


def tracks_of(walk: CrowdTracks, e: int = 0) -> Trajectories:
    """Return the people of environment ``e`` as a recording, frame k at ``times[k]``."""
    frame, id = np.nonzero(walk.present[:, e])
    place = walk.position[frame, e, id]
    return Trajectories(
        id,
        frame,
        place[:, 0],
        place[:, 1],
        row_rate=1.0 / float(walk.times[1] - walk.times[0]),
        frame_step=1,
        name="crowd",
    )


def substeps(model: CrowdModel) -> int:
    """Return the number of steps of a model in each :data:`STEP`: its time step is at most that of its range.

    >>> from crowdbot.models import ORCA, CollisionFreeSpeed
    >>> substeps(ORCA()), substeps(CollisionFreeSpeed())
    (1, 5)
    """
    known = model_range(model)
    return 1 if known is None else max(1, math.ceil(STEP / known.max_step - 1e-9))


def stream_of(*path: str | int | float) -> np.random.Generator:
    """Return a random stream of the page; a fixed seed gives all models the same crowds."""
    return stream(SEED, "validation", *(p if isinstance(p, int) else str(p) for p in path))


def free_speeds(shape: tuple[int, ...], rng: np.random.Generator, spread: float = SPREAD) -> Floats:
    """Return free speeds ``[...]`` [m/s], normal around 1.34 m/s and clipped at two standard deviations."""
    return FREE_SPEED + spread * np.clip(rng.standard_normal(shape), -2.0, 2.0)


def stuck_start(result: dict[str, Any]) -> str:
    """Return in how many starts people are stuck, as the begin of a sentence.

    >>> stuck_start({"stuck": 2, "starts": 5})
    'in 2 of 5 starts,'
    """
    return f"in {result['stuck']} of {result['starts']} starts,"


def stuck_part(result: dict[str, Any]) -> str:
    """Return in how many starts people are stuck, as the end of a value; empty if there is none.

    >>> stuck_part({"stuck": 2, "starts": 5})
    ', 2 of 5 stuck'
    """
    return f", {result['stuck']} of {result['starts']} stuck" if result["stuck"] else ""


def portion(report: Report, k: int, count: int) -> Report:
    """Return the progress callback of part ``k`` of ``count`` equal parts.

    >>> portion(print, 1, 4)(0.5)
    0.375
    """
    return lambda part: report((k + part) / count)


def share(part: float) -> str:
    """Return a share as text.

    >>> share(0.126), share(0.002)
    ('13 %', 'less than 1 %')
    """
    return "less than 1 %" if 0.0 < part < 0.01 else f"{100.0 * part:.0f} %"


def opening(place: Floats, x: float, middle: float, width: float) -> Floats:
    """Return the nearest points ``[E, A, 2]`` [m] of an opening across x with room for a body."""
    half = max(0.5 * width - RADIUS - 0.05, 0.0)
    return np.stack([np.full(place.shape[:-1], x), np.clip(place[..., 1], middle - half, middle + half)], axis=-1)


def gate(place: Floats, inner: Sequence[float], outer: Sequence[float]) -> tuple[Floats, Bools]:
    """Return the nearest points of a gate at a corner, and which people have passed it.

    Args:
        place: ``[E, A, 2]`` [m].
        inner, outer: the two ends [m] of the gate; approaching people have ``inner`` on their left.
    """
    start, along = np.asarray(inner, dtype=np.float64), np.subtract(outer, inner)
    length = float(np.hypot(*along))
    along = along / length
    away = place - start
    share = np.clip(away @ along, RADIUS + 0.05, length - RADIUS - 0.05)
    passed = along[0] * away[..., 1] - along[1] * away[..., 0] > 0.0
    return start + share[..., None] * along, passed


def starts(count: int, low: Sequence[float], high: Sequence[float], rng: np.random.Generator) -> Floats:
    """Return positions ``[count, 2]`` [m] between two corners: a randomly filled, jittered lattice.

    Raises:
        InputError: the bodies do not fit without overlap.
    """
    width, height = high[0] - low[0], high[1] - low[1]
    columns = max(1, round(math.sqrt(count * (width + 0.5) / (height + 0.5))))
    while True:
        rows = -(-count // columns)
        cell = width / columns, height / max(rows - 1, 1) if rows > 1 else height + 2.0 * RADIUS
        if cell[1] >= 2.02 * RADIUS or cell[0] < 2.02 * RADIUS:
            break
        columns += 1
    if min(cell) < 2.0 * RADIUS:
        raise InputError(f"{count} bodies of radius {RADIUS} m do not fit into {width:.2f} x {height:.2f} m")
    cells = rng.permutation(columns * rows)[:count]
    across = low[1] + (cells % rows) * cell[1] if rows > 1 else np.full(count, 0.5 * (low[1] + high[1]))
    along = low[0] + (cells // rows + 0.5) * cell[0]
    slack = 0.45 * np.maximum(np.asarray(cell) - 2.0 * RADIUS, 0.0)
    jittered = np.stack([along, across], axis=1) + rng.uniform(-1.0, 1.0, (count, 2)) * np.minimum(slack, 0.2)
    return np.clip(jittered, low, high)


def crowds(
    name: str, people: int, numbers: Sequence[int], low: Sequence[float], high: Sequence[float]
) -> tuple[Floats, Floats]:
    """Return positions ``[E, people, 2]`` [m] between two corners and free speeds ``[E, people]`` [m/s] of starts."""
    rngs = [stream_of(name, people, number) for number in numbers]
    place = np.stack([starts(people, low, high, rng) for rng in rngs])
    return place, np.stack([free_speeds((people,), rng) for rng in rngs])
