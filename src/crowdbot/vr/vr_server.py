"""The server of the headsets: pages, sessions, and what a participant may do."""

from __future__ import annotations

import asyncio
import base64
import hashlib
import hmac
import json
import re
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar
from urllib.parse import quote

import numpy as np
from aiohttp import WSCloseCode, WSMsgType, web
from numpy.typing import NDArray

from crowdbot.bridges import parse_binding
from crowdbot.core import CrowdbotError, InputError
from crowdbot.web import DESKS, AppServer, Desk, StateFrame, Window

from .vr_desk import VrDesk
from .vr_participant import VrParticipant

HEADSET_COOKIE = "crowdbot-headset"
"""Name of the cookie that holds the token of a headset; that of the operator stays beside it."""
LENGTH = 32
"""Characters of the signature: 192 bits."""
PAGES = frozenset(("/vr", "/vr.js", "/vr.css", "/icon.svg", "/licenses.txt"))
PARTS = re.compile(r"(headset|headset-window|(simulator|experiments)/(bodies|robots)/[^/]+\.bin)\Z")
"""Addresses below ``/api/SESSION/`` that a headset needs: its sockets, and meshes of bodies and robots."""


def token_of_session(secret: str, session: str) -> str:
    """Return the token of the headsets of a session: its name and a signature by the secret of the server.

    >>> token_of_session("secret", "main").partition(".")[0]
    'main'
    """
    digest = hmac.new(secret.encode(), b"headset:" + session.encode(), hashlib.sha256).digest()
    return f"{session}.{base64.urlsafe_b64encode(digest).decode()[:LENGTH]}"


def session_of_token(secret: str, token: str) -> str | None:
    """Return the session that a token of headsets opens, or None if it is none of this server.

    >>> session_of_token("secret", token_of_session("secret", "main"))
    'main'
    >>> session_of_token("secret", "main.AAAA") is None
    True
    """
    session = token.rpartition(".")[0]
    right = token_of_session(secret, session)
    return session if hmac.compare_digest(token.encode(), right.encode()) else None


def is_headset_path(path: str, session: str) -> bool:
    """Return whether a headset of a session needs an address of the server.

    >>> is_headset_path("/vr", "main"), is_headset_path("/api/main/socket", "main")
    (True, False)
    """
    start = f"/api/{session}/"
    return path in PAGES or (path.startswith(start) and bool(PARTS.match(path.removeprefix(start))))


HEADSET_COMMANDS = frozenset(
    ("simulator.description", "simulator.show_frame", "experiments.description", "experiments.show_frame",
     "experiments.draft", "experiments.finish_screen", "vr.pause", "vr.stop_robots")
)  # fmt: skip
"""Commands of the page of a participant: the picture, answers to the present screen, and what makes it safe."""
CHANNELS = frozenset(("scene", "trial"))
STATES = {
    "vr": ("participants", "settings", "rooms", "mirror", "own_body", "robot_margin", "pose", "warnings", "pause"),
    "simulator": ("status",),
    "experiments": ("open", "phase", "waiting", "index", "text", "questions", "answers"),
}
"""Parts of the states of the desks: nothing about files, conditions or other participants' answers."""
EVENTS = frozenset(("vr.state", "simulator.status", "simulator.opened", "experiments.state"))

UNIT = 32767.0
"""Unit of the quaternions in frames of the picture."""
HALF = 16383.0 * np.sqrt(2.0)
"""Unit of the parts of triples: none is above the square root of 1/2."""
OTHERS = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])


class HeadsetWindow(Window):
    """A window with the rights of a participant.

    It gets the picture, the screen of the experiment and the state of its headset, and may call
    :data:`HEADSET_COMMANDS` only.
    """

    def tell(self, event: str, data: Any) -> None:
        if event == "hello":
            desks = {name: _part(name, state) for name, state in data["desks"].items() if name in STATES}
            super().tell(event, {"session": data["session"], "desks": desks})
        elif event in EVENTS:
            desk, _, what = event.partition(".")
            super().tell(event, _part(desk, data) if what == "state" else data if what == "status" else {})

    def show(self, frame: StateFrame) -> None:
        if frame.channel in CHANNELS:
            super().show(headset_frame(frame))

    async def _call(self, number: int, address: str, arguments: dict[str, Any]) -> None:
        if address in HEADSET_COMMANDS:
            await super()._call(number, address, arguments)
        else:
            self._put({"id": number, "error": f"a headset may not call {address!r:.80}"})


def _part(desk: str, state: Mapping[str, Any]) -> dict[str, Any]:
    return {name: state[name] for name in STATES[desk] if name in state}


def pack_triples(bones: NDArray[np.int16]) -> NDArray[np.int16]:
    """Return quaternions ``[N, 4 B]`` without the largest part of each, which is positive: ``[N, 3 B]``.

    The lowest bits of the first and second part tell which one is missing. The error is below 0.0001.

    >>> pack_triples(np.array([[0, 32767, 0, 0]], dtype=np.int16)).tolist()
    [[1, 0, 0]]
    """
    parts = bones.reshape(-1, 4).astype(np.float64) / UNIT
    parts /= np.linalg.norm(parts, axis=1, keepdims=True)
    largest = np.argmax(np.abs(parts), axis=1)
    rows = np.arange(len(parts))
    parts *= np.where(parts[rows, largest] < 0.0, -1.0, 1.0)[:, None]
    found = 2 * np.round(parts[rows[:, None], OTHERS[largest]] * HALF).astype(np.int16)
    found[:, 0] |= (largest & 1).astype(np.int16)
    found[:, 1] |= (largest >> 1).astype(np.int16)
    return np.asarray(found.reshape(len(bones), -1), dtype=np.int16)


def headset_frame(frame: StateFrame) -> StateFrame:
    """Return a frame of the picture with triples instead of bones, a quarter smaller."""
    if "bones" not in frame.arrays:
        return frame
    arrays = {name: values for name, values in frame.arrays.items() if name != "bones"}
    return replace(frame, arrays={**arrays, "triples": pack_triples(frame.arrays["bones"])})


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
        app = super().application()
        app.router.add_get("/api/{session}/headset", self._headset)
        app.router.add_get("/api/{session}/headset-window", self._headset_window)
        return app

    def _refusal(self, request: web.Request) -> str | None:
        refusal = super()._refusal(request)
        if refusal is None or not self._opens_headset(request):
            return refusal
        return self.access.refusal(request.headers.get("Host"), request.headers.get("Origin"), self.access.token)

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
