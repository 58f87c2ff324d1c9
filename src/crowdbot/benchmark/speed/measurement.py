"""Results of a benchmark: timed work, or a value that is read once."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Gauge", "Measurement", "peak_memory"]


@dataclass(frozen=True)
class Measurement:
    """Work to time: ``work()`` processes ``amount`` units; its speed is divided by ``reference`` [units/s].

    If ``other`` is given, it processes ``other_amount`` of the same units, and its speed is the reference.
    """

    unit: str
    amount: float
    work: Callable[[], object]
    against: str
    reference: float = 0.0
    other: Callable[[], object] | None = None
    other_amount: float = 0.0


@dataclass(frozen=True)
class Gauge:
    """A value that is read once and not timed; the ratio is ``value / reference``."""

    unit: str
    value: float
    against: str
    reference: float


def peak_memory() -> float:
    """Return the largest memory of this process so far [MB]."""
    if sys.platform == "win32":
        import ctypes

        counters = (ctypes.c_size_t * 9)()  # PROCESS_MEMORY_COUNTERS: two DWORDs, then PeakWorkingSetSize
        process = ctypes.c_void_p(ctypes.windll.kernel32.GetCurrentProcess())
        ctypes.windll.kernel32.K32GetProcessMemoryInfo(process, ctypes.byref(counters), ctypes.sizeof(counters))
        return float(counters[1]) / 2**20
    status = Path("/proc/self/status")
    if status.exists() and (found := re.search(r"VmHWM:\s+(\d+)", status.read_text(encoding="utf-8"))):
        return int(found[1]) / 2**10  # getrusage would count the memory of the parent at the fork
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)
