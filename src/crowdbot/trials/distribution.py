"""Distributions: a parameter of people is a number, or is drawn for each person."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, did_you_mean, parse_number
from crowdbot.core.fields import plain

FORMS = "a number, uniform(low, high), normal(mean, sd) or normal(mean, sd, low, high)"


@dataclass(frozen=True)
class Distribution:
    """A number that is drawn for each person.

    Kinds: ``number`` (value), ``uniform`` (low, high), ``normal`` (mean, standard deviation, low, high). A normal
    distribution is truncated at ``low`` and ``high`` (default: three standard deviations), so every value has bounds
    that can be checked in advance.

    Raises:
        InputError: the kind is unknown, the numbers are too few, too many, not finite or in the wrong order.

    >>> Distribution.parse("normal(1.34, 0.26)").extent
    (0.56, 2.12)
    >>> print(Distribution.parse("uniform(0.2,0.3)"), Distribution.of(1.3))
    uniform(0.2, 0.3) 1.3
    """

    kind: str
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        allowed = {"number": (1,), "uniform": (2,), "normal": (2, 4)}
        if self.kind not in allowed:
            raise InputError(f"{self.kind!r} is not a distribution{did_you_mean(self.kind, allowed)}; use {FORMS}")
        if len(self.values) not in allowed[self.kind]:
            raise InputError(f"{self.kind} takes {_counts(allowed[self.kind])} numbers, not {len(self.values)}")
        object.__setattr__(self, "values", tuple(float(v) for v in self.values))
        if not all(math.isfinite(v) for v in self.values):
            raise InputError(f"{self} is not finite")
        if self.kind == "normal" and self.values[1] <= 0.0:
            raise InputError(f"{self} has the standard deviation {self.values[1]:g}, it must be above 0")
        low, high = self.extent
        if low > high or (self.kind != "number" and low == high):
            raise InputError(f"{self} has its low end {low:g} not below its high end {high:g}")

    @classmethod
    def parse(cls, text: str) -> Distribution:
        """Read ``1.3``, ``uniform(0.2, 0.3)``, ``normal(1.34, 0.26)`` or ``normal(1.34, 0.26, 0.8, 2.0)``."""
        match = re.fullmatch(r"\s*([A-Za-z][A-Za-z-]*)\s*\(([^()]*)\)\s*", text)
        if not match:
            return cls("number", (parse_number(text, f"is not {FORMS}"),))
        return cls(match[1].lower(), tuple(parse_number(part) for part in match[2].split(",")))

    @classmethod
    def of(cls, value: Any) -> Distribution:
        """Return a distribution from a number, a text or a distribution."""
        if isinstance(value, cls):
            return value
        return cls.parse(value) if isinstance(value, str) else cls("number", (float(value),))

    def __str__(self) -> str:
        """Return the text that :meth:`parse` reads."""
        inside = ", ".join(plain(v) for v in self.values)
        return inside if self.kind == "number" else f"{self.kind}({inside})"

    @property
    def extent(self) -> tuple[float, float]:
        """The smallest and the largest value that can be drawn."""
        if self.kind == "normal" and len(self.values) == 2:
            mean, sd = self.values
            return round(mean - 3.0 * sd, 12), round(mean + 3.0 * sd, 12)
        return self.values[-2 if len(self.values) > 1 else 0], self.values[-1]

    def draw(self, rng: np.random.Generator, count: int) -> NDArray[np.float64]:
        """Return ``[count]`` values; each value uses exactly one number from ``rng``."""
        return self.values_at(rng.random(count))

    def values_at(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values at shares of the distribution in [0, 1), of any shape.

        >>> Distribution.parse("uniform(2, 4)").values_at(np.array([0.0, 0.5])).tolist()
        [2.0, 3.0]
        """
        low, high = self.extent
        if self.kind == "number":
            return np.full(share.shape, low)
        if self.kind == "uniform":
            return np.asarray(low + (high - low) * share)
        normal = NormalDist(*self.values[:2])
        bottom, top = normal.cdf(low), normal.cdf(high)
        drawn = [normal.inv_cdf(_inside(bottom + (top - bottom) * u)) for u in share.ravel().tolist()]
        return np.clip(np.array(drawn, dtype=np.float64).reshape(share.shape), low, high)


def _inside(share: float) -> float:
    return min(max(share, 1e-15), 1.0 - 1e-15)


def _counts(allowed: tuple[int, ...]) -> str:
    return " or ".join(str(count) for count in allowed)
