"""Threading layer of parallel kernels, safe after ``fork`` and with several Python threads.

GNU OpenMP, the default of numba on Linux, hangs in a child process that is forked after the first parallel kernel. The
``workqueue`` layer supports forks but aborts if two Python threads enter it. oneTBB supports both and is preferred
where its wheel exists; otherwise ``workqueue`` runs behind a lock. So it does on one core: oneTBB has no threads of its
own there, and a program whose first kernel ran in another thread than the main one would wait at its end for a task
that no thread takes. The environment variable ``NUMBA_THREADING_LAYER`` overrides this choice.
"""

from __future__ import annotations

import ctypes
import importlib.metadata
import os
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from numba.core import compiler_lock, config
from numba.np.ufunc import parallel

LIBRARY = {"win32": "tbb12.dll", "darwin": "libtbb.12.dylib"}.get(sys.platform, "libtbb.so.12")
ACTIVE_VALUE = {"win32": "?global_control_active_value@r1@detail@tbb@@YA_KH@Z"}.get(
    sys.platform, "_ZN3tbb6detail2r127global_control_active_valueEi"
)
"""Exported name of a function of oneTBB: the value of a global limit, of which 0 is the number of threads."""
PATIENCE = 10.0
"""Maximum time [s] that a fork waits for kernels in other threads."""

REST = 0.05
"""Time [s] in which idle threads of oneTBB fall asleep."""

_entry = threading.RLock()
"""Held for a moment when a call begins, and during a fork: calls that follow each other do not keep a fork waiting."""
_alone = threading.RLock()
"""Held by the one call that runs on a layer that does not support several Python threads."""
_compiling: Any = compiler_lock.global_compiler_lock
_layer: Any = parallel.threading_layer
_running: set[object] = set()
_callers: set[int] = set()
"""Threads that have called a kernel."""


def prefer_safe_layers() -> None:
    """Make numba try oneTBB first, then ``workqueue``, and let it find the library of the ``tbb`` wheel.

    On one core, ``workqueue`` comes first.
    """
    settings: Any = config
    library = _load_tbb()
    if "NUMBA_THREADING_LAYER_PRIORITY" not in os.environ:
        several = _allowed_threads(library) > 1
        settings.THREADING_LAYER_PRIORITY = [*(("tbb", "workqueue") if several else ("workqueue", "tbb")), "omp"]


def _load_tbb() -> ctypes.CDLL | None:
    """Load the library of the ``tbb`` wheel, which is outside of the search path; numba then finds it by name."""
    try:
        files = importlib.metadata.files("tbb") or []
    except importlib.metadata.PackageNotFoundError:
        return None
    for file in files:
        if file.name.lower() == LIBRARY:
            try:
                return ctypes.CDLL(os.fspath(file.locate().resolve()))  # type: ignore[attr-defined]
            except OSError:  # built for another system: numba uses the next layer
                return None
    return None


def _allowed_threads(library: ctypes.CDLL | None) -> int:
    """Return how many threads oneTBB has, which knows the limits of a container, or how many cores numba sees."""
    try:
        allowed = library[ACTIVE_VALUE]  # type: ignore[index]
    except (AttributeError, TypeError):  # another release, or none
        return int(config.NUMBA_DEFAULT_NUM_THREADS)  # type: ignore[attr-defined]
    allowed.restype = ctypes.c_size_t
    return int(allowed(0))


def guard(compiled: Callable[..., Any]) -> Callable[..., Any]:
    """Return a thread-safe wrapper of a compiled parallel kernel.

    If the threading layer supports only one kernel at a time, a call waits for the others.
    """
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return compiled

    def run(*arguments: Any) -> Any:
        call = object()
        with _entry:  # waits while another thread forks
            _running.add(call)
            _callers.add(threading.get_ident())
        try:
            if _is_thread_safe():
                return compiled(*arguments)
            with _alone:
                return compiled(*arguments)
        finally:
            _running.discard(call)

    return run


def _is_thread_safe() -> bool:
    """Return whether numba has started its threads on a layer that supports several Python threads."""
    try:
        return bool(_layer() != "workqueue")
    except ValueError:  # not started yet
        return False


def _before_fork() -> None:
    """Wait until no other thread runs or compiles a kernel, which the child process could not finish."""
    _entry.acquire()
    end = time.monotonic() + PATIENCE
    while _running and time.monotonic() < end:
        time.sleep(0.0005)
    _compiling.acquire()
    main = threading.main_thread()
    if _is_thread_safe() and (threading.current_thread() is not main or _callers - {main.ident}):
        # numba ends the threads of oneTBB before a fork in the main thread, unless other threads have called kernels.
        # Otherwise the child gets a copy of their state, which works if they sleep and may hang if they hold a lock.
        time.sleep(REST)


def _after_fork_in_parent() -> None:
    _compiling.release()
    _entry.release()


def _after_fork_in_child() -> None:
    global _alone  # noqa: PLW0603
    _alone = threading.RLock()  # a thread that the child does not have may hold the other one
    _running.clear()
    _callers.clear()
    _after_fork_in_parent()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_before_fork, after_in_parent=_after_fork_in_parent, after_in_child=_after_fork_in_child)
