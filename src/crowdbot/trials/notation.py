"""Notation of numbers and points in a trial: ``0,0 4,0 4,2``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from crowdbot.core import InputError, parse_number

NAME = "[A-Za-z][A-Za-z0-9_]*"
"""Names that other elements refer to; names of robots and sensors are part of ROS topics and frames."""


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
