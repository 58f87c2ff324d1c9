"""AppServer: the HTTP server of the app."""

from __future__ import annotations

import asyncio
import contextlib
import functools
import re
import ssl
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import ClassVar, cast

from aiohttp import WSCloseCode, web

from crowdbot.core import AccessPolicy, CrowdbotError, InputError, close_listener

from .app_session import AppSession
from .desk import Desk
from .desk_thread import DeskThread
from .session_limits import CLASSROOM, SessionLimits
from .window import Window
from .workspace import SESSIONS, Workspace

COOKIE = "crowdbot-token"
"""Name of the cookie that holds the token after the first page."""
POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; worker-src 'self' blob:; "
    "connect-src 'self' ws: wss:; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
SANDBOX = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:"
)
"""Policy of a page with scripts of its own: without access to the app or the net."""
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}
MESSAGE = 4 << 20
"""Largest message of a window [B]."""
CLOSING = 5.0
"""Time for the desks to stop their runs at the end [s]."""
WINDOWS = 400
"""Windows of all sessions."""
SWEEP = 5.0
"""Longest time between two looks for sessions that nobody uses [s]."""
CODE = frozenset((".py", ".pyc", ".pyd", ".so"))
"""Files that a server for other machines does not take."""
NAME = re.compile(r"[A-Za-z0-9_-]{1,40}\Z")
STATIC = {
    "": ("index.html", "text/html"),
    "app.js": ("app.js", "text/javascript"),
    "app.css": ("app.css", "text/css"),
    "icon.svg": ("icon.svg", "image/svg+xml"),
    "licenses.txt": ("licenses.txt", "text/plain"),
}


