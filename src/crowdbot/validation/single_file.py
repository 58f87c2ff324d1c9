"""Single-file test: speed by line density on a periodic track that is too narrow to overtake."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.core import Scene
from crowdbot.models import CrowdModel

from .literature import line_speed
from .scenario import (
    FREE_SPEED,
    RADIUS,
    STEP,
    Check,
    Floats,
    Report,
    Verdict,
    corridor_walls,
    deepest_overlap,
    share,
    simulate_periodic,
    stream_of,
)

__all__ = ["SINGLE_FILE"]

LENGTH = 20.0
WIDTH = 0.7
"""Width [m]; two bodies of 0.4 m do not fit side by side."""
DENSITIES = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25)
"""People per metre of track; at 2.5, bodies touch."""
QUICK = (0.5, 1.0, 1.5, 2.0)
WARM, MEASURED = 30.0, 20.0
"""Warm-up and measurement time [s]."""
LIMIT = 0.20
"""Allowed root mean square deviation from the published line [m/s]."""


def run(model: CrowdModel, quick: bool, report: Report) -> dict[str, Any]:
    """Measure the mean forward speed at each density; densities are environments."""
    densities = QUICK if quick else DENSITIES
    warm, measured = (6.0, 4.0) if quick else (WARM, MEASURED)
    crowd = _file([round(density * LENGTH) for density in densities])
    walk = simulate_periodic(model, crowd, LENGTH, warm + measured, stream_of("single-file", "model"), report)
    x, here = walk.position[..., 0], crowd.active
    first = round(warm / (4.0 * STEP))
    moved = (x[-1] - x[first]) / (walk.times[-1] - walk.times[first])
    lateral = np.abs(walk.position[..., 1] - 0.5 * WIDTH)[:, here]
    return {
        "density": list(densities),
        "speed": [float(moved[e, here[e]].mean()) for e in range(len(densities))],
        "overtakings": int(sum(_overtakings(x[0, e, here[e]], x[-1, e, here[e]]) for e in range(len(densities)))),
        "outside": float(np.mean(np.any(lateral > 0.5 * WIDTH, axis=0))),
        "overlap": deepest_overlap(walk, LENGTH),
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
    judge,
)


def _file(counts: list[int]) -> Scene:
    E, A = len(counts), max(counts)
    place, here = np.zeros((E, A, 2)), np.zeros((E, A), dtype=np.bool_)
    for e, count in enumerate(counts):
        rng, gap = stream_of("single-file", count), LENGTH / count
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
