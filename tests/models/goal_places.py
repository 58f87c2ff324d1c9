"""A made place for tests of goals: a junction where people go straight on or turn off, and windows of it."""

from __future__ import annotations

import functools
import math

import numpy as np

from crowdbot.core import stream
from crowdbot.data import Trajectories, Windows
from crowdbot.models import GroundTruth
from crowdbot.models.goals import EnvironmentLayout, LearnedDestinations

STEP = 0.4
EXITS = ((12.0, 0.0), (0.0, 12.0), (-12.0, 0.0))
WALLS = (np.array([(1.5, 3.5), (1.5, 9.0)]), np.array([(-1.5, 9.0), (-1.5, 3.5)]))


def street(seed: int = 0, people: int = 60, noise: float = 0.01) -> Trajectories:
    """Return people who come from the west; who walks north of the middle line turns left at x = 0, the others not."""
    rng = stream(seed, "street")
    rows = []
    for person in range(people):
        y, speed = rng.uniform(0.5, 2.5) * rng.choice([-1.0, 1.0]), rng.uniform(1.0, 1.6)
        far = speed * STEP * np.arange(math.floor(22.0 / speed / STEP))
        straight = np.stack([-10.0 + far, np.full(len(far), y)], axis=1)
        left = np.stack([np.minimum(-10.0 + far, 0.0), y + np.maximum(far - 10.0, 0.0)], axis=1)
        way = (left if y > 0.0 else straight) + rng.normal(0.0, noise, (len(far), 2))
        rows += [(person, 10 * (8 * person + k), *place) for k, place in enumerate(way)]
    id, frame, x, y = np.array(rows).T
    # someone stands far away until the end, so that nobody else is cut off
    last = int(frame.max())
    id = np.append(id, [people, people])
    frame = np.append(frame, [last + 10, last + 20])
    x, y = np.append(x, [-9.0, -9.0]), np.append(y, [-5.0, -5.0])
    return Trajectories(id.astype(int), frame.astype(int), x, y, row_rate=1.0 / STEP, frame_step=10, name="street")


def moved(place: np.ndarray, angle: float, shift: tuple[float, float]) -> np.ndarray:
    """Return points turned to the left and shifted."""
    cos, sin = math.cos(angle), math.sin(angle)
    x, y = place[..., 0], place[..., 1]
    return np.stack([cos * x - sin * y + shift[0], sin * x + cos * y + shift[1]], axis=-1)


def made(kind: type, past: Windows, angle: float = 0.0, shift: tuple[float, float] = (0.0, 0.0)) -> object:
    """Return a goal of a kind for the street, turned and shifted."""
    if kind is GroundTruth:
        return GroundTruth(past, past)
    if kind is EnvironmentLayout:
        exits = moved(np.array(EXITS), angle, shift)
        return EnvironmentLayout(exits, [moved(wall, angle, shift) for wall in WALLS])
    if kind is LearnedDestinations:
        return _learned(angle, shift)
    return kind()


@functools.lru_cache(4)
def _learned(angle: float, shift: tuple[float, float]) -> LearnedDestinations:
    tracks = street()
    place = moved(tracks.position, angle, shift)
    return LearnedDestinations.learn(
        Trajectories(tracks.id, tracks.frame, place[:, 0], place[:, 1], 1.0 / STEP, frame_step=10)
    )


def windows(position: object, dt: float = STEP, **more: object) -> Windows:
    """Make windows from positions ``[W, T, A, 2]``; NaN where nobody is."""
    place = np.array(position, dtype=float)
    W, T, A, _ = place.shape
    present = ~np.isnan(place[..., 0])
    nobody = np.zeros((W, A), dtype=bool)
    id, frame = np.tile(np.arange(A), (W, 1)), np.tile(np.arange(T), (W, 1))
    return Windows(
        np.where(present[..., None], place, 0.0), present, nobody, nobody, id, frame, dt, "all", "made", **more
    )


def crowd(seed: int = 0, W: int = 4, T: int = 8, A: int = 6, holes: float = 0.15) -> Windows:
    """Return wandering people near the junction, with holes and padding."""
    rng = stream(seed, "goals")
    speed = rng.normal(0.0, 1.0, (W, 1, A, 2)) + rng.normal(0.0, 0.2, (W, T, A, 2))
    place = rng.uniform(-6.0, 6.0, (W, 1, A, 2)) + np.cumsum(STEP * speed, axis=1)
    place[rng.random((W, T, A)) < holes] = np.nan
    for window in range(W):
        place[window, :, A - window % 3 :] = np.nan
    return windows(place)
