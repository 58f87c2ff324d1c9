"""Output of commands: JSON or tables on stdout, progress and notes on stderr."""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from crowdbot.trials import Trial


Progress = Callable[[str, float], None]
"""Progress callback: called with the name of the current task and the completed fraction, 0 to 1."""


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--json``."""
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout and nothing else")


def print_json(value: Any) -> None:
    """Print one JSON object; NaN and infinity become null."""
    print(json_text(value))


def json_text(value: Any) -> str:
    """Return the text that :func:`print_json` prints."""
    return json.dumps(_plain(value), indent=2, allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "item") and not hasattr(value, "__len__"):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def print_table(
    title: str, head: Sequence[str], rows: Sequence[Sequence[str]], caption: str = "", words: int = 1
) -> None:
    """Print a table on stdout; the first ``words`` columns are aligned left, the others right.

    Without column names, the table has no header. A table with numbers that is wider than the terminal has columns that
    are closer to each other, then intervals on lines of their own, then names that break after a space or a
    punctuation mark.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table

    console = Console(width=None if sys.stdout.isatty() else 120, highlight=False, markup=False)
    lines = [list(row) for row in rows]
    narrow = words < len(head) and _width(head, lines) + 2 * len(head) > console.width
    if narrow and _width(head, lines) > console.width:
        lines = [[*row[:words], *(cell.replace(" [", "\n[") for cell in row[words:])] for row in lines]
    excess = _width(head, lines) - console.width
    if narrow and excess > 0:
        room = _shrink([_column_width(head[k], [row[k] for row in lines]) for k in range(words)], excess)
        names = [[_break_name(name, size) for name, size in zip(row, room, strict=False)] for row in lines]
        lines = [[*own, *row[words:]] for own, row in zip(names, lines, strict=True)]
    table = Table(box=box.SIMPLE_HEAD, show_header=any(head), padding=0 if narrow else (0, 1))
    for index, name in enumerate(head):
        whole = narrow and index < words  # such names are broken already; numbers give way instead
        table.add_column(name, justify="left" if index < words else "right", overflow="fold", no_wrap=whole)
    for line in lines:
        table.add_row(*line)
    console.print(title, style="italic")
    console.print(table)
    if caption:
        console.print(caption, style="dim italic")


SHORTEST_NAME = 8
"""Smallest width of a column of names [characters]."""


def _column_width(head: str, cells: Iterable[str]) -> int:
    return max(len(line) for cell in (head, *cells) for line in cell.splitlines() or [""])


def _width(head: Sequence[str], rows: Sequence[Sequence[str]]) -> int:
    """Return the width of a table whose columns are one character apart, with its two edges."""
    return 1 + sum(1 + _column_width(name, [row[k] for row in rows]) for k, name in enumerate(head))


def _shrink(widths: Sequence[int], excess: int) -> list[int]:
    """Return smaller widths: the widest column gives first, none becomes narrower than :data:`SHORTEST_NAME`."""
    shrink = list(widths)
    for _ in range(excess):
        widest = max(range(len(shrink)), key=lambda k: shrink[k])
        if shrink[widest] <= SHORTEST_NAME:
            break
        shrink[widest] -= 1
    return shrink


def _break_name(name: str, width: int) -> str:
    """Return a name on lines of at most a width, each ending after a space or a punctuation mark if possible.

    >>> _break_name("robots/mine.py:Mine", 12)
    'robots/\\nmine.py:Mine'
    """
    lines = [""]
    for word in re.findall(r"[^\s/:,_+-]*[\s/:,_+-]*", name):
        if lines[-1] and len(lines[-1] + word.rstrip()) > width:
            lines.append("")
        lines[-1] += word
    return "\n".join(line.rstrip() for line in lines)


