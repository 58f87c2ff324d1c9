"""Report of an evaluation: one HTML page with tables, comparisons, a Pareto picture and the worst runs to play."""

from __future__ import annotations

import html
import importlib.resources
import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from string import Template

from crowdbot.core import explain_write_errors
from crowdbot.metrics import metric_table

from .comparison import PairedComparison
from .pareto import pareto_svg
from .realism import load_clearances, realism_notice
from .requirement import Requirement
from .result import CellResult, EvaluationResult
from .statistic import Statistic, metric_title
from .sweep_effects import FactorEffect, factor_effects
from .verdict import judge_cell
from .worst_run import WorstRun, not_dangerous, person_contacts

WIDTH, HEIGHT, MARGIN, STEP = 320, 220, 66, 64
COLORS = ("#1b6ca8", "#c8553d", "#3a7d44", "#8e5ea2", "#b8860b", "#59636f")


def effects_svg(effects: Sequence[FactorEffect]) -> str:
    """Return one picture of the effects of one trial, navigator, robot and metric.

    A panel for each factor has the mean at each level, and a panel for each pair of factors has a line for each level
    of the second one; parallel lines are no interaction. Bars are intervals of 95 %.
    """
    known = [effect for effect in effects if math.isfinite(effect.mean.value)]
    if not known:
        return ""
    low = min(item.mean.low for item in known)
    high = max(item.mean.high for item in known)
    if high - low < 1e-12:
        low, high = low - 0.5, high + 0.5
    groups: dict[tuple[str, ...], list[FactorEffect]] = {}
    for item in known:
        groups.setdefault(item.factors, []).append(item)
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


MOST_CONTACTS = 10
"""Largest number of contacts of a row in the report."""
NO_SUCCESS = "<p>No robot arrived in any run, so there is nothing to compare.</p>"
PROTOCOL_UNITS = {
    "margin": "m", "step": "s", "control_period": "s", "latency": "s", "duration": "s", "goal_tolerance": "m",
    "width": "m", "narrow_passage": "m",
}  # fmt: skip
"""Units of the columns of the protocol."""


def write_report(
    result: EvaluationResult,
    path: Path,
    statistics: Sequence[Statistic],
    *,
    worst: Sequence[WorstRun] = (),
    requirements: Sequence[Requirement] = (),
    comparisons: Sequence[PairedComparison] = (),
    again: Sequence[str] = (),
) -> None:
    """Write one HTML page that needs no other file and asks nothing from the network.

    Args:
        result: the evaluation.
        path: the page.
        statistics: columns of the table.
        worst: runs to play.
        requirements: bounds with their verdicts.
        comparisons: comparisons of the navigators.
        again: lines about the worst runs, with the commands that play them.

    Raises:
        InputError: the page cannot be written.
    """
    seeds = max((len(cell.runs) for cell in result.cells), default=0)
    page = Template(_asset("report.html")).substitute(
        style=_asset("report.css"),
        script=_asset("report.js"),
        lead=_verdicts(result.cells, requirements),
        size=html.escape(
            f"{len(result.cells)} combinations of trial, navigator and robot, {seeds} seeds each. Intervals are 95 %:"
            " exact binomial (Clopper-Pearson) for rates, bootstrap for others."
        ),
        table=_results(result, statistics),
        realism=_realism(result.cells),
        protocol=_protocol(result.cells),
        contacts=_contacts(result.cells),
        requirements=_requirements(result, requirements),
        comparisons=_comparisons(comparisons),
        pareto=(pareto_svg(result.cells) or NO_SUCCESS) + _effects(result, statistics),
        failures=_again(again) + _failures(result),
        calm=_calm(worst),
        runs="".join(f"<option value='{k}'>{html.escape(_title(run))}</option>" for k, run in enumerate(worst)),
        provenance=html.escape(json.dumps(dict(result.provenance), indent=1)),
        data=json.dumps([run.drawing for run in worst], allow_nan=False).replace("<", "\\u003c"),
    )
    with explain_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(page, encoding="utf-8")


def _asset(name: str) -> str:
    return importlib.resources.files("crowdbot").joinpath("assets", "evaluation", name).read_text(encoding="utf-8")


