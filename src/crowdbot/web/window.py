"""Window: one browser window, connected by a WebSocket."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from aiohttp import WSMsgType, web

from crowdbot.core import CrowdbotError

from .app_session import AppSession
from .plain_json import clean_json
from .state_frame import StateFrame

CREDIT = 2
"""State frames that may be on their way to a window at the same time."""
EVENTS = 1000
"""Events that may wait for a window; a window that is further behind is closed and connects again."""
CHANNELS = 64
"""Channels that a window can name."""
CALLS = 32
"""Commands of one window that may run at the same time."""


class Window:
    """One browser window of a session.

    Text messages are JSON; numbers that are not finite are null. The window calls commands with
    ``{"id": 1, "call": "desk.command", "args": {...}}`` and gets ``{"id": 1, "result": ...}`` or
    ``{"id": 1, "error": "sentence"}``. It confirms each state frame with ``{"drawn": sequence}``; no more than two
    unconfirmed frames are sent, so that a slow window sees the newest state and never slows the run. A window gets the
    frames of all channels, or from ``{"wants": [channel, ...]}`` on only those that it names.

    Args:
        session: the session that the window shows.
        socket: the open WebSocket.
        address: values of the address of the page, from which a desk opens what it names.
    """

    def __init__(
        self, session: AppSession, socket: web.WebSocketResponse, address: Mapping[str, str] | None = None
    ) -> None:
        self.session, self._socket, self._address = session, socket, address or {}
        self._sent = self._drawn = 0
        self._frames: dict[str, StateFrame] = {}
        self._wants: frozenset[str] | None = None
        self._events: list[str] = []
        self._wake = asyncio.Event()
        self._calls: set[asyncio.Task[None]] = set()

    def tell(self, event: str, data: Any) -> None:
        """Send an event."""
        self._put({"event": event, "data": data})

    def show(self, frame: StateFrame) -> None:
        """Send a frame when the window has drawn the frames before; replaces one of the same channel that waits."""
        if self.wants(frame.channel):
            self._frames[frame.channel] = frame
            self._wake.set()

    def discard(self, channel: str) -> None:
        """Forget a frame of a channel that waits."""
        self._frames.pop(channel, None)

    def wants(self, channel: str) -> bool:
        """Return whether the window shows a channel; a page that is hidden shows none."""
        return self._wants is None or channel in self._wants

    def is_ready(self, channel: str | None = None) -> bool:
        """Return whether a frame of a channel, or of any, would be sent at once."""
        wanted = self._wants != frozenset() if channel is None else self.wants(channel)
        return wanted and self._sent - self._drawn < CREDIT and not self._frames

    async def serve(self) -> None:
        """Exchange messages until the window is closed."""
        writer = asyncio.create_task(self._write())
        self.session.windows.add(self)
        try:
            self.tell("hello", {"session": self.session.name, "desks": self.session.greet(self._address)})
            async for message in self._socket:
                if message.type != WSMsgType.TEXT:
                    break
                if not self._receive(message.data):
                    break
        finally:
            self.session.windows.discard(self)
            for task in (writer, *self._calls):
                task.cancel()
            await asyncio.gather(writer, *self._calls, return_exceptions=True)
            await self._socket.close()

    def _receive(self, text: str) -> bool:
        """Handle a message; False if it is not one of ours."""
        try:
            message = json.loads(text)
        except (ValueError, RecursionError):
            return False
        if not isinstance(message, dict):
            return False
        if isinstance(message.get("drawn"), int):
            self._drawn = max(self._drawn, min(message["drawn"], self._sent))
            if self._frames:  # as a rule none waits, and waking the writer for nothing costs a tenth of a frame
                self._wake.set()
            return True
        if "wants" in message:
            return self._choose(message["wants"])
        address, arguments, number = message.get("call"), message.get("args", {}), message.get("id")
        if not isinstance(address, str) or not isinstance(arguments, dict) or not isinstance(number, int):
            return False
        if len(self._calls) >= CALLS:
            self._put({"id": number, "error": f"more than {CALLS} commands are running; wait for one of them"})
            return True
        task = asyncio.create_task(self._call(number, address, arguments))
        self._calls.add(task)
        task.add_done_callback(self._calls.discard)
        return True

    def _choose(self, wants: Any) -> bool:
        if not isinstance(wants, list) or len(wants) > CHANNELS or not all(isinstance(want, str) for want in wants):
            return False
        self._wants = frozenset(wants)
        self._frames = {name: frame for name, frame in self._frames.items() if name in self._wants}
        return True

    async def _call(self, number: int, address: str, arguments: dict[str, Any]) -> None:
        try:
            answer: dict[str, Any] = {"id": number, "result": await self.session.call(address, arguments)}
        except CrowdbotError as error:
            answer = {"id": number, "error": str(error)}
        except OSError as error:
            answer = {"id": number, "error": f"{error.filename or 'file'}: {error.strerror or error}"}
        except Exception as error:  # a bug must reach the user, and the server must go on
            answer = {"id": number, "error": _bug(address, error)}
        try:
            self._put(answer)
        except TypeError as error:  # the result is no JSON
            self._put({"id": number, "error": _bug(address, error)})

    def _put(self, message: dict[str, Any]) -> None:
        try:
            text = json.dumps(message, allow_nan=False)
        except ValueError:  # a number is not finite
            text = json.dumps(clean_json(message), allow_nan=False)
        self._events.append(text)
        self._wake.set()

    async def _write(self) -> None:
        while True:
            await self._wake.wait()
            self._wake.clear()
            if len(self._events) > EVENTS:
                await self._socket.close(code=1013, message=b"the window is too slow")
                return
            events, self._events = self._events, []
            for text in events:
                await self._socket.send_str(text)
            while self._frames and self._sent - self._drawn < CREDIT:
                frame = self._frames.pop(next(iter(self._frames)))
                self._sent += 1
                await self._socket.send_bytes(replace(frame, sequence=self._sent).encode(), compress=0)


def _bug(address: str, error: Exception) -> str:
    return f"{address}: {type(error).__name__}: {error}; this is a bug in crowdbot or in your code"
