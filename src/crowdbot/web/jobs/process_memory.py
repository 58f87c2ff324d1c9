"""Memory of a process and of the processes that it has started."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from pathlib import Path

from crowdbot.core import peak_memory

__all__ = ["end_descendants", "process_memory"]

PROC = Path("/proc")


def process_memory() -> float:
    """Return the resident memory of this process and of those that it has started [B].

    On macOS and Windows, it is the peak of this process alone.

    >>> process_memory() > 1e6
    True
    """
    if sys.platform == "linux" and PROC.joinpath("self", "statm").exists():
        page = os.sysconf("SC_PAGE_SIZE")
        return float(page * sum(_pages(pid) for pid in (os.getpid(), *_descendants(os.getpid()))))
    return peak_memory()


def end_descendants() -> None:
    """End the processes that this process has started, on Linux; elsewhere they end by themselves, or go on."""
    for pid in _descendants(os.getpid()):
        with contextlib.suppress(OSError):
            os.kill(pid, signal.SIGTERM)


def _pages(pid: int) -> int:
    try:
        return int(PROC.joinpath(str(pid), "statm").read_text(encoding="ascii").split()[1])
    except (OSError, ValueError, IndexError):  # it has ended
        return 0


def _descendants(pid: int) -> list[int]:
    """Return the processes that a process has started, and theirs."""
    found, front = list[int](), [pid]
    while front:
        with contextlib.suppress(OSError):
            for task in PROC.joinpath(str(front.pop()), "task").iterdir():
                with contextlib.suppress(OSError):
                    children = [int(one) for one in task.joinpath("children").read_text(encoding="ascii").split()]
                    found += children
                    front += children
    return found