def _verdicts(cells: Sequence[CellResult], requirements: Sequence[Requirement]) -> str:
    """Return the sentences that the page begins with, one paragraph for each row."""
    parts = []
    for cell in cells:
        verdict = judge_cell(cell, requirements)
        kind = "safe" if verdict.safe else "unsafe"
        notes = (*cell.remarks, realism_notice(cell.realism))
        contacts = [f"Hardest contact with a person: {contact.sentence}" for contact in person_contacts(cell)[:1]]
        small = (*contacts, *(f"Note: {note}" for note in notes if note), verdict.limit)
        limit = "".join(f"<br><small>{html.escape(text)}</small>" for text in small)
        parts.append(f"<p class='verdict {kind}'>{html.escape(verdict.sentence)}{limit}</p>")
    return "".join(parts)


def _again(lines: Sequence[str]) -> str:
    text = html.escape("\n".join(lines))
    return f"<h2>Run the worst seeds again</h2><pre>{text}</pre>" if lines else ""


def _calm(worst: Sequence[WorstRun]) -> str:
    """Return which of the rows whose runs are played have no dangerous run."""
    cells = {id(run.cell): run.cell for run in worst}.values()
    lines = [
        f"{', '.join(filter(None, (cell.trial, cell.method, cell.robot)))}: {calm}."
        for cell in cells
        if (calm := not_dangerous(cell))
    ]
    return "".join(f"<p>{html.escape(line)}</p>" for line in lines)


def _title(run: WorstRun) -> str:
    cell, note = run.cell, "" if run.same else " (another digest on this computer)"
    where = " on ".join(filter(None, (cell.method, cell.robot)))
    return f"{cell.trial}, {where}, seed {run.row.seed}: {run.row.outcome}{note}"


def _names(cell: CellResult) -> tuple[str, str, str]:
    return cell.trial, cell.method, cell.robot or "-"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    table = [list(row) for row in rows]
    if not table:
        return ""
    empty = [k for k, name in enumerate(head) if name == "robot" and all(row[k] == "-" for row in table)]
    names = "".join(f"<th>{html.escape(name)}</th>" for k, name in enumerate(head) if k not in empty)
    cells = ["".join(f"<td>{html.escape(cell)}</td>" for k, cell in enumerate(row) if k not in empty) for row in table]
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    return f"<div class='wide'><table><thead><tr>{names}</tr></thead><tbody>{body}</tbody></table></div>"


def _results(result: EvaluationResult, statistics: Sequence[Statistic]) -> str:
    head = ["trial", "navigator", "robot", "runs", *(statistic.title for statistic in statistics)]
    rows = [
        [*_names(cell), str(len(cell.valid)), *(str(cell.estimate(statistic)) for statistic in statistics)]
        for cell in result.cells
    ]
    return _table(head, rows) + _definitions(statistics)


def _definitions(statistics: Sequence[Statistic]) -> str:
    """Return what the columns are, from the table of metrics."""
    table = metric_table()
    metrics = dict.fromkeys(statistic.metric for statistic in statistics if statistic.metric in table)
    rows = [f"<li><b>{name.replace('_', ' ')}</b>: {html.escape(table[name].formula)}</li>" for name in metrics]
    return f"<details><summary>What the columns are</summary><ul>{''.join(rows)}</ul></details>" if rows else ""


def _contacts(cells: Sequence[CellResult]) -> str:
    """Return the table of contacts with persons, the hardest of each row first."""
    rows = [
        [
            *_names(cell),
            str(contact.seed),
            contact.region or "unknown",
            contact.severity,
            f"{contact.speed:.2f}",
            contact.cause or "unknown",
        ]
        for cell in cells
        for contact in person_contacts(cell)[:MOST_CONTACTS]
    ]
    head = ["trial", "navigator", "robot", "seed", "body region", "severity [force / limit]", "impact speed [m/s]"]
    table = _table([*head, "approached by"], rows)
    about = (
        f"<p>The {MOST_CONTACTS} hardest of each row. Severity is the force over the limit of ISO/TS 15066 for the body"
        " region; above 1 is above the onset of pain. In the planar world the region is unknown: the range is that of"
        " all regions below the height of the robot, at the closing speed of the bodies.</p>"
    )
    return f"<h2>Contacts with persons</h2>{about}{table}" if table else ""


def _realism(cells: Sequence[CellResult]) -> str:
    """Return how the people of each trial differ from recorded people around a robot; equal trials share a list."""
    trials: dict[tuple[str, ...], dict[str, None]] = {}
    for cell in cells:
        if cell.realism:
            trials.setdefault(tuple(item.sentence for item in cell.realism), {})[cell.trial] = None
    if not trials:
        return ""
    table = load_clearances()
    parts = [
        "<h2>How real are these people?</h2>"
        f"<p>Some crowds are compared with people in {table.recordings} recordings of a golf cart (CITR, Yang et al."
        f" 2019): the least clearance of each recording, and of the median of {table.seeds} simulated runs of it. The"
        " cart has a radius of 0.9 m, and 8 people walk in the open; smaller robots and dense crowds are not"
        " compared.</p>"
    ]
    for sentences, names in trials.items():
        lines = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in sentences)
        parts.append(f"<p><b>{html.escape(', '.join(names))}</b></p><ul>{lines}</ul>")
    return "".join(parts)


