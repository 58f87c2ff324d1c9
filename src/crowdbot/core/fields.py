"""Fields of trial elements: their XML names, allowed values, notation and descriptions.

Trials are frozen dataclasses whose fields are made by the functions below. The reader, the writer and the schema only
use :func:`outline`, so a new element only needs a new dataclass.
"""

from __future__ import annotations

import dataclasses
import functools
import importlib
import math
import re
import types
import typing
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from .errors import InputError, did_you_mean
from .markup.xml_tree import parse_number
from .model_parameter import Bounds

LARGEST = 1e6
"""Largest number in a trial, in any unit."""

NAME = "[A-Za-z][A-Za-z0-9_]*"
"""Names that other elements refer to; names of robots and sensors are part of ROS topics and frames."""

UNWRITABLE = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def plain(value: float) -> str:
    """Return the shortest text that is parsed as the same number.

    >>> plain(4.0), plain(0.1)
    ('4', '0.1')
    """
    return repr(float(value)).removesuffix(".0")


WITH_UNIT = re.compile(r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d+)?\s*[A-Za-z%°][A-Za-z0-9/%²°*^]*")


def unit_hint(text: str, unit: str) -> str:
    """Return the unit of a value as the end of an error about a number with letters behind it; empty otherwise.

    >>> unit_hint("10m", "s")
    '; give it in s, without the unit'
    >>> unit_hint("ten", "s"), unit_hint("10 people", "")
    ('', '; give the number without a unit')
    """
    if WITH_UNIT.fullmatch(text.strip()) is None:
        return ""
    return f"; give it in {unit}, without the unit" if unit else "; give the number without a unit"


class Points(tuple[tuple[float, float], ...]):
    """Points x, y [m], written ``0,0 4,0 4,2``.

    >>> Points.parse("0,0 4,0  4,2.5"), str(Points.of([[0, 0], [4, 0]]))
    (((0.0, 0.0), (4.0, 0.0), (4.0, 2.5)), '0,0 4,0')
    """

    __slots__ = ()

    @classmethod
    def parse(cls, text: str) -> Points:
        """Read points separated by blanks, with a comma between x and y."""
        points = []
        for place in re.sub(r"\s*,\s*", ",", text.strip()).split():
            pair = place.split(",")
            if len(pair) != 2:
                raise InputError(f"has {place[:40]!r} where a point x,y should be, such as 0,0 4,0 4,2")
            try:
                points.append((parse_number(pair[0]), parse_number(pair[1])))
            except InputError as error:
                raise InputError(f"has the point {place[:40]!r}, which {error}") from None
        return cls(points)

    @classmethod
    def of(cls, value: Iterable[Any] | str) -> Points:
        """Return points from any ``[N, 2]`` numbers or from a text."""
        if isinstance(value, cls):
            return value
        if isinstance(value, str):
            return cls.parse(value)
        try:
            pairs = [tuple(float(part) for part in point) for point in value]
        except (TypeError, ValueError):
            pairs = [()]
        if any(len(pair) != 2 for pair in pairs):
            raise InputError("must be points x, y")
        return cls((pair[0], pair[1]) for pair in pairs)

    def shift(self, dx: float, dy: float) -> Points:
        """Return the points moved by dx, dy."""
        return Points((x + dx, y + dy) for x, y in self)

    def __str__(self) -> str:
        """Return the text that :meth:`parse` reads."""
        return " ".join(f"{plain(x)},{plain(y)}" for x, y in self)


