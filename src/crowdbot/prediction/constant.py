"""Predictors that keep a motion constant: velocity, fitted line, acceleration, and a velocity with a random turn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper
from crowdbot.data import Forecast, Windows, observed_velocity

from .predictor import Predictor, window_streams

__all__ = ["ConstantAcceleration", "ConstantVelocity", "LeastSquares", "SampledConstantVelocity"]

SCHOLLER = Paper(
    "Schöller, Aravantinos, Lay, Knoll",
    2020,
    "What the constant velocity model can teach us about pedestrian motion prediction",
    "IEEE Robotics and Automation Letters",
    "10.1109/LRA.2020.2969925",
)


@dataclass(frozen=True)
class ConstantVelocity(Predictor):
    """Everyone goes on with the mean velocity of their last ``displacements`` steps.

    One displacement is the strongest simple baseline on smooth tracks; more of them help on noisy ones, and as many as
    there are, or more, mean the whole observed track. Holes are bridged by an even walk, tracks that begin late count
    from their begin, and somebody seen at the last row only is expected to stand. Deterministic: K = 1.

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

    def __post_init__(self) -> None:
        if self.displacements < 1:
            raise InputError(f"constant velocity: displacements = {self.displacements} must be at least 1")

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where people will be, see :meth:`Predictor.predict`."""
        self.check(past, steps, samples)
        velocity = observed_velocity(past, self.displacements)
        time = past.dt * np.arange(1, steps + 1)
        place = past.position[:, -1, None] + velocity[:, None] * time[:, None, None]
        return self.forecast(past, place[:, None])


@dataclass(frozen=True)
class LeastSquares(Predictor):
    """Everyone goes on along the straight, even walk that fits all rows at which they were seen with least squares.

    Only rows that were seen are fitted; with two of them it is the line through both, and somebody seen at one row is
    expected to stand. Deterministic: K = 1.

    Fields:
        anchored: False: the walk goes on from where the fitted line is now, as the linear regression of the literature;
            True: from where the person was last seen, with the velocity of the line.

    >>> import numpy as np
    >>> here = np.ones((1, 3, 1), dtype=bool)
    >>> past = Windows(np.array([[[[0.0, 0.0]], [[1.0, 0.0]], [[5.0, 0.0]]]]), here, ~here[:, 0], ~here[:, 0],
    ...     np.array([[7]]), np.array([[0, 10, 20]]), 0.4, "all", "street")
    >>> LeastSquares().predict(past, 2).position[0, 0, :, 0, 0].tolist()
    [7.0, 9.5]
    >>> LeastSquares(anchored=True).predict(past, 2).position[0, 0, :, 0, 0].tolist()
    [7.5, 10.0]
    """

    anchored: bool = False

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where people will be, see :meth:`Predictor.predict`."""
        self.check(past, steps, samples)
        now = past.position[:, -1, None]
        there = past.present[..., None]
        row = np.arange(1 - past.present.shape[1], 1.0)[:, None, None]
        count = np.maximum(there.sum(axis=1, keepdims=True), 1)
        middle = np.sum(there * row, axis=1, keepdims=True) / count
        away = np.where(there, past.position - now, 0.0)  # from now: far from the origin nothing is lost
        late = np.where(there, row - middle, 0.0)
        spread = np.sum(late * late, axis=1, keepdims=True)
        velocity = np.sum(late * away, axis=1, keepdims=True) / np.where(spread > 0.0, spread, 1.0)
        start = 0.0 if self.anchored else away.sum(axis=1, keepdims=True) / count - middle * velocity
        step = np.arange(1.0, steps + 1.0)[:, None, None]
        return self.forecast(past, (now + start + velocity * step)[:, None])


@dataclass(frozen=True)
class ConstantAcceleration(Predictor):
    """Everyone goes on with the last change of their velocity, step by step.

    The last three rows at which a person was seen give two displacements and their difference; with two rows the
    velocity is kept, with one the place. Deterministic: K = 1. On tracks at 0.4 s it is a bad predictor, kept because
    it is asked for.
    """

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where people will be, see :meth:`Predictor.predict`."""
        self.check(past, steps, samples)
        velocity, acceleration = _last_motion(past)
        count = np.arange(1.0, steps + 1.0)[:, None, None]
        moved = velocity[:, None] * count + acceleration[:, None] * (count * (count + 1.0) / 2.0)
        return self.forecast(past, (past.position[:, -1, None] + moved)[:, None])


@dataclass(frozen=True)
class SampledConstantVelocity(Predictor):
    """Futures of constant velocity whose heading and speed are drawn once for each person and sample.

    The heading turns by a normal angle, the speed is multiplied by a normal factor around 1 (not below 0). No
    training at all: the floor that every generative predictor has to beat.

    Fields:
        heading_sd: standard deviation of the turn [rad], 25 degrees as in the paper.
        speed_sd: standard deviation of the factor [1].
        displacements: last displacements that are averaged.

    Paper: Schöller et al. (2020), doi 10.1109/LRA.2020.2969925 (heading); the factor is common practice.
    """

    heading_sd: float = math.radians(25.0)
    speed_sd: float = 0.3
    displacements: int = 1

    paper: ClassVar[Paper] = SCHOLLER

    def __post_init__(self) -> None:
        for name in ("heading_sd", "speed_sd"):
            value = getattr(self, name)
            if not 0.0 <= value < math.inf:
                raise InputError(f"sampled constant velocity: {name} = {value} must be finite and at least 0")
        if self.displacements < 1:
            raise InputError(f"sampled constant velocity: displacements = {self.displacements} must be at least 1")

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where people will be, see :meth:`Predictor.predict`."""
        self.check(past, steps, samples)
        W, _, A, _ = past.position.shape
        here = past.present[:, -1]
        drawn = np.zeros((W, samples, A, 2))
        for window, own in enumerate(window_streams(rng, W)):
            # neither padding nor a larger number of samples changes what is drawn first
            drawn[window][:, here[window]] = own.standard_normal((samples, int(here[window].sum()), 2))
        turn = self.heading_sd * drawn[..., 0]
        factor = np.maximum(0.0, 1.0 + self.speed_sd * drawn[..., 1])
        velocity = _turned(observed_velocity(past, self.displacements)[:, None], turn) * factor[..., None]
        time = past.dt * np.arange(1, steps + 1)
        place = past.position[:, -1, None, None] + velocity[:, :, None] * time[:, None, None]
        return self.forecast(past, place)


def _turned(vector: NDArray[np.float64], angle: NDArray[np.float64]) -> NDArray[np.float64]:
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def _last_motion(past: Windows) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the last displacement [m] and its last change [m], both ``[W, A, 2]`` and per row."""
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
