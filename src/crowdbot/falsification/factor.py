"""Factor: a value of a trial that a search varies, with its distribution."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from scipy import special

from crowdbot.core import InputError, did_you_mean, parse_number
from crowdbot.trials import Distribution

CALL = re.compile(r"\s*([A-Za-z][A-Za-z-]*)\s*\((.*)\)\s*", re.DOTALL)
KINDS = ("uniform", "normal", "log-uniform", "integer", "choice")
EDGE = 1e-15
"""Distance of a share from 0 and 1 at least."""


@dataclass(frozen=True)
class Factor:
    """A value of a trial with its distribution, as the image of a standard normal number.

    Kinds: ``uniform`` (low, high), ``normal`` (mean, standard deviation, optionally low and high), ``log-uniform``
    (low, high), ``integer`` (low, high, both included) and ``choice`` (equally likely texts).

    Fields:
        path: path of the value in the trial, as in a sweep.
        kind: kind of the distribution.
        arguments: texts of its numbers, or the choices.

    Raises:
        InputError: the kind is unknown, or the numbers are too few, not finite or in the wrong order.

    >>> speed = parse_factor("agent[1]/speed=uniform(0.8, 1.6)")
    >>> round(speed.value_at(0.0), 12), parse_factor("crowd/type=choice(orca, boids)").value_at(2.0)
    (1.2, 'boids')
    """

    path: str
    kind: str
    arguments: tuple[str, ...]

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(
                f"factor {self.path}: {self.kind!r} is not a distribution{did_you_mean(self.kind, KINDS)};"
                f" known are {', '.join(KINDS)}"
            )
        if self.kind == "choice":
            if len(set(self.arguments)) < 2 or len(set(self.arguments)) < len(self.arguments):
                raise InputError(f"factor {self.path}: choice needs at least two different values")
            return
        try:
            if self.kind in ("uniform", "normal"):
                Distribution.parse(self.text)
                return
            low, high = self._bounds()
        except InputError as error:
            raise InputError(f"factor {self.path}: {error}") from None
        if self.kind == "log-uniform" and low <= 0.0:
            raise InputError(f"factor {self.path}: {self.text} has a low end {low:g} that is not above 0")
        if self.kind == "integer" and (low != round(low) or high != round(high)):
            raise InputError(f"factor {self.path}: {self.text} must have whole numbers")
        if not low < high:
            raise InputError(f"factor {self.path}: {self.text} has its low end {low:g} not below its high end {high:g}")

    @property
    def text(self) -> str:
        """The distribution as text."""
        return f"{self.kind}({', '.join(self.arguments)})"

    @property
    def continuous(self) -> bool:
        """Whether the value is a real number."""
        return self.kind in ("uniform", "normal", "log-uniform")

    def value_at(self, z: float) -> float | int | str:
        """Return the value for a standard normal number.

        >>> wide, few = parse_factor("x=log-uniform(0.1, 10)"), parse_factor("x=integer(2, 5)")
        >>> [round(wide.value_at(0.0), 12), few.value_at(9.0)]
        [1.0, 5]
        """
        share = min(max(float(special.ndtr(z)), EDGE), 1.0 - EDGE)
        if self.kind == "choice":
            return self.arguments[min(int(share * len(self.arguments)), len(self.arguments) - 1)]
        if self.kind in ("uniform", "normal"):
            return float(Distribution.parse(self.text).values_at(np.array([share]))[0])
        low, high = self._bounds()
        if self.kind == "integer":
            return int(low) + min(int(share * (high - low + 1)), int(high - low))
        return float(np.clip(low * math.exp(share * math.log(high / low)), low, high))

    def _bounds(self) -> tuple[float, float]:
        if len(self.arguments) != 2:
            raise InputError(f"{self.kind} takes 2 numbers, not {len(self.arguments)}")
        low, high = (parse_number(text) for text in self.arguments)
        if not (math.isfinite(low) and math.isfinite(high)):
            raise InputError(f"{self.text} is not finite")
        return low, high


def parse_factor(text: str) -> Factor:
    """Return the factor of a text such as ``agent[1]/speed=uniform(0.8, 1.6)``.

    Raises:
        InputError: the text has another form; see also :class:`Factor`.

    >>> parse_factor("robot/x=normal(0, 0.1)").text
    'normal(0, 0.1)'
    """
    path, equals, distribution = text.partition("=")
    match = CALL.fullmatch(distribution)
    if not (path.strip() and equals and match):
        raise InputError(f"factor {text!r} must be PATH=DISTRIBUTION, such as agent[1]/speed=uniform(0.8, 1.6)")
    if path.strip() == "seed":
        raise InputError(f"factor {text!r}: the seed is always a factor; leave it out")
    words = tuple(word.strip() for word in match[2].split(","))
    if not all(words):
        raise InputError(f"factor {text!r} has an empty value")
    return Factor(path.strip(), match[1].lower(), words)