def print_metrics(title: str, metrics: Mapping[str, float]) -> None:
    """Print the navigation metrics of an episode with their units."""
    from crowdbot.metrics import FALL_METRICS, IMPACT_METRICS, NAVIGATION_METRICS

    units = NAVIGATION_METRICS | IMPACT_METRICS | FALL_METRICS
    rows = [
        (name.replace("_", " "), number(value), units.get(name.rpartition(".")[2], ("", ""))[0])
        for name, value in metrics.items()
    ]
    print_table(title, ("navigation metric", "value", "unit"), rows)


def number(value: Any, digits: int = 3) -> str:
    """Return a number for a table: ``-`` for a missing value, ``none`` for infinity."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, float) and math.isinf(value):
        return "none"
    if isinstance(value, float):
        return f"{value:.{digits}f}"
    return str(value)


def note(sentence: str) -> None:
    """Print a sentence on stderr."""
    print(sentence, file=sys.stderr, flush=True)


def print_robots(trials: Iterable[Trial], quiet: bool = False) -> None:
    """Print on stderr the robots of trials, once each: type, drive, speed, sensors, and what the trial overrides."""
    from crowdbot.trials import robot_lines

    for line in () if quiet else robot_lines((trial.name, trial.robots) for trial in trials):
        note(f"crowdbot: {line}")


@contextmanager
def print_warnings() -> Iterator[None]:
    """Print warnings of crowdbot as plain sentences on stderr."""
    from crowdbot.simulation import RunFailureWarning

    def say(
        message: Warning | str, category: type[Warning], filename: str, lineno: int,
        file: TextIO | None = None, line: str | None = None,
    ) -> None:  # fmt: skip
        note(f"crowdbot: warning: {message}")

    with warnings.catch_warnings():
        warnings.filterwarnings("always", category=UserWarning, module="crowdbot")
        warnings.filterwarnings("ignore", category=RunFailureWarning)  # the command reports it
        warnings.showwarning = say
        yield


@contextmanager
def progress(quiet: bool = False) -> Iterator[Progress]:
    """Show progress bars on stderr, one for each task; plain lines if stderr is not a terminal.

    With ``CROWDBOT_PROGRESS=json`` in the environment, the lines are JSON, ``{"task": "evaluate", "share": 0.25}``, for
    programs that start a command. Also reports the compilation of kernels.
    """
    if os.environ.get("CROWDBOT_PROGRESS") == "json":
        with _report_compilation(note):
            yield _json_lines()
    elif quiet:
        yield lambda what, share: None
    elif sys.stderr.isatty():
        with _bars() as report:
            yield report
    else:
        with _report_compilation(note):
            yield _lines()


@contextmanager
def _report_compilation(say: Callable[[str], None]) -> Iterator[None]:
    from crowdbot.core import cache_folder, is_cold, notify_compiling

    def report() -> None:
        if is_cold():
            say(f"first run: compiling kernels once, into {cache_folder()}; this takes up to a minute or two")
        else:
            say(f"compiling further kernels once, into {cache_folder()}")

    with notify_compiling(report):
        yield


@contextmanager
def _bars() -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, TaskID, TaskProgressColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bars

    columns = (TextColumn("{task.description:<44}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn())
    with Bars(*columns, console=Console(stderr=True)) as bars:
        known: dict[str, TaskID] = {}

        def report(what: str, share: float) -> None:
            if what not in known:
                known[what] = bars.add_task(what, total=1.0)
            bars.update(known[what], completed=share)

        with _report_compilation(lambda sentence: bars.console.print(sentence, highlight=False, markup=False)):
            yield report


def _json_lines() -> Progress:
    newest: dict[str, float] = {}

    def report(what: str, share: float) -> None:
        if share - newest.get(what, -1.0) >= 0.002 or share >= 1.0:
            newest[what] = share
            note(json.dumps({"task": what, "share": round(float(share), 4)}))

    return report


def _lines() -> Progress:
    quarters: dict[str, int] = {}

    def report(what: str, share: float) -> None:
        quarter = min(4, int(share * 4.0 + 1e-9))
        if quarters.get(what, -1) < quarter:
            quarters[what] = quarter
            if quarter in (0, 4):
                note(f"{what} ..." if quarter == 0 else f"{what} done")

    return report
