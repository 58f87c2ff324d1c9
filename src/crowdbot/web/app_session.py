"""AppSession: the desks and windows of one user, and the folder that they may use."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Protocol

from crowdbot.core import InputError, did_you_mean

from .command import call_command
from .desk import Desk, Resource
from .desk_thread import DeskThread
from .jobs.job_board import JobBoard
from .session_limits import SessionLimits
from .state_frame import StateFrame
from .workspace import Workspace


class Viewer(Protocol):
    """A window of a session."""

    def tell(self, event: str, data: Any) -> None:
        """Send an event."""

    def show(self, frame: StateFrame) -> None:
        """Send a state frame."""

    def discard(self, channel: str) -> None:
        """Forget a frame of a channel that has not been sent."""

    def is_ready(self, channel: str | None = None) -> bool:
        """Return whether the window shows a channel, or any, and has drawn what was sent."""


class AppSession:
    """The desks of one user and the browser windows that show them.

    Several windows may show the same session: they see the same state, and each may change it.

    Args:
        name: name of the session.
        workspace: the folders that the session may read and write.
        desks: a class for each tab.
        loop: event loop of the server.
        limits: limits of the session.

    Attributes:
        jobs: long work in worker processes.
        windows: the windows that are open.
    """

    def __init__(
        self,
        name: str,
        workspace: Workspace,
        desks: Iterable[type[Desk]],
        loop: asyncio.AbstractEventLoop,
        limits: SessionLimits | None = None,
    ) -> None:
        self.name, self.workspace, self._loop = name, workspace, loop
        self.limits = limits or SessionLimits()
        self.windows: set[Viewer] = set()
        self.used = time.monotonic()
        self.jobs = JobBoard(workspace, self.limits, self.tell)
        self.desks = {desk.name: desk(self) for desk in desks}
        self._threads = {name: DeskThread(f"crowdbot-{name}") for name in self.desks}
        self._latest: dict[str, StateFrame] = {}
        self._lock = threading.Lock()

    def desk(self, name: str) -> Desk:
        """Return the desk with this name.

        Raises:
            InputError: there is no such desk.
        """
        if name not in self.desks:
            raise InputError(f"tab {name!r} does not exist{did_you_mean(name, self.desks)}")
        return self.desks[name]

    async def call(self, address: str, arguments: dict[str, Any]) -> Any:
        """Call the command ``desk.command`` in the thread of its desk and return its result.

        ``desk.greet`` returns the present state of a desk, also while its thread is busy.
        """
        name, _, command = address.partition(".")
        desk = self.desk(name)
        if command == "greet" and not arguments:
            return desk.greet()
        return await asyncio.wrap_future(self._threads[name].call(call_command, desk, command, arguments))

    async def resource(self, name: str, path: str, query: dict[str, str]) -> Resource:
        """Return a file of a desk; raises KeyError if there is none."""
        desk = self.desk(name)
        result: Resource = await asyncio.wrap_future(self._threads[name].call(desk.resource, path, query))
        return result

    @property
    def idle(self) -> float:
        """Time since the session had a window or a job [s]."""
        if self.windows or self.jobs.active:
            self.used = time.monotonic()
        return time.monotonic() - self.used

    def greet(self, address: Mapping[str, str]) -> dict[str, Any]:
        """Return the state of all desks for a new window, whose page has an address with these values."""
        for desk in self.desks.values():
            desk.visit(address)
        return {name: desk.greet() for name, desk in self.desks.items()}

    def tell(self, event: str, data: Any) -> None:
        """Send an event to all windows, from any thread; ``event`` is ``desk.name``."""
        self._do(lambda: self._tell_windows(event, data))

    def show(self, frame: StateFrame) -> None:
        """Send a state frame to all windows, from any thread.

        A window that has not drawn the frames before gets only the newest one of each channel.
        """
        with self._lock:
            waits = frame.channel in self._latest
            self._latest[frame.channel] = frame
        if not waits:
            self._do(self._send_latest)

    def discard(self, channel: str) -> None:
        """Forget a frame of a channel that no window has got yet, from any thread."""
        with self._lock:
            self._latest.pop(channel, None)
        self._do(lambda: self._discard(channel))

    def is_ready(self, channel: str | None = None) -> bool:
        """Return whether a window could take a frame of a channel, or of any, now; from any thread."""
        return any(window.is_ready(channel) for window in tuple(self.windows))

    def _tell_windows(self, event: str, data: Any) -> None:
        for window in self.windows:
            window.tell(event, data)

    def _discard(self, channel: str) -> None:
        for window in self.windows:
            window.discard(channel)

    def _send_latest(self) -> None:
        with self._lock:
            frames, self._latest = self._latest, {}
        for frame in frames.values():
            for window in self.windows:
                window.show(frame)

    def _do(self, action: Callable[[], Any]) -> None:
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(action)

    def close(self) -> None:
        """Stop all desks and jobs."""
        for desk in self.desks.values():
            desk.close()
        self.jobs.close()
        for thread in self._threads.values():
            thread.close()
