"""Compiling, told: who waits for kernels that have not been compiled yet may hear of it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

from numba.core import event

__all__ = ["notify_compiling"]


class _Once(event.Listener):
    def __init__(self, tell: Callable[[], None]) -> None:
        self.tell, self.told = tell, False

    def on_start(self, event: Any) -> None:
        """Tell of the first function of crowdbot that is compiled; one that the cache holds is not."""
        function = event.data["dispatcher"].py_func
        if not self.told and str(function.__module__).startswith("crowdbot."):
            self.told = True
            self.tell()

    def on_end(self, event: Any) -> None:
        """Say nothing more."""


@contextlib.contextmanager
def notify_compiling(tell: Callable[[], None]) -> Iterator[None]:
    """Call ``tell`` as soon as a kernel has to be compiled, once for as long as the context lasts.

    >>> with notify_compiling(lambda: print("one moment")):
    ...     pass
    """
    with event.install_listener("numba:compile", _Once(tell)):
        yield
