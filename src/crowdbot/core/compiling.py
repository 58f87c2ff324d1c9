"""Notification of kernel compilation, which takes time in a first run."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

from numba.core import event


class _FirstCompilation(event.Listener):
    def __init__(self, callback: Callable[[], None]) -> None:
        self.callback, self.is_done = callback, False

    def on_start(self, event: Any) -> None:
        """Notify at the first function of crowdbot that is compiled instead of loaded from the cache."""
        function = event.data["dispatcher"].py_func
        if not self.is_done and str(function.__module__).startswith("crowdbot."):
            self.is_done = True
            self.callback()

    def on_end(self, event: Any) -> None:
        """Do nothing."""


@contextlib.contextmanager
def notify_compiling(notify: Callable[[], None]) -> Iterator[None]:
    """Call ``notify`` once, when the first kernel is compiled within the context.

    >>> with notify_compiling(lambda: print("one moment")):
    ...     pass
    """
    with event.install_listener("numba:compile", _FirstCompilation(notify)):
        yield
