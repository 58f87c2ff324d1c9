"""Plot of degraded input: error of each predictor by level, one panel per degradation."""

from __future__ import annotations

import math
import os
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .degraded import DegradedScore

COLUMNS = 4
STYLES = (
    ("#0072b2", "o"), ("#e69f00", "s"), ("#009e73", "^"), ("#cc79a7", "D"),
    ("#d55e00", "v"), ("#56b4e9", "P"), ("#000000", "X"), ("#9a9a9a", "*"),
)  # fmt: skip
"""Colours that are distinguishable with colour blindness (Okabe & Ito), and markers."""
COVERAGE = "#9a9a9a"
FAR = 2.5
"""A line that exceeds all others by this factor is clipped."""
SMALLEST = 1e-6
"""Errors below this are treated as 0."""


def plot_degradation(sweeps: Sequence[Sequence[DegradedScore]], folder: Path, title: str = "") -> list[Path]:
    """Write ``degraded.png`` and ``degraded.svg`` atomically and return them.

    Each panel shows the error (ADE) of each predictor by level, the range over the draws, and below it the share of
    predicted people.

    Args:
        sweeps: scores of all levels and predictors for each degradation; not empty.
        folder: existing output folder.
        title: title of the plot.
    """
    from matplotlib import rc_context

    with rc_context({"svg.hashsalt": "crowdbot", "font.family": "sans-serif"}):
        figure = _figure(sweeps)
        figure.suptitle(title, fontsize=10)
        files = []
        for ending, metadata in (("png", {"Software": None}), ("svg", {"Date": None, "Creator": None})):
            file = folder / f"degraded.{ending}"
            draft = file.with_suffix(f".{ending}.part")
            figure.savefig(draft, format=ending, dpi=130, metadata=metadata)
            os.replace(draft, file)
            files.append(file)
    return files


def _figure(sweeps: Sequence[Sequence[DegradedScore]]) -> Any:
    from matplotlib.figure import Figure

    columns = min(COLUMNS, len(sweeps))
    rows = -(-len(sweeps) // columns)
    wide = 3.0 if len(sweeps) > 1 else 6.0
    figure = Figure(
        figsize=(0.5 + wide * columns, 0.9 + (3.3 if len(sweeps) > 1 else 4.4) * rows), layout="constrained"
    )
    styles: dict[str, tuple[str, str]] = {}
    for scores in sweeps:
        for score in scores:
            styles.setdefault(score.predictor, STYLES[len(styles) % len(STYLES)])
    panels = figure.subfigures(rows, columns, squeeze=False)
    for number, (panel, scores) in enumerate(zip(panels.flat, sweeps, strict=False)):
        _panel(panel, scores, styles, first=number % columns == 0)
    lines = panels[0, 0].axes[0].get_lines()
    figure.legend(
        lines, [line.get_label() for line in lines], loc="outside lower center", ncols=4, fontsize=9, frameon=False
    )
    return figure


def _panel(panel: Any, scores: Sequence[DegradedScore], styles: dict[str, tuple[str, str]], first: bool) -> None:
    """Draw one degradation: errors above, share of predicted people below."""
    above, below = panel.subplots(2, 1, sharex=True, height_ratios=(4, 1))
    tops: dict[str, float] = {}
    for number, (predictor, (color, marker)) in enumerate(styles.items()):
        own = [score for score in scores if score.predictor == predictor]
        level = [score.level for score in own]
        error = [score.score.ade if score.score else math.nan for score in own]
        # later lines are thinner: coinciding lines stay visible
        above.plot(
            level,
            error,
            color=color,
            marker=marker,
            label=predictor,
            markersize=max(3.0, 7.5 - number),
            linewidth=max(1.0, 3.0 - 0.5 * number),
        )
        above.fill_between(level, [s.low for s in own], [s.high for s in own], color=color, alpha=0.18, linewidth=0)
        tops[predictor] = max((s.high for s in own if s.score), default=math.nan)
    units = next((score.score.units for score in scores if score.score), "m")
    _limit(above, tops, units)
    one = [score for score in scores if score.predictor == scores[0].predictor]
    below.plot([s.level for s in one], [100.0 * s.coverage for s in one], ".-", color=COVERAGE, linewidth=1.2)
    below.set_ylim(0.0, 110.0)
    for axis in (above, below):
        axis.grid(alpha=0.25, linewidth=0.6)
        axis.tick_params(labelsize=8)
        axis.spines[["top", "right"]].set_visible(False)
    degradation = scores[0].degradation
    unit = "" if degradation.unit in ("1", degradation.level) else f" [{degradation.unit}]"
    below.set_xlabel(f"{degradation.level}{unit}", fontsize=9)
    if first:
        above.set_ylabel(f"mean error (ADE) [{units}]", fontsize=9)
        below.set_ylabel("predicted\n[%]", fontsize=8)
    rest = ", ".join(f"{name} {value}" for name, value in degradation.describe(level=False).items())
    above.set_title("\n".join([degradation.name, *textwrap.wrap(rest, 42)]), fontsize=9)


def _limit(axis: Any, tops: dict[str, float], units: str) -> None:
    """Start the axis at 0, and clip a predictor far worse than all others."""
    axis.set_ylim(bottom=0.0)
    high = sorted(((top, name) for name, top in tops.items() if math.isfinite(top)), reverse=True)
    if len(high) > 1 and high[1][0] > SMALLEST and high[0][0] > FAR * high[1][0]:
        axis.set_ylim(top=1.2 * high[1][0])
        axis.text(
            0.98, 0.97, f"{high[0][1]}\ngoes on to {high[0][0]:.3g} {units}", transform=axis.transAxes, fontsize=7,
            horizontalalignment="right", verticalalignment="top",
        )  # fmt: skip
