"""Bounds: what a number may be, and the one sentence that tells all of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from .errors import InputError

__all__ = ["Bounds", "check_number"]


@dataclass(frozen=True)
class Bounds:
    """The lowest and the highest number that is allowed, of which either may be missing; never NaN or infinity.

    Fields:
        unit: of the number, for people.
        at_least, above: the lowest number, or what it must be above.
        at_most, below: the highest number, or what it must be below.
        whole: whether it must be a whole number.

    >>> Bounds("s", above=0.0, at_most=60.0).allowed(), Bounds("m", at_least=0.0).allowed()
    ('above 0 s and at most 60 s', 'finite and at least 0 m, without an upper limit')
    >>> Bounds(at_least=1, at_most=9, whole=True).allowed(), Bounds().allowed()
    ('a whole number of at least 1 and at most 9', 'finite')
    """

    unit: str = ""
    at_least: float | None = None
    above: float | None = None
    at_most: float | None = None
    below: float | None = None
    whole: bool = False

    def holds(self, value: Any) -> bool:
        """Return whether a number, or every one of an array, is allowed."""
        if isinstance(value, int | float):
            return bool(self._right(value))
        try:
            numbers = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            return False
        return bool(np.all(self._right(numbers)))

    def allowed(self, high_first: bool = False) -> str:
        """Return what is allowed, after ``must be``; the upper end comes first when that is asked for."""
        low = [f"{word} {self._amount(end)}" for word, end in (("above", self.above), ("at least", self.at_least))
               if end is not None]  # fmt: skip
        high = [f"{word} {self._amount(end)}" for word, end in (("below", self.below), ("at most", self.at_most))
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
        return float(numbers[~self._right(numbers)].flat[0])

    def _right(self, numbers: Any) -> Any:
        right = (numbers > _or(self.above, -math.inf)) & (numbers < _or(self.below, math.inf))
        right = right & (numbers >= _or(self.at_least, -math.inf)) & (numbers <= _or(self.at_most, math.inf))
        return right & (numbers == np.floor(numbers)) if self.whole else right

    def _amount(self, value: float) -> str:
        number = f"{value:.0f}" if value == round(value) and abs(value) < 1e8 else f"{value:.6g}"
        return f"{number} {self.unit}".rstrip()


def check_number(
    owner: str,
    name: str,
    value: Any,
    unit: str = "",
    *,
    at_least: float | None = None,
    above: float | None = None,
    at_most: float | None = None,
    below: float | None = None,
    whole: bool = False,
) -> None:
    """Raise :class:`InputError` unless a number of ``owner``, or each of an array, is allowed; see :class:`Bounds`.

    >>> check_number("Lidar2D", "rate", 0.0, "Hz", above=0.0)
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: Lidar2D: rate = 0.0 Hz must be finite and above 0 Hz, without an upper limit
    """
    bounds = Bounds(unit, at_least, above, at_most, below, whole)
    if not bounds.holds(value):
        shown = f"{value} {unit}".rstrip()
        raise InputError(f"{owner}: {name} = {shown} must be {bounds.allowed()}")


def _or(value: float | None, other: float) -> float:
    return other if value is None else value
