"""The command line that runs the worst seeds of a row again, and plays them in its report."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crowdbot.evaluation import CellResult, EvaluationResult


COUNT = 3
"""Number of seeds of a row."""


def print_worst(result: EvaluationResult, options: argparse.Namespace) -> None:
    """Print the worst seeds of each row with the command that plays them."""
    for line in worst_lines(result, options):
        print(line)


def worst_values(cell: CellResult, options: argparse.Namespace) -> dict[str, object]:
    """Return the worst seeds of a row and the command as JSON values."""
    from crowdbot.evaluation import worst_rows

    rows = worst_rows(cell, COUNT)
    runs = [{"seed": row.seed, "reason": reason} for row, reason in rows]
    return {"runs": runs, "command": _command(cell, [row.seed for row, _ in rows], options) if rows else ""}


def worst_lines(result: EvaluationResult, options: argparse.Namespace) -> list[str]:
    """Return the worst seeds of each row, each followed by the command that plays them."""
    from crowdbot.evaluation import not_dangerous, worst_rows

    lines = []
    for cell in result.cells:
        rows = worst_rows(cell, COUNT)
        if rows:
            where = ", ".join(filter(None, (cell.trial, cell.method, cell.robot)))
            runs = "; ".join(f"seed {row.seed} ({reason})" for row, reason in rows)
            calm = not_dangerous(cell)
            lines.append(f"{where}: {calm}; closest run: {runs}" if calm else f"worst runs of {where}: {runs}")
            lines.append(f"  {_command(cell, [row.seed for row, _ in rows], options)}")
    return lines


def _command(cell: CellResult, seeds: list[int], options: argparse.Namespace) -> str:
    """Return the command of this evaluation for one row and some seeds, all of which its report plays."""
    named = [name for name in options.trials if Path(name).stem == cell.base] or options.trials
    words = ["crowdbot", "evaluate", *named, "--navigators", cell.method]
    words += ["--safety", options.safety] if options.safety != "own" else []
    words += ["--robots", cell.robot] if cell.robot else []
    words += ["--world", options.world] if options.world else []
    swept = {text.partition("=")[0] for texts in options.sweep for text in texts}
    levels = [f"{name}={level}" for name, level in cell.factors.items() if name in swept]
    for setting in [*options.set, *levels]:
        words += ["--set", setting]
    words += ["--trust"] if options.trust else []
    words += ["--seeds", ",".join(map(str, seeds)), "--worst", str(len(seeds)), "--out", "worst"]
    return shlex.join(words)
