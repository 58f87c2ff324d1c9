"""Costs of calibration, and the check of user-defined ones."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import reduce
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, kernel, prange, stream
from crowdbot.data import Windows, example_windows
from crowdbot.typing import Bools, Floats

from .rollout import ResimulatedTracks

METRICS = Paper(
    "Wolinski, Guy, Olivier, Lin, Manocha, Pettré",
    2014,
    "Parameter estimation and comparative evaluation of crowd simulations",
    "Computer Graphics Forum",
    "10.1111/cgf.12328",
)
"""Source of the three costs of the literature."""


@dataclass(frozen=True)
class Cost(ABC):
    """Dissimilarity between recorded and simulated tracks, for each person [m]."""

    paper: ClassVar[Paper] = METRICS

    @abstractmethod
    def measure(self, tracks: ResimulatedTracks) -> Floats:
        """Return the cost ``[P, W, A]`` [m] of every candidate and person; NaN for people that do not count.

        The people who count depend on the recording only, not on the candidate. Robots never count.
        """


def mean_over_rows(distance: Floats, counted: NDArray[np.bool_]) -> Floats:
    """Return the mean over the counted rows ``[P, W, A]`` of ``distance [P, W, T, A]``; NaN where no row counts."""
    count = counted.sum(axis=1)
    total = np.where(counted, distance, 0.0).sum(axis=2)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


@dataclass(frozen=True)
class Absolute(Cost):
    """Mean distance [m] between simulated and recorded positions, simulated from the first row over all rows.

    People count if they are observed at the first row and at another row.

    Source: Wolinski et al. (2014), doi 10.1111/cgf.12328.
    """

    def measure(self, tracks: ResimulatedTracks) -> NDArray[np.float64]:
        past = tracks.past
        away = tracks.once - past.position[:, 1:]
        counted = past.present[:, 1:] & (past.present[:, 0] & ~past.robot)[:, None]
        return mean_over_rows(np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2), counted)


@dataclass(frozen=True)
class Progressive(Cost):
    """Mean distance [m] between simulated and recorded positions one row ahead of every observed row.

    A simulation of one row starts at each row from the second on, where the velocity is known from the previous row.
    People count if they are observed at such a row and at the next one, so at least three rows are needed.

    Source: Wolinski et al. (2014), doi 10.1111/cgf.12328.
    """

    def measure(self, tracks: ResimulatedTracks) -> NDArray[np.float64]:
        past = tracks.past
        away = tracks.stepwise - past.position[:, 2:]
        counted = past.present[:, 2:] & past.present[:, 1:-1] & ~past.robot[:, None]
        return mean_over_rows(np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2), counted)


@kernel(parallel=True)
def _differ(simulated: Floats, recorded: Floats, counted: Bools, total: Floats) -> None:
    """Sum the differences between simulated and recorded distances of each person to all others, over all rows."""
    P, W, T, A = simulated.shape[:4]
    for pw in prange(P * W):
        p, w = pw // W, pw % W
        for t in range(T):
            for a in range(A):
                if not counted[w, t, a]:
                    continue
                for b in range(a):
                    if not counted[w, t, b]:
                        continue
                    dx = simulated[p, w, t, a, 0] - simulated[p, w, t, b, 0]
                    dy = simulated[p, w, t, a, 1] - simulated[p, w, t, b, 1]
                    ex = recorded[w, t, a, 0] - recorded[w, t, b, 0]
                    ey = recorded[w, t, a, 1] - recorded[w, t, b, 1]
                    gap = abs(np.sqrt(dx * dx + dy * dy) - np.sqrt(ex * ex + ey * ey))
                    total[p, w, a] += gap
                    total[p, w, b] += gap


@dataclass(frozen=True)
class InterPedestrian(Cost):
    """Mean difference [m] between simulated and recorded distances of each person to all others, over all rows.

    The simulation starts at the first row. A pair counts at the rows where both are observed, if both are present at
    the first row. People without a pair do not count.

    Source: Wolinski et al. (2014), doi 10.1111/cgf.12328.
    """

    def measure(self, tracks: ResimulatedTracks) -> Floats:
        past, simulated = tracks.past, np.ascontiguousarray(tracks.once)
        counted = past.present[:, 1:] & (past.present[:, 0] & ~past.robot)[:, None]
        others = np.where(counted, counted.sum(axis=2, keepdims=True) - 1, 0).sum(axis=1)
        total = np.zeros((*simulated.shape[:2], simulated.shape[3]))
        _differ(simulated, np.ascontiguousarray(past.position[:, 1:]), counted, total)
        return np.where(others > 0, total / np.maximum(others, 1), np.nan)


@dataclass(frozen=True)
class WeightedSum(Cost):
    """Weighted sum of several costs; people count if they count in all of them.

    Fields:
        parts: the costs.
        weights: one weight per cost, at least 0 and not all 0.

    Raises:
        InputError: there is no cost, or the weights do not fit.

    >>> from crowdbot.calibration import Absolute, InterPedestrian
    >>> WeightedSum((Absolute(), InterPedestrian()), (1.0, 0.5)).weights
    (1.0, 0.5)
    """

    parts: tuple[Cost, ...]
    weights: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.parts) == 0 or len(self.parts) != len(self.weights):
            raise InputError(
                f"weighted-sum: {len(self.parts)} costs and {len(self.weights)} weights; each cost needs one weight"
            )
        if not all(0.0 <= weight < math.inf for weight in self.weights) or sum(self.weights) == 0.0:
            raise InputError(f"weighted-sum: weights {self.weights} must be finite, at least 0 and not all 0")

    def measure(self, tracks: ResimulatedTracks) -> NDArray[np.float64]:
        return reduce(
            np.add,
            (weight * part.measure(tracks) for part, weight in zip(self.parts, self.weights, strict=True)),
        )


ERROR = (0.0, 0.1, 0.5)
"""Maximum deviation [m] of the candidates from the recording."""


def check_cost(cost: Cost) -> None:
    """Check a cost with three candidates; the first one reproduces the recording exactly.

    Raises:
        InputError: the cost violates a rule of the contract.

    >>> from crowdbot.calibration import Absolute
    >>> check_cost(Absolute())
    """
    name = type(cost).__name__
    if not isinstance(cost, Cost):
        raise InputError(f"{name} is not a Cost")
    parameters = getattr(cost, "__dataclass_params__", None)
    if parameters is None or not parameters.frozen:
        raise InputError(f"{name} is not frozen; decorate the class with @dataclass(frozen=True)")
    past = example_windows()
    value = np.asarray(cost.measure(_candidates(past)))
    wanted = [len(ERROR), *past.robot.shape]
    if list(value.shape) != wanted:
        raise InputError(f"{name}.measure returned shape {list(value.shape)}, it must be [P, W, A] = {wanted}")
    counted = ~np.isnan(value)
    if np.any(counted != counted[:1]):
        raise InputError(
            f"{name}.measure: the people who count must depend on the recording only, not on the candidate"
        )
    if np.any(counted[0] & past.robot):
        raise InputError(f"{name}.measure counts robots; their cost must be NaN")
    if not np.any(counted):
        raise InputError(f"{name}.measure counts nobody")
    if np.any(value[counted] < 0.0) or not np.all(np.isfinite(value[counted])):
        raise InputError(f"{name}.measure must be finite and at least 0 for people who count")
    if np.any(value[0][counted[0]] > np.max(value[1:], axis=0)[counted[0]]):
        raise InputError(f"{name}.measure: the candidate that reproduces the recording must not be the worst")
    for window in range(len(past)):
        alone = np.asarray(cost.measure(_candidates(past, window)))[:, 0]
        if not np.array_equal(alone, value[:, window], equal_nan=True):
            raise InputError(f"{name}.measure of window {window} differs when it is computed alone")


def _candidates(past: Windows, window: int | None = None) -> ResimulatedTracks:
    """Return tracks that deviate from the recording by :data:`ERROR`, of all windows or one."""
    noise = stream(0, "contract").uniform(-1.0, 1.0, past.position.shape)
    tracks = past.position + np.array(ERROR)[:, None, None, None, None] * noise
    if window is not None:
        past, tracks = past[window : window + 1], tracks[:, window : window + 1]

    def rows_from(first: int) -> NDArray[np.float64]:
        return tracks[:, :, first:]

    return ResimulatedTracks(past, lambda: rows_from(1), lambda: rows_from(2))
