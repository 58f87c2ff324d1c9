"""Corridor test: speed by density of a one-way crowd on a periodic track between two walls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.measurement import compute_fundamental_diagram
from crowdbot.models import CrowdModel

from .literature import weidmann_speed
from .scenario import (
    FREE_SPEED,
    RADIUS,
    Check,
    CrowdTracks,
    Report,
    Verdict,
    corridor_walls,
    deepest_overlap,
    free_speeds,
    share,
    simulate_periodic,
    starts,
    stream_of,
)
from .section import section_of, section_values
from .statistics import STARTS, SteadyWindow, find_steady_window

__all__ = ["CORRIDOR", "corridor_crowd"]

LENGTH, WIDTH = 12.0, 3.0
DENSITIES = (0.25, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0)
"""People per square metre."""
QUICK = (0.5, 1.5, 3.0)
SECONDS = 45.0
EVERY = 1.0
"""Time between measurements [s]."""
LEAST = 5
"""Minimum number of values of a bin."""
LIMIT = 0.25
"""Allowed root mean square deviation from Weidmann's curve [m/s]."""
SPREAD = 0.05
"""Standard deviation of free speeds [m/s]; RiMEA test 4 requires nearly equal ones, 1.2 to 1.4 m/s."""


def run(model: CrowdModel, quick: bool, report: Report) -> dict[str, Any]:
    """Measure speed over Voronoi density in the steady state; densities and starts are environments."""
    densities, starts_, seconds = (QUICK, 1, 6.0) if quick else (DENSITIES, STARTS, SECONDS)
    runs = [("one-way", density, k) for density in densities for k in range(starts_)]
    crowd = corridor_crowd(runs, LENGTH, WIDTH, two_way=False, spread=SPREAD)
    walk = simulate_periodic(model, crowd, LENGTH, seconds, stream_of("corridor", "model"), report)
    y, here = walk.position[..., 1], crowd.active
    windows = [_window(walk, here, slice(k * starts_, (k + 1) * starts_)) for k in range(len(densities))]
    return {
        **_diagram(walk, [window.begin for window in windows], starts_),
        "starts": starts_,
        "initial_density": list(densities),
        "steady_from": [window.begin if window.steady else None for window in windows],
        "outside": float(np.mean(np.any((y < 0.0) | (y > WIDTH), axis=0)[here])),
        "overlap": deepest_overlap(walk, LENGTH),
    }


def _window(walk: CrowdTracks, here: NDArray[np.bool_], rows: slice) -> SteadyWindow:
    """Return the steady window of the mean forward speed of all starts of a density."""
    moved = np.diff(walk.position[:, rows, :, 0], axis=0) * here[rows]
    speed = moved.sum(axis=(1, 2)) / (here[rows].sum() * (walk.times[1] - walk.times[0]))
    return find_steady_window(walk.times[1:], speed)


def _diagram(walk: CrowdTracks, begins: Sequence[float], starts_: int) -> dict[str, Any]:
    """Return the fundamental diagram of all environments, with intervals over starts if there are several."""
    density, speed, start = [], [], []
    for e in range(walk.position.shape[1]):
        rho, v = section_values(section_of(walk, e, LENGTH, begins[e // starts_]), WIDTH, EVERY)
        density.append(rho)
        speed.append(v)
        start.append(np.full(len(rho), e % starts_))
    who = np.concatenate(start) if starts_ > 1 else None
    found = compute_fundamental_diagram(np.concatenate(density), np.concatenate(speed), 0.5, who, least=LEAST)
    return {name: found[name].tolist() for name in found.columns}


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
