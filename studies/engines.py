"""Measure crowd models beside other engines in the same run: docs/results/engines.md.

    python studies/engines.py --page docs/results/engines.md [--repeats 7] [--rvo2 FOLDER] [--quick]

``crowdbot bench engines`` measures the same and prints the table.
"""

from __future__ import annotations

import argparse
import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path

from crowdbot.benchmark import EngineReport, EngineSizes, measure_engines
from crowdbot.cli.output import progress
from crowdbot.core import CrowdbotError, explain_write_errors

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
    lines = [
        "# Speed beside other engines",
        "",
        "```",
        command,
        "```",
        "",
        *textwrap.wrap(report.as_dict()["protocol"], WIDTH),
        "",
    ]
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


def main(words: Sequence[str] | None = None) -> int:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--page", type=Path, required=True, metavar="FILE.md", help="page")
    add("--repeats", type=int, default=7, metavar="N", help="timed repetitions (default: 7)")
    add("--rvo2", type=Path, metavar="FOLDER", help="source of RVO2, which is compiled (default: the package pyrvo)")
    add("--quick", action="store_true", help="small crowds: a test of the command")
    options = parser.parse_args(words)
    command = [f"python studies/engines.py --repeats {options.repeats}", *(["--quick"] if options.quick else [])]
    command += [*(["--rvo2 RVO2"] if options.rvo2 is not None else []), "--page engines.md"]
    try:
        sizes = EngineSizes.quick(options.repeats) if options.quick else EngineSizes(options.repeats)
        with progress() as report:
            engines = measure_engines(sizes, options.rvo2, report)
        write_engines_page(engines, options.page, " ".join(command))
    except CrowdbotError as error:
        parser.error(str(error))
    return 0


if __name__ == "__main__":
    sys.exit(main())
