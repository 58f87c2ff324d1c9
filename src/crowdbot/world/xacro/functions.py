"""Functions and methods that xacro expressions may call."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Any

from crowdbot.core import InputError

MOST_ITEMS = 10_000
"""Maximum length of a string, list or range in an expression."""


def _range(*limits: int) -> list[int]:
    found = range(*limits)
    if len(found) > MOST_ITEMS:
        raise InputError(f"a range has more than {MOST_ITEMS} numbers")
    return list(found)


def _factorial(value: int) -> int:
    if not 0 <= value <= 170:
        raise InputError(f"factorial({value}) must be of 0 to 170")
    return math.factorial(value)


def _tokenize(text: str, sep: str = ",; ", skip_empty: bool = True) -> list[str]:
    rows = re.split(f"[{re.escape(sep)}]", text)
    return [row for row in rows if row] if skip_empty else rows


def _round(value: float, digits: int = 0) -> float:
    if not -300 <= digits <= 300:
        raise InputError(f"round() to {digits} digits is not supported")
    return round(value, digits) if digits else round(value)


def _map(function: Callable[[Any], Any], rows: Any) -> list[Any]:
    return [function(row) for row in rows]


def _text(value: Any = "") -> str:
    return str(value)


def _integer(value: Any = 0) -> int:
    if isinstance(value, str) and len(value) > 300:
        raise InputError("a number has more than 300 digits")
    return int(value)


MATH_NAMES = (
    "acos acosh asin asinh atan atan2 atanh ceil copysign cos cosh degrees erf erfc exp expm1 fabs floor fmod frexp"
    " gamma gcd hypot isclose isfinite isinf isnan ldexp lgamma log log10 log1p log2 modf radians sin sinh sqrt tan"
    " tanh trunc"
)
CONSTANTS: dict[str, float] = {"pi": math.pi, "e": math.e, "tau": math.tau, "inf": math.inf, "nan": math.nan}
MATH: dict[str, Any] = {name: getattr(math, name) for name in MATH_NAMES.split() if name != "ldexp"}
MATH |= {"pow": math.pow, "factorial": _factorial, **CONSTANTS}
BUILTIN: dict[str, Any] = {
    "list": list, "dict": dict, "tuple": tuple, "len": len, "str": _text, "float": float, "int": _integer,
    "bool": bool, "min": min, "max": max, "round": _round, "abs": abs, "sum": sum, "sorted": sorted, "any": any,
    "all": all, "range": _range, "map": _map,
}  # fmt: skip
FUNCTIONS: dict[str, Any] = {**MATH, **BUILTIN, "math": MATH, "python": BUILTIN}
"""Names that every expression knows; ``math`` and ``python`` are name spaces. ``xacro`` is added for each file."""
TOKENIZE = {"tokenize": _tokenize}

ATTRIBUTES: Mapping[type, tuple[str, ...]] = {
    str: ("lower", "upper", "strip", "lstrip", "rstrip", "split", "startswith", "endswith", "replace", "join", "title",
          "count", "find", "isdigit"),
    dict: ("keys", "values", "items", "get"),
    list: ("index", "count"),
}  # fmt: skip
"""Methods of strings, dictionaries and lists. ``format`` is missing, since it reaches attributes of objects."""
SPEC = re.compile(r"%(?:%|[-+ 0#]{0,3}\d{0,2}(?:\.\d{1,2})?[sdifgeGEr])")


def format_text(text: str, values: Any) -> str:
    """Return ``text % values`` for the formats s, d, i, f, g, e and r with a width of at most 99.

    Raises:
        InputError: the format is not supported, or does not fit the values.

    >>> format_text("%s_%02d", ("wheel", 3))
    'wheel_03'
    """
    if "%" in SPEC.sub("", text):
        raise InputError(f"the format {text[:60]!r} is not supported; use %s, %d, %f or %g")
    try:
        return str(text % values)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"the format {text[:60]!r} does not fit its values: {error}") from None