@dataclass(frozen=True)
class Constraint:
    """The allowed values of an attribute; ``unit`` and ``about`` document it."""

    about: str
    unit: str = ""
    min: float | None = None
    exclusive_min: float | None = None
    max: float | None = None
    choices: tuple[str, ...] = ()
    pattern: str = ""
    points: int = 0

    def problem(self, value: Any) -> str:
        """Return the problem of a value as the end of a sentence, empty if there is none.

        >>> Constraint("number of people", min=0).problem(-3)
        'must be at least 0 and at most 1000000'
        >>> Constraint("time step", unit="s", exclusive_min=0.0, max=1.0).problem(2.5)
        'must be at most 1 s and above 0 s'
        """
        if isinstance(value, str):
            return self._wrong_word(value)
        if isinstance(value, bool) or value is None:
            return ""
        if isinstance(value, tuple):
            return self._wrong_points(value)
        low, high = getattr(value, "extent", (value, value))
        if not (math.isfinite(low) and math.isfinite(high)):
            return "is not finite"
        if self.bounds.holds(low) and self.bounds.holds(high):
            return ""
        too_high = dataclasses.replace(self.bounds, max=None).holds(low)
        return f"must be {self.bounds.describe(too_high)}{self._reach(low, high)}"

    @functools.cached_property
    def bounds(self) -> Bounds:
        """The range of a number."""
        lowest = -LARGEST if self.min is None and self.exclusive_min is None else self.min
        return Bounds(self.unit, lowest, self.exclusive_min, LARGEST if self.max is None else self.max)

    def _wrong_word(self, value: str) -> str:
        if UNWRITABLE.search(value):
            return "holds a character that XML cannot hold"
        if self.choices and value not in self.choices:
            return f"must be {' or '.join(self.choices)}{did_you_mean(value, self.choices)}"
        if self.pattern and not re.fullmatch(self.pattern, value):
            return f"must match {self.pattern} (a letter, then letters, digits or underscores)"
        return ""

    def _wrong_points(self, value: tuple[tuple[float, float], ...]) -> str:
        if len(set(value)) < self.points:
            return f"must be at least {self.points} different points, such as 0,0 4,0 4,2"
        if not all(math.isfinite(number) for point in value for number in point):
            return "is not finite"
        largest = LARGEST if self.max is None else self.max
        if any(abs(number) > largest for point in value for number in point):
            return f"must lie within {largest:.7g} {self.unit} of the origin"
        return ""

    def _reach(self, low: float, high: float) -> str:
        return "" if low == high else f", and it ranges from {low:g} to {high:g}"


@dataclass(frozen=True)
class PluginSpec:
    """A part that users can extend: the package and the base class of ``type="..."`` in XML."""

    room: str
    contract: str
    drawn: bool = False
    """Whether its attributes may be distributions."""

    def places(self) -> tuple[types.ModuleType, type]:
        """Return the package and the base class."""
        room = importlib.import_module(f"crowdbot.{self.room}")
        return room, getattr(room, self.contract)


@dataclass(frozen=True)
class FieldSpec:
    """One field of an element.

    Fields:
        name: name in Python.
        word: name of the attribute or of the child element in XML.
        role: ``attribute``, ``child``, ``children``, ``plugged`` (a child element) or ``mounted``
            (a plugin whose attributes are those of this element).
        kind: type of the value, or of one child.
        required: whether a value must be given.
        default: value if none is given.
        rule: allowed values of an attribute.
        plug: package and base class of a plugin.
        about: description, one line.
        max: maximum number of child elements.
        elements: classes of the child elements by XML name.
        into: conversion between child elements and one value, see :func:`children`.
    """

    name: str
    word: str
    role: str
    kind: Any
    required: bool
    default: Any
    rule: Constraint | None
    plug: PluginSpec | None
    about: str
    max: int = 1
    elements: Mapping[str, Any] = field(default_factory=dict)
    into: Any = None

    @property
    def words(self) -> tuple[str, ...]:
        """XML names of the child elements."""
        return (self.word,) if self.role == "plugged" else tuple(self.elements)

    @property
    def unit(self) -> str:
        """Unit of the value, empty without one."""
        return "" if self.rule is None else self.rule.unit

    def wrong(self, value: Any) -> str:
        """Return the problem of a value as the end of a sentence; a default has none."""
        is_default = not self.required and value == self.default
        return "" if self.rule is None or is_default else self.rule.problem(value)


def attribute(
    default: Any = dataclasses.MISSING,
    *,
    about: str,
    unit: str = "",
    min: float | None = None,
    exclusive_min: float | None = None,
    max: float | None = None,
    choices: tuple[str, ...] = (),
    pattern: str = "",
    points: int = 0,
) -> Any:
    """Return a field that is an XML attribute: a number, a word, true or false, points, or a distribution."""
    rule = Constraint(about, unit, min, exclusive_min, max, choices, pattern, points)
    return dataclasses.field(default=default, metadata={"role": "attribute", "rule": rule, "about": about})


def child(factory: Any = dataclasses.MISSING, *, about: str) -> Any:
    """Return a field that is one child element; with ``factory=None`` it is optional and defaults to None."""
    row = {"role": "child", "about": about}
    if factory is None:
        return dataclasses.field(default=None, metadata=row)
    return dataclasses.field(default_factory=factory, metadata=row)


def children(words: str | Mapping[str, type], *, about: str, min: int = 0, max: int = 10_000, into: Any = None) -> Any:
    """Return a field of ``min`` (0 or 1) to ``max`` child elements, in order.

    Args:
        words: XML name, or classes by XML name.
        about: description, one line.
        min: minimum number of elements.
        max: maximum number of elements.
        into: converts the children to one value: ``into.gather(children)`` returns the value, ``into.spread(value)``
            the children, ``into.problems(children)`` yields the index and the problem of every conflicting child.
    """
    row = {"role": "children", "words": words, "about": about, "max": max, "into": into}
    return dataclasses.field(metadata=row) if min else dataclasses.field(default=(), metadata=row)


