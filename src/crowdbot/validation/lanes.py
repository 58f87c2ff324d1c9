"""Lane tests: two-way flow in a wide corridor (lanes) and in a narrow one (jams)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.measurement import lane_order
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

from .corridor import corridor_crowd
from .crowd_motion import deepest_overlap, one_start, simulate_periodic
from .scenario import FREE_SPEED, Check, Report, Row, Verdict, share, stream_of
from .statistics import ends_of, find_steady_window, summarize_starts, text_of, worst_of

LENGTH = 12.0
WIDE, DENSITY = 4.0, 1.0
"""Width [m] and density [1/m2] of the recording bi_corr_400_b_03."""
NARROW_WIDTH = 2.0
NARROW_DENSITIES = (0.5, 1.0, 1.5, 2.0)
SECONDS, LAST = 60.0, 20.0
NARROW_SECONDS, NARROW_LAST = 90.0, 10.0
ORDER = 0.5
"""Minimum lane order; recordings have about 0.5 to 1."""
JAM = 0.1
"""Speeds below this fraction of the free speed are a jam."""


def run_lanes(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Measure the order over time; starts are environments."""
    seconds, last = (8.0, 4.0) if quick else (SECONDS, LAST)
    crowd = corridor_crowd([("two-way", DENSITY, k) for k in numbers], LENGTH, WIDE, two_way=True, spread=0.26)
    walk = simulate_periodic(model, crowd, LENGTH, seconds, stream_of("lanes", "model", numbers[0]), report)
    assert crowd.preferred_velocity is not None
    side = np.sign(crowd.preferred_velocity[..., 0])
    speed = _forward(walk.times, walk.position[..., 0], side, last).mean(axis=1)
    every = slice(None, None, 5)
    times, y = walk.times[every], walk.position[..., 1]
    rows: list[Row] = []
    for e in range(len(numbers)):
        order = np.asarray([lane_order(place, side[e]) for place in y[every, e]])
        window = find_steady_window(times, order)
        rows.append(
            {
                "time": times.tolist(),
                "order": order.tolist(),
                "last_order": float(order[times >= seconds - last].mean()),
                "steady_from": window.begin if window.steady else None,
                "speed": float(speed[e]),
                "outside": float(np.mean(np.any((y[:, e] < 0.0) | (y[:, e] > WIDE), axis=0))),
                "overlap": deepest_overlap(one_start(walk, e), LENGTH),
            }
        )
    return rows


def summarize_lanes(rows: Sequence[Row]) -> dict[str, Any]:
    """Return means over starts, and their intervals for the order of lanes and the speed."""
    values = {name: [row[name] for row in rows] for name in ("last_order", "speed", "outside", "overlap")}
    return {
        "time": rows[0]["time"],
        "order": np.mean([row["order"] for row in rows], axis=0).tolist(),
        "last_order": float(np.mean(values["last_order"])),
        "speed": float(np.mean(values["speed"])),
        "interval": ends_of(summarize_starts([values["last_order"], values["speed"]])),
        "steady_from": [row["steady_from"] for row in rows],
        "outside": float(np.mean(values["outside"])),
        "overlap": max(values["overlap"]),
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
    summarize_lanes,
    judge_lanes,
)


def run_narrow(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Measure the speed in a narrow corridor; densities and starts are environments."""
    seconds, last = (10.0, 4.0) if quick else (NARROW_SECONDS, NARROW_LAST)
    densities = (1.0, 2.0) if quick else NARROW_DENSITIES
    runs = [("narrow", density, k) for density in densities for k in numbers]
    crowd = corridor_crowd(runs, LENGTH, NARROW_WIDTH, two_way=True, spread=0.26)
    walk = simulate_periodic(model, crowd, LENGTH, seconds, stream_of("narrow", "model", numbers[0]), report)
    assert crowd.preferred_velocity is not None
    forward = _forward(walk.times, walk.position[..., 0], np.sign(crowd.preferred_velocity[..., 0]), last)
    here, y = crowd.active, walk.position[..., 1]
    wrong = np.any((y < 0.0) | (y > NARROW_WIDTH), axis=0)
    rows: list[Row] = []
    for j in range(len(numbers)):
        own = [k * len(numbers) + j for k in range(len(densities))]
        rows.append(
            {
                "density": list(densities),
                "speed": [float(forward[e, here[e]].mean()) for e in own],
                "outside": float(np.mean(np.concatenate([wrong[e, here[e]] for e in own]))),
                "overlap": max(deepest_overlap(one_start(walk, e), LENGTH) for e in own),
            }
        )
    return rows


def summarize_narrow(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the speeds of all starts by density, and intervals of their means."""
    speed = np.asarray([row["speed"] for row in rows]).T
    return {
        "density": rows[0]["density"],
        "speeds": speed.tolist(),
        "interval": ends_of(summarize_starts(speed)),
        **worst_of(rows),
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
    summarize_narrow,
    judge_narrow,
)


def _forward(times: Floats, x: Floats, side: NDArray[np.float64], last: float) -> Floats:
    """Return the speed ``[E, A]`` [m/s] in the walking direction of each person over the last seconds."""
    first = int(np.searchsorted(times, times[-1] - last - 1e-9))
    return np.asarray(side * (x[-1] - x[first]) / (times[-1] - times[first]))
