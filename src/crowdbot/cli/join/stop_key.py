"""StopKey: the Enter key as the emergency stop of a real robot."""

from __future__ import annotations

import contextlib
import os
import select
import sys
import threading
from collections.abc import Callable
from types import TracebackType

from crowdbot.cli.output import note

GO = "go"
LOOK = 0.1
"""Longest real time [s] until the thread sees that it has to end."""


class StopKey:
    """Reads lines from the standard input: ``go`` releases the robot, every other line stops it.

    The end of the input stops nothing: a robot can also be started without a terminal. On Windows, where no program can
    wait for a key and for something else, the thread takes no line after the end of the run, but lives until the next.

    Args:
        request: called with whether to stop and the reason; returns why the robot is not released.
    """

    def __init__(self, request: Callable[[bool, str], str]) -> None:
        self.request = request
        self._end = threading.Event()
        self._thread: threading.Thread | None = None

    def __enter__(self) -> StopKey:
        """Start to read."""
        with contextlib.suppress(OSError, ValueError):  # no standard input
            place = sys.stdin.fileno()
            self._thread = threading.Thread(target=self._read, args=(place,), name="stop-key", daemon=True)
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop to read."""
        self._end.set()
        if self._thread is not None and sys.platform != "win32":
            self._thread.join()

    def _read(self, place: int) -> None:
        text = b""
        while not self._end.is_set():
            if sys.platform != "win32" and not select.select([place], [], [], LOOK)[0]:
                continue
            part = os.read(place, 1000)
            if not part or self._end.is_set():
                return
            *lines, text = (text + part).split(b"\n")
            for line in lines:
                self.take_line(line.decode("utf-8", "replace"))

    def take_line(self, line: str) -> None:
        """Take a line."""
        stop = line.strip().lower() != GO
        problem = self.request(stop, "the key")
        if problem:
            note(f"crowdbot: the robot is not released: {problem}")