class AppServer:
    """The server of the app: pages, files of the desks, and a WebSocket for each window.

    Args:
        desks: a class for each tab.
        folder: the sessions read and write files in subfolders of this folder; the session ``main`` uses it itself.
        host: address to listen on.
        port: port; 0 takes a free one.
        access: who may use the server (default: loopback without a token, elsewhere a random token).
        readable: more folders whose files may be read.
        tls: certificate of the server for HTTPS.
        limits: limits of each session (default: those of a class beyond the loopback address, else few).
        most_sessions: sessions at the same time.

    Attributes:
        url: address of the page, with the token if one is needed; set while the server runs.

    >>> import tempfile
    >>> async def main():
    ...     async with AppServer((), Path(tempfile.mkdtemp()), port=0).running() as server:
    ...         return server.url.startswith("http://127.0.0.1:")
    >>> asyncio.run(main())
    True
    """

    pages: ClassVar[Mapping[str, tuple[str, str]]] = STATIC
    """File and media type of each page, by its name in the address."""

    def __init__(
        self,
        desks: Sequence[type[Desk]],
        folder: Path,
        host: str = "127.0.0.1",
        port: int = 8700,
        access: AccessPolicy | None = None,
        readable: tuple[Path, ...] = (),
        tls: ssl.SSLContext | None = None,
        limits: SessionLimits | None = None,
        most_sessions: int = 40,
    ) -> None:
        self.desks, self.folder, self.host, self.port = tuple(desks), folder, host, port
        self.access = access or AccessPolicy(host)
        self.readable, self.tls = readable, tls
        self.limits = limits or (CLASSROOM if self.access.needs_token else SessionLimits())
        self.most_sessions = most_sessions
        self.sessions: dict[str, AppSession] = {}
        self.url = ""
        self._sockets: set[web.WebSocketResponse] = set()

    @contextlib.asynccontextmanager
    async def running(self) -> AsyncIterator[AppServer]:
        """Serve inside the block.

        Raises:
            InputError: the address is not one of this machine, or the port is in use.
        """
        runner = web.AppRunner(self.application(), access_log=None, shutdown_timeout=2.0)
        await runner.setup()
        try:
            listener = await self._listen(runner)
            host, port = listener.sockets[0].getsockname()[:2]
            shown = f"[{host}]" if ":" in host else host
            token = f"?token={self.access.token}" if self.access.needs_token else ""
            self.url = f"{'https' if self.tls else 'http'}://{shown}:{port}/{token}"
            sweeper = asyncio.create_task(self._end_idle_sessions())
            try:
                yield self
            finally:
                sweeper.cancel()
                await close_listener(listener)
        finally:
            for socket in list(self._sockets):
                await socket.close(code=WSCloseCode.GOING_AWAY, message=b"the server stops")
            connections = [] if runner.server is None else runner.server.connections
            transports = [connection.transport for connection in connections]
            await runner.cleanup()
            closing = [
                asyncio.wrap_future(DeskThread("closing").call(session.close)) for session in self.sessions.values()
            ]
            if closing:  # a desk that is still busy then ends with the program
                await asyncio.wait(closing, timeout=CLOSING)
            self.sessions.clear()
            for transport in transports:  # a window that reads no longer would keep its connection open
                if transport is not None:
                    transport.abort()
            for _ in range(5):  # the loop closes the sockets in its next turns
                await asyncio.sleep(0)

    async def _listen(self, runner: web.AppRunner) -> asyncio.Server:
        """Accept the connections of the application."""
        loop, server = asyncio.get_running_loop(), cast("web.Server", runner.server)
        try:
            return await loop.create_server(server, self.host, self.port, ssl=self.tls)
        except OSError as error:
            place = f"{self.host} port {self.port}"
            raise InputError(
                f"the app cannot listen on {place}: {error.strerror or error}; give another --port (0: a free one)"
            ) from None

    def application(self) -> web.Application:
        """Return the aiohttp application."""
        app = web.Application(middlewares=[self._guard], client_max_size=MESSAGE)
        app.router.add_get("/api/{session}/socket", self._socket)
        app.router.add_get("/api/{session}/{desk}/{path:.+}", self._resource)
        app.router.add_post("/api/{session}/upload", self._upload)
        app.router.add_get("/{name:[^/]*}", self._static)
        return app

    async def _end_idle_sessions(self) -> None:
        """End sessions that nobody uses; their files stay, and the next window of that name begins anew."""
        while True:
            await asyncio.sleep(min(SWEEP, self.limits.idle / 2))
            for name in [name for name, session in self.sessions.items() if session.idle > self.limits.idle]:
                session = self.sessions.pop(name)
                await asyncio.wrap_future(DeskThread("closing").call(session.close))

    @web.middleware
    async def _guard(
        self, request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
    ) -> web.StreamResponse:
        refusal = self._refusal(request)
        response: web.StreamResponse
        if refusal is not None:
            response = web.Response(status=403, text=refusal + "\n")
        else:
            try:
                response = await handler(request)
            except web.HTTPException as error:
                response = web.Response(status=error.status, text=(error.text or error.reason) + "\n")
            except CrowdbotError as error:
                response = web.Response(status=400, text=f"{error}\n")
            except ConnectionError:  # cut before the answer; nobody reads this one
                response = web.Response(status=400, text="the connection was cut\n")
        if not response.prepared:
            for header, value in HEADERS.items():
                response.headers.setdefault(header, value)
            if refusal is None and self.access.needs_token and "token" in request.query:
                name = self._cookie(request)
                secure = self.tls is not None
                response.set_cookie(name, request.query["token"], httponly=True, samesite="Strict", secure=secure)
        return response

    def _refusal(self, request: web.Request) -> str | None:
        """Return why a request is refused, or None if it is allowed."""
        token = request.query.get("token") or request.cookies.get(COOKIE)
        if self.access.needs_token and token and self.access.opens(token, request.path):
            token = self.access.token
        return self.access.refusal(request.headers.get("Host"), request.headers.get("Origin"), token)

    def session_address(self, session: str) -> str:
        """Return the address of the page of a session; its token, if one is needed, opens this session only."""
        if not NAME.match(session):
            raise InputError(f"session {session!r:.60}: expected 1 to 40 letters, digits, - or _")
        base = self.url.partition("?")[0]
        token = f"?token={self.access.session_token(session)}" if self.access.needs_token else ""
        return f"{base}{token}#session={session}"

    def _cookie(self, request: web.Request) -> str:
        """Return the name of the cookie for the token in the address of an allowed request."""
        return COOKIE

    async def _static(self, request: web.Request) -> web.StreamResponse:
        name = request.match_info["name"]
        if name not in self.pages:
            raise web.HTTPNotFound(text=f"page {name!r:.80} does not exist")
        file, kind = self.pages[name]
        data = resources.files("crowdbot").joinpath("assets", "web", file).read_bytes()
        response = web.Response(body=data, content_type=kind, charset="utf-8", headers={"Cache-Control": "no-cache"})
        response.enable_compression()
        return response

    async def _socket(self, request: web.Request) -> web.StreamResponse:
        return await self._serve_window(request, functools.partial(Window, address=dict(request.query)))

    async def _serve_window(
        self, request: web.Request, kind: Callable[[AppSession, web.WebSocketResponse], Window]
    ) -> web.StreamResponse:
        """Serve a window of a kind until it is closed."""
        session = self._session(request)
        if len(self._sockets) >= WINDOWS:
            raise web.HTTPServiceUnavailable(text=f"more than {WINDOWS} windows are open")
        if len(session.windows) >= self.limits.windows:
            raise web.HTTPServiceUnavailable(
                text=f"session {session.name} has {self.limits.windows} windows, its limit; close one of them"
            )
        if request.headers.get("Origin") is None and self.access.needs_token and "token" not in request.query:
            raise web.HTTPForbidden(text="the request has no origin and no token")
        socket = web.WebSocketResponse(max_msg_size=MESSAGE, heartbeat=20.0, compress=False)
        await socket.prepare(request)
        self._sockets.add(socket)
        try:
            await kind(session, socket).serve()
        finally:
            self._sockets.discard(socket)
        return socket

    async def _resource(self, request: web.Request) -> web.StreamResponse:
        session, path = self._session(request), request.match_info["path"]
        try:
            found = await session.resource(request.match_info["desk"], path, dict(request.query))
        except KeyError:
            raise web.HTTPNotFound(text=f"file {path!r:.80} does not exist") from None
        response = web.Response(
            body=found.data or None, status=200 if found.data else 204, headers={"Cache-Control": "no-cache"}
        )
        response.content_type = found.kind
        if found.sandbox:
            response.headers["Content-Security-Policy"] = SANDBOX
        if found.name is not None:
            name = re.sub(r"[^A-Za-z0-9._-]", "-", found.name)
            response.headers["Content-Disposition"] = f'attachment; filename="{name}"'
        return response

    async def _upload(self, request: web.Request) -> web.StreamResponse:
        session, name = self._session(request), Path(request.query.get("name", "")).name
        path = session.workspace.writable(name)
        if self.access.needs_token and path.suffix.casefold() in CODE:
            raise web.HTTPForbidden(text=f"{name!r:.80} is code; a server for other machines takes data only")
        draft, most = path.with_name(f".{name}.part"), self.limits.upload
        session.workspace.check_space(min(request.content_length or 0, most))
        try:
            with draft.open("wb") as file:
                async for block in request.content.iter_chunked(1 << 20):
                    if file.tell() + len(block) > most:
                        sentence = f"{name:.80} is larger than {most / 1e6:g} MB, the largest file that is taken"
                        raise web.HTTPRequestEntityTooLarge(int(most), file.tell() + len(block), text=sentence)
                    file.write(block)
            session.workspace.check_space()
            draft.replace(path)
        finally:
            draft.unlink(missing_ok=True)
        return web.json_response({"name": name})

    def _session(self, request: web.Request) -> AppSession:
        name = request.match_info["session"]
        if not NAME.match(name):
            raise web.HTTPBadRequest(text="the name of a session has 1 to 40 letters, digits, - or _")
        if name not in self.sessions:
            if len(self.sessions) >= self.most_sessions:
                raise web.HTTPServiceUnavailable(
                    text=f"{self.most_sessions} sessions are open, the limit of this server; try again later"
                )
            folder = self.folder if name == "main" else self.folder / SESSIONS / name
            space = Workspace(folder, self.readable, self.limits.disk)
            loop = asyncio.get_running_loop()
            self.sessions[name] = AppSession(name, space, self.desks, loop, self.limits)
        return self.sessions[name]
