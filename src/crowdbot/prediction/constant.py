"""Baselines: constant velocity, least squares, constant acceleration, sampled constant velocity."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper
from crowdbot.data import Forecast, Windows, observed_velocity

from .predictor import Predictor, window_streams

SCHOLLER = Paper(
    "Schöller, Aravantinos, Lay, Knoll",
    2020,
    "What the constant velocity model can teach us about pedestrian motion prediction",
    "IEEE Robotics and Automation Letters",
    "10.1109/LRA.2020.2969925",
)


@dataclass(frozen=True)
class ConstantVelocity(Predictor):
    """Constant velocity: the mean of the last displacements.

    One displacement is the strongest simple baseline on smooth tracks; more of them reduce noise. Values above the
    number of observed rows use the whole track. Missing rows are interpolated linearly. The velocity of people who are
    observed at the last row only is zero. Deterministic: K = 1.

    Fields:
        displacements: number of displacements in the mean, at least 1.

    Paper: Schöller et al. (2020), doi 10.1109/LRA.2020.2969925.

    >>> import numpy as np
    >>> here = np.ones((1, 3, 1), dtype=bool)
    >>> past = Windows(np.array([[[[0.0, 0.0]], [[1.0, 0.0]], [[3.0, 0.0]]]]), here, ~here[:, 0], ~here[:, 0],
    ...     np.array([[7]]), np.array([[0, 10, 20]]), 0.4, "all", "street")
    >>> ConstantVelocity().predict(past, 2).position[0, 0, :, 0, 0].tolist()
    [5.0, 7.0]
    >>> ConstantVelocity(displacements=2).predict(past, 2).position[0, 0, :, 0, 0].tolist()
    [4.5, 6.0]
    """

    displacements: int = 1

    paper: ClassVar[Paper] = SCHOLLER
    batched = True

    def __post_init__(self) -> None:
        if self.displacements < 1:
            raise InputError(f"constant velocity: displacements = {self.displacements} must be at least 1")

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        self.check(past, steps, samples)
        velocity = observed_velocity(past, self.displacements)
        time = past.dt * np.arange(1, steps + 1)
        place = past.position[:, -1, None] + velocity[:, None] * time[:, None, None]
        return self.forecast(past, place[:, None])


@dataclass(frozen=True)
class LeastSquares(Predictor):
    """Linear regression over all observed rows of each person.

    The velocity of people who are observed at one row only is zero. Deterministic: K = 1.

    Fields:
        anchored: False: start at the fitted line, as in the literature; True: start at the last observed position.

    >>> import numpy as np
    >>> here = np.ones((1, 3, 1), dtype=bool)
    >>> past = Windows(np.array([[[[0.0, 0.0]], [[1.0, 0.0]], [[5.0, 0.0]]]]), here, ~here[:, 0], ~here[:, 0],
    ...     np.array([[7]]), np.array([[0, 10, 20]]), 0.4, "all", "street")
    >>> LeastSquares().predict(past, 2).position[0, 0, :, 0, 0].tolist()
    [7.0, 9.5]
    >>> LeastSquares(anchored=True).predict(past, 2).position[0, 0, :, 0, 0].tolist()
    [7.5, 10.0]
    """

    batched = True

    anchored: bool = False

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        self.check(past, steps, samples)
        now = past.position[:, -1, None]
        there = past.present[..., None]
        row = np.arange(1 - past.present.shape[1], 1.0)[:, None, None]
        count = np.maximum(there.sum(axis=1, keepdims=True), 1)
        middle = np.sum(there * row, axis=1, keepdims=True) / count
        away = np.where(there, past.position - now, 0.0)  # relative to the last position, for precision
        late = np.where(there, row - middle, 0.0)
        spread = np.sum(late * late, axis=1, keepdims=True)
        velocity = np.sum(late * away, axis=1, keepdims=True) / np.where(spread > 0.0, spread, 1.0)
        start = 0.0 if self.anchored else away.sum(axis=1, keepdims=True) / count - middle * velocity
        step = np.arange(1.0, steps + 1.0)[:, None, None]
        return self.forecast(past, (now + start + velocity * step)[:, None])


@dataclass(frozen=True)
class ConstantAcceleration(Predictor):
    """Constant acceleration, from the last three observed rows of each person.

    Two observed rows give constant velocity, one row a constant position. Deterministic: K = 1. Inaccurate on tracks
    with a time step of 0.4 s; included for comparison.
    """

    batched = True

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        self.check(past, steps, samples)
        velocity, acceleration = _last_motion(past)
        count = np.arange(1.0, steps + 1.0)[:, None, None]
        moved = velocity[:, None] * count + acceleration[:, None] * (count * (count + 1.0) / 2.0)
        return self.forecast(past, (past.position[:, -1, None] + moved)[:, None])


@dataclass(frozen=True)
class SampledConstantVelocity(Predictor):
    """Constant velocity with a random heading and speed for each person and sample.

    The heading is rotated by a normally distributed angle; the speed is multiplied by a normally distributed factor
    with mean 1, clipped at 0. A baseline for generative predictors that requires no training.

    Fields:
        heading_sd: standard deviation of the angle [rad]; 25 degrees as in the paper.
        speed_sd: standard deviation of the factor [1].
        displacements: number of displacements in the mean velocity.

    Paper: Schöller et al. (2020), doi 10.1109/LRA.2020.2969925 (heading); the factor is common practice.
    """

    heading_sd: float = math.radians(25.0)
    speed_sd: float = 0.3
    displacements: int = 1

    paper: ClassVar[Paper] = SCHOLLER
    batched = draws = True

    def __post_init__(self) -> None:
        for name in ("heading_sd", "speed_sd"):
            value = getattr(self, name)
            if not 0.0 <= value < math.inf:
                raise InputError(f"sampled constant velocity: {name} = {value} must be finite and at least 0")
        if self.displacements < 1:
            raise InputError(f"sampled constant velocity: displacements = {self.displacements} must be at least 1")

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        self.check(past, steps, samples)
        W, _, A, _ = past.position.shape
        here = past.present[:, -1]
        drawn = np.zeros((W, samples, A, 2))
        for window, own in enumerate(window_streams(rng, W)):
            # draws are independent of the padding and of the number of samples
            drawn[window][:, here[window]] = own.standard_normal((samples, int(here[window].sum()), 2))
        turn = self.heading_sd * drawn[..., 0]
        factor = np.maximum(0.0, 1.0 + self.speed_sd * drawn[..., 1])
        velocity = _rotate(observed_velocity(past, self.displacements)[:, None], turn) * factor[..., None]
        time = past.dt * np.arange(1, steps + 1)
        place = past.position[:, -1, None, None] + velocity[:, :, None] * time[:, None, None]
        return self.forecast(past, place)


def _rotate(vector: NDArray[np.float64], angle: NDArray[np.float64]) -> NDArray[np.float64]:
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def _last_motion(past: Windows) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the last displacement and its last change [m], both ``[W, A, 2]`` per row."""
    now = past.position.shape[1] - 1
    seen = past.present[:, now].astype(np.int64)
    place = np.zeros((3, *past.position[:, now].shape))
    row_of = np.zeros((3, *seen.shape))
    place[0], row_of[0] = past.position[:, now], now
    for row in range(now - 1, -1, -1):
        here = past.present[:, row] & (seen > 0)
        for order in (1, 2):
            take = here & (seen == order)
            place[order] = np.where(take[..., None], past.position[:, row], place[order])
            row_of[order] = np.where(take, row, row_of[order])
        seen = np.where(here, seen + 1, seen)
    later = (place[0] - place[1]) / np.maximum(row_of[0] - row_of[1], 1.0)[..., None]
    earlier = (place[1] - place[2]) / np.maximum(row_of[1] - row_of[2], 1.0)[..., None]
    change = (later - earlier) / np.maximum((row_of[0] - row_of[2]) / 2.0, 1.0)[..., None]
    return np.where((seen >= 2)[..., None], later, 0.0), np.where((seen >= 3)[..., None], change, 0.0)
