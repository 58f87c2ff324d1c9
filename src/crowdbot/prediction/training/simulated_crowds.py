"""Simulated crowds as training data: several crowd models, layouts, densities and speeds, free of any licence."""

from __future__ import annotations

import numpy as np

from crowdbot.core import stream
from crowdbot.data import Trajectories, Windows
from crowdbot.prediction.simulated import Simulated
from crowdbot.typing import Floats

CROWD_MODELS = ("orca", "social-force", "power-law", "collision-free-speed", "anticipation-velocity")
"""Crowd models of the training data."""
CROWD_LAYOUTS = ("one-way", "two-way", "crossing", "everywhere")
"""Directions of walking: all the same, opposite, at right angles, random."""
STEP = 0.4
"""Time step of the tracks [s]."""
ROWS = 24
"""Rows of a simulated crowd."""
APART = 0.7
"""Smallest initial distance between two people [m]."""


def simulated_crowds(scenes: int = 6, seed: int = 0) -> list[Trajectories]:
    """Return tracks at 0.4 s of simulated crowds, one recording per model and layout.

    Args:
        scenes: number of crowds per model and layout, each of 4 to 40 people at 0.05 to 0.8 persons per square metre.
        seed: random seed.

    People walk at their preferred speed, normal(1.3, 0.25) m/s, in the direction of the layout, around each other.
    """
    found = []
    for model in CROWD_MODELS:
        predictor = Simulated(model, substep=0.05)
        for layout in CROWD_LAYOUTS:
            rng = stream(seed, "crowds", model, layout)
            crowds = [_rows(predictor, layout, rng) for _ in range(scenes)]
            found.append(_recording(crowds, f"simulated-{model}-{layout}"))
    return found


def _rows(predictor: Simulated, layout: str, rng: np.random.Generator) -> Floats:
    """Return positions ``[T, A, 2]`` [m] of one crowd."""
    count = int(rng.integers(4, 41))
    side = float(np.sqrt(count / rng.uniform(0.05, 0.8)))
    place = _places(count, side, rng)
    A = len(place)
    angle = {
        "one-way": np.zeros(A),
        "two-way": np.pi * rng.integers(0, 2, A),
        "crossing": 0.5 * np.pi * rng.integers(0, 2, A),
        "everywhere": rng.uniform(-np.pi, np.pi, A),
    }[layout] + rng.normal(0.0, 0.1, A)
    speed = np.clip(rng.normal(1.3, 0.25, A), 0.4, 2.2)
    velocity = speed[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    position = np.stack([place - STEP * velocity, place])[None]
    here, nobody = np.ones((1, 2, A), dtype=np.bool_), np.zeros((1, A), dtype=np.bool_)
    past = Windows(position, here, nobody, nobody, np.arange(A)[None], np.arange(2)[None], STEP, "all", "simulated")
    return np.asarray(predictor.predict(past, ROWS).position[0, 0])


def _places(count: int, side: float, rng: np.random.Generator) -> Floats:
    """Return at most ``count`` random points in a square, at least ``APART`` from each other."""
    kept: list[Floats] = []
    for point in rng.uniform(0.0, side, (20 * count, 2)):
        if len(kept) < count and all(np.hypot(*(point - other)) >= APART for other in kept):
            kept.append(point)
    return np.array(kept)


def _recording(crowds: list[Floats], name: str) -> Trajectories:
    """Return crowds as one recording; they follow each other without a common row."""
    id, frame, place, first = [], [], [], 0
    for number, rows in enumerate(crowds):
        T, A, _ = rows.shape
        id.append(np.tile(first + np.arange(A), T))
        frame.append(np.repeat(number * (ROWS + 40) + np.arange(T), A))
        place.append(rows.reshape(-1, 2))
        first += A
    xy = np.concatenate(place)
    return Trajectories(
        np.concatenate(id), np.concatenate(frame), xy[:, 0], xy[:, 1], row_rate=1.0 / STEP, frame_step=1, name=name
    )
