"""Measurements of ``crowdbot bench``.

Each is the median of several repeats after a warm-up. Ratios compare with another measurement of the same run, or with
real time.
"""

from __future__ import annotations

import functools
import os
import platform
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError, MissingExtra, UnknownName

from .bridge_loads import bridge_measurements
from .forecast_frames import LIVE_FRAMES, live_frames, scheme_frames
from .learning import learning_measurements
from .measurement import Gauge, Measurement
from .workloads import measurements

BRIDGES = "bridges"
"""Name of all measurements of bridges."""


@dataclass(frozen=True)
class SpeedRow:
    """One measured speed and its ratio to a reference."""

    name: str
    median: float
    unit: str
    against: str
    ratio: float
    environment: str

    def as_dict(self) -> dict[str, Any]:
        """Return the row as ``crowdbot bench --json`` prints it."""
        return asdict(self)


def measure(
    names: Sequence[str] = (),
    repeats: int = 7,
    progress: Callable[[str, float], None] | None = None,
    recording: Path | None = None,
    more: Mapping[str, Callable[[], Measurement | Gauge]] | None = None,
) -> list[SpeedRow]:
    """Time the named measurements (default: all); calibrated frames are taken from ``recording``, if given.

    The name ``bridges`` stands for all that begin with ``bridge-``. ``more`` are further measurements, of rooms above
    this one.

    Raises:
        UnknownName: a name is not among :func:`crowdbot.benchmark.measurements`.
        MissingExtra: a named measurement needs a package that is not installed (without names: skipped).
        InputError: ``repeats`` is below 1.
    """
    if repeats < 1:
        raise InputError(f"repeats {repeats} is below 1")
    known = (
        measurements()
        | learning_measurements()
        | bridge_measurements()
        | {f"scheme-frame{'-warm' * warm}": functools.partial(scheme_frames, warm, recording) for warm in (False, True)}
        | {name: functools.partial(live_frames, name) for name in LIVE_FRAMES}
        | dict(more or {})
    )
    names = [row for name in names for row in (bridge_measurements() if name == BRIDGES else (name,))]
    unknown = next((name for name in names if name not in known), None)
    if unknown is not None:
        raise UnknownName("measurement", unknown, known)
    report = progress or (lambda what, share: None)
    rows = []
    for name in names or list(known):
        report(name, 0.0)
        try:
            task = known[name]()
        except MissingExtra as error:
            if names:
                raise
            report(f"{name} skipped: {error}", 1.0)
            continue
        rows.append(_row(name, task, repeats, report))
    return rows


def _row(name: str, task: Measurement | Gauge, repeats: int, report: Callable[[str, float], None]) -> SpeedRow:
    if isinstance(task, Gauge):
        report(name, 1.0)
        return SpeedRow(name, task.value, task.unit, task.against, task.value / task.reference, environment())
    task.work()
    if task.other is not None:
        task.other()
    mine: list[float] = []
    theirs: list[float] = []
    for repeat in range(repeats):  # alternating: a change of the load affects both
        mine.append(_seconds(task.work))
        if task.other is not None:
            theirs.append(_seconds(task.other))
        report(name, (repeat + 1) / repeats)
    speed = task.amount / statistics.median(mine)
    reference = task.other_amount / statistics.median(theirs) if theirs else task.reference
    return SpeedRow(name, speed, task.unit, task.against, speed / reference, environment())


def _seconds(work: Callable[[], object]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def load_average() -> float | None:
    """Return the number of processes that wait for a core, the mean over a minute; None where the system has none."""
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else None


def environment() -> str:
    """Return the machine and the versions in one line."""
    import numba

    from crowdbot import __version__

    return (
        f"{_processor()}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()},"
        f" numpy {np.__version__}, numba {numba.__version__}, crowdbot {__version__}"
    )


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())
