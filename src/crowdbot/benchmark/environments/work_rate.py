"""Rates of repeated work, per CPU second of all threads and per second of wall time."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class TimedWork:
    """Work to time: ``work(state)`` processes ``amount`` units of the new state that ``prepare()`` returns.

    ``prepare`` is not timed.
    """

    amount: float
    prepare: Callable[[], Any]
    work: Callable[[Any], object]


@dataclass(frozen=True)
class WorkRate:
    """Units per CPU second, over all threads of the process, and per second of wall time."""

    per_cpu_second: float
    per_second: float


def rates(works: Mapping[str, TimedWork], repeats: int, warm_up: bool = True) -> dict[str, WorkRate]:
    """Return the median rate of each work.

    The works alternate, which spreads a change of the machine's load over all of them.

    Args:
        works: works by name.
        repeats: number of timed executions of each.
        warm_up: execute each once before, to compile and load kernels.
    """
    if warm_up:
        for work in works.values():
            work.work(work.prepare())
    seconds: dict[str, list[tuple[float, float]]] = {name: [] for name in works}
    for _ in range(repeats):
        for name, work in works.items():
            state = work.prepare()
            cpu, wall = time.process_time(), time.perf_counter()
            work.work(state)
            seconds[name].append((time.process_time() - cpu, time.perf_counter() - wall))
    return {
        name: WorkRate(
            works[name].amount / max(statistics.median(cpu for cpu, _ in found), 1e-9),
            works[name].amount / max(statistics.median(wall for _, wall in found), 1e-9),
        )
        for name, found in seconds.items()
    }
