"""Noise of sensors, as values; random numbers come from a given generator."""

from __future__ import annotations

import dataclasses
import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import InputError, check_number, did_you_mean, kebab_case
from crowdbot.typing import Floats

Randomness = np.random.Generator | Sequence[np.random.Generator]
"""A generator for all environments, or one per environment, which gives equal results alone and in a batch."""

TERM = re.compile(r"\s*([A-Za-z][\w-]*)\s*\(([^()]*)\)\s*[,+]?")


@dataclass(frozen=True)
class Noise(ABC):
    """Noise of a sensor. A tuple of them is applied one after the other.

    >>> Noise.parse("gaussian(0.01) peak(0.001, 1.0)")
    (Gaussian(sd=0.01), Peak(probability=0.001, height=1.0, sd=0.0))
    """

    @abstractmethod
    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
        """Return the error of readings of ``shape``, in the unit of the reading."""

    def apply(self, values: Floats, rng: np.random.Generator) -> Floats:
        """Return ``values`` with the noise; the number of draws depends only on their shape."""
        return values + self.draw(values.shape, rng)

    @classmethod
    def parse(cls, text: str) -> tuple[Noise, ...]:
        """Parse the text of a trial file, such as ``gaussian(0.01) peak(0.001, 1.0)``.

        Raises:
            InputError: a noise is unknown, or its numbers are wrong.
        """
        noises: list[Noise] = []
        place = 0
        while text[place:].strip():
            term = TERM.match(text, place)
            if term is None:
                raise InputError(f"noise {text!r} must be a list of name(number, ...), such as gaussian(0.01)")
            noises.append(_made(term.group(1), term.group(2), text))
            place = term.end()
        return tuple(noises)

    def __str__(self) -> str:
        """Return the text that :meth:`parse` reads."""
        values = [float(getattr(self, f.name)) for f in dataclasses.fields(self)]
        optional = [f.default for f in dataclasses.fields(self)]
        while values and values[-1] == optional[len(values) - 1]:
            values.pop()
        numbers = ", ".join(map(repr, values))
        return f"{kebab_case(type(self).__name__)}({numbers})"


@dataclass(frozen=True)
class Gaussian(Noise):
    """Normal noise of zero mean and standard deviation ``sd``, in the unit of the reading.

    >>> Gaussian(0.5).draw((2,), np.random.default_rng(0)).round(3).tolist()
    [0.063, -0.066]
    """

    sd: float

    def __post_init__(self) -> None:
        check_number("gaussian noise", "sd", self.sd, min=0.0)

    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
        return rng.normal(0.0, abs(self.sd), shape)  # NumPy rejects -0.0


@dataclass(frozen=True)
class Offset(Noise):
    """A constant error ``value``, in the unit of the reading.

    >>> Offset(-0.02).draw((2,), np.random.default_rng(0)).tolist()
    [-0.02, -0.02]
    """

    value: float

    def __post_init__(self) -> None:
        check_number("offset noise", "value", self.value)

    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
        # draws nothing
        return np.full(shape, self.value)


@dataclass(frozen=True)
class Peak(Noise):
    """A rare outlier: with ``probability`` a reading gets ``height`` added, or a normal draw around it.

    >>> Peak(1.0, 2.5).draw((2,), np.random.default_rng(0)).tolist()
    [2.5, 2.5]
    """

    probability: float
    height: float
    sd: float = 0.0

    def __post_init__(self) -> None:
        _check_probability("peak", self.probability)
        check_number("peak noise", "height", self.height)
        check_number("peak noise", "sd", self.sd, min=0.0)

    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
        # height where a uniform draw falls below the probability; with sd normal around it
        chosen = rng.random(shape) < self.probability
        return np.where(chosen, self.height if self.sd == 0.0 else rng.normal(self.height, self.sd, shape), 0.0)


@dataclass(frozen=True)
class Dropout(Noise):
    """A lost return: with ``probability``, a reading is infinite, which means no object within range.

    Other sensors return NaN.

    >>> Dropout(1.0).draw((2,), np.random.default_rng(0)).tolist()
    [inf, inf]
    """

    probability: float

    def __post_init__(self) -> None:
        _check_probability("dropout", self.probability)

    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
        return np.where(rng.random(shape) < self.probability, np.inf, 0.0)


