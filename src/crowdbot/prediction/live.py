"""Live: people as a tracker sees them, row by row, and where they will be."""

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
    """Predicts a live stream of tracked people: one row after the other, at an even time step.

    People may appear, vanish, be missed for some rows and come back: everyone who is in the last row is predicted from
    the rows there are. A calibrated crowd begins with what it found at the row before.

    Args:
        predictor: any predictor whose goal does not look at the future.
        dt: time between rows [s].
        observe: how many rows are kept.
        walls: rings ``[N, 2]`` [m] of what cannot be walked on.
        seed: of predictors that draw or search.

    Raises:
        InputError: ``dt`` is not above 0, fewer than one row is kept, or the predictor needs the future.

    >>> from crowdbot.prediction import ConstantVelocity
    >>> live = Live(ConstantVelocity(), dt=0.4)
    >>> live.see([7], [[0.0, 0.0]])
    >>> live.see([7, 9], [[0.4, 0.0], [3.0, 1.0]])
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
            raise InputError(f"live: {predictor!r} is no predictor; give an object, such as crowdbot.AnchorNet()")
        goal = getattr(predictor, "goal", None)
        if getattr(goal, "knows_future", False):
            raise InputError(
                f"live: {type(goal).__name__} looks at what people will do, which nobody knows while predicting live;"
                " take current-direction"
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
        """Identity of everyone in the last row, robots too, in the order of forecasts."""
        return self._rows[-1][0] if self._rows else np.zeros(0, dtype=np.int64)

    def see(self, ids: ArrayLike, position: ArrayLike, robots: Iterable[int] = ()) -> None:
        """Add a row: who is seen ``[N]`` and where ``[N, 2]`` [m]; ``robots`` names those who are robots.

        Raises:
            InputError: shapes do not fit, a position is not finite, an identity stands twice or is below 0.
        """
        who = np.asarray(ids, dtype=np.int64).reshape(-1)
        place = np.asarray(position, dtype=float).reshape(-1, 2)
        if len(who) != len(place):
            raise InputError(f"live: {len(who)} identities and {len(place)} positions; each needs the other")
        if not np.all(np.isfinite(place)):
            raise InputError(f"live: the position of {who[~np.isfinite(place).all(axis=1)][0]} is not finite")
        if len(np.unique(who)) != len(who) or np.any(who < 0):
            raise InputError(f"live: identities {who.tolist()} must be different and not below 0")
        order = np.argsort(who)
        self._rows = [*self._rows[1 - self.observe :], (who[order], place[order], frozenset(robots))][-self.observe :]
        self._count += 1

    def past(self, plans: Mapping[int, ArrayLike] | None = None) -> Windows:
        """Return the rows that are kept, as one window of everyone in the last row."""
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
        """Return where everyone in the last row will be, in the order of :attr:`ids`.

        Args:
            steps: rows ahead.
            samples: futures, of predictors that have several.
            plans: known next positions of robots, identity -> ``[S, 2]`` [m]: what if the robot goes there? What is
                asked with a plan is not remembered for the next row.

        Raises:
            InputError: nothing was seen yet, or a plan is for nobody in the last row.
        """
        if not self._rows:
            raise InputError("live: nothing was seen yet; call see first")
        rng = stream(self._seed, "live", self._count)
        forecast, memory = self.predictor.follow(self.past(plans), steps, samples, rng, self._memory)
        if not plans:
            self._memory = memory
        return forecast
