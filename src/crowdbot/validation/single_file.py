"""Single-file test: speed by line density on a periodic track that is too narrow to overtake."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from crowdbot.core import Scene
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

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
    line_speed,
    share,
    stream_of,
)
from .statistics import find_steady_window, summarize_starts, worst_of

LENGTH = 20.0
WIDTH = 0.7
"""Width [m]; two bodies of 0.4 m do not fit side by side."""
DENSITIES = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25)
"""People per metre of track; at 2.5, bodies touch."""
QUICK = (0.5, 1.0, 1.5, 2.0)
SECONDS = 50.0
"""Duration of a run [s]."""
LIMIT = 0.20
"""Allowed root mean square deviation from the published line [m/s]."""


def run(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Measure the mean forward speed in the steady state; densities and starts are environments."""
    densities, seconds = (QUICK, 10.0) if quick else (DENSITIES, SECONDS)
    runs = [(round(density * LENGTH), k) for density in densities for k in numbers]
    crowd = file_crowd(runs)
    walk = simulate_periodic(model, crowd, LENGTH, seconds, stream_of("single-file", "model", numbers[0]), report)
    rows: list[Row] = []
    for j in range(len(numbers)):
        parts = [_measure(one_start(walk, k * len(numbers) + j)) for k in range(len(densities))]
        rows.append(
            {
                "density": list(densities),
                "speed": [part["speed"] for part in parts],
                "steady_from": [part["steady_from"] for part in parts],
                "overtakings": sum(part["overtakings"] for part in parts),
                "outside": float(np.mean([part["outside"] for part in parts])),
                "overlap": max(part["overlap"] for part in parts),
            }
        )
    return rows


def _measure(walk: CrowdTracks) -> dict[str, Any]:
    """Return the values of one density and start in the steady state of the mean forward speed."""
    place = walk.position[:, 0, walk.present[0, 0]]
    x = place[..., 0]
    window = find_steady_window(walk.times[1:], np.diff(x, axis=0).mean(axis=1) / (walk.times[1] - walk.times[0]))
    first = int(np.searchsorted(walk.times, window.begin - 1e-9))
    lateral = np.abs(place[..., 1] - 0.5 * WIDTH)
    return {
        "speed": float((x[-1] - x[first]).mean() / (walk.times[-1] - walk.times[first])),
        "steady_from": window.begin if window.steady else None,
        "overtakings": _overtakings(x[0], x[-1]),
        "outside": float(np.mean(np.any(lateral > 0.5 * WIDTH, axis=0))),
        "overlap": deepest_overlap(walk, LENGTH),
    }


def summarize(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the speeds with intervals over starts."""
    found = summarize_starts(np.asarray([row["speed"] for row in rows]).T)
    return {
        "density": rows[0]["density"],
        "speed": found["mean"],
        "low": found["low"],
        "high": found["high"],
        "steady_from": [list(item) for item in zip(*(row["steady_from"] for row in rows), strict=True)],
        "overtakings": sum(row["overtakings"] for row in rows),
        **worst_of(rows),
    }


def judge(result: dict[str, Any]) -> Verdict:
    """Compare with the published line, and check for overtaking and people in walls."""
    density, speed = np.asarray(result["density"]), np.asarray(result["speed"])
    distance = float(np.sqrt(np.mean((speed - line_speed(density)) ** 2)))
    value = f"{distance:.2f} m/s"
    words = []
    if speed[-1] > 0.5 * FREE_SPEED:
        words.append(f"people in single file walk at {speed[-1]:.2f} m/s even at {density[-1]:g} people per metre")
    elif speed[0] < 0.5 * FREE_SPEED:
        words.append(f"the walls of a track {WIDTH} m wide slow down people {1.0 / density[0]:.0f} m apart")
    elif np.any(speed[density <= 1.0] < 0.2):
        words.append(f"people in single file nearly stop at {density[speed < 0.2][0]:g} per metre")
    elif distance > LIMIT:
        words.append(
            "people in single file are " + ("too fast" if np.mean(speed - line_speed(density)) > 0.0 else "too slow")
        )
    if result["overtakings"]:
        words.append(f"people in single file walk through each other ({result['overtakings']} overtakings)")
    if result["outside"] > 0.0:
        words.append(f"{share(result['outside'])} of people in single file leave the track through its walls")
    passed = distance <= LIMIT and not result["overtakings"] and result["outside"] == 0.0
    return Verdict(value, passed, "; ".join(words))


SINGLE_FILE = Check(
    "single-file",
    "single file",
    f"the root mean square deviation of the speeds from 1 / density = 0.36 m + 1.06 s * speed is at most {LIMIT:.2f}"
    " m/s, and nobody overtakes or leaves the track",
    run,
    summarize,
    judge,
)


def file_crowd(runs: Sequence[tuple[int, int]]) -> Scene:
    """Return one environment for each run (people, number of the start)."""
    E, A = len(runs), max(count for count, _ in runs)
    place, here = np.zeros((E, A, 2)), np.zeros((E, A), dtype=np.bool_)
    for e, (count, number) in enumerate(runs):
        rng, gap = stream_of("single-file", count, number), LENGTH / count
        shake = min(0.3, 0.4 * (gap - 2.0 * RADIUS))
        place[e, :count, 0] = (np.arange(count) + 0.5) * gap + shake * rng.uniform(-1.0, 1.0, count)
        place[e, :count, 1] = 0.5 * WIDTH + rng.uniform(-0.02, 0.02, count)
        here[e, :count] = True
    wish = np.broadcast_to([FREE_SPEED, 0.0], place.shape)
    return Scene.of(
        place,
        radius=RADIUS,
        preferred_speed=FREE_SPEED,
        preferred_velocity=wish,
        active=here,
        walls=corridor_walls(LENGTH, WIDTH),
    )


def _overtakings(before: Floats, after: Floats) -> int:
    """Return the number of pairs that changed their order, including lapped people."""
    order = np.argsort(before)
    last = after[order]
    swapped = last[:, None] > last[None, :]
    lapped = last[None, :] > last[:, None] + LENGTH
    ahead = np.triu(np.ones(swapped.shape, dtype=np.bool_), 1)
    return int(np.sum((swapped | lapped) & ahead))
