"""What differs between Linux, macOS and Windows; code for one of them stands in this file where it can."""

from __future__ import annotations

import math
import os
import platform
import re
import sys
from pathlib import Path
from typing import BinaryIO, NoReturn

from .errors import InputError

LOCKED_BYTE = 1 << 30
"""Position of the locked byte on Windows, beyond any content, since locked bytes cannot be read by others there."""

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl


def lock_file(stream: BinaryIO) -> None:
    """Lock a file that is open for writing, until it is closed.

    It is ``flock`` on Linux and macOS, and on Windows ``msvcrt.locking`` of one byte.

    Raises:
        OSError: it is locked by another process, or by this one through another stream.

    >>> import tempfile
    >>> with tempfile.TemporaryFile() as stream:
    ...     lock_file(stream)
    """
    if sys.platform == "win32":
        place = stream.tell()
        stream.seek(LOCKED_BYTE)
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
        stream.seek(place)
    else:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)


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

        if STATUS.exists() and (match := re.search(r"VmHWM:\s+(\d+)", STATUS.read_text(encoding="utf-8"))):
            return float(match[1]) * 2**10  # getrusage would count the memory of the parent at the fork
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return float(peak if sys.platform == "darwin" else peak * 2**10)


NAMES = {"linux": "Linux", "darwin": "macOS", "win32": "Windows"}


def system_name() -> str:
    """Return the name of this operating system for messages.

    >>> system_name() in ("Linux", "macOS", "Windows")
    True
    """
    return NAMES.get(sys.platform) or platform.system()


def refuse_system(what: str, systems: str, instead: str) -> NoReturn:
    """Raise the exception of a feature that this operating system lacks.

    Args:
        what: the feature, in the singular.
        systems: where it works.
        instead: what the user can do on this system.

    Raises:
        InputError: always.

    >>> refuse_system("the hourglass", "Multics", "use a clock")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: the hourglass needs Multics, this is ...; use a clock
    """
    raise InputError(f"{what} needs {systems}, this is {system_name()}; {instead}")


def user_cache_folder() -> Path:
    """Return the folder of crowdbot for what can be computed anew.

    >>> user_cache_folder().name
    'crowdbot'
    """
    if sys.platform == "win32":
        folder = _local_data()
    elif sys.platform == "darwin":
        folder = Path.home() / "Library" / "Caches"
    else:
        folder = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return folder / "crowdbot"


def user_data_folder() -> Path:
    """Return the folder of crowdbot for files that the user has put there.

    >>> user_data_folder().name
    'crowdbot'
    """
    if sys.platform == "win32":
        folder = _local_data()
    elif sys.platform == "darwin":
        folder = Path.home() / "Library" / "Application Support"
    else:
        folder = Path(os.environ.get("XDG_DATA_HOME", Path.home() / ".local" / "share"))
    return folder / "crowdbot"


def _local_data() -> Path:
    return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
