"""Noise is a value attached to a sensor: what it adds to every reading, drawn from a given generator."""

from __future__ import annotations

import dataclasses
import math
import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.core.errors import did_you_mean
from crowdbot.core.plug import kebab

__all__ = ["Gaussian", "Noise", "Offset", "Peak", "Randomness", "disturbed"]

Floats = NDArray[np.float64]
Randomness = np.random.Generator | Sequence[np.random.Generator]
"""One generator that serves the environments in turn, or one for each environment (alone = in a batch, bitwise)."""

TERM = re.compile(r"\s*([A-Za-z][\w-]*)\s*\(([^()]*)\)\s*[,+]?")


@dataclass(frozen=True)
class Noise(ABC):
    """Something that is added to what a sensor measures; several add up as a tuple.

    >>> Noise.parse("gaussian(0.01) peak(0.001, 1.0)")
    (Gaussian(sd=0.01), Peak(probability=0.001, height=1.0))
    """

    @abstractmethod
    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
        """Return what is added to readings of ``shape``, in the unit of the reading."""

    @classmethod
    def parse(cls, text: str) -> tuple[Noise, ...]:
        """Read noise from text, as it stands in a trial file: ``gaussian(0.01) peak(0.001, 1.0)``.

        Raises:
            InputError: a word is not a known noise, or its numbers do not fit.
        """
        found: list[Noise] = []
        place = 0
        while text[place:].strip():
            term = TERM.match(text, place)
            if term is None:
                raise InputError(f"noise {text!r} must be a list of name(number, ...), such as gaussian(0.01)")
            found.append(_made(term.group(1), term.group(2), text))
            place = term.end()
        return tuple(found)

    def __str__(self) -> str:
        """Return the text that :meth:`parse` reads."""
        numbers = ", ".join(repr(float(getattr(self, f.name))) for f in dataclasses.fields(self))
        return f"{kebab(type(self).__name__)}({numbers})"


@dataclass(frozen=True)
class Gaussian(Noise):
    """Normal noise of zero mean and standard deviation ``sd``, in the unit of the reading.

    >>> Gaussian(0.5).draw((2,), np.random.default_rng(0)).round(3).tolist()
    [0.063, -0.066]
    """

    sd: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.sd < math.inf:
            raise InputError(f"gaussian noise: sd = {self.sd} must be finite and at least 0")

    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
        """Return independent normal draws."""
        return rng.normal(0.0, self.sd, shape)


@dataclass(frozen=True)
class Offset(Noise):
    """A constant error ``value``, in the unit of the reading.

    >>> Offset(-0.02).draw((2,), np.random.default_rng(0)).tolist()
    [-0.02, -0.02]
    """

    value: float

    def __post_init__(self) -> None:
        if not math.isfinite(self.value):
            raise InputError(f"offset noise: value = {self.value} must be finite")

    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
        """Return the constant; draws nothing."""
        return np.full(shape, self.value)


@dataclass(frozen=True)
class Peak(Noise):
    """A rare outlier: each reading gets ``height`` added with ``probability``, otherwise nothing.

    >>> Peak(1.0, 2.5).draw((2,), np.random.default_rng(0)).tolist()
    [2.5, 2.5]
    """

    probability: float
    height: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.probability <= 1.0:
            raise InputError(f"peak noise: probability = {self.probability} must be between 0 and 1")
        if not math.isfinite(self.height):
            raise InputError(f"peak noise: height = {self.height} must be finite")

    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
        """Return ``height`` where a uniform draw falls below the probability."""
        return np.where(rng.random(shape) < self.probability, self.height, 0.0)


def disturbed(values: Floats, noise: tuple[Noise, ...], rng: Randomness | None) -> Floats:
    """Return ``values`` ``[E, ...]`` with every noise added; what is infinite stays infinite.

    The number of draws depends on the shape only, never on what was measured.

    Raises:
        InputError: there is noise but no generator, or not one generator for each environment.

    >>> disturbed(np.ones((1, 2)), (Offset(0.5), Offset(1.0)), np.random.default_rng(0)).tolist()
    [[2.5, 2.5]]
    """
    if not noise:
        return values
    if rng is None:
        raise InputError("a sensor with noise needs a generator of randomness: pass rng=stream(seed, ...)")
    generators = [rng] * len(values) if isinstance(rng, np.random.Generator) else list(rng)
    if len(generators) != len(values):
        raise InputError(f"{len(generators)} generators were given for {len(values)} environments")
    result = values.copy()
    for number, generator in enumerate(generators):
        for part in noise:
            result[number] += part.draw(values.shape[1:], generator)
    return result


def _made(word: str, inside: str, text: str) -> Noise:
    known: dict[str, type[Noise]] = {kebab(c.__name__): c for c in (Gaussian, Offset, Peak)}
    kind = known.get(word.lower())
    if kind is None:
        raise InputError(
            f"unknown noise {word!r} in {text!r}{did_you_mean(word, known)}; known are {', '.join(sorted(known))}"
        )
    names = [f.name for f in dataclasses.fields(kind)]
    try:
        numbers = [float(part) for part in inside.split(",") if part.strip()]
    except ValueError:
        raise InputError(f"noise {word}({inside}): its values must be numbers: {word}({', '.join(names)})") from None
    if len(numbers) != len(names):
        raise InputError(f"noise {word}({inside}) has {len(numbers)} values, it takes {word}({', '.join(names)})")
    return kind(*numbers)