def plugin_field(room: str, contract: str, *, about: str, default: Any = dataclasses.MISSING) -> Any:
    """Return a field that is a child element whose ``type`` is a built-in name or an address."""
    row = {"role": "plugged", "plug": PluginSpec(room, contract), "about": about}
    return dataclasses.field(default=default, metadata=row)


def mounted_field(room: str, contract: str, *, about: str, drawn: bool = False) -> Any:
    """Return a field whose ``type`` and attributes belong to the element itself; ``drawn`` allows distributions."""
    return dataclasses.field(metadata={"role": "mounted", "plug": PluginSpec(room, contract, drawn), "about": about})


@functools.cache
def outline(cls: type) -> tuple[FieldSpec, ...]:
    """Return the fields of an element in the order of the XML."""
    hints = typing.get_type_hints(cls)
    return tuple(_part(field, hints[field.name]) for field in dataclasses.fields(cls) if "role" in field.metadata)


def _part(field: dataclasses.Field[Any], hint: Any) -> FieldSpec:
    row = field.metadata
    several = row["role"] == "children" and row["into"] is None
    kind = typing.get_args(hint)[0] if several else _without_none(hint)
    words = row.get("words", field.name.replace("_", "-"))
    elements = dict(words) if isinstance(words, Mapping) else {words: kind}
    default = field.default if field.default_factory is dataclasses.MISSING else field.default_factory()
    return FieldSpec(
        field.name,
        next(iter(elements)),
        row["role"],
        kind,
        default is dataclasses.MISSING,
        default,
        row.get("rule"),
        row.get("plug"),
        row["about"],
        row.get("max", 1),
        elements if row["role"] in ("child", "children") else {},
        row.get("into"),
    )


def _without_none(hint: Any) -> Any:
    """Return the type of an optional value without None."""
    options = [option for option in typing.get_args(hint) if option is not type(None)]
    return options[0] if isinstance(hint, types.UnionType) and len(options) == 1 else hint


def check(element: Any) -> None:
    """Convert the fields of an element to their types; raise :class:`InputError` if a value is not allowed.

    Called in ``__post_init__``. Lists become tuples, and numbers become distributions if the field is one.
    """
    cls: type = type(element)
    for part in outline(cls):
        value = getattr(element, part.name)
        if part.role == "attribute":
            value = _convert_attribute(element, part, value)
        elif part.role == "children" and part.into is None:
            value = _convert_children(element, part, value)
        elif not (isinstance(value, _contract(part)) or (value is None and not part.required)):
            raise InputError(
                f"{cls.__name__}: {part.name} is a {type(value).__name__}, it must be a {_contract(part).__name__}"
            )
        object.__setattr__(element, part.name, value)
        wrong = part.wrong(value)
        if wrong:
            raise InputError(f"{cls.__name__}: {part.name}={quote_value(value)} {wrong}")


def _contract(part: FieldSpec) -> type:
    return part.plug.places()[1] if part.plug else part.kind


def _convert_children(element: Any, part: FieldSpec, value: Any) -> tuple[Any, ...]:
    name = type(element).__name__
    if not isinstance(value, list | tuple):
        raise InputError(f"{name}: {part.name} is a {type(value).__name__}, it must be a list")
    if len(value) > part.max:
        raise InputError(f"{name}: {len(value)} {part.name} are too many, at most {part.max}")
    if part.required and not value:
        raise InputError(f"{name}: {part.name} is empty; it must hold at least one: {part.about}")
    kinds = tuple(part.elements.values())
    for item in value:
        if not isinstance(item, kinds):
            known = " or ".join(kind.__name__ for kind in kinds)
            raise InputError(f"{name}: {part.name} holds a {type(item).__name__}, it takes {known}")
    return tuple(value)


def _convert_attribute(element: Any, part: FieldSpec, value: Any) -> Any:
    if value is None and part.default is None:
        return value
    try:
        if hasattr(part.kind, "of"):
            return part.kind.of(value)
        if part.kind in (int, float) and not isinstance(value, bool | str):
            exact = part.kind(value)
            if exact == value or math.isnan(value):
                return exact
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{type(element).__name__}: {part.name}={quote_value(value)} {error}") from None
    if type(value) is part.kind:
        return value
    raise InputError(f"{type(element).__name__}: {part.name}={quote_value(value)} is not a {part.kind.__name__}")


def quote_value(value: Any) -> str:
    """Return a value in quotes for a message; long values are shortened."""
    text = str(value)
    return f'"{text if len(text) <= 60 else text[:57] + "..."}"'
