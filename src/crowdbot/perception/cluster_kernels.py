"""Kernels that divide a planar scan into clusters of neighbouring points."""

from __future__ import annotations

import math

from crowdbot.core import kernel
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.typing import Bools, Floats, Ints

FLAT = 0.15
"""A cluster is flat if it bulges towards the scanner by less than this share of its width."""
WIDE = 0.35
"""Width [m] above which a flat cluster is not a person."""


@kernel
def hide_walls(points: Floats, segments: Floats, margin: float, use: Bools) -> None:
    """Clear ``use`` ``[R]`` at points ``[R, 2]`` within ``margin`` [m] of a wall ``[S, 4]``."""
    for s in range(len(segments)):
        ax, ay, bx, by = segments[s, 0], segments[s, 1], segments[s, 2], segments[s, 3]
        left, right = min(ax, bx) - margin, max(ax, bx) + margin
        low, high = min(ay, by) - margin, max(ay, by) + margin
        for k in range(len(points)):
            x, y = points[k, 0], points[k, 1]
            if use[k] and left <= x <= right and low <= y <= high:
                px, py = nearest_on_segment(x, y, ax, ay, bx, by)
                if math.hypot(px - x, py - y) <= margin:
                    use[k] = False


@kernel
def cut_clusters(
    ranges: Floats, use: Bools, step: float, circle: bool, gap: float, dip: float, begin: Ints, size: Ints,
) -> int:  # fmt: skip
    """Write first beam and number of beams of each cluster, and return the number of clusters.

    A cluster ends where two neighbouring points are more than ``gap`` [m] plus two beam widths apart, and where the
    range has a maximum that is ``dip`` [m] above the minima on both sides: two people side by side.
    """
    count, found, start = len(ranges), 0, 0
    if circle:
        for k in range(count):
            if not _joined(ranges, use, (k - 1) % count, k, step, gap):
                start = k
                break
    k = 0
    while k < count:
        if not use[(start + k) % count]:
            k += 1
            continue
        first = k
        while k + 1 < count and _joined(ranges, use, (start + k) % count, (start + k + 1) % count, step, gap):
            k += 1
        k += 1
        found = _split(ranges, start, first, k, dip, begin, size, found)
    return found


@kernel
def _joined(ranges: Floats, use: Bools, one: int, other: int, step: float, gap: float) -> bool:
    if not (use[one] and use[other]):
        return False
    a, b = ranges[one], ranges[other]
    square = a * a + b * b - 2.0 * a * b * math.cos(step)
    limit = gap + 2.0 * min(a, b) * step
    return bool(square <= limit * limit)


@kernel
def _split(ranges: Floats, start: int, first: int, last: int, dip: float, begin: Ints, size: Ints, found: int) -> int:
    """Cut the beams first to last - 1, counted from ``start``, at deep maxima of the range."""
    count = len(ranges)
    low, top, at = ranges[(start + first) % count], -math.inf, first
    for k in range(first + 1, last):
        value = ranges[(start + k) % count]
        if value < low and top < low + dip:
            low, top, at = value, -math.inf, k
        elif value > top:
            top, at = value, k
        if top >= low + dip and value <= top - dip:
            begin[found], size[found] = (start + first) % count, at - first
            found += 1
            first, low, top = at, value, -math.inf
    begin[found], size[found] = (start + first) % count, last - first
    return found + 1


@kernel
def place_clusters(
    ranges: Floats, points: Floats, bearing: Floats, step: float, begin: Ints, size: Ints, origin: Floats,
    body: float, limits: tuple[float, float, float], place: Floats, width: Floats, hidden: Bools,
) -> None:  # fmt: skip
    """Write the centre, the width and whether an edge is hidden for each cluster; NaN for those that are no person.

    ``limits`` are the smallest and the largest width [m], and the share of the beams on a leg that must return. The
    radius of a cluster of half angle a at distance d is d sin(a) / (1 - sin(a)), that of the disc which its outer
    beams touch; with a hidden edge, the disc of radius ``body`` is put at the visible one.
    """
    count = len(ranges)
    for c in range(len(begin)):
        n, b = size[c], begin[c]
        e = (b + n - 1) % count
        near = math.inf
        for k in range(n):
            near = min(near, ranges[(b + k) % count])
        chord = math.hypot(points[e, 0] - points[b, 0], points[e, 1] - points[b, 1])
        width[c] = chord + near * step
        place[c, 0] = math.nan
        if near <= 0.0 or chord > limits[1] or width[c] < limits[0] or n * near * step < limits[2] * 2.0 * LEG:
            continue
        if width[c] > WIDE and _bulge(points, b, n, origin) < FLAT * chord:
            continue
        before, after = ranges[(b - 1) % count], ranges[(e + 1) % count]
        left, right = before < ranges[b] - body, after < ranges[e] - body
        half = 0.5 * n * step
        angle = bearing[b] + 0.5 * (n - 1) * step
        sine = min(0.95, math.sin(min(half, 1.5)))
        radius = min(near * sine / (1.0 - sine), 1.4 * body)
        hidden[c] = (left or right) and radius < 0.8 * body
        if hidden[c] and left != right:
            wide = math.asin(min(1.0, body / (near + body)))
            angle += (wide - half) if right else (half - wide)
        radius = body if hidden[c] else radius
        place[c, 0] = origin[0] + (near + radius) * math.cos(angle)
        place[c, 1] = origin[1] + (near + radius) * math.sin(angle)


LEG = 0.06
"""Radius of a leg [m]."""


@kernel
def _bulge(points: Floats, begin: int, size: int, origin: Floats) -> float:
    """Return how far [m] a cluster bulges over the chord towards the scanner."""
    count = len(points)
    last = (begin + size - 1) % count
    ax, ay = points[begin, 0], points[begin, 1]
    dx, dy = points[last, 0] - ax, points[last, 1] - ay
    length = math.hypot(dx, dy)
    if length == 0.0:
        return 0.0
    side = 1.0 if dx * (origin[1] - ay) - dy * (origin[0] - ax) > 0.0 else -1.0
    best = 0.0
    for k in range(size):
        p = (begin + k) % count
        best = max(best, side * (dx * (points[p, 1] - ay) - dy * (points[p, 0] - ax)) / length)
    return best
