"""Arcs and circles of drawings as lines of points."""

from __future__ import annotations

import math
from collections.abc import Sequence

Ring = tuple[tuple[float, float], ...]

DEVIATION = 0.01
"""Largest distance [m] between an arc and its chords."""
MOST_CHORDS = 512
LEAST_CHORDS = 8
"""Number of chords of a full circle."""


def arc_points(
    center: tuple[float, float], radius: float, begin: float, end: float, unit: float
) -> list[tuple[float, float]]:
    """Return points of an arc from one angle counter-clockwise to another [deg]; equal angles are a full circle.

    Args:
        center, radius: in the unit of the drawing.
        begin, end: angles.
        unit: unit of the drawing [m].

    >>> [(round(x, 3), round(y, 3)) for x, y in arc_points((0.0, 0.0), 0.1, 0.0, 90.0, 1.0)]
    [(0.1, 0.0), (0.071, 0.071), (0.0, 0.1)]
    """
    begin = math.radians(math.fmod(begin, 360.0))
    angle = math.fmod(math.radians(math.fmod(end, 360.0)) - begin, 2.0 * math.pi)
    angle = angle if angle > 1e-9 else angle + 2.0 * math.pi
    return _chords(center, radius, begin, angle, unit)


def bulge_points(rows: Sequence[tuple[float, float, float]], closed: bool, unit: float) -> list[tuple[float, float]]:
    """Return points of a polyline with vertices x, y and bulge, the tangent of a quarter of the angle to the next.

    >>> [(round(x, 2), round(y, 2)) for x, y in bulge_points([(0, 0, 1.0), (0.2, 0, 0.0)], False, 1.0)]
    [(0, 0), (0.03, -0.07), (0.1, -0.1), (0.17, -0.07), (0.2, 0)]
    """
    if not rows:
        return []
    ends = [*rows[1:], rows[0]] if closed else rows[1:]
    found = [rows[0][:2]]
    for (x, y, bulge), (u, v, _) in zip(rows, ends, strict=False):
        chord = math.hypot(u - x, v - y)
        if abs(bulge) > 1e-9 and chord > 0.0:
            angle = 4.0 * math.atan(bulge)
            far = 0.25 * chord * (1.0 / bulge - bulge)  # of the centre, to the left of the chord
            center = (0.5 * (x + u) - far * (v - y) / chord, 0.5 * (y + v) + far * (u - x) / chord)
            radius = 0.25 * chord * (abs(bulge) + 1.0 / abs(bulge))
            begin = math.atan2(y - center[1], x - center[0])
            found += _chords(center, radius, begin, angle, unit)[1:-1]
        found.append((u, v))
    return found


def _chords(
    center: tuple[float, float], radius: float, begin: float, angle: float, unit: float
) -> list[tuple[float, float]]:
    size = max(radius * unit, 1e-9)
    widest = 2.0 * math.acos(max(-1.0, 1.0 - DEVIATION / size)) if size > DEVIATION else math.pi
    widest = min(2.0 * math.pi / LEAST_CHORDS, max(2.0 * math.pi / MOST_CHORDS, widest))
    count = max(1, math.ceil(abs(angle) / widest - 1e-9))
    turns = [begin + angle * k / count for k in range(count + 1)]
    return [(center[0] + radius * math.cos(turn), center[1] + radius * math.sin(turn)) for turn in turns]
