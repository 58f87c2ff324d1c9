"""Windows: parts of a recording with the same number of rows, batched over windows and padded over people."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError


@dataclass(frozen=True)
class Windows:
    """W windows with T rows and A people (padded).

    Fields:
        position: ``[W, T, A, 2]`` [m]; 0 where a person is absent.
        present: ``[W, T, A]`` bool.
        scored: ``[W, A]`` bool, people who are scored; predictors must not use it.
        robot: ``[W, A]`` bool, tracks of robots: input of predictors, never scored.
        id: ``[W, A]`` int64, identity in the recording, -1 for padding.
        frame: ``[W, T]`` int64, frame counter of the recording.
        dt: time between rows [s].
        protocol: name of the protocol.
        source: name of the recording.
        walls: rings ``[N, 2]`` [m] around areas that are not walkable; empty if unknown.
        units: ``m``, or ``px`` for recordings in pixels: then every [m] above is pixels.
        plan: ``[W, S, A, 2]`` [m], planned positions of robots at the next S rows, NaN for everyone else; or None.
        radius: ``[W, A]`` [m] radii of people and robots, NaN where unknown; or None. Joint futures keep apart by them.
        covariance: ``[W, T, A, 2, 2]`` [m^2] of the measured positions, NaN where unknown; or None. Filters read it.

    >>> from crowdbot.data import Trajectories
    >>> rows = range(20)
    >>> tracks = Trajectories([7] * 20, rows, [0.5 * row for row in rows], [0.0] * 20, row_rate=2.5)
    >>> past, future = tracks.windows(observe=8, predict=12)
    >>> past.position.shape, future.position.shape, past.protocol
    ((1, 8, 1, 2), (1, 12, 1, 2), 'all')
    """

    position: NDArray[np.float64]
    present: NDArray[np.bool_]
    scored: NDArray[np.bool_]
    robot: NDArray[np.bool_]
    id: NDArray[np.int64]
    frame: NDArray[np.int64]
    dt: float
    protocol: str
    source: str
    walls: tuple[NDArray[np.float64], ...] = ()
    units: str = "m"
    plan: NDArray[np.float64] | None = None
    radius: NDArray[np.float64] | None = None
    covariance: NDArray[np.float64] | None = None

    def __len__(self) -> int:
        """Return the number of windows."""
        return len(self.position)

    def __getitem__(self, chosen: slice | NDArray[np.int64] | NDArray[np.bool_]) -> Windows:
        """Return some of the windows."""
        arrays = {n: getattr(self, n)[chosen] for n in ("position", "present", "scored", "robot", "id", "frame")}
        known = [name for name in ("plan", "radius", "covariance") if getattr(self, name) is not None]
        more = {name: getattr(self, name)[chosen] for name in known}
        return dataclasses.replace(self, **arrays, **more)

    def with_plans(self, plans: Mapping[int, ArrayLike]) -> Windows:
        """Return the windows with plans of robots: ``plans`` maps an id to its next positions ``[S, 2]`` [m].

        Predictors condition on the plan: the robot follows it and stops at its end, and crowd models react.

        Raises:
            InputError: the plans differ in length, are empty or not finite, or an identity is in no window.

        >>> here = np.ones((1, 2, 1), dtype=bool)
        >>> past = Windows(np.zeros((1, 2, 1, 2)), here, ~here[:, 0], here[:, 0], np.array([[7]]),
        ...     np.array([[0, 10]]), 0.4, "all", "street")
        >>> past.with_plans({7: [[0.0, 0.4], [0.0, 0.8]]}).plan[0, :, 0].tolist()
        [[0.0, 0.4], [0.0, 0.8]]
        """
        try:
            rows = {who: np.asarray(plan, dtype=float) for who, plan in plans.items()}
        except (TypeError, ValueError):
            raise InputError("the plan of a robot must be numbers [S, 2] [m], all rows of two") from None
        for who, plan in rows.items():
            if plan.ndim != 2 or plan.shape[1] != 2 or len(plan) == 0 or not np.all(np.isfinite(plan)):
                raise InputError(
                    f"the plan of robot {who} has shape {list(plan.shape)}; it must be finite positions [S, 2], S >= 1"
                )
            if not np.any(self.id == who):
                raise InputError(f"the plan is for robot {who}, who is in no window of {self.source}")
        lengths = {len(plan) for plan in rows.values()}
        if len(lengths) != 1:
            raise InputError(f"there must be a plan, and all must have as many rows; they have {sorted(lengths)}")
        W, _, A = self.present.shape
        known = np.full((W, lengths.pop(), A, 2), np.nan)
        for who, plan in rows.items():
            window, person = np.nonzero(self.id == who)
            known[window, :, person] = plan
        return dataclasses.replace(self, plan=known)

    def plan_at(self, step: int) -> NDArray[np.float64]:
        """Return planned positions ``step`` rows ahead (from 1), ``[W, A, 2]`` [m], NaN for everyone else."""
        if self.plan is None:
            return np.full((len(self), self.present.shape[2], 2), np.nan)
        return self.plan[:, min(step, self.plan.shape[1]) - 1]
