"""Bounds: range of allowed numbers, and its description in messages."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

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
