"""Lane tests: two-way flow in a wide corridor (lanes) and in a narrow one (jams)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.measurement import lane_order
from crowdbot.models import CrowdModel

from .corridor import corridor_crowd
from .scenario import FREE_SPEED, Check, Floats, Report, Verdict, deepest_overlap, share, simulate_periodic, stream_of
from .statistics import STARTS, summarize_starts, text_of

__all__ = ["LANES", "NARROW"]

LENGTH = 12.0
WIDE, DENSITY, SEEDS = 4.0, 1.0, STARTS
"""Width [m] and density [1/m2] of the recording bi_corr_400_b_03, and runs of each model."""
NARROW_WIDTH = 2.0
NARROW_DENSITIES = (0.5, 1.0, 1.5, 2.0)
NARROW_SEEDS = STARTS
SECONDS, LAST = 60.0, 20.0
NARROW_SECONDS, NARROW_LAST = 90.0, 10.0
ORDER = 0.5
"""Minimum lane order; recordings have about 0.5 to 1."""
JAM = 0.1
"""Speeds below this fraction of the free speed are a jam."""


def run_lanes(model: CrowdModel, quick: bool, report: Report) -> dict[str, Any]:
    """Measure the order over time, mean over runs."""
    seconds, last, seeds = (8.0, 4.0, 1) if quick else (SECONDS, LAST, SEEDS)
    crowd = corridor_crowd([("two-way", DENSITY, k) for k in range(seeds)], LENGTH, WIDE, two_way=True, spread=0.26)
    walk = simulate_periodic(model, crowd, LENGTH, seconds, stream_of("lanes", "model"), report)
    wish = crowd.preferred_velocity
    assert wish is not None
    side = np.sign(wish[..., 0])
    every = slice(None, None, 5)
    order = [[lane_order(y[e], side[e]) for e in range(seeds)] for y in walk.position[every, ..., 1]]
    times = walk.times[every]
    late = times >= seconds - last
    y = walk.position[..., 1]
    last_order = np.asarray(order)[late].mean(axis=0)
    speed = _forward(walk.times, walk.position[..., 0], side, last).mean(axis=1)
    return {
        "time": times.tolist(),
        "order": np.mean(order, axis=1).tolist(),
        "last_order": float(last_order.mean()),
        "speed": float(speed.mean()),
        "interval": _ends(summarize_starts([last_order, speed])),
        "outside": float(np.mean(np.any((y < 0.0) | (y > WIDE), axis=0))),
        "overlap": deepest_overlap(walk, LENGTH),
    }


def judge_lanes(result: dict[str, Any]) -> Verdict:
    """Check that lanes form and people keep moving."""
    words = []
    if result["last_order"] < ORDER:
        words.append(f"lanes hardly form in a two-way flow (order {result['last_order']:.2f})")
    if result["speed"] < 0.5 * FREE_SPEED:
        words.append(f"a two-way flow of 1 person/m2 in a 4 m corridor slows down to {result['speed']:.2f} m/s")
    order, speed = result.get("interval", (None, None))
    value = f"{text_of(result['last_order'], order)}, {text_of(result['speed'], speed)} m/s"
    return Verdict(value, not words, "; ".join(words))


LANES = Check(
    "lanes",
    "lanes",
    f"in a corridor 4 m wide with 1 person/m2, the mean lane order of the last {LAST:g} s is at least {ORDER}, and the"
    " mean forward speed is at least half of the free speed",
    run_lanes,
    judge_lanes,
)


def run_narrow(model: CrowdModel, quick: bool, report: Report) -> dict[str, Any]:
    """Measure the speed in a narrow corridor, by density and seed."""
    seconds, last = (10.0, 4.0) if quick else (NARROW_SECONDS, NARROW_LAST)
    densities, seeds = ((1.0, 2.0), 1) if quick else (NARROW_DENSITIES, NARROW_SEEDS)
    runs = [("narrow", density, k) for density in densities for k in range(seeds)]
    crowd = corridor_crowd(runs, LENGTH, NARROW_WIDTH, two_way=True, spread=0.26)
    walk = simulate_periodic(model, crowd, LENGTH, seconds, stream_of("narrow", "model"), report)
    wish = crowd.preferred_velocity
    assert wish is not None
    forward = _forward(walk.times, walk.position[..., 0], np.sign(wish[..., 0]), last)
    here, y = crowd.active, walk.position[..., 1]
    speed = np.asarray([forward[e, here[e]].mean() for e in range(len(runs))]).reshape(len(densities), seeds)
    return {
        "density": list(densities),
        "speeds": speed.tolist(),
        "interval": _ends(summarize_starts(speed)),
        "outside": float(np.mean(np.any((y < 0.0) | (y > NARROW_WIDTH), axis=0)[here])),
        "overlap": deepest_overlap(walk, LENGTH),
    }


def judge_narrow(result: dict[str, Any]) -> Verdict:
    """Count the jams."""
    density, speed = np.asarray(result["density"]), np.asarray(result["speeds"])
    jams = speed < JAM * FREE_SPEED
    words = []
    if np.any(jams):
        first = density[np.any(jams, axis=1)][0]
        words.append(
            f"jams in a two-way corridor 2 m wide, at {first:g} people/m2 or more ({int(jams.sum())} of"
            f" {jams.size} runs)"
        )
    if result["outside"] > 0.0:
        words.append(f"{share(result['outside'])} of people are pushed through the walls of a narrow two-way corridor")
    return Verdict(f"{int(jams.sum())} of {jams.size} jam", not words, "; ".join(words))


NARROW = Check(
    "narrow",
    "narrow two-way",
    "in a corridor 2 m wide, no run at 0.5 to 2 people/m2 jams, and nobody's centre leaves the corridor. A jam is a"
    f" mean forward speed below {JAM:.0%} of 1.34 m/s in the last {NARROW_LAST:g} of {NARROW_SECONDS:g} s; people in"
    " experiments do not jam at these densities (Zhang et al. 2012)",
    run_narrow,
    judge_narrow,
)


def _ends(summary: dict[str, Any]) -> list[tuple[float, float]]:
    return list(zip(summary["low"], summary["high"], strict=True))


def _forward(times: Floats, x: Floats, side: NDArray[np.float64], last: float) -> Floats:
    """Return the speed ``[E, A]`` [m/s] in the walking direction of each person over the last seconds."""
    first = int(np.searchsorted(times, times[-1] - last - 1e-9))
    return np.asarray(side * (x[-1] - x[first]) / (times[-1] - times[first]))
