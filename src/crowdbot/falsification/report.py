"""Report of a search: one HTML page with the estimate, clusters, pictures and the failures to play."""

from __future__ import annotations

import html
import importlib.resources
import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from string import Template
from typing import Any

from crowdbot.core import explain_write_errors
from crowdbot.evaluation import CellResult, EvaluationPlan, EvaluationResult, RunRow, WorstRun, worst_runs

from .plots import COLORS, factors_svg, runs_svg
from .result import FalsificationResult
from .search_space import SearchSpace


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
        (n + 1, names[n], one.event, len(one.members), f"{one.share:.3g}",
         f"{result.samples[one.worst].robustness:.3g}", factor_ranges(result, one.members))
        for n, one in enumerate(result.clusters)
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
