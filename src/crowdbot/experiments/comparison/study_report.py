"""Report of a study: tables and plots."""

from __future__ import annotations

import html
import io
import math
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.core import explain_write_errors

from .study import COLORS, TrialMeasures
from .study_analysis import StudyAnalysis

if TYPE_CHECKING:
    from matplotlib.figure import Figure


STYLE = """
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .75rem; text-align: left; border-bottom: 1px solid #8886; }
.wide { overflow-x: auto; } figure { margin: 1rem 0; background: #fff; } svg { max-width: 100%; height: auto; }
"""
UNTOLD = ("Creator", "Date", "Format", "Type")
"""Metadata of plots that would change the page or name another site."""
COLUMNS = 5
"""Number of plots of measures beside each other."""


def write_study_report(analysis: StudyAnalysis, path: Path, title: str) -> None:
    """Write one HTML page that needs no other file and asks nothing from the network.

    Args:
        analysis: the analysis.
        path: the page.
        title: heading, such as the name of the experiment.

    Raises:
        InputError: the page cannot be written.
    """
    people = len({trial.participant for trial in analysis.trials})
    lost = [trial for trial in analysis.trials if trial.reason]
    labels = list(dict.fromkeys(name for trial in analysis.trials for name in trial.labels))
    body = [
        f"<h1>{html.escape(title)}</h1>",
        f"<p>{len(analysis.trials)} trials of {people} participants, {len(lost)} without a result.</p>",
        "<h2>Conditions</h2><p>Mean and standard deviation over the participants.</p>",
        _conditions(analysis),
        f"<figure>{_svg(measures_figure(analysis))}</figure>"
        if analysis.finite_measures
        else "<p>No trial has a result.</p>",
        "<h2>Differences between conditions</h2><p>Second minus first, within participants, with the 95 % interval; "
        "paired t-test (shares of binary outcomes: exact sign test), Holm's correction over all rows; d<sub>z</sub>: "
        "mean in relation to the standard deviation of the differences; equivalent: both one-sided tests within the "
        "bound have p &lt; 0.05.</p>",
        _tests(analysis),
        f"<h2>Motion in the trials</h2><p>{analysis.study.about}</p>",
        f"<figure>{_tracks_plot(analysis)}</figure>",
        "<h2>All trials</h2>",
        _table(
            ["participant", "condition", *labels, *(m.title for m in analysis.finite_measures.values()), "note"],
            (
                [t.participant, t.condition, *(t.labels.get(name, "") for name in labels), *_row(t, analysis), t.reason]
                for t in analysis.trials
            ),
        ),
    ]
    page = (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
        f'<meta name="viewport" content="width=device-width"><style>{STYLE}</style></head>'
        f"<body>{''.join(body)}</body></html>\n"
    )
    with explain_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(page, encoding="utf-8")


def _row(trial: TrialMeasures, analysis: StudyAnalysis) -> list[str]:
    return [_number(trial.values.get(name, math.nan)) for name in analysis.finite_measures]


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3f}"


def _p_value(value: float) -> str:
    return "-" if math.isnan(value) else "&lt; 0.001" if value < 0.001 else f"{value:.3f}"


def _table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    names = "".join(f"<th>{html.escape(name)}</th>" for name in head)
    cells = ["".join(f"<td>{html.escape(str(cell), quote=False)}</td>" for cell in row) for row in rows]
    body = "".join(f"<tr>{row}</tr>" for row in cells).replace("&amp;lt;", "&lt;")
    return f"<div class='wide'><table><thead><tr>{names}</tr></thead><tbody>{body}</tbody></table></div>"


def _conditions(analysis: StudyAnalysis) -> str:
    rows = []
    for condition in analysis.conditions:
        row: list[Any] = [condition]
        counts = []
        for name in analysis.finite_measures:
            values = np.array(list(analysis.values(name, condition).values()))
            spread = values.std(ddof=1) if len(values) > 1 else math.nan
            row.append(f"{_number(values.mean())} ± {_number(spread)}" if len(values) else "-")
            counts.append(len(values))
        rows.append([*row, max(counts, default=0)])
    return _table(
        ["condition", *(measure.title for measure in analysis.finite_measures.values()), "participants"], rows
    )


def _tests(analysis: StudyAnalysis) -> str:
    rows = []
    for item in analysis.tests:
        test = item.test
        verdict = "unknown" if math.isnan(test.equivalence) else "yes" if test.equivalent else "not shown"
        rows.append(
            [
                analysis.measures[item.measure].title,
                item.first,
                item.second,
                f"{_number(test.difference)} [{_number(test.low)}, {_number(test.high)}]",
                _p_value(item.corrected),
                _number(test.effect),
                f"±{test.bound:g}",
                verdict,
                test.participants,
            ]
        )
    head = ["measure", "first", "second", "difference", "p", "d_z", "bound", "equivalent", "participants"]
    return _table(head, rows)


