"""Report of a search: one HTML page with the estimate, clusters, pictures and the failures to play."""

from __future__ import annotations

import html
import importlib.resources
import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from crowdbot.core import explain_write_errors
from crowdbot.evaluation import CellResult, EvaluationPlan, EvaluationResult, RunRow, WorstRun, worst_runs

from .result import FalsificationResult
from .search_space import SearchSpace

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


def write_report(result: FalsificationResult, space: SearchSpace, path: Path) -> None:
    """Write one HTML page that needs no other file and asks nothing from the network.

    Args:
        result: the result of the search.
        space: its search space, from which the failures that are kept are simulated again.
        path: the page.

    Raises:
        InputError: the page cannot be written.
    """
    runs = [_drawing(result, space, one.sample) for one in result.found]
    titles = [
        f"{number}: {result.samples[one.sample].event}, seed {result.samples[one.sample].seed}"
        for number, one in enumerate(result.found, 1)
    ]
    page = Template(_asset("falsification", "report.html")).substitute(
        style=_asset("evaluation", "report.css"),
        script=_asset("evaluation", "report.js"),
        lead=html.escape(_lead(result)),
        summary=_summary(result),
        runs_plot=runs_svg(result),
        clusters=_clusters(result),
        factors_plot=_factors(result),
        runs="".join(f"<option value='{k}'>{html.escape(title)}</option>" for k, title in enumerate(titles)),
        found=_found(result),
        errors=_errors(result),
        data=json.dumps([run.drawing for run in runs], allow_nan=False).replace("<", "\\u003c"),
    )
    with explain_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(page, encoding="utf-8")


def _lead(result: FalsificationResult) -> str:
    """Return what was searched, and what a reader must know of the robot."""
    said = f"{result.title}, failure: {result.failure}. {describe_rarity(result)}"
    return " ".join((said, *(f"Note: {remark}" for remark in result.remarks)))


def _factors(result: FalsificationResult) -> str:
    """Return the section with the factors of failures, empty without any."""
    return f"<section><h2>Factors of the failures</h2>{factors_svg(result)}</section>" if result.failures else ""


def describe_rarity(result: FalsificationResult) -> str:
    """Return how likely a failure is, in a sentence."""
    if result.estimate is None:
        return (
            f"{result.failures} of {len(result.samples)} runs of a directed search fail; it estimates no probability."
        )
    value, low, high, runs = result.estimate
    if not runs:
        return f"None of {len(result.samples)} runs is possible; there is no estimate."
    if not result.failures:
        return f"No run fails; the failure probability is at most {high:.2g} (95 %)."
    once = f", once in {1.0 / value:.3g} runs" if 0.0 < value < 0.5 else ""
    return f"The failure probability is {value:.3g}, 95 % interval {low:.2g} to {high:.2g}{once}."


def factor_ranges(result: FalsificationResult, members: Sequence[int]) -> str:
    """Return the ranges of all factors among some runs as text."""
    return ", ".join(
        f"{path} {' or '.join(map(str, values))}" if values and isinstance(values[0], str)
        else f"{path} {values[0]:.3g} to {values[1]:.3g}"
        for path, values in result.ranges(members).items()
    )  # fmt: skip


def _drawing(result: FalsificationResult, space: SearchSpace, index: int) -> WorstRun:
    sample = result.samples[index]
    plan = EvaluationPlan([space.variant_of(sample.point)], seeds=[sample.seed], trust=space.trust)
    row = RunRow(sample.seed, sample.outcome, sample.digest)
    cell = CellResult(result.trial, result.method, "", "", {}, (row,))
    return worst_runs(plan, EvaluationResult((cell,)))[0]


def _asset(folder: str, name: str) -> str:
    return importlib.resources.files("crowdbot").joinpath("assets", folder, name).read_text(encoding="utf-8")


def _table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    names = "".join(f"<th>{html.escape(name)}</th>" for name in head)
    body = "".join(f"<tr>{''.join(f'<td>{html.escape(str(cell))}</td>' for cell in row)}</tr>" for row in rows)
    return f"<div class='wide'><table><thead><tr>{names}</tr></thead><tbody>{body}</tbody></table></div>"


def _summary(result: FalsificationResult) -> str:
    estimate = "-" if result.estimate is None else str(result.estimate)
    first = "-" if result.first_failure is None else result.first_failure
    head = ("search", "runs", "failures", "first failure at run", "invalid", "failure probability [95 %]")
    return _table(head, [(result.search, len(result.samples), result.failures, first, result.invalid, estimate)])


def _clusters(result: FalsificationResult) -> str:
    if not result.clusters:
        return "<p>No run fails.</p>"
    names = (*("red", "orange", "violet", "teal", "pink", "olive")[: len(COLORS)], *["dark"] * len(result.clusters))
    rows = [
        (n + 1, names[n], cluster.event, len(cluster.members), f"{cluster.share:.3g}",
         f"{result.samples[cluster.worst].robustness:.3g}", factor_ranges(result, cluster.members))
        for n, cluster in enumerate(result.clusters)
    ]  # fmt: skip
    head = ("cluster", "color", "event", "failures", "share of the probability", "least robustness", "values")
    return _table(head, rows)


def _found(result: FalsificationResult) -> str:
    rows = [
        (one.file or n, one.cluster, result.samples[one.sample].event, result.samples[one.sample].seed,
         f"{result.samples[one.sample].robustness:.3g}",
         ", ".join(f"{path} = {_short(value)}" for path, value in one.values.items()))
        for n, one in enumerate(result.found, 1)
    ]  # fmt: skip
    return _table(("trial", "cluster", "event", "seed", "robustness", "values"), rows) if rows else ""


def _short(value: float | int | str) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _errors(result: FalsificationResult) -> str:
    if not result.errors:
        return ""
    about = "<p>A run whose navigator raises, hangs or returns NaN counts as a failure.</p>"
    table = _table(("runs", "message"), [(count, message) for message, count in result.errors.items()])
    return f"<h2>Errors of the navigator</h2>{about}{table}"
