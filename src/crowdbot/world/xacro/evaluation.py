"""Evaluation of expression trees with limits of steps and sizes."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from crowdbot.core import InputError, did_you_mean

from .expression import Tree

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


MOST_STEPS = 1_000_000
LARGEST = 2.0**1000
ARITHMETIC: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "//": operator.floordiv,
    "%": operator.mod, "**": operator.pow,
}  # fmt: skip
COMPARISON: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt, ">": operator.gt, "<=": operator.le, ">=": operator.ge, "==": operator.eq, "!=": operator.ne,
    "in": lambda a, b: a in b, "not in": lambda a, b: a not in b, "is": operator.is_, "is not": operator.is_not,
}  # fmt: skip


MAKERS = ("sign", "binary", "tuple", "list", "dict", "each", "call")
"""Operations that make new values."""


class Names(Protocol):
    """Names of an expression that are not functions: properties."""

    def get(self, name: str, /) -> Any:
        """Return the value of a property; raises ``KeyError`` if there is none."""


class Budget:
    """Number of steps that an expansion may still take.

    >>> Budget(2).spend(3)
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: the expansion needs more than 2 steps, the maximum
    """

    def __init__(self, most: int = MOST_STEPS) -> None:
        self.most, self.left = most, most

    def spend(self, steps: int = 1) -> None:
        """Count steps.

        Raises:
            InputError: none are left.
        """
        self.left -= steps
        if self.left < 0:
            raise InputError(f"the expansion needs more than {self.most} steps, the maximum")


def evaluate(tree: Tree, names: Names, budget: Budget, local: Mapping[str, Any] | None = None) -> Any:
    """Return the value of an expression tree.

    Args:
        tree: result of :func:`parse_expression`.
        names: properties.
        budget: limit of steps.
        local: further names, which hide others.

    Raises:
        InputError: a name is unknown, types do not fit, or a limit is exceeded.
    """
    try:
        return _Evaluation(names, budget, dict(local or {})).of(tree)
    except InputError:
        raise
    except ZeroDivisionError:
        raise InputError("an expression divides by zero") from None
    except (KeyError, IndexError) as error:
        raise InputError(f"there is no item {str(error)[:80]}") from None
    except (TypeError, ValueError, ArithmeticError, AttributeError, RecursionError, MemoryError) as error:
        raise InputError(f"an expression has no value: {str(error)[:120]}") from None


class _Evaluation:
    def __init__(self, names: Names, budget: Budget, local: dict[str, Any]) -> None:
        self.names, self.budget, self.local = names, budget, local

    def of(self, tree: Tree) -> Any:
        self.budget.spend()
        found = getattr(self, f"on_{tree[0]}")(*tree[1:])
        return self.measure(found) if tree[0] in MAKERS else found

    def measure(self, value: Any) -> Any:
        """Return a new value if it is small enough, and count its size."""
        if isinstance(value, int) and abs(value) > LARGEST:
            raise InputError("a number in an expression is too large")
        if isinstance(value, str | list | tuple | dict):
            size = _size(value, MOST_ITEMS)
            if size > MOST_ITEMS:
                raise InputError(f"an expression makes a text or list longer than {MOST_ITEMS}")
            self.budget.spend(size // 16)
        return value

    def on_value(self, value: Any) -> Any:
        return value

    def on_name(self, name: str) -> Any:
        if name in self.local:
            return self.local[name]
        try:
            return self.names.get(name)
        except KeyError:
            pass
        if name in FUNCTIONS:
            return FUNCTIONS[name]
        raise InputError(f"the name {name[:60]!r} is not defined{did_you_mean(name, FUNCTIONS)}")

    def on_if(self, condition: Tree, yes: Tree, no: Tree) -> Any:
        return self.of(yes if self.of(condition) else no)

    def on_or(self, tree: Tree, other: Tree) -> Any:
        return self.of(tree) or self.of(other)

    def on_and(self, tree: Tree, other: Tree) -> Any:
        return self.of(tree) and self.of(other)

    def on_not(self, tree: Tree) -> bool:
        return not self.of(tree)

    def on_sign(self, sign: str, tree: Tree) -> Any:
        value = self.of(tree)
        return -value if sign == "-" else +value

    def on_compare(self, first: Tree, *pairs: tuple[str, Tree]) -> bool:
        left = self.of(first)
        for sign, tree in pairs:
            right = self.of(tree)
            if not COMPARISON[sign](left, right):
                return False
            left = right
        return True

    def on_binary(self, sign: str, tree: Tree, other: Tree) -> Any:
        left, right = self.of(tree), self.of(other)
        if sign == "%" and isinstance(left, str):
            return format_text(left, right)
        if sign == "**":
            return _power(left, right)
        if sign == "*":
            for row, count in ((left, right), (right, left)):
                if isinstance(row, str | list | tuple) and isinstance(count, int) and len(row) * count > MOST_ITEMS:
                    raise InputError(f"an expression makes a text or list longer than {MOST_ITEMS}")
        return ARITHMETIC[sign](left, right)

    def on_tuple(self, *rows: Tree) -> tuple[Any, ...]:
        return tuple(self.of(row) for row in rows)

    def on_list(self, *rows: Tree) -> list[Any]:
        return [self.of(row) for row in rows]

    def on_dict(self, *rows: tuple[Tree, Tree]) -> dict[Any, Any]:
        return {self.of(key): self.of(value) for key, value in rows}

    def on_each(self, body: Tree, name: str, source: Tree, condition: Tree | None) -> list[Any]:
        found, before = [], dict(self.local)
        for value in self.of(source):
            self.local[name] = value
            if condition is None or self.of(condition):
                found.append(self.of(body))
        self.local = before
        return found

    def on_slice(self, *parts: Tree | None) -> slice:
        return slice(*(None if part is None else self.of(part) for part in parts))

    def on_index(self, tree: Tree, index: Tree) -> Any:
        value = self.of(tree)
        if not isinstance(value, str | list | tuple | dict):
            raise InputError(f"a {type(value).__name__} has no items")
        return value[self.of(index)]

    def on_attribute(self, tree: Tree, name: str) -> Any:
        value = self.of(tree)
        if isinstance(value, dict) and name in value:
            return value[name]
        for kind, known in ATTRIBUTES.items():
            if isinstance(value, kind) and name in known:
                return getattr(value, name)
        get = getattr(value, "namespace", None)
        if callable(get):
            try:
                return get(name)
            except KeyError:
                pass
        raise InputError(f"{name[:60]!r} is not an attribute that an expression can use")

    def on_call(self, tree: Tree, rows: tuple[Tree, ...], named: tuple[tuple[str, Tree], ...]) -> Any:
        function = self.of(tree)
        if not callable(function):
            raise InputError(f"a {type(function).__name__} is not a function")
        values = [self.of(row) for row in rows]
        for value in values:
            self.measure(value)
        found = function(*values, **{name: self.of(tree) for name, tree in named})
        return found if isinstance(found, str | int | float | dict | list | tuple | None) else list(found)


def _power(base: Any, exponent: Any) -> Any:
    whole = isinstance(base, int) and isinstance(exponent, int) and exponent >= 0
    if whole and exponent * math.log2(abs(base) + 1) > 1000.0:
        raise InputError("a power in an expression is too large")
    power = base**exponent
    if isinstance(power, complex):
        raise InputError("a power in an expression is not a real number")
    return power


def _size(value: Any, most: int) -> int:
    """Return the number of characters and items in a value, including inner ones; counting stops above ``most``."""
    if isinstance(value, str):
        return len(value)
    if not isinstance(value, list | tuple | dict):
        return 1
    found = 1
    for inner in [*value.keys(), *value.values()] if isinstance(value, dict) else value:
        found += _size(inner, most - found)
        if found > most:
            break
    return found