def _svg(figure: Any) -> str:
    import matplotlib.pyplot as plt

    out = io.StringIO()
    with plt.rc_context({"svg.hashsalt": "crowdbot"}):
        figure.savefig(out, format="svg", bbox_inches="tight", metadata=dict.fromkeys(UNTOLD))
    plt.close(figure)
    text = out.getvalue()
    return text[text.index("<svg") :]


def measures_figure(analysis: StudyAnalysis) -> Figure:
    """Return a plot of each measure: a line for each participant over the conditions, and the means."""
    import matplotlib.pyplot as plt

    conditions, shown = analysis.conditions, analysis.finite_measures
    columns = min(COLUMNS, len(shown))
    rows = -(-len(shown) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(3.0 * columns, 3.4 * rows), squeeze=False)
    for axis in axes.flat[len(shown) :]:
        axis.remove()
    for axis, (name, measure) in zip(axes.flat, shown.items(), strict=False):
        values = [analysis.values(name, condition) for condition in conditions]
        for who in sorted({k for value in values for k in value}):
            axis.plot(
                [value.get(who, math.nan) for value in values], color="0.75", linewidth=0.8, marker="o", markersize=2
            )
        for k, value in enumerate(values):
            if value:
                axis.plot(k, np.mean(list(value.values())), "D", color=COLORS[k % len(COLORS)], markersize=7)
        axis.set_xticks(range(len(conditions)), conditions, rotation=35, ha="right", fontsize=8)
        axis.set_xlim(-0.5, len(conditions) - 0.5)
        axis.set_title(textwrap.fill(measure.title, 34), fontsize=8)
    figure.tight_layout()
    return figure


def _tracks_plot(analysis: StudyAnalysis) -> str:
    """Return the plot of the study of the trials with results."""
    trials = [trial for trial in analysis.trials if not trial.reason]
    return _svg(analysis.study.draw(trials)) if trials else "<p>No trial has a result.</p>"


PANEL_COLUMNS = 3
WIDE = 2.0
"""Width over height of the ways above which the panels are below each other."""


def draw_paths(trials: Sequence[TrialMeasures]) -> Figure:
    """Return a panel for each condition.

    Args:
        trials: trials with the curves ``person`` and ``robot`` ``[T, 2]`` [m], and maybe a point ``mark`` ``[2]`` and
            walls ``wall 1``, ``wall 2``, ... ``[N, 2]``.
    """
    import matplotlib.pyplot as plt

    conditions = list(dict.fromkeys(trial.condition for trial in trials))
    places = np.concatenate([curve.reshape(-1, 2) for trial in trials for curve in trial.curves.values()])
    width, height = np.nanmax(places, axis=0) - np.nanmin(places, axis=0)
    wide = bool(width > WIDE * height)
    columns = 1 if wide else min(PANEL_COLUMNS if len(conditions) != 4 else 2, len(conditions))
    rows = -(-len(conditions) // columns)
    size = (8.0, 2.6 * rows) if wide else (3.4 * columns, 3.8 * rows)
    figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, sharex=True, sharey=True)
    for axis in axes.flat[len(conditions) :]:
        axis.remove()
    for k, (axis, condition) in enumerate(zip(axes.flat, conditions, strict=False)):
        color = COLORS[k % len(COLORS)]
        for trial in (trial for trial in trials if trial.condition == condition):
            axis.plot(*trial.curves["robot"].T, color="0.2", linewidth=1.0, linestyle="--")
            axis.plot(*trial.curves["person"].T, color=color, linewidth=0.9)
            axis.plot(*trial.curves["person"][0], "o", color=color, markersize=3)
            mark = trial.curves.get("mark")
            if mark is not None and np.isfinite(mark).all():
                axis.plot(*mark, "x", color=color, markersize=6)
            for name, wall in trial.curves.items():
                if name.startswith("wall "):
                    axis.plot(*wall.T, color="0.6", linewidth=2.0)
        axis.set_title(condition, fontsize=9, loc="left")
        axis.set_aspect("equal")
        axis.tick_params(labelsize=7)
        axis.set_xlabel("x [m]", fontsize=8)
        axis.set_ylabel("y [m]", fontsize=8)
    figure.tight_layout()
    return figure
