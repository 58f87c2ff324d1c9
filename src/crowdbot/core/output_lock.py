"""Output files: one writer at a time, and no existing file is overwritten unless that is requested."""

from __future__ import annotations

import contextlib
import os
import socket
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from .errors import InputError

ATTEMPTS = 20
"""Maximum number of attempts to take over a stale lock."""
WRITING = 5.0
"""Age [s] below which an empty lock file is assumed to be still being written by its process."""

_held: set[str] = set()


@contextlib.contextmanager
def lock_output(path: Path, force: bool = False) -> Iterator[None]:
    """Lock a file for writing within the context.

    The lock is the file ``.NAME.lock`` in the same folder, with process id and host. A lock is taken over if its
    process was on this host and has ended.

    Args:
        path: the file to write, in an existing folder.
        force: whether an existing file may be overwritten.

    Raises:
        InputError: the file exists and ``force`` is false, is a folder or device, or another run is writing it.
        OSError: the lock cannot be created.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder, lock_output(Path(folder) / "episode.mcap"):
    ...     os.listdir(folder)
    ['.episode.mcap.lock']
    """
    if path.exists() and not path.is_file():
        raise InputError(f"{path} is a {'folder' if path.is_dir() else 'device'}; give the path of a file")
    lock = _lock_of(path)
    _acquire(path, lock)
    try:
        if path.exists() and not force:
            raise InputError(f"{path} already exists; use another path, or --force (force=True) to overwrite it")
        yield
    finally:
        _held.discard(str(lock))
        lock.unlink(missing_ok=True)


def release_stale_lock(path: Path) -> None:
    """Remove the lock of a file if its process has ended.

    Raises:
        InputError: another run is writing the file.
    """
    lock = _lock_of(path)
    if lock.exists():
        _acquire(path, lock)
        _held.discard(str(lock))
        lock.unlink(missing_ok=True)


def _lock_of(path: Path) -> Path:
    whole = path.resolve()
    return whole.with_name(f".{whole.name}.lock")


def _acquire(path: Path, lock: Path) -> None:
    for _ in range(ATTEMPTS):
        try:
            number = os.open(lock, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o644)
        except FileExistsError:
            _remove_stale(path, lock)
            continue
        try:
            with os.fdopen(number, "w", encoding="utf-8") as stream:
                stream.write(f"{os.getpid()} {socket.gethostname()}\n")
        except OSError:  # a full disk
            lock.unlink(missing_ok=True)
            raise
        _held.add(str(lock))
        return
    raise InputError(f"{path} is being written by another run; wait until it ends, or give another place")


def _remove_stale(path: Path, lock: Path) -> None:
    """Remove a lock whose process has ended; only one of several processes succeeds."""
    try:
        text, age = lock.read_text(encoding="utf-8", errors="replace"), time.time() - lock.stat().st_mtime
    except FileNotFoundError:
        return
    except PermissionError:  # Windows: its process is removing it
        time.sleep(0.05)
        return
    pid, _, host = text.strip().partition(" ")
    if not pid.isdigit():
        if age < WRITING:  # its process is writing it, or was killed before; the attempts last longer than WRITING
            time.sleep(0.3)
            return
    elif host != socket.gethostname():
        raise InputError(f"{path} is being written by process {pid} on {host}; if that run has ended, delete {lock}")
    elif str(lock) in _held if int(pid) == os.getpid() else _is_running(int(pid)):
        raise InputError(
            f"{path} is being written by another run (process {pid}); wait until it ends, or give another place"
        )
    taken = lock.with_name(f"{lock.name}.{os.getpid()}")
    with contextlib.suppress(FileNotFoundError):  # another process was faster
        lock.replace(taken)
        if taken.read_text(encoding="utf-8", errors="replace") != text:  # a new lock was created in between
            taken.replace(lock)
        taken.unlink(missing_ok=True)


def _is_running(pid: int) -> bool:
    if sys.platform == "win32":
        import ctypes

        kernel = ctypes.windll.kernel32
        handle = kernel.OpenProcess(0x1000, False, pid)  # PROCESS_QUERY_LIMITED_INFORMATION
        if not handle:
            return bool(kernel.GetLastError() == 5)  # ERROR_ACCESS_DENIED: it runs, under another user
        status = ctypes.c_ulong()
        kernel.GetExitCodeProcess(handle, ctypes.byref(status))
        kernel.CloseHandle(handle)
        return status.value == 259  # STILL_ACTIVE
    else:
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return False
        except (PermissionError, OverflowError):
            return True
        return True
