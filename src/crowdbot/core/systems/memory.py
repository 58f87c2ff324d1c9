"""Memory of this machine and of this process, as the operating system tells it."""

from __future__ import annotations

import math
import os
import re
import sys
from pathlib import Path

STATUS = Path("/proc/self/status")


def machine_memory() -> float:
    """Return the memory of this machine [B], infinity where the system does not tell it.

    >>> machine_memory() > 1e8
    True
    """
    if sys.platform == "win32":
        import ctypes

        status = (ctypes.c_ulonglong * 8)(64)  # MEMORYSTATUSEX: its length and the load, then ullTotalPhys
        ctypes.windll.kernel32.GlobalMemoryStatusEx(ctypes.byref(status))
        return float(status[1]) or math.inf
    else:
        try:
            return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
        except (ValueError, OSError):
            return math.inf


def peak_memory() -> float:
    """Return the largest resident memory of this process so far [B].

    >>> peak_memory() > 1e6
    True
    """
    if sys.platform == "win32":
        import ctypes

        counters = (ctypes.c_size_t * 9)()  # PROCESS_MEMORY_COUNTERS: two DWORDs, then PeakWorkingSetSize
        process = ctypes.c_void_p(ctypes.windll.kernel32.GetCurrentProcess())
        ctypes.windll.kernel32.K32GetProcessMemoryInfo(process, ctypes.byref(counters), ctypes.sizeof(counters))
        return float(counters[1])
    else:
        import resource

        if STATUS.exists() and (found := re.search(r"VmHWM:\s+(\d+)", STATUS.read_text(encoding="utf-8"))):
            return float(found[1]) * 2**10  # getrusage would count the memory of the parent at the fork
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return float(peak if sys.platform == "darwin" else peak * 2**10)
