"""Layers computed from a crowd: density field, time to collision, and predicted paths."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.prediction import Live, Predictor
from crowdbot.typing import Floats

CELL, MARGIN, MOST_CELLS = 0.5, 2.0, 160
"""Side of a cell of the density field [m], space around the people [m], and largest number of cells of a side."""
SCALE = 1.0
"""Radius R [m] of the density kernel."""
DENSITY_UNIT = 0.025
"""Density of one unit of the field [1/m2]; the largest is 6.4."""
SOON, NEAR = 3.0, 8.0
"""Times to collision that are shown [s], and distance [m] up to which pairs are looked at."""
ROW, OBSERVED, STEPS, SAMPLES = 0.4, 8, 12, 6
"""Time between rows [s], observed rows, predicted rows, and futures of predictors that draw several."""
SHARE = 0.05
"""Largest share of a processor core for predictions; a slow predictor is asked less often."""


def density_field(position: Floats) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Return the density of people on a grid ``[H, W]`` in units of 1/40 per square metre, and x0, y0, cell [m].

    The density at a point is the sum of ``exp(-d^2 / R^2) / (pi R^2)`` over all people, with R = 1 m.

    Source: Helbing, Johansson & Al-Abideen 2007, doi:10.1103/PhysRevE.75.046109.

    >>> field, place = density_field(np.array([[0.0, 0.0]]))
    >>> float(field.max() * 0.025), place.tolist()
    (0.275, [-2.0, -2.0, 0.5])
    """
    if not len(position):
        return np.zeros((1, 1), dtype=np.uint8), np.array([0.0, 0.0, CELL], dtype=np.float32)
    low = np.floor((position.min(axis=0) - MARGIN) / CELL) * CELL
    count = np.minimum(np.ceil((position.max(axis=0) + MARGIN - low) / CELL).astype(np.int64), MOST_CELLS)
    x, y = (low[axis] + CELL * (np.arange(count[axis]) + 0.5) for axis in (0, 1))
    across = np.exp(-(((x - position[:, :1]) / SCALE) ** 2))
    along = np.exp(-(((y - position[:, 1:]) / SCALE) ** 2))
    field = along.T @ across / (np.pi * SCALE**2)
    units = np.minimum(np.round(field / DENSITY_UNIT), 255.0).astype(np.uint8)
    return units, np.array([*low, CELL], dtype=np.float32)


def collision_lines(scene: Scene) -> NDArray[np.float32]:
    """Return rows x, y, x, y [m] and time [s] of pairs that touch within 3 s if nobody changes the velocity, E = 1.

    >>> scene = Scene.of([[0.0, 0.0], [3.0, 0.0]], [[1.0, 0.0], [0.0, 0.0]], radius=0.5)
    >>> collision_lines(scene).tolist()
    [[0.0, 0.0, 3.0, 0.0, 2.0]]
    """
    here = np.flatnonzero(scene.active[0])
    place, velocity, radius = scene.position[0, here], scene.velocity[0, here], scene.radius[0, here]
    first, second = np.triu_indices(len(here), 1)
    near = np.abs(place[second] - place[first]).max(axis=1, initial=0.0) < NEAR
    first, second = first[near], second[near]
    way, toward = place[second] - place[first], velocity[first] - velocity[second]
    closing = np.sum(way * toward, axis=1)
    square = np.sum(toward * toward, axis=1)
    gap = np.sum(way * way, axis=1) - (radius[first] + radius[second]) ** 2
    inside = closing**2 - square * gap
    meets = (closing > 0.0) & (inside > 0.0) & (gap > 0.0)
    after = gap[meets] / (closing[meets] + np.sqrt(inside[meets]))
    soon = after < SOON
    a, b = first[meets][soon], second[meets][soon]
    return np.concatenate([place[a], place[b], after[soon, None]], axis=1).astype(np.float32)


class PredictedPaths:
    """Predicted paths of the people of a scene that moves on.

    Args:
        predictor: any predictor.
        walls: rings ``[N, 2]`` [m].

    >>> from crowdbot.prediction import ConstantVelocity
    >>> paths = PredictedPaths(ConstantVelocity())
    >>> before = Scene.of([[0.0, 0.0]], [[1.0, 0.0]])
    >>> _ = paths.update(0.0, before, np.array([7]), lambda seconds: None)
    >>> after = Scene.of([[0.4, 0.0]], [[1.0, 0.0]])
    >>> paths.update(0.4, after, np.array([7]), lambda seconds: None).shape
    (1, 26)
    """

    def __init__(self, predictor: Predictor, walls: tuple[Floats, ...] = ()) -> None:
        self.predictor, self._walls = predictor, walls
        self._live = Live(predictor, ROW, OBSERVED, walls, coast=0.0)
        self._latest = np.nan
        self._due = 0.0
        self._rows: deque[tuple[NDArray[np.int64], Floats]] = deque(maxlen=OBSERVED)
        self._found: Floats = np.zeros((0, 1, STEPS, 2))
        self._who = np.zeros(0, dtype=np.int64)

    def exchange(self, predictor: Predictor) -> None:
        """Ask another predictor, with the rows observed so far."""
        self.predictor, self._live, self._due = predictor, Live(predictor, ROW, OBSERVED, self._walls, coast=0.0), 0.0
        for ids, position in self._rows:
            self._live.update(ids, position)
        self._predict()

    def update(
        self, seconds: float, scene: Scene, ids: NDArray[np.int64], before: Callable[[float], Scene | None]
    ) -> NDArray[np.float32]:
        """Return paths ``[P, 2 (S + 1)]`` x, y [m] in steps of 0.4 s from the current positions, several a person.

        Args:
            seconds: time [s].
            scene, ids: people and robots now.
            before: returns the scene at an earlier time with the same ids, or None; asked after a jump.
        """
        step = seconds - self._latest
        if not -1e-9 <= step <= 2.0 * ROW:
            self._restart(seconds, ids, before)
            step = ROW
        if step >= ROW - 1e-6:
            self._latest = seconds
            self._add(scene, ids)
            self._predict()
        here = np.flatnonzero(scene.active[0])
        _, rows, slots = np.intersect1d(self._who, ids[here], return_indices=True)
        found, now = self._found[:, rows], scene.position[0, here[slots]]
        start = np.broadcast_to(now[None, :, None], (*found.shape[:2], 1, 2))
        lines = np.concatenate([start, found], axis=2)
        return lines.reshape(-1, 2 * (found.shape[2] + 1)).astype(np.float32)

    def _restart(self, seconds: float, ids: NDArray[np.int64], before: Callable[[float], Scene | None]) -> None:
        self._live = Live(self.predictor, ROW, OBSERVED, self._walls, coast=0.0)
        self._rows.clear()
        for k in range(OBSERVED - 1, 0, -1):
            earlier = before(seconds - k * ROW)
            if earlier is not None:
                self._add(earlier, ids)

    def _add(self, scene: Scene, ids: NDArray[np.int64]) -> None:
        here = np.flatnonzero(scene.active[0])
        self._rows.append((ids[here].copy(), scene.position[0, here].copy()))
        self._live.update(*self._rows[-1])

    def _predict(self) -> None:
        begin = time.monotonic()
        if begin < self._due or not len(self._live.ids):
            return
        forecast = self._live.predict(STEPS, SAMPLES)
        known = np.flatnonzero(forecast.valid[0])
        self._found = forecast.position[0].transpose(0, 2, 1, 3)[:, known]
        self._who = self._live.ids[known]
        self._due = begin + (time.monotonic() - begin) / SHARE
