"""Pictures of the effects of factors, as SVG for the report."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence

from .sweep_effects import FactorEffect

WIDTH, HEIGHT, MARGIN, STEP = 320, 220, 66, 64
COLORS = ("#1b6ca8", "#c8553d", "#3a7d44", "#8e5ea2", "#b8860b", "#59636f")


def effects_svg(effects: Sequence[FactorEffect]) -> str:
    """Return one picture of the effects of one trial, navigator, robot and metric.

    A panel for each factor has the mean at each level, and a panel for each pair of factors has a line for each level
    of the second one; parallel lines are no interaction. Bars are intervals of 95 %.
    """
    known = [one for one in effects if math.isfinite(one.mean.value)]
    if not known:
        return ""
    low = min(one.mean.low for one in known)
    high = max(one.mean.high for one in known)
    if high - low < 1e-12:
        low, high = low - 0.5, high + 0.5
    groups: dict[tuple[str, ...], list[FactorEffect]] = {}
    for one in known:
        groups.setdefault(one.factors, []).append(one)
    panels = [_panel(k, factors, rows, low, high) for k, (factors, rows) in enumerate(groups.items())]
    columns = min(3, len(panels))
    lines = -(-len(panels) // columns)
    first = known[0]
    label = html.escape(f"{first.metric} of {first.trial}, {first.method}")
    body = "".join(panels)
    return f'<svg viewBox="0 0 {columns * WIDTH} {lines * HEIGHT}" role="img" aria-label="{label}">{body}</svg>'


def _panel(number: int, factors: Sequence[str], rows: Sequence[FactorEffect], low: float, high: float) -> str:
    left, top = (number % 3) * WIDTH, (number // 3) * HEIGHT
    levels = list(dict.fromkeys(row.levels[0] for row in rows))
    lines = list(dict.fromkeys(row.levels[1] for row in rows)) if len(factors) > 1 else [""]

    def y_of(value: float) -> float:
        return top + HEIGHT - 40 - (HEIGHT - 74) * (value - low) / (high - low)

    step = (WIDTH - 2 * MARGIN) / max(1, len(levels) - 1)
    parts = [f'<text x="{left + MARGIN}" y="{top + 16}">{html.escape(" and ".join(factors))}</text>']
    axis = f"M{left + MARGIN - 12} {y_of(high):.1f}V{y_of(low):.1f}H{left + WIDTH - 16}"
    parts.append(f'<path d="{axis}" stroke="#59636f" fill="none"/>')
    for value in (low, (low + high) / 2, high):
        parts.append(f'<text x="{left + MARGIN - 16}" y="{y_of(value) + 4:.1f}" text-anchor="end">{value:.3g}</text>')
    for k, level in enumerate(levels):
        x = left + MARGIN + k * step
        parts.append(f'<text x="{x:.1f}" y="{y_of(low) + 18:.1f}" text-anchor="middle">{html.escape(level)}</text>')
    for j, line in enumerate(lines):
        color, points = COLORS[j % len(COLORS)], []
        for row in rows:
            if len(factors) > 1 and row.levels[1] != line:
                continue
            x = left + MARGIN + levels.index(row.levels[0]) * step + 4 * (j - (len(lines) - 1) / 2)
            y = y_of(row.mean.value)
            points.append(f"{x:.1f} {y:.1f}")
            bar = f"M{x:.1f} {y_of(row.mean.low):.1f}V{y_of(row.mean.high):.1f}"
            parts.append(f'<path d="{bar}" stroke="{color}" fill="none"/>')
            parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{color}"/>')
        parts.append(f'<path d="M{"L".join(points)}" stroke="{color}" fill="none"/>')
        if line:
            x, y = left + MARGIN + j * STEP, top + HEIGHT - 4
            parts.append(f'<text x="{x}" y="{y}" fill="{color}">{html.escape(line)}</text>')
    return "".join(parts)
