"""Live: forecasts of a stream of tracked people."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows

from .predictor import Predictor

__all__ = ["Live"]

Floats = NDArray[np.float64]
Row = tuple[NDArray[np.int64], Floats, frozenset[int]]


class Live:
    """Predicts a live stream of tracked people at a constant time step.

    People may appear, disappear, be missing for some rows and return. All people in the last row are predicted, from
    the rows in which they were observed. A calibrated crowd starts each search from the previous result.

    Args:
        predictor: any predictor whose goal does not require the future.
        dt: time between rows [s].
        observe: number of observed rows.
        walls: rings ``[N, 2]`` [m] of obstacles.
        seed: random seed.

    Raises:
        InputError: ``dt`` is not above 0, ``observe`` is below 1, or the predictor requires the future.

    >>> from crowdbot.prediction import ConstantVelocity
    >>> live = Live(ConstantVelocity(), dt=0.4)
    >>> live.update([7], [[0.0, 0.0]])
    >>> live.update([7, 9], [[0.4, 0.0], [3.0, 1.0]])
    >>> live.predict(2).position[0, 0, :, 0].round(1).tolist(), live.ids.tolist()
    ([[0.8, 0.0], [1.2, 0.0]], [7, 9])
    """

    def __init__(
        self, predictor: Predictor, dt: float, observe: int = 8, walls: Iterable[ArrayLike] = (), seed: int = 0
    ) -> None:
        if not 0.0 < dt < np.inf:
            raise InputError(f"live: dt = {dt} s must be finite and above 0")
        if observe < 1:
            raise InputError(f"live: observe = {observe} rows must be at least 1")
        if not isinstance(predictor, Predictor):
            raise InputError(f"live: {predictor!r} is not a predictor; pass an instance, such as crowdbot.AnchorNet()")
        goal = getattr(predictor, "goal", None)
        if getattr(goal, "knows_future", False):
            raise InputError(
                f"live: {type(goal).__name__} requires the future, which is unknown in live prediction; use"
                " current-direction"
            )
        self.predictor = predictor
        self.dt = dt
        self.observe = observe
        self.walls = tuple(np.asarray(ring, dtype=float) for ring in walls)
        self._seed = seed
        self._rows: list[Row] = []
        self._count = 0
        self._memory: Any = None

    @property
    def ids(self) -> NDArray[np.int64]:
        """Identities of all agents in the last row, in the order of forecasts, including robots."""
        return self._rows[-1][0] if self._rows else np.zeros(0, dtype=np.int64)

    def update(self, ids: ArrayLike, position: ArrayLike, robots: Iterable[int] = ()) -> None:
        """Add a row: identities ``[N]`` and positions ``[N, 2]`` [m]; ``robots`` lists the identities of robots.

        Raises:
            InputError: shapes do not match, a position is not finite, or an identity is duplicate or negative.
        """
        who = np.asarray(ids, dtype=np.int64).reshape(-1)
        place = np.asarray(position, dtype=float).reshape(-1, 2)
        if len(who) != len(place):
            raise InputError(f"live: {len(who)} identities and {len(place)} positions; the numbers must be equal")
        if not np.all(np.isfinite(place)):
            raise InputError(f"live: the position of {who[~np.isfinite(place).all(axis=1)][0]} is not finite")
        if len(np.unique(who)) != len(who) or np.any(who < 0):
            raise InputError(f"live: identities {who.tolist()} must be distinct and at least 0")
        order = np.argsort(who)
        self._rows = [*self._rows[1 - self.observe :], (who[order], place[order], frozenset(robots))][-self.observe :]
        self._count += 1

    def past(self, plans: Mapping[int, ArrayLike] | None = None) -> Windows:
        """Return the stored rows as one window of all agents in the last row."""
        who = self.ids
        T, A = len(self._rows), len(who)
        position, present = np.zeros((1, T, A, 2)), np.zeros((1, T, A), dtype=np.bool_)
        robots: frozenset[int] = frozenset()
        for row, (ids, place, machines) in enumerate(self._rows):
            robots |= machines
            _, here, there = np.intersect1d(who, ids, assume_unique=True, return_indices=True)
            position[0, row, here], present[0, row, here] = place[there], True
        nobody = np.zeros((1, A), dtype=np.bool_)
        frame = self._count - T + np.arange(T)
        past = Windows(
            position, present, nobody, np.isin(who, sorted(robots))[None], who[None], frame[None], self.dt, "live",
            "live stream", self.walls,
        )  # fmt: skip
        return past.with_plans(plans) if plans else past

    def predict(self, steps: int, samples: int = 1, plans: Mapping[int, ArrayLike] | None = None) -> Forecast:
        """Return the forecast of all agents in the last row, in the order of :attr:`ids`.

        Args:
            steps: number of predicted rows.
            samples: number of futures.
            plans: planned positions of robots, identity -> ``[S, 2]`` [m]. A query with a plan does not change the
                memory of the predictor.

        Raises:
            InputError: no row yet, or a plan for an identity that is not in the last row.
        """
        if not self._rows:
            raise InputError("live: no row yet; call update first")
        rng = stream(self._seed, "live", self._count)
        forecast, memory = self.predictor.follow(self.past(plans), steps, samples, rng, self._memory)
        if not plans:
            self._memory = memory
        return forecast
