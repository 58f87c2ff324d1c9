"""DeskThread: a thread that runs the commands of a desk, one after the other."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any


class DeskThread:
    """A daemon thread with a queue of calls.

    The program does not wait for it at its end: a command that compiles kernels for a minute must not hold up Ctrl-C.

    Args:
        name: name of the thread.

    >>> thread = DeskThread("example")
    >>> thread.call(max, 2, 3).result()
    3
    >>> thread.close()
    """

    def __init__(self, name: str) -> None:
        self._calls: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def call(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Call a function in the thread and return its future."""
        future: Future[Any] = Future()

        def run() -> None:
            if not future.set_running_or_notify_cancel():
                return
            try:
                future.set_result(function(*arguments))
            except BaseException as error:
                future.set_exception(error)

        self._calls.put(run)
        return future

    def close(self) -> None:
        """End the thread after the calls that are in its queue."""
        self._calls.put(None)

    def _run(self) -> None:
        while (call := self._calls.get()) is not None:
            call()
