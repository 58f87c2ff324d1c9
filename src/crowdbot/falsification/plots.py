"""Pictures of a search as SVG: robustness of all runs, and factors of the failures."""

from __future__ import annotations

import html
import math

import numpy as np

from .result import FalsificationResult

WIDTH, HEIGHT, MARGIN, LABELS = 760, 300, 56, 250
MOST = 3000
"""Largest number of runs without a failure that are drawn."""
COLORS = ("#c2403a", "#d98a1f", "#7a4fb5", "#1f8a8a", "#b5487f", "#5c6b1f")
"""Colors of the first clusters; others are dark."""
OTHER = "#333"
REACH = 4.5
"""Range of the coordinates that is drawn, in standard deviations."""


def runs_svg(result: FalsificationResult) -> str:
    """Return a picture of the robustness of each run in the order of the search; the color is that of the cluster."""
    values = np.array([sample.robustness for sample in result.samples])
    finite = values[np.isfinite(values)]
    if not len(finite):
        return ""
    low, high = min(0.0, float(finite.min())), max(float(np.quantile(finite, 0.99)), 1e-3)

    def x_of(k: float) -> float:
        return MARGIN + (WIDTH - 1.5 * MARGIN) * k / max(1, len(values) - 1)

    def y_of(value: float) -> float:
        return MARGIN / 2 + (HEIGHT - 1.5 * MARGIN) * (high - min(value, high)) / (high - low)

    colors = _colors(result)
    safe = [k for k in range(len(values)) if k not in colors and math.isfinite(values[k])]
    safe = [safe[k] for k in np.unique(np.linspace(0, len(safe) - 1, min(len(safe), MOST)).astype(int))] if safe else []
    dots = [f'<circle cx="{x_of(k):.1f}" cy="{y_of(values[k]):.1f}" r="1.3" fill="#9aa4b0"/>' for k in safe]
    dots += [
        f'<circle cx="{x_of(k):.1f}" cy="{y_of(values[k]):.1f}" r="2.2" fill="{color}"/>' for k, color in colors.items()
    ]
    base, zero = HEIGHT - MARGIN, y_of(0.0)
    lines = f'<path d="M{MARGIN} {MARGIN / 2:.1f}V{base}H{WIDTH - MARGIN / 2}" stroke="#59636f" fill="none"/>'
    lines += (
        f'<path d="M{MARGIN} {zero:.1f}H{WIDTH - MARGIN / 2}" stroke="#c2403a" stroke-dasharray="4 3" fill="none"/>'
    )
    texts = [f'<text x="{MARGIN - 6}" y="{y_of(v) + 4:.1f}" text-anchor="end">{v:.2g}</text>' for v in {low, 0.0, high}]
    texts += [
        f'<text x="{x_of(k):.1f}" y="{base + 18}" text-anchor="middle">{k + 1}</text>'
        for k in sorted({0, len(values) // 2, len(values) - 1})
    ]
    texts.append(f'<text x="{WIDTH / 2}" y="{base + 38}" text-anchor="middle">run</text>')
    title = "robustness; a failure is at or below 0"
    texts.append(f'<text x="{MARGIN}" y="16">{title}</text>')
    return _svg(HEIGHT, "Robustness of all runs", [*dots, lines, *texts])


def factors_svg(result: FalsificationResult) -> str:
    """Return a picture of the failures on each factor, in standard deviations from its median."""
    colors = _colors(result)
    if not colors or not result.factors:
        return ""
    row = 26
    height = row * len(result.factors) + 50

    def x_of(z: float) -> float:
        return LABELS + (WIDTH - LABELS - 20) * (min(max(z, -REACH), REACH) + REACH) / (2 * REACH)

    parts = []
    for d, factor in enumerate(result.factors):
        y = 20 + row * d
        label = html.escape(f"{factor.path} = {factor.text}")
        parts.append(f'<text x="{LABELS - 8}" y="{y + 4}" text-anchor="end" font-size="10">{label}</text>')
        parts.append(f'<path d="M{x_of(-REACH):.1f} {y}H{x_of(REACH):.1f}" stroke="#dde3ea"/>')
        parts.append(f'<path d="M{x_of(-1):.1f} {y}H{x_of(1):.1f}" stroke="#9aa4b0" stroke-width="4"/>')
        for k, color in colors.items():
            x = x_of(result.samples[k].point[d])
            parts.append(f'<path d="M{x:.1f} {y - 8}V{y + 8}" stroke="{color}" stroke-opacity="0.5"/>')
    base = height - 22
    parts += [
        f'<text x="{x_of(z):.1f}" y="{base}" text-anchor="middle">{z:+d} sd</text>' if z else
        f'<text x="{x_of(0):.1f}" y="{base}" text-anchor="middle">median</text>'
        for z in (-4, -2, 0, 2, 4)
    ]  # fmt: skip
    return _svg(height, "Factors of the failures", parts)


def _colors(result: FalsificationResult) -> dict[int, str]:
    """Return the color of each failure by the index of its run."""
    colors = [*COLORS, *[OTHER] * len(result.clusters)]
    return {k: colors[n] for n, cluster in enumerate(result.clusters) for k in cluster.members}


def _svg(height: int, label: str, parts: list[str]) -> str:
    return f'<svg viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{label}">{"".join(parts)}</svg>'
