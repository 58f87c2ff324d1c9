"""Forecast: predicted positions as weighted samples."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

__all__ = ["Forecast"]


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

    def __post_init__(self) -> None:
        if self.position.ndim != 5 or self.position.shape[4] != 2:
            raise InputError(
                f"forecast of {self.predictor}: position has shape {list(self.position.shape)}, not [W, K, T, A, 2]"
            )
        W, K, _, A, _ = self.position.shape
        for name, fits in (("weight", (W, K)), ("valid", (W, A))):
            if getattr(self, name).shape != fits:
                shape = list(getattr(self, name).shape)
                raise InputError(f"forecast of {self.predictor}: {name} has shape {shape}, it must be {list(fits)}")
        wrong = ~np.isfinite(self.position).all(axis=(1, 2, 4)) & self.valid
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

    def __getitem__(self, chosen: slice | NDArray[np.int64] | NDArray[np.bool_]) -> Forecast:
        """Return the forecast of some of the windows."""
        arrays = {name: getattr(self, name)[chosen] for name in ("position", "weight", "valid")}
        return dataclasses.replace(self, **arrays)
