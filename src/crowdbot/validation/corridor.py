"""Corridor test: speed by density of a one-way crowd on a periodic track between two walls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from crowdbot.core import Scene
from crowdbot.models import CrowdModel

from .crowd_motion import deepest_overlap, one_start, simulate_periodic
from .scenario import (
    FREE_SPEED,
    RADIUS,
    Check,
    CrowdTracks,
    Report,
    Row,
    Verdict,
    corridor_walls,
    free_speeds,
    share,
    starts,
    stream_of,
    weidmann_speed,
)
from .section import section_of, section_values
from .statistics import bin_values, find_steady_window, pool_bins, worst_of

LENGTH, WIDTH = 12.0, 3.0
DENSITIES = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0)
"""People per square metre."""
QUICK = (0.5, 1.5, 3.0)
SECONDS = 45.0
EVERY = 2.0
"""Time between measurements [s]."""
BIN = 0.5
"""Width of the bins of density [1/m2]."""
LEAST = 5
"""Minimum number of values of a bin."""
LIMIT = 0.25
"""Allowed root mean square deviation from Weidmann's curve [m/s]."""
SPREAD = 0.05
"""Standard deviation of free speeds [m/s]; RiMEA test 4 requires nearly equal ones, 1.2 to 1.4 m/s."""


def run(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Measure speed over Voronoi density in the steady state; densities and starts are environments."""
    densities, seconds = (QUICK, 6.0) if quick else (DENSITIES, SECONDS)
    runs = [("one-way", density, k) for density in densities for k in numbers]
    crowd = corridor_crowd(runs, LENGTH, WIDTH, two_way=False, spread=SPREAD)
    walk = simulate_periodic(model, crowd, LENGTH, seconds, stream_of("corridor", "model", numbers[0]), report)
    rows: list[Row] = []
    for j in range(len(numbers)):
        parts = [_measure(one_start(walk, k * len(numbers) + j)) for k in range(len(densities))]
        values = [np.concatenate([part[name] for part in parts]) for name in ("density", "speed")]
        rows.append(
            {
                "initial_density": list(densities),
                "bins": bin_values(values[0], values[1], BIN),
                "steady_from": [part["steady_from"] for part in parts],
                "outside": float(np.mean([part["outside"] for part in parts])),
                "overlap": max(part["overlap"] for part in parts),
            }
        )
    return rows


def _measure(walk: CrowdTracks) -> dict[str, Any]:
    """Return the values of one density and start in the steady state of the mean forward speed."""
    people = walk.present[0, 0]
    x, y = walk.position[:, 0, people, 0], walk.position[:, 0, people, 1]
    speed = np.diff(x, axis=0).mean(axis=1) / (walk.times[1] - walk.times[0])
    window = find_steady_window(walk.times[1:], speed)
    density, values = section_values(section_of(walk, 0, LENGTH, window.begin), WIDTH, EVERY)
    return {
        "density": density,
        "speed": values,
        "steady_from": window.begin if window.steady else None,
        "outside": float(np.mean(np.any((y < 0.0) | (y > WIDTH), axis=0))),
        "overlap": deepest_overlap(walk, LENGTH),
    }


def summarize(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the fundamental diagram of all starts with intervals."""
    return {
        **pool_bins([row["bins"] for row in rows], BIN, LEAST if len(rows) > 1 else 1),
        "initial_density": rows[0]["initial_density"],
        "steady_from": [list(item) for item in zip(*(row["steady_from"] for row in rows), strict=True)],
        **worst_of(rows),
    }


def judge(result: dict[str, Any]) -> Verdict:
    """Compare with Weidmann's curve, and check for people in walls."""
    density, speed = np.asarray(result["density"]), np.asarray(result["speed"])
    curve = weidmann_speed(density)
    distance = float(np.sqrt(np.mean((speed - curve) ** 2)))
    dense = int(np.argmin(np.abs(density - 3.0)))
    words = []
    if speed[dense] > 0.7 * FREE_SPEED:
        words.append(f"a one-way crowd of {density[dense]:g} people/m2 still walks at {speed[dense]:.2f} m/s")
    elif np.any(speed[density <= 1.0] < 0.5 * curve[density <= 1.0]):
        words.append("a one-way crowd is far too slow even at 1 person/m2")
    elif distance > LIMIT:
        words.append("one-way crowds are " + ("too fast" if np.mean(speed - curve) > 0.0 else "too slow"))
    if result["outside"] > 0.0:
        words.append(f"{share(result['outside'])} of a dense one-way crowd are pushed through the walls")
    passed = distance <= LIMIT and result["outside"] == 0.0
    return Verdict(f"{distance:.2f} m/s", passed, "; ".join(words))


CORRIDOR = Check(
    "corridor",
    "corridor",
    f"the root mean square deviation of the speeds from Weidmann's curve is at most {LIMIT:.2f} m/s, and nobody's"
    " centre leaves the corridor (together with single file, this is RiMEA test 4)",
    run,
    summarize,
    judge,
)


def corridor_crowd(
    runs: list[tuple[str, float, int]], length: float, width: float, *, two_way: bool, spread: float
) -> Scene:
    """Return crowds in a corridor, one environment per run (name, density [1/m2], number), initially walking.

    With ``two_way``, a random half of the people walks towards -x.
    """
    counts = [round(density * length * width) for _, density, _ in runs]
    E, A = len(counts), max(counts)
    place, here, wish = np.zeros((E, A, 2)), np.zeros((E, A), dtype=np.bool_), np.zeros((E, A, 2))
    for e, (name, _, number) in enumerate(runs):
        count, rng = counts[e], stream_of("corridor", name, counts[e], number)
        margin = RADIUS + 0.05
        place[e, :count] = starts(count, (0.0, margin), (length, width - margin), rng)
        side = np.where(rng.permutation(count) < count // 2, -1.0, 1.0) if two_way else np.ones(count)
        wish[e, :count, 0] = side * free_speeds((count,), rng, spread)
        here[e, :count] = True
    speed = np.where(here, np.abs(wish[..., 0]), FREE_SPEED)
    return Scene.of(
        place,
        0.5 * wish,
        radius=RADIUS,
        preferred_speed=speed,
        preferred_velocity=wish,
        active=here,
        walls=corridor_walls(length, width),
    )
