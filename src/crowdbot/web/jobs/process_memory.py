"""Memory of a process and of the processes that it has started."""

from __future__ import annotations

import contextlib
import math
import os
import signal
import sys
from pathlib import Path

__all__ = ["end_descendants", "machine_memory", "process_memory"]

PROC = Path("/proc")


def machine_memory() -> float:
    """Return the memory of this machine [B], infinity where the system does not tell it.

    >>> machine_memory() > 1e8
    True
    """
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return math.inf


def process_memory() -> float:
    """Return the resident memory of this process and of those that it has started [B].

    Where the system has no ``/proc``, it is the peak of this process alone, and 0 on Windows.

    >>> process_memory() > 1e6
    True
    """
    if PROC.joinpath("self", "statm").exists():
        page = os.sysconf("SC_PAGE_SIZE")
        return float(page * sum(_pages(pid) for pid in (os.getpid(), *_descendants(os.getpid()))))
    if sys.platform == "win32":
        return 0.0
    import resource

    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)


def end_descendants() -> None:
    """End the processes that this process has started."""
    for pid in _descendants(os.getpid()):
        with contextlib.suppress(OSError):
            os.kill(pid, signal.SIGTERM)


def _pages(pid: int) -> int:
    try:
        return int(PROC.joinpath(str(pid), "statm").read_text().split()[1])
    except (OSError, ValueError, IndexError):  # it has ended
        return 0


def _descendants(pid: int) -> list[int]:
    """Return the processes that a process has started, and theirs."""
    found, front = list[int](), [pid]
    while front:
        with contextlib.suppress(OSError):
            for task in PROC.joinpath(str(front.pop()), "task").iterdir():
                with contextlib.suppress(OSError):
                    children = [int(one) for one in task.joinpath("children").read_text().split()]
                    found += children
                    front += children
    return found