def _protocol(cells: Sequence[CellResult]) -> str:
    """Return the settings that all rows share, and those that differ beside each row."""
    keys = list(dict.fromkeys(key for cell in cells for key in cell.protocol))
    values = {key: [_words(cell.protocol.get(key)) for cell in cells] for key in keys}
    same = [[_protocol_title(key), values[key][0]] for key in keys if len({*values[key]}) == 1]
    differ = [key for key in keys if len({*values[key]}) > 1]
    rows = [[cell.trial, cell.method, *(values[key][k] for key in differ)] for k, cell in enumerate(cells)]
    head = ["trial", "navigator", *map(_protocol_title, differ)]
    shared = _table(["setting", "all rows" if len(cells) > 1 else "value"], same)
    return shared + (_table(head, rows) if differ else "")


def _protocol_title(key: str) -> str:
    unit = PROTOCOL_UNITS.get(key)
    return key.replace("_", " ") + (f" [{unit}]" if unit else "")


def _words(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list | tuple):
        return ", ".join(map(str, value)) or "nothing"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _requirements(result: EvaluationResult, requirements: Sequence[Requirement]) -> str:
    rows = []
    for requirement in requirements:
        for cell in result.cells:
            verdict = requirement.judge(cell.values(requirement.statistic.metric))
            warning = judge_cell(cell).warning
            passed = "holds" if verdict.holds else "does not hold"
            passed += f", but shows nothing: {warning}" if verdict.holds and warning else ""
            rows.append([*_names(cell), requirement.text, passed, verdict.sentence])
    table = _table(["trial", "navigator", "robot", "requirement", "verdict", "measured"], rows)
    return f"<h2>Requirements</h2>{table}" if table else ""


def _comparisons(comparisons: Sequence[PairedComparison]) -> str:
    rows = [
        [comparison.trial, comparison.robot or "-", metric_title(comparison.metric), comparison.first,
         comparison.second, str(comparison.difference), _p_value(comparison.p_value), _p_value(comparison.corrected)]
        for comparison in comparisons
        if not math.isnan(comparison.p_value)
    ]  # fmt: skip
    head = ["trial", "robot", "metric", "first", "second", "second - first", "p", "p corrected"]
    table = _table(head, rows)
    about = "<p>Runs with the same seed are compared in pairs; p-values are corrected for all comparisons (Holm).</p>"
    return f"<h2>Comparisons</h2>{about}{table}" if table else ""


def _effects(result: EvaluationResult, statistics: Sequence[Statistic]) -> str:
    """Return tables and pictures of the effects of factors; empty without factors."""
    if not any(cell.factors for cell in result.cells):
        return ""
    parts = [
        "<h2>Effects of factors</h2><p>The effect of a level is its mean minus the mean of all levels; that of a"
        " pair of levels is what is left after both. Intervals: bootstrap over seeds, 95 %.</p>"
    ]
    for metric in dict.fromkeys(statistic.metric for statistic in statistics):
        groups: dict[tuple[str, str, str], list[FactorEffect]] = {}
        for effect in factor_effects(result, metric):
            groups.setdefault((effect.trial, effect.method, effect.robot), []).append(effect)
        for names, rows in groups.items():
            title = html.escape(f"{metric_title(metric)}: {', '.join(filter(None, names))}")
            cells = [(" and ".join(row.factors), ", ".join(row.levels), str(row.mean), str(row.effect)) for row in rows]
            parts.append(f"<h3>{title}</h3>{effects_svg(rows)}")
            parts.append(_table(["factor", "level", "mean", "effect"], cells))
    return "".join(parts)


def _p_value(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3g}"


def _failures(result: EvaluationResult) -> str:
    rows = [[cell.trial, cell.method, str(row.seed), "failed", row.message] for cell, row in result.failures]
    rows += [[cell.trial, cell.method, str(row.seed), "invalid", row.message] for cell, row in result.invalid]
    table = _table(["trial", "navigator", "seed", "kind", "message"], rows)
    about = (
        "<p>A failed run counts as a run without success. An invalid run is impossible whatever the navigator does,"
        " and counts nowhere.</p>"
    )
    return f"<h2>Failed and invalid runs</h2>{about}{table}" if table else ""
