"""VrServer: the server of the app with a page and a socket for headsets."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar
from urllib.parse import quote

from aiohttp import WSCloseCode, WSMsgType, web

from crowdbot.bridges import parse_binding
from crowdbot.core import CrowdbotError, InputError
from crowdbot.web import DESKS, AppServer, Desk

from .headset_access import HEADSET_COOKIE, is_headset_path, session_of_token, token_of_session
from .headset_window import HeadsetWindow
from .vr_desk import VrDesk
from .vr_participant import VrParticipant

VR_DESKS: tuple[type[Desk], ...] = (*DESKS, VrDesk)
"""The tabs of the app with that for virtual reality."""

MESSAGE = 1 << 16
"""Largest message of a headset [B]."""
SILENCE = 5.0
"""Time [s] without a message after which the connection to a headset is closed."""
WAITING = 200
"""Messages that may wait for a headset; more are left out."""


def with_captures(desks: Sequence[type[Desk]], captures: Sequence[str]) -> tuple[type[Desk], ...]:
    """Return the tabs of an app whose session opens motion capture, such as ``xsens:9763=participant``.

    Raises:
        InputError: a text has another form.

    >>> [desk for desk in with_captures(VR_DESKS, ["xsens:9763=guest"]) if desk.name == "vr"][0].first_captures
    ('xsens:9763=guest',)
    """
    for text in captures:
        parse_binding(text)
    more = {"first_captures": tuple(captures), "__doc__": VrDesk.__doc__}
    return tuple(type("VrDesk", (desk,), more) if issubclass(desk, VrDesk) else desk for desk in desks)


class VrServer(AppServer):
    """An :class:`crowdbot.web.AppServer` that also serves the page ``vr`` of participants and takes their poses.

    A headset connects a second WebSocket, ``api/SESSION/headset``, beside that of its window. It sends a state frame of
    the channel ``headset`` with each of its pictures; the server answers each with times for the estimate of the clock
    offset, and sends what the avatar touches. The socket carries poses only, so that they never wait for pictures.

    The address for headsets has a token of its own, for one session. It opens the page of participants, their sockets
    and the meshes of the picture, and nothing else of the app.

    Args:
        as for :class:`crowdbot.web.AppServer`; the desks must contain :class:`VrDesk`.

    >>> import tempfile
    >>> from pathlib import Path
    >>> async def main():
    ...     async with VrServer(VR_DESKS, Path(tempfile.mkdtemp()), port=0).running() as server:
    ...         return server.vr_url == server.url + "vr"
    >>> asyncio.run(main())
    True
    """

    pages: ClassVar[Mapping[str, tuple[str, str]]] = {
        **AppServer.pages,
        "vr": ("vr.html", "text/html"),
        "vr.js": ("vr.js", "text/javascript"),
        "vr.css": ("vr.css", "text/css"),
    }
    reached_at: str = ""
    """Address at which headsets reach the server, if it listens on all addresses of the machine."""

    @property
    def vr_url(self) -> str:
        """Address of the page of participants of the session ``main``."""
        return self.headset_address("main")

    def headset_address(self, session: str) -> str:
        """Return the address of the page of participants of a session, with its token if one is needed."""
        base = self.url.partition("?")[0]
        if self.reached_at:
            base = base.replace("0.0.0.0", self.reached_at, 1)  # noqa: S104
        token = f"?token={quote(token_of_session(self.access.token, session))}" if self.access.needs_token else ""
        return f"{base}vr{token}" + ("" if session == "main" else f"#session={session}")

    def application(self) -> web.Application:
        """Return the aiohttp application."""
        app = super().application()
        app.router.add_get("/api/{session}/headset", self._headset)
        app.router.add_get("/api/{session}/headset-window", self._headset_window)
        return app

    def _refusal(self, request: web.Request) -> str | None:
        found = super()._refusal(request)
        if found is None or not self._opens_headset(request):
            return found
        return self.access.refusal(request.host, request.headers.get("Origin"), self.access.token)

    def _cookie(self, request: web.Request) -> str:
        return HEADSET_COOKIE if self._opens_headset(request) else super()._cookie(request)

    def _opens_headset(self, request: web.Request) -> bool:
        """Return whether a request has the token of a headset, for something that a headset needs."""
        token = request.query.get("token") or request.cookies.get(HEADSET_COOKIE) or ""
        session = session_of_token(self.access.token, token)
        return session is not None and is_headset_path(request.path, session)

    async def _headset_window(self, request: web.Request) -> web.StreamResponse:
        return await self._serve_window(request, HeadsetWindow)

    async def _headset(self, request: web.Request) -> web.StreamResponse:
        session = self._session(request)
        desk = session.desk("vr")
        assert isinstance(desk, VrDesk)
        socket = web.WebSocketResponse(max_msg_size=MESSAGE, heartbeat=2.0, compress=False)
        await socket.prepare(request)
        self._sockets.add(socket)
        try:
            await _Headset(desk, socket).serve(request.query.get("avatar", ""))
        finally:
            self._sockets.discard(socket)
        return socket

    def _session(self, request: web.Request):  # type: ignore[no-untyped-def]
        session = super()._session(request)
        desk = session.desks.get("vr")
        if isinstance(desk, VrDesk):
            desk.address = self.headset_address(session.name)
        return session


class _Headset:
    """One headset: poses in, times and touches out."""

    def __init__(self, desk: VrDesk, socket: web.WebSocketResponse) -> None:
        self._desk, self._socket = desk, socket
        self._loop = asyncio.get_running_loop()
        self._waiting: asyncio.Queue[dict[str, Any]] = asyncio.Queue(WAITING)

    async def serve(self, wish: str) -> None:
        """Exchange messages until the headset is gone or silent; it wishes to move an avatar, such as before a cut."""
        try:
            person = await self._loop.run_in_executor(None, self._desk.arrive, self._tell, wish)
        except CrowdbotError as error:
            await self._socket.send_str(json.dumps({"refused": str(error)}))
            await self._socket.close(code=1013, message=b"refused")
            return
        writer = asyncio.create_task(self._write())
        cut = True
        try:
            await self._socket.send_str(json.dumps({"joined": person.avatar}))
            cut = await self._read(person)
        finally:
            writer.cancel()
            await asyncio.gather(writer, return_exceptions=True)
            await asyncio.shield(self._loop.run_in_executor(None, self._desk.depart, person, cut))
            if not self._socket.closed:
                await self._socket.close()

    async def _read(self, person: VrParticipant) -> bool:
        """Take poses until the connection ends; return whether it was cut, not closed by the participant."""
        while True:
            try:
                message = await self._socket.receive(timeout=SILENCE)
            except TimeoutError:
                return True
            if message.type != WSMsgType.BINARY:
                return not (message.type == WSMsgType.CLOSE and message.data == WSCloseCode.OK)
            try:
                answer = person.take(message.data)
            except InputError as error:
                await self._socket.send_str(json.dumps({"refused": str(error)}))
                return True
            await self._socket.send_str(json.dumps(answer))

    def _tell(self, message: dict[str, Any]) -> None:
        """Send a message, from any thread."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._put, message)

    def _put(self, message: dict[str, Any]) -> None:
        if not self._waiting.full():
            self._waiting.put_nowait({**message, "at": time.monotonic()})

    async def _write(self) -> None:
        while True:
            await self._socket.send_str(json.dumps(await self._waiting.get()))
