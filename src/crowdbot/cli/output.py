"""Output of commands: JSON or tables on stdout, progress and notes on stderr."""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
import textwrap
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

    Without column names, the table has no header. In a narrow terminal the columns are closer to each other.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table

    console = Console(width=None if sys.stdout.isatty() else 120, highlight=False, markup=False)
    widths = [
        max(len(line) for cell in column for line in cell.splitlines() or [""])
        for column in zip(head, *rows, strict=False)
    ]
    narrow = words == 1 and sum(widths) + 3 * len(widths) + 1 > console.width
    table = Table(box=box.SIMPLE_HEAD, show_header=any(head), padding=0 if narrow else (0, 1))
    for index, name in enumerate(head):
        table.add_column(name, justify="left" if index < words else "right", overflow="fold")
    first = console.width - sum(widths[1:]) - len(widths) - 1
    for row in rows:
        name = "\n".join(textwrap.wrap(row[0], max(8, first))) if narrow else row[0]  # breaks at spaces and hyphens
        table.add_row(name, *row[1:])
    console.print(title, style="italic")
    console.print(table)
    if caption:
        console.print(caption, style="dim italic")


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
