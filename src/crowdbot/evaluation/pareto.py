"""Pareto picture: success against time to the goal, with the severity of contacts as colour."""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Sequence

from .intervals import Estimate
from .result import CellResult

WIDTH, HEIGHT, MARGIN = 720, 380, 56
LETTER, LINE, DOT = 6.3, 14.0, 8.0
"""Width of a letter of a label, height of a line, and half of the width of a point."""
HALO = 'stroke="#fff" stroke-width="3" paint-order="stroke"'
"""White edge of a label: a bar behind it crosses no letter."""


def pareto_front(points: Sequence[tuple[float, ...]]) -> list[int]:
    """Return the points that no other point beats; every value is better when it is lower.

    >>> pareto_front([(0.1, 3.0), (0.2, 2.0), (0.2, 3.0)])
    [0, 1]
    """
    return [
        k
        for k, point in enumerate(points)
        if not any(_dominates(other, point) for j, other in enumerate(points) if j != k)
    ]


def _dominates(first: tuple[float, ...], second: tuple[float, ...]) -> bool:
    pairs = list(zip(first, second, strict=True))
    return all(a <= b for a, b in pairs) and any(a < b for a, b in pairs)


def pareto_svg(cells: Sequence[CellResult]) -> str:
    """Return an SVG picture of all cells with a success, or an empty text.

    The best cells of a trial, which no other beats in success, time and severity, have a dark edge. Severity is the
    mean over runs of what the physics world measured, or of the lower bound of discs in the plane. If a cell has
    neither, because the mass of its robot is unknown, collisions take its place.
    """
    rows = [(cell, cell.estimate("success-rate"), cell.estimate("time_to_goal")) for cell in cells]
    rows = [row for row in rows if not math.isnan(row[2].value) and not math.isnan(row[1].value)]
    if not rows:
        return ""
    slowest = max(row[2].high if math.isfinite(row[2].high) else row[2].value for row in rows) * 1.05
    fastest = min(row[2].low if math.isfinite(row[2].low) else row[2].value for row in rows) * 0.95
    harm, measure = _harm([row[0] for row in rows])
    best = _best(rows, harm)
    worst = max((value for value in harm if math.isfinite(value)), default=0.0)

    def x_of(time: float) -> float:
        return MARGIN + (WIDTH - 2 * MARGIN) * (time - fastest) / max(1e-9, slowest - fastest)

    def y_of(share: float) -> float:
        return HEIGHT - MARGIN - (HEIGHT - 1.6 * MARGIN) * share

    legend = f"height: success rate; color: {measure}, green 0" + (f", red {worst:.2g} and more" if worst > 0.0 else "")
    parts = [_axes(fastest, slowest, x_of, y_of, legend)]
    labels = [(x_of(time.value) - DOT, x_of(time.value) + DOT, y_of(share.value) + 4.0) for _, share, time in rows]
    texts = []
    for k, (cell, success, time) in enumerate(rows):
        x, y = x_of(time.value), y_of(success.value)
        edge = "#111" if k in best else "#9aa4b0"
        low, high = (value if math.isfinite(value) else time.value for value in (time.low, time.high))
        bars = f"M{x:.1f} {y_of(success.low):.1f}V{y_of(success.high):.1f}M{x_of(low):.1f} {y:.1f}H{x_of(high):.1f}"
        parts.append(f'<path d="{bars}" stroke="#9aa4b0" fill="none"/>')
        hue = 130.0 * (1.0 - min(1.0, harm[k] / worst)) if worst > 0.0 else 0.0 if math.isinf(harm[k]) else 130.0
        parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="hsl({hue:.0f} 60% 50%)" stroke="{edge}" stroke-width="2"/>'
        )
        label = ", ".join(filter(None, (cell.trial, cell.method, cell.robot)))
        anchor, shift = ("end", -10) if x > WIDTH / 2 else ("start", 10)
        left = x + shift - (LETTER * len(label) if anchor == "end" else 0.0)
        line = _free_line(labels, left, left + LETTER * len(label), y + 4.0)
        labels.append((left, left + LETTER * len(label), line))
        place = f'x="{x + shift:.1f}" y="{line:.1f}" text-anchor="{anchor}"'
        texts.append(f"<text {place} {HALO}>{html.escape(label)}</text>")
    body = "".join(parts + texts)  # labels are above the bars of all cells
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="Success and time to the goal">{body}</svg>'


def _free_line(labels: Sequence[tuple[float, float, float]], left: float, right: float, line: float) -> float:
    """Return the first line from ``line`` down on which a label from ``left`` to ``right`` covers no other."""
    while any(left < other[1] and other[0] < right and abs(line - other[2]) < LINE for other in labels):
        line += LINE
    return line


def _harm(cells: Sequence[CellResult]) -> tuple[list[float], str]:
    """Return the severity of each cell, or its collision rate if one has no severity, and what it is."""
    names = ("max_severity", "severity_lower_bound")
    measured = [next((name for name in names if name in cell.metrics), "") for cell in cells]
    values = [cell.estimate(name).value if name else math.nan for cell, name in zip(cells, measured, strict=True)]
    if any(math.isnan(value) for value in values):
        return [cell.estimate("collision-rate").value for cell in cells], "collision rate"
    return values, "mean severity" if set(measured) == {names[0]} else "mean severity (lower bound in the plane)"


def _best(rows: Sequence[tuple[CellResult, Estimate, Estimate]], harm: Sequence[float]) -> set[int]:
    """Return the rows that no other of their trial beats in success, time and severity."""
    found: set[int] = set()
    for trial in {row[0].trial for row in rows}:
        own = [k for k, row in enumerate(rows) if row[0].trial == trial]
        found |= {own[k] for k in pareto_front([(-rows[k][1].value, rows[k][2].value, harm[k]) for k in own])}
    return found


def _axes(
    fastest: float, slowest: float, x_of: Callable[[float], float], y_of: Callable[[float], float], legend: str
) -> str:
    base, left, right = y_of(0.0), MARGIN, WIDTH - MARGIN
    parts = [f'<path d="M{left} {y_of(1.0):.1f}V{base:.1f}H{right}" stroke="#59636f" fill="none"/>']
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        parts.append(f'<text x="{left - 8}" y="{y_of(share) + 4:.1f}" text-anchor="end">{share:g}</text>')
    for k in range(5):
        time = fastest + (slowest - fastest) * k / 4
        parts.append(f'<text x="{x_of(time):.1f}" y="{base + 18:.1f}" text-anchor="middle">{time:.1f}</text>')
    parts.append(f'<text x="{WIDTH / 2}" y="{base + 38:.1f}" text-anchor="middle">mean time to the goal [s]</text>')
    parts.append(f'<text x="{left}" y="14">{html.escape(legend)}</text>')
    return "".join(parts)
