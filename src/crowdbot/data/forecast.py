"""Forecast: predicted positions as weighted samples."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Disc, InputError, Path2D, draw_svg

ARRAYS = (
    "position",
    "weight",
    "valid",
    "covariance",
    "existence",
    "out_of_distribution",
    "person_weight",
    "future_covariance",
)
"""Fields with one entry per window."""


class GaussianMixture(NamedTuple):
    """Gaussian mixtures of positions of people, K components.

    Fields:
        weight: ``[W, K, A]``, sums to 1 over K for predicted people.
        mean: ``[W, K, T, A, 2]`` [m].
        covariance: ``[W, K, T, A, 2, 2]`` [m^2].
    """

    weight: NDArray[np.float64]
    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]


@dataclass(frozen=True)
class Forecast:
    """Predicted positions of the people of W windows.

    Fields:
        position: ``[W, K, T, A, 2]`` [m]: windows, samples, future steps 1..T, people in the order of the past; 0
            for people without a prediction.
        weight: ``[W, K]``, each row sums to 1.
        valid: ``[W, A]`` bool: people that were predicted (present at the last observed step).
        dt: time step [s].
        predictor: name of the predictor.
        covariance: ``[W, T, A, 2, 2]`` [m^2] of the positions around the forecast with K = 1, if the predictor has one.
            It contains the noise of a tracker as far as the past has covariances of its positions.
        existence: ``[W, A]`` probability that a person is still there, for people hidden at the last row; None means 1.
        out_of_distribution: ``[W, A]`` between 0 and 1: how unlike the training data a person is. A learned predictor
            gives this share of its answer to a baseline.
        person_weight: ``[W, K, A]`` probability of a person's own future in each joint future, if the predictor has it;
            sums to 1 over K for predicted people. ``weight`` is that of the joint future.
        future_covariance: ``[W, K, T, A, 2, 2]`` [m^2] of the true position around each future, if the predictor has
            it: with ``person_weight``, a Gaussian mixture for each person and step, see :meth:`mixture`.

    Raises:
        InputError: the shapes do not fit, or a position of a predicted person is not finite.

    >>> import numpy as np
    >>> forecast = Forecast.of(np.zeros((3, 20, 12, 5, 2)), np.ones((3, 5), dtype=bool), 0.4, "mine")
    >>> forecast.samples, forecast.steps, len(forecast[:2]), float(forecast.weight[0, 0])
    (20, 12, 2, 0.05)
    """

    position: NDArray[np.float64]
    weight: NDArray[np.float64]
    valid: NDArray[np.bool_]
    dt: float
    predictor: str
    covariance: NDArray[np.float64] | None = None
    existence: NDArray[np.float64] | None = None
    out_of_distribution: NDArray[np.float64] | None = None
    person_weight: NDArray[np.float64] | None = None
    future_covariance: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        if self.position.ndim != 5 or self.position.shape[4] != 2:
            raise InputError(
                f"forecast of {self.predictor}: position has shape {list(self.position.shape)}, not [W, K, T, A, 2]"
            )
        W, K, T, A, _ = self.position.shape
        shapes = {"weight": (W, K), "valid": (W, A), "covariance": (W, T, A, 2, 2), "existence": (W, A)}
        shapes["future_covariance"] = (W, K, T, A, 2, 2)
        for name, fits in (shapes | {"out_of_distribution": (W, A), "person_weight": (W, K, A)}).items():
            value = getattr(self, name)
            if value is not None and value.shape != fits:
                shape = list(getattr(self, name).shape)
                raise InputError(f"forecast of {self.predictor}: {name} has shape {shape}, it must be {list(fits)}")
        finite = np.isfinite(self.position)
        if finite.all():  # much faster than along axes
            return
        wrong = ~finite.all(axis=(1, 2, 4)) & self.valid
        if np.any(wrong):
            window, person = np.argwhere(wrong)[0]
            raise InputError(
                f"forecast of {self.predictor}: person {person} of window {window} has a position that is not finite"
            )

    @classmethod
    def of(cls, position: NDArray[np.float64], valid: NDArray[np.bool_], dt: float, predictor: str) -> Forecast:
        """Make a forecast of equally likely samples ``[W, K, T, A, 2]`` [m]; people not ``valid`` are set to 0."""
        W, K = position.shape[:2]
        kept = np.where(valid[:, None, None, :, None], position, 0.0)
        return cls(kept, np.full((W, K), 1.0 / K), valid, dt, predictor)

    @classmethod
    def concatenate(cls, parts: Sequence[Forecast]) -> Forecast:
        """Return the windows of several forecasts of one predictor, in order."""
        known = [name for name in ARRAYS if getattr(parts[0], name) is not None]
        joined: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in known}
        return dataclasses.replace(parts[0], **joined)

    def mixture(self) -> GaussianMixture:
        """Return the Gaussian mixture of the true position of each person at each step.

        Its components are the futures, with ``future_covariance``; or the forecast with K = 1, with ``covariance``.

        Raises:
            InputError: the forecast has neither.
        """
        if self.future_covariance is not None:
            equal = np.repeat(self.weight[:, :, None], self.valid.shape[1], axis=2)
            own = equal if self.person_weight is None else self.person_weight
            return GaussianMixture(own, self.position, self.future_covariance)
        if self.covariance is None or self.samples != 1:
            what = "no covariance" if self.covariance is None else f"{self.samples} samples without covariances"
            raise InputError(f"mixture: the forecast of {self.predictor} has {what}")
        return GaussianMixture(np.ones((len(self), 1, self.valid.shape[1])), self.position, self.covariance[:, None])

    @property
    def samples(self) -> int:
        """Number K of samples."""
        return int(self.position.shape[1])

    @property
    def steps(self) -> int:
        """Number T of future steps."""
        return int(self.position.shape[2])

    def __len__(self) -> int:
        """Return the number of windows."""
        return len(self.position)

    def _repr_svg_(self) -> str:
        """Return a drawing for notebooks: the predicted paths of the middle window."""
        if not len(self):
            return draw_svg([], caption=f"{self.predictor}: no windows")
        window = len(self) // 2
        people = np.flatnonzero(self.valid[window])
        paths = self.position[window][:, :, people]
        opacity = np.clip(self.weight[window] / self.weight[window].max(), 0.15, 1.0) if self.samples > 1 else [1.0]
        lines = [
            Path2D(paths[k, :, a], opacity=float(opacity[k])) for a in range(len(people)) for k in range(self.samples)
        ]
        starts = [Disc(float(paths[0, 0, a, 0]), float(paths[0, 0, a, 1]), 0.15) for a in range(len(people))]
        about = f"window {window + 1} of {len(self)}, {len(people)} people, {self.samples} x {self.steps} steps"
        return draw_svg(lines, starts, f"{self.predictor}: {about} of {self.dt:.4g} s")

    def __getitem__(self, chosen: slice | NDArray[np.int64] | NDArray[np.bool_]) -> Forecast:
        """Return the forecast of some of the windows."""
        arrays = {name: getattr(self, name)[chosen] for name in ARRAYS if getattr(self, name) is not None}
        return dataclasses.replace(self, **arrays)
