"""Parameters of models: one table for docs, command line, XML and calibration.

A model is a frozen dataclass with fields defined by :func:`parameter`. A value is a number for all agents, or an array
that broadcasts to ``[E, A]``.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError


@dataclass(frozen=True)
class Bounds:
    """Range of allowed numbers; each end is optional. NaN and infinity are never allowed.

    Fields:
        unit: unit of the number, for messages.
        min, exclusive_min: lower end, inclusive or exclusive.
        max, exclusive_max: upper end, inclusive or exclusive.
        whole: whether only whole numbers are allowed.

    >>> Bounds("s", exclusive_min=0.0, max=60.0).describe(), Bounds("m", min=0.0).describe()
    ('above 0 s and at most 60 s', 'finite and at least 0 m, without an upper limit')
    >>> Bounds(min=1, max=9, whole=True).describe(), Bounds().describe()
    ('a whole number of at least 1 and at most 9', 'finite')
    """

    unit: str = ""
    min: float | None = None
    exclusive_min: float | None = None
    max: float | None = None
    exclusive_max: float | None = None
    whole: bool = False

    def holds(self, value: Any) -> bool:
        """Return whether a number, or every number of an array, is allowed."""
        if isinstance(value, int | float):
            return bool(self._contains(value))
        try:
            numbers = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            return False
        if self.whole or not numbers.size:
            return bool(np.all(self._contains(numbers)))
        return bool(self._contains(numbers.min()) and self._contains(numbers.max()))  # both are NaN if one number is

    def describe(self, high_first: bool = False) -> str:
        """Return the text after ``must be`` in a message, with the upper end first if ``high_first``."""
        low = [f"{word} {self._amount(end)}" for word, end in (("above", self.exclusive_min), ("at least", self.min))
               if end is not None]  # fmt: skip
        high = [f"{word} {self._amount(end)}" for word, end in (("below", self.exclusive_max), ("at most", self.max))
                if end is not None]  # fmt: skip
        ends = " and ".join([*high, *low] if high_first else [*low, *high])
        if self.whole:
            return f"a whole number{f' of {ends}' if ends else ''}"
        if low and high:
            return ends
        return f"finite and {ends}, without {'an upper' if low else 'a lower'} limit" if ends else "finite"

    def worst(self, value: Any) -> float:
        """Return the first number of a value that is not allowed."""
        numbers = np.asarray(value, dtype=np.float64)
        return float(numbers[~self._contains(numbers)].flat[0])

    def _contains(self, numbers: Any) -> Any:
        inside = (numbers > _default(self.exclusive_min, -math.inf)) & (
            numbers < _default(self.exclusive_max, math.inf)
        )
        inside = inside & (numbers >= _default(self.min, -math.inf)) & (numbers <= _default(self.max, math.inf))
        return inside & (numbers == np.floor(numbers)) if self.whole else inside

    def _amount(self, value: float) -> str:
        number = f"{value:.0f}" if value == round(value) and abs(value) < 1e8 else f"{value:.6g}"
        return f"{number} {self.unit}".rstrip()


def check_number(
    owner: str,
    name: str,
    value: Any,
    unit: str = "",
    *,
    min: float | None = None,
    exclusive_min: float | None = None,
    max: float | None = None,
    exclusive_max: float | None = None,
    whole: bool = False,
) -> None:
    """Raise :class:`InputError` unless a number of ``owner``, or every number of an array, is within the bounds.

    The arguments are the fields of :class:`Bounds`.

    >>> check_number("Lidar2D", "rate", 0.0, "Hz", exclusive_min=0.0)
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: Lidar2D: rate = 0.0 Hz must be finite and above 0 Hz, without an upper limit
    """
    bounds = Bounds(unit, min, exclusive_min, max, exclusive_max, whole)
    if not bounds.holds(value):
        shown = f"{value} {unit}".rstrip()
        raise InputError(f"{owner}: {name} = {shown} must be {bounds.describe()}")


def _default(value: float | None, other: float) -> float:
    return other if value is None else value


FLOAT, BOOL = np.dtype(np.float64), np.dtype(np.bool_)

PerAgent = float | NDArray[np.float64]
"""A number for all agents, or an array that broadcasts to ``[E, A]``."""


@dataclass(frozen=True)
class Parameter:
    """One row of a parameter table: ``low`` and ``high`` limit calibration, ``min`` and ``max`` all values."""

    name: str
    unit: str
    default: float
    low: float
    high: float
    source: str
    min: float = 0.0
    max: float | None = None

    def bounds(self, largest: float | None = None) -> Bounds:
        """Return the allowed range; ``largest`` is the upper limit if ``max`` is None."""
        highest = largest if self.max is None else self.max
        return Bounds("" if self.unit == "1" else self.unit, min=self.min, max=highest)


def parameter(
    default: float,
    *,
    unit: str,
    low: float,
    high: float,
    source: str,
    min: float = 0.0,
    max: float | None = None,
) -> Any:
    """Make the dataclass field of one parameter.

    Args:
        default: default value.
        unit: SI unit, ``1`` for dimensionless parameters.
        low, high: limits for calibration.
        source: source of the default.
        min: minimum value.
        max: maximum value (default: that of the model).
    """
    row = Parameter("", unit, default, low, high, source, min, max)
    return dataclasses.field(default=default, metadata={"parameter": row})


def parameters(model: Any) -> tuple[Parameter, ...]:
    """Return the parameter table of a model or model class, in the order of its fields."""
    return _table(model if isinstance(model, type) else type(model))


@functools.lru_cache(maxsize=256)
def _table(kind: Any) -> tuple[Parameter, ...]:
    return tuple(
        dataclasses.replace(field.metadata["parameter"], name=field.name)
        for field in dataclasses.fields(kind)
        if "parameter" in field.metadata
    )


def check_parameters(model: Any, largest: float | None = None) -> None:
    """Raise :class:`InputError` if a parameter is outside its range.

    Args:
        model: an instance with parameters.
        largest: upper limit of parameters without ``max``; None for no limit.
    """
    for row in parameters(model):
        value, bounds = getattr(model, row.name), row.bounds(largest)
        if not bounds.holds(value):
            raise InputError(
                f"{type(model).__name__}: {row.name} = {bounds.worst(value)} [{row.unit}] is not allowed,"
                f" it must be {bounds.describe()}"
            )


def per_agent(value: PerAgent, shape: tuple[int, int], name: str = "parameter") -> NDArray[np.float64]:
    """Return ``value`` as a contiguous float64 array of ``shape`` ``[E, A]``.

    >>> per_agent(0.5, (1, 3)).tolist()
    [[0.5, 0.5, 0.5]]
    """
    try:
        return dense(value, shape, FLOAT)
    except ValueError:
        got = np.shape(value)
        raise InputError(f"{name} has shape {got}, which does not broadcast to [E, A] = {list(shape)}") from None


def dense(value: Any, shape: tuple[int, ...], kind: np.dtype[Any]) -> NDArray[Any]:
    """Return a value as an array that kernels accept: C-contiguous, aligned and writeable; a copy only if necessary.

    Args:
        value: a number or an array.
        shape: shape of the result, to which the value is broadcast.
        kind: data type of the result.

    Raises:
        ValueError: the value does not broadcast to the shape.

    >>> dense(2.0, (1, 3), np.dtype(np.int32)).tolist()
    [[2, 2, 2]]
    """
    if type(value) is np.ndarray:
        if value.dtype is kind and value.shape == shape and value.flags.carray:
            return value
    elif type(value) is float or type(value) is bool or type(value) is int:
        array = np.empty(shape, dtype=kind)
        array.fill(value)
        return array
    # writeable: numba has a separate type for read-only arrays
    return np.require(np.broadcast_to(np.asarray(value, dtype=kind), shape), requirements=["C", "A", "W"])


def every(mask: NDArray[np.bool_]) -> bool:
    """Return whether all values are True; ten times faster than a reduction of a short array.

    >>> every(np.array([True, False])), every(np.array([], dtype=np.bool_))
    (False, True)
    """
    return 0 not in mask.tobytes()


def some(mask: NDArray[np.bool_]) -> bool:
    """Return whether a value is True; ten times faster than a reduction of a short array.

    >>> some(np.array([True, False])), some(np.array([], dtype=np.bool_))
    (True, False)
    """
    return 1 in mask.tobytes()


@dataclass(frozen=True)
class Paper:
    """One publication.

    >>> print(Paper("Reynolds", 1987, "Flocks, herds and schools", "SIGGRAPH", "10.1145/37401.37406"))
    Reynolds (1987). Flocks, herds and schools. SIGGRAPH. https://doi.org/10.1145/37401.37406
    """

    authors: str
    year: int
    title: str
    venue: str
    doi: str = ""

    def __str__(self) -> str:
        link = f" https://doi.org/{self.doi}" if self.doi else ""
        return f"{self.authors} ({self.year}). {self.title}. {self.venue}.{link}"

    def bibtex(self) -> str:
        """Return the BibTeX entry."""
        key = self.authors.split(",")[0].split()[-1].lower() + str(self.year)
        doi = f"  doi = {{{self.doi}}},\n" if self.doi else ""
        return (
            f"@article{{{key},\n  author = {{{self.authors}}},\n  title = {{{self.title}}},\n"
            f"  journal = {{{self.venue}}},\n  year = {{{self.year}}},\n{doi}}}"
        )


@functools.cache
def field_units(kinds: tuple[type, ...]) -> dict[str, str]:
    """Return the units of fields from the docstrings of classes and their bases; the first that has one counts.

    Many docstrings refer to another class of the contract for a field, in which the same name has the same unit.

    >>> class Disc:
    ...     '''A disc.
    ...
    ...     Fields:
    ...         radius: size of the disc [m].
    ...     '''
    >>> field_units((Disc,))
    {'radius': 'm'}
    """
    units: dict[str, str] = {}
    for base in dict.fromkeys(base for kind in kinds for base in kind.__mro__):
        text = inspect.cleandoc(base.__doc__ or "") + "\n"
        section = re.search(r"^(?:Fields|Args):\n((?: {4}.*\n|\n(?= {4}))+)", text, re.MULTILINE)
        for line in re.split(r"\n {4}(?! )|; ", f"\n{section[1]}" if section else ""):
            names, _, about = line.partition(": ")
            if unit := re.search(r"\[([^\]]+)\]", about):
                for name in names.split(", "):
                    units.setdefault(name, unit[1])
    return units
