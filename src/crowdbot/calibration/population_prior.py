"""PopulationPrior: joint distribution of the parameters of people, estimated from fits."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .parameter_space import PREFERRED_SPEED, ParameterSpace

if TYPE_CHECKING:
    from .fit import Fit


EDGE = 0.01
"""Minimum distance of a value from its bounds, relative to the range, before the transformation."""
SHRINKAGE = 0.1
"""Shrinkage of the covariance towards its diagonal, which makes it invertible."""


@dataclass(frozen=True, eq=False)
class PopulationPrior:
    """A joint normal distribution over people of the (transformed) parameters of a model.

    Parameters are transformed by the logit of their position between the bounds; the preferred speed is represented by
    its difference [m/s] from the observed speed. A few seconds of one track hardly determine the parameters of a
    person, and parameters are correlated (for example time horizon and radius). The distribution over many people
    describes which combinations are likely.

    Fields:
        names: names of the D parameters.
        mean, covariance: ``[D]`` and ``[D, D]`` of the transformed parameters.
        strength: twice the penalty [m] of a deviation by one standard deviation.

    >>> from crowdbot.models import ORCA
    >>> prior = PopulationPrior(("radius",), np.zeros(1), np.eye(1))
    >>> values = np.array([[[0.25]], [[0.39]]])
    >>> prior.penalty(ParameterSpace(ORCA(), ("radius",)), values, values).round(4).tolist()
    [[0.0], [0.5669]]
    """

    names: tuple[str, ...] = field(repr=False)
    mean: Floats = field(repr=False)
    covariance: Floats = field(repr=False)
    strength: float = 0.1

    def __post_init__(self) -> None:
        D = len(self.names)
        if np.shape(self.mean) != (D,) or np.shape(self.covariance) != (D, D):
            raise InputError(
                f"population prior: mean {list(np.shape(self.mean))} and covariance {list(np.shape(self.covariance))}"
                f" must be [{D}] and [{D}, {D}], one for each of {', '.join(self.names)}"
            )
        if not (np.all(np.isfinite(self.mean)) and np.all(np.linalg.eigvalsh(self.covariance) > 0.0)):
            raise InputError("population prior: mean must be finite and the covariance positive definite")
        if not 0.0 <= self.strength < np.inf:
            raise InputError(f"population prior: strength = {self.strength} must be finite and not below 0")

    @classmethod
    def from_fits(cls, fits: Fit | Sequence[Fit], strength: float = 0.1) -> PopulationPrior:
        """Return the distribution of individually calibrated parameters.

        Raises:
            InputError: a fit is shared, the fits have different parameters, or they have fewer than D + 2 people.
        """
        many = [fits] if not isinstance(fits, Sequence) else list(fits)
        if not many or any(fit.space.shared or fit.space.names != many[0].space.names for fit in many):
            raise InputError("population prior: the fits must have individual parameters, and all the same ones")
        space = many[0].space
        rows = np.concatenate(
            [_transform(space, fit.values, fit.given)[fit.counted] for fit in many if np.any(fit.counted)]
            or [np.zeros((0, len(space.names)))]
        )
        if len(rows) < len(space.names) + 2:
            raise InputError(
                f"population prior: {len(rows)} people are too few for {len(space.names)} parameters,"
                f" it needs at least {len(space.names) + 2}"
            )
        covariance = np.cov(rows, rowvar=False).reshape(len(space.names), -1)
        own = np.diag(np.maximum(np.diag(covariance), 1e-4))
        return cls(space.names, rows.mean(axis=0), (1.0 - SHRINKAGE) * covariance + SHRINKAGE * own, strength)

    def penalty(self, space: ParameterSpace, values: Floats, given: Floats) -> Floats:
        """Return the penalty ``[..., A]`` [m] for unusual values ``[..., A, D]``.

        ``given`` are the initial values; their preferred speed is the observed speed.

        Raises:
            InputError: the space has other parameters.
        """
        self._check(space)
        away = _transform(space, values, given) - self.mean
        square = np.sum(away @ np.linalg.inv(self.covariance) * away, axis=-1)
        return np.asarray(0.5 * self.strength * square)

    def typical(self, space: ParameterSpace, given: Floats) -> Floats:
        """Return the values ``[..., A, D]`` of the average person, with the observed speed of each person."""
        self._check(space)
        share = 1.0 / (1.0 + np.exp(-self.mean))
        values = np.broadcast_to(space.low + share * (space.high - space.low), given.shape).copy()
        for column, name in enumerate(space.names):
            if name == PREFERRED_SPEED.name:
                moved = given[..., column] + self.mean[column]
                values[..., column] = np.clip(moved, PREFERRED_SPEED.low, PREFERRED_SPEED.high)
        return values

    def save(self, path: str | Path) -> None:
        """Write the prior as a JSON file."""
        text = {
            "names": self.names, "mean": self.mean.tolist(), "covariance": self.covariance.tolist(),
            "strength": self.strength,
        }  # fmt: skip
        Path(path).write_text(json.dumps(text, indent=1) + "\n", encoding="utf-8")

    @classmethod
    def load(cls, path: str | Path) -> PopulationPrior:
        """Read a prior from a JSON file.

        Raises:
            InputError: the file is not a population prior.
        """
        try:
            text = json.loads(Path(path).read_text(encoding="utf-8"))
            return cls(
                tuple(map(str, text["names"])),
                np.array(text["mean"], dtype=float),
                np.array(text["covariance"], dtype=float),
                float(text["strength"]),
            )
        except OSError as error:
            raise InputError(f"{path}: cannot be read ({error.strerror})") from None
        except (ValueError, KeyError, TypeError, np.linalg.LinAlgError):
            raise InputError(f"{path} is not a population prior; write one with PopulationPrior.save") from None

    def _check(self, space: ParameterSpace) -> None:
        if space.names != self.names:
            raise InputError(
                f"population prior: it is of {', '.join(self.names)}, and {', '.join(space.names)} are calibrated"
            )


def _transform(space: ParameterSpace, values: Floats, given: Floats) -> Floats:
    share = np.clip((values - space.low) / (space.high - space.low), EDGE, 1.0 - EDGE)
    out = np.log(share / (1.0 - share))
    for column, name in enumerate(space.names):
        if name == PREFERRED_SPEED.name:
            out[..., column] = values[..., column] - given[..., column]
    return np.asarray(out)
