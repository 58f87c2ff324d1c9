"""Page with the results of ``crowdbot bench engines``."""

from __future__ import annotations

import textwrap
from pathlib import Path

from crowdbot.core import explain_write_errors

from .report import PROTOCOL, EngineReport

__all__ = ["write_engines_page"]

WIDTH = 120
TITLES = "model, engine, people, order, threads, step [s], crowdbot [ms], engine [ms], ratio, 10 to 90 %"
COLUMNS = tuple(TITLES.split(", "))


def write_engines_page(report: EngineReport, path: Path, command: str) -> None:
    """Write a report as Markdown.

    Args:
        report: the report.
        path: the file.
        command: the command that made the report.

    Raises:
        InputError: the file cannot be written.
    """
    rows = [
        (row.model, row.engine, str(row.people), row.order, str(row.threads), f"{row.dt:g}", f"{row.ours:.3g}",
         f"{row.theirs:.4g}", f"{row.ratio:.2f}", f"{row.low:.2f} to {row.high:.2f}")
        for row in report.rows
    ]  # fmt: skip
    lines = ["# Speed beside other engines", "", "```", command, "```", "", *textwrap.wrap(PROTOCOL, WIDTH), ""]
    lines += [" | ".join(("", *cells, "")).strip() for cells in (COLUMNS, ("---",) * len(COLUMNS), *rows)]
    lines += ["", *(f"* {engine}: {protocol}." for engine, protocol in report.protocols.items())]
    versions = ", ".join(f"{name} {value}" for name, value in sorted(report.versions.items()))
    lines += [f"* {report.machine}; {versions}."]
    lines += [f"* {sentence}." for sentence in report.missing.values()]
    if report.million is not None:
        one = report.million
        lines += ["", f"{one.people} people ({one.model}, all kernels in their default number of threads):"
f" {one.seconds:.2f} s a step of 0.1 s, {one.megabytes:.0f} MB at most."]  # fmt: skip
    with explain_write_errors(path):
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