@dataclass(frozen=True)
class Quantised(Noise):
    """Rounding to whole multiples of ``step``, in the unit of the reading; half a step goes to the even multiple.

    >>> Quantised(0.25).apply(np.array([0.3, 0.4]), np.random.default_rng(0)).tolist()
    [0.25, 0.5]
    """

    step: float

    def __post_init__(self) -> None:
        check_number("quantised", "step", self.step, exclusive_min=0.0)

    @classmethod
    def bits(cls, bits: int, low: float, high: float) -> Quantised:
        """Return the rounding of a number of ``bits`` whose smallest and largest values are ``low`` and ``high``.

        >>> Quantised.bits(8, 0.0, 255.0).step
        1.0
        """
        if bits != int(bits) or not 1 <= bits <= 64:
            raise InputError(f"quantised: bits = {bits} must be a whole number from 1 to 64")
        return cls((high - low) / (2**bits - 1))

    def draw(self, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
        # rounding depends on the reading
        return np.zeros(shape)

    def apply(self, values: Floats, rng: np.random.Generator) -> Floats:
        # rounded readings; infinite values are unchanged
        return np.round(values / self.step) * self.step


def apply_noise(values: Floats, noise: tuple[Noise, ...], rng: Randomness | None) -> Floats:
    """Return ``values`` ``[E, ...]`` with all noise applied; infinite values are unchanged.

    The number of draws depends only on the shape.

    Raises:
        InputError: there is noise but no generator, or not one generator for each environment.

    >>> apply_noise(np.ones((1, 2)), (Offset(0.5), Offset(1.0)), np.random.default_rng(0)).tolist()
    [[2.5, 2.5]]
    """
    if not noise:
        return values
    result = values.copy()
    add_noise(result, noise, rng)
    return result


def add_noise(values: Floats, noise: tuple[Noise, ...], rng: Randomness | None) -> None:
    """Apply noise to ``values`` ``[E, ...]`` in place, as :func:`apply_noise`.

    Raises:
        InputError: there is noise but no generator, or not one generator for each environment.
    """
    if not noise:
        return
    if rng is None:
        raise InputError("a sensor with noise needs a random generator: pass rng=stream(seed, ...)")
    generators = [rng] * len(values) if isinstance(rng, np.random.Generator) else list(rng)
    if len(generators) != len(values):
        raise InputError(f"{len(generators)} generators were given for {len(values)} environments")
    if len(noise) == 1 or len(set(map(id, generators))) == len(generators):
        for part in noise:
            _add_part(values, part, generators)
        return
    for row, generator in enumerate(generators):  # a shared generator draws all noise of an environment before the next
        for part in noise:
            _add_part(values[row : row + 1], part, [generator])


def _add_part(values: Floats, part: Noise, generators: list[np.random.Generator]) -> None:
    """Apply one noise in place, with as many draws from each generator as :meth:`Noise.apply` and the same result."""
    fast = FAST.get(type(part))
    if fast is not None and values.dtype == np.float64:
        fast(values, part, generators)
        return
    for row, generator in enumerate(generators):
        values[row] = part.apply(values[row], generator)


def _add_gaussian(values: Floats, part: Any, generators: list[np.random.Generator]) -> None:
    draws = np.empty((len(values), math.prod(values.shape[1:])))
    for row, generator in zip(draws, generators, strict=True):
        generator.standard_normal(out=row)
    draws *= abs(part.sd)
    draws += 0.0  # Generator.normal adds its mean, which turns -0.0 into 0.0
    values += draws.reshape(values.shape)


def _add_outliers(values: Floats, part: Any, generators: list[np.random.Generator]) -> None:
    height = np.inf if isinstance(part, Dropout) else part.height
    if not isinstance(part, Dropout) and part.sd != 0.0:
        for e, generator in enumerate(generators):
            values[e] = part.apply(values[e], generator)
        return
    draws = np.empty((len(values), math.prod(values.shape[1:])))
    for row, generator in zip(draws, generators, strict=True):
        generator.random(out=row)
    values += np.where(draws < part.probability, height, 0.0).reshape(values.shape)


def _add_offset(values: Floats, part: Any, generators: list[np.random.Generator]) -> None:
    values += part.value


def _round(values: Floats, part: Any, generators: list[np.random.Generator]) -> None:
    values /= part.step
    np.round(values, out=values)
    values *= part.step


FAST: dict[type[Noise], Callable[[Floats, Any, list[np.random.Generator]], None]] = {
    Gaussian: _add_gaussian,
    Peak: _add_outliers,
    Dropout: _add_outliers,
    Offset: _add_offset,
    Quantised: _round,
}
"""Noise in batches, by the exact class: a subclass may override :meth:`Noise.apply`."""


def _check_probability(name: str, probability: float) -> None:
    check_number(f"{name} noise", "probability", probability, min=0.0, max=1.0)


def normals(shape: tuple[int, ...], rng: Randomness | None) -> Floats:
    """Return standard normal draws ``[E, ...]``, each environment's from its generator.

    Raises:
        InputError: there is no generator, or not one for each environment.
    """
    draws = np.zeros(shape)
    add_noise(draws, (Gaussian(1.0),), rng)
    return draws


def _made(word: str, inside: str, text: str) -> Noise:
    known: dict[str, type[Noise]] = {kebab_case(c.__name__): c for c in (Dropout, Gaussian, Offset, Peak, Quantised)}
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
    least = sum(f.default is dataclasses.MISSING for f in dataclasses.fields(kind))
    if not least <= len(numbers) <= len(names):
        raise InputError(f"noise {word}({inside}) has {len(numbers)} values, it takes {word}({', '.join(names)})")
    return kind(*numbers)
