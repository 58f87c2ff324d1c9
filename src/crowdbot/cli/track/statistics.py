"""``crowdbot track SOURCE --statistics``: returns of people in scans, by distance."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import print_json, print_table, progress

from .annotated_scans import is_annotated, read_annotated
from .reading_logs import reading_logs
from .tracker_choice import chosen_detectors

if TYPE_CHECKING:
    from crowdbot.evaluation import ReadingLog


def print_statistics(options: argparse.Namespace) -> int:
    """Print the statistics of the scans of a trial, an episode or recorded scans."""
    from crowdbot.evaluation import scan_statistics

    if is_annotated(options.source):
        title = Path(options.source).name
        bands, missing = scan_statistics(_annotated(options.source))
    else:
        options.detector = options.detector or ["lidar-clusters"]
        with progress(options.json) as report:
            logs = reading_logs(options, options.source, next(iter(chosen_detectors(options).values())), report)
        title = f"{logs[0].name}, {logs[0].sensor}, {len(logs)} runs"
        bands, missing = scan_statistics(row for log in logs for row in _logged(log))
    if options.json:
        print_json({"source": title, "missing": missing, "bands": [one._asdict() for one in bands]})
        return 0
    rows = [
        [f"{one.near:g} to {one.far:g} m", str(one.people), f"{one.returns:.1f}", f"{one.low:.0f} to {one.high:.0f}",
         f"{one.unseen:.3f}", _shown(one.apart), _shown(one.width)]
        for one in bands if one.people
    ]  # fmt: skip
    head = ("distance", "people", "returns a person", "10 to 90 %", "without return", "in two pieces", "width [m]")
    caption = "people who are not hidden; returns at most 0.45 m from the centre;"
    print_table(f"scans of {title}", head, rows, f"{caption} {100 * missing:.1f} % of all beams have no return")
    return 0


def _shown(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2f}"


def _annotated(source: str) -> Iterator[tuple[Any, Any]]:
    for row in read_annotated(source):
        if row.people is not None:
            yield row.scan, row.people


def _logged(log: ReadingLog) -> Iterator[tuple[Any, Any]]:
    import numpy as np

    for row in log.rows:
        yield row.reading, np.array(list(row.people.values())).reshape(-1, 2)
