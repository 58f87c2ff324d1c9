"""HangWatch: interrupts the decision of a navigator that does not return."""

from __future__ import annotations

import ctypes
import math
import os
import threading
import time
from types import TracebackType

__all__ = ["LONGEST", "HangWatch", "HungNavigatorError"]

LONGEST = 60.0
"""Longest real time [s] of a decision."""
AGAIN = 1.0
"""Time [s] after which a decision that has caught the exception is interrupted again."""


class HungNavigatorError(Exception):
    """A decision took longer than :data:`LONGEST`."""


class HangWatch:
    """Raises :class:`HungNavigatorError` in the current thread if the code inside takes too long.

    Python code is interrupted between two of its instructions, in any thread. A call of compiled code is not
    interrupted before it returns.

    Args:
        what: what is watched, for the message.
        limit: longest real time [s]; None: :data:`LONGEST`.

    >>> with HangWatch("an example", limit=0.1):
    ...     while True:
    ...         pass
    Traceback (most recent call last):
    crowdbot.navigation.hang_watch.HungNavigatorError: an example did not return within 0.1 s
    """

    def __init__(self, what: str, limit: float | None = None) -> None:
        self._limit = LONGEST if limit is None else limit
        self._sentence = f"{what} did not return within {self._limit:g} s"
        self._thread, self._end, self._late = threading.get_ident(), 0.0, False

    def __enter__(self) -> HangWatch:
        """Begin to watch."""
        self._end = time.monotonic() + self._limit
        _WATCHER.add(self)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End, and tell how long the code was allowed to take."""
        _WATCHER.remove(self)
        if self._late and (error is None or isinstance(error, HungNavigatorError)):
            raise HungNavigatorError(self._sentence) from None

    def interrupt(self, now: float) -> None:
        """Raise the exception in the watched thread; called by the watcher."""
        self._late, self._end = True, now + AGAIN
        _raise_in(self._thread, HungNavigatorError)

    @property
    def end(self) -> float:
        """Time of the next interrupt."""
        return self._end

    def forget(self) -> None:
        """Take back an exception that has not been raised yet."""
        if self._late:
            _raise_in(self._thread, None)


class _Watcher:
    """A thread that interrupts the watched code; it starts with the first watch of a process."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget everything, without a thread."""
        self._change = threading.Condition()
        self._watches: list[HangWatch] = []
        self._runner: threading.Thread | None = None
        self._wake = math.inf

    def add(self, watch: HangWatch) -> None:
        with self._change:
            self._watches.append(watch)
            if self._runner is None:
                self._runner = threading.Thread(target=self._run, name="crowdbot-hang-watch", daemon=True)
                self._runner.start()
            elif watch.end < self._wake:  # otherwise it wakes early enough, without a switch of threads now
                self._change.notify()

    def remove(self, watch: HangWatch) -> None:
        with self._change:
            self._watches.remove(watch)
            watch.forget()

    def _run(self) -> None:
        with self._change:
            while True:
                now = time.monotonic()
                for watch in self._watches:
                    if now >= watch.end:
                        watch.interrupt(now)
                self._wake = min((watch.end for watch in self._watches), default=math.inf)
                self._change.wait(None if self._wake == math.inf else max(0.0, self._wake - now))


def _raise_in(thread: int, error: type[BaseException] | None) -> None:
    """Let a thread raise an exception, or take back one that is pending."""
    target = None if error is None else ctypes.py_object(error)
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), target)


_WATCHER = _Watcher()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_WATCHER.reset)  # a forked process has no such thread
