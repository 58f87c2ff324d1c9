"""Scenarios of the checks, with their walls and published reference values."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, stream
from crowdbot.data import Trajectories
from crowdbot.models import CrowdModel
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
    known = model.valid_range
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


THICK = 0.5
"""Thickness of the walls [m]; those of cabins have 0.1 m."""
CORNER_SOLIDS: list[Solid] = [
    (-2.0, -0.5, 12.5, 0.0),
    (12.0, 0.0, 12.5, 18.0),
    (-2.0, 2.0, 10.0, 18.0),
]
"""The corner of RiMEA 6: a corridor 2 m wide with arms of 12 m along the outer walls."""


def rings(solids: Sequence[Solid]) -> list[list[tuple[float, float]]]:
    """Return solid rectangles as rings for :class:`crowdbot.core.Walls`."""
    return [[(x0, y0), (x1, y0), (x1, y1), (x0, y1)] for x0, y0, x1, y1 in solids]


def inside_solids(walk: CrowdTracks, solids: Sequence[Solid]) -> float:
    """Return the share of people whose centre is inside a solid at any time."""
    x, y = walk.position[..., 0], walk.position[..., 1]
    wrong = np.zeros(walk.present.shape, dtype=np.bool_)
    for x0, y0, x1, y1 in solids:
        wrong |= (x > x0) & (x < x1) & (y > y0) & (y < y1)
    return float(np.any(wrong & walk.present, axis=0)[walk.present[0]].mean())


def corridor_walls(length: float, width: float) -> list[list[tuple[float, float]]]:
    """Return the two walls of a corridor along x, ``0 < y < width``, extended at both ends of the track."""
    x0, x1 = -2.0 * SEEN, length + 2.0 * SEEN
    return rings([(x0, -THICK, x1, 0.0), (x0, width, x1, width + THICK)])


def bottleneck_solids(length: float, half: float, door: float, deep: float) -> list[Solid]:
    """Return a room along negative x, closed at ``-length``, that opens into a passage at x = 0.

    Args:
        length: length of the room [m].
        half: half width of the room [m].
        door: width of the passage [m].
        deep: length of the passage [m].
    """
    side = 0.5 * door
    return [
        (0.0, side, deep, half + THICK),
        (0.0, -half - THICK, deep, -side),
        (-length - THICK, half, 0.0, half + THICK),
        (-length - THICK, -half - THICK, 0.0, -half),
        (-length - THICK, -half, -length, half),
    ]


def waiting_room() -> list[Solid]:
    """Return the room of 8 x 5 m of RiMEA 5 with a door of 1 m in the middle of its right wall."""
    return [(-0.5, -0.5, 8.5, 0.0), (-0.5, 5.0, 8.5, 5.5), (-0.5, 0.0, 0.0, 5.0), (8.0, 0.0, 8.5, 2.0),
            (8.0, 3.0, 8.5, 5.0)]  # fmt: skip


def hall_solids(length: float, deep: float, door: float) -> list[Solid]:
    """Return a hall from 0, 0 to ``length, deep`` [m] with two doors of width ``door`` in each long side."""
    solids: list[Solid] = [(-THICK, -THICK, 0.0, deep + THICK), (length, -THICK, length + THICK, deep + THICK)]
    half = 0.5 * door
    for y0, y1 in ((-THICK, 0.0), (deep, deep + THICK)):
        ends = [0.0, 0.25 * length - half, 0.25 * length + half, 0.75 * length - half, 0.75 * length + half, length]
        solids += [(a, y0, b, y1) for a, b in zip(ends[::2], ends[1::2], strict=True)]
    return solids


def two_rooms(way: float, door: float, leave: bool) -> list[Solid]:
    """Return two rooms of 10 x 10 m along x, with a corridor in their middle at y = 5 m.

    Args:
        way: length of the corridor [m].
        door: width of the corridor [m], and of the exit.
        leave: whether the second room has an exit opposite the corridor.
    """
    end = 20.0 + way
    walls: list[Solid] = [(-THICK, -THICK, 0.0, 10.0 + THICK)]
    for x0, x1 in ((0.0, 10.0), (10.0 + way, end)):
        walls += [(x0, -THICK, x1, 0.0), (x0, 10.0, x1, 10.0 + THICK)]
    low, high = 5.0 - 0.5 * door, 5.0 + 0.5 * door
    for x0, x1 in ((10.0, 10.0 + way), (end, end + THICK)) if leave else ((10.0, 10.0 + way),):
        walls += [(x0, -THICK, x1, low), (x0, high, x1, 10.0 + THICK)]
    return walls if leave else [*walls, (end, -THICK, end + THICK, 10.0 + THICK)]


def long_corner_solids(straight: float | None) -> list[Solid]:
    """Return a corridor 10 m wide, straight of a length [m], or (None) with a corner to the right seen from its top."""
    if straight is None:
        return [
            (-0.5, -0.5, 0.0, 30.5),
            (0.0, 30.0, 10.0, 30.5),
            (10.0, 10.0, 18.0, 30.5),
            (0.0, -0.5, 18.0, 0.0),
        ]
    top = straight
    return [(-0.5, -4.0, 0.0, top + 0.5), (10.0, -4.0, 10.5, top + 0.5), (0.0, top, 10.0, top + 0.5)]


def cabin_solids(cabins: int, width: float, deep: float, way: float) -> list[Solid]:
    """Return walls 0.1 m thick around cabins on both sides of a corridor along x, with doors of 1 m in their middle.

    Args:
        cabins: cabins on each side.
        width: width of a cabin [m].
        deep: depth of a cabin [m].
        way: width of the corridor [m].
    """
    half, end = 0.5 * way, cabins * width
    solids: list[Solid] = []
    for sign in (1.0, -1.0):
        near, far = (half, half + deep) if sign > 0.0 else (-half - deep, -half)
        edge = half if sign > 0.0 else -half - 0.1
        back = far if sign > 0.0 else near - 0.1
        solids.append((-0.1, back, end + 0.1, back + 0.1))
        for k in range(cabins + 1):
            solids.append((k * width - 0.05, near, k * width + 0.05, far))
        for k in range(cabins):
            middle = (k + 0.5) * width
            solids += [(k * width, edge, middle - 0.5, edge + 0.1), (middle + 0.5, edge, (k + 1) * width, edge + 0.1)]
    return solids


SPECIFIC_FLOW = 1.9
"""Persons per second and metre of width through a bottleneck, Seyfried et al. 2009."""

BOTTLENECK_FLOWS = (
    (0.9, 1.71),
    (1.0, 2.02),
    (1.1, 2.19),
    (1.2, 2.53),
    (1.4, 2.91),
    (1.6, 3.11),
    (1.8, 3.91),
    (2.0, 3.91),
    (2.2, 4.52),
    (2.5, 5.55),
)
"""Width [m] and flow [1/s] of Liddle et al. 2009: 150 people, first to last; also used in the validation tests of
JuPedSim.
"""

SOURCES = (
    "Weidmann 1993, Transporttechnik der Fussgänger, ETH Zürich, Schriftenreihe des IVT 90,"
    " doi:10.3929/ethz-a-000687810",
    "Seyfried, Steffen, Klingsch, Boltes 2005, The fundamental diagram of pedestrian movement revisited,"
    " doi:10.1088/1742-5468/2005/10/P10002",
    "Steffen, Seyfried 2010, Methods for measuring pedestrian density, flow, speed and direction with minimal scatter,"
    " doi:10.1016/j.physa.2009.12.015 (density by Voronoi cells)",
    "Zhang, Klingsch, Schadschneider, Seyfried 2011, Transitions in pedestrian fundamental diagrams of straight"
    " corridors and T-junctions, doi:10.1088/1742-5468/2011/06/P06004 (the HERMES corridor runs)",
    "Rex, Löwen 2007, Lane formation in oppositely charged colloids driven by an electric field,"
    " doi:10.1103/PhysRevE.75.051402; Nowak, Schadschneider 2012, Quantitative analysis of pedestrian counterflow,"
    " doi:10.1103/PhysRevE.85.046128 (order parameter of lanes)",
    "Zhang, Klingsch, Schadschneider, Seyfried 2012, Ordering in bidirectional pedestrian flows and its influence on"
    " the fundamental diagram, doi:10.1088/1742-5468/2012/02/P02002 (two-way flows that move at 2 people/m2 and more)",
    "Seyfried, Passon, Steffen, Boltes, Rupprecht, Klingsch 2009, New insights into pedestrian flow through"
    " bottlenecks, doi:10.1287/trsc.1090.0263",
    "Liddle, Seyfried, Klingsch, Rupprecht, Schadschneider, Winkens 2009, An experimental study of pedestrian"
    " congestions: influence of bottleneck width and length, arXiv:0911.4350",
    "Adrian, Seyfried, Sieben 2020, Crowds in front of bottlenecks at entrances from the perspective of physics and"
    " social psychology, doi:10.1098/rsif.2019.0871 (run 040_c_56_h-)",
    "RiMEA e.V. 2016, Guideline for microscopic evacuation analysis, version 3.0.0",
)


def weidmann_speed(density: ArrayLike) -> Floats:
    """Return Weidmann's speed [m/s] over the density [1/m2] of a crowd in a plane.

    >>> weidmann_speed([0.5, 2.0]).round(2).tolist()
    [1.3, 0.61]
    """
    inverse = 1.0 / np.asarray(density, dtype=np.float64)
    return np.asarray(FREE_SPEED * np.clip(1.0 - np.exp(-1.913 * (inverse - 1.0 / 5.4)), 0.0, 1.0))


def line_speed(density: ArrayLike) -> Floats:
    """Return the speed [m/s] of a single file over its line density [1/m]: 1 / density = 0.36 m + 1.06 s * speed.

    Seyfried et al. 2005, cut at the free speed.

    >>> line_speed([0.5, 1.0, 2.0]).round(2).tolist()
    [1.34, 0.6, 0.13]
    """
    inverse = 1.0 / np.asarray(density, dtype=np.float64)
    return np.asarray(np.clip((inverse - 0.36) / 1.06, 0.0, FREE_SPEED))
