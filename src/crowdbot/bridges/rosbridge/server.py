"""RosbridgeServer: a rosbridge v2 server for roslibpy, roslib.js, Foxglove and other clients."""

from __future__ import annotations

import asyncio
import contextlib
import hmac
import ipaddress
import threading
import urllib.parse
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.core import InputError
from crowdbot.recording import StepMessage

from .frames import MOST_TEXT, OutgoingMessage
from .graph import RosGraph
from .session import ClientSession

PORT = 9090
MOST_CLIENTS, MOST_STEPS = 64, 200
"""Largest number of clients, and of steps whose messages wait for the thread of the server."""
HEARTBEAT = 10.0
"""Real time [s] between two pings; a client that does not answer in half of it is disconnected."""
STARTUP = 10.0
MOST_FRAME = 2 * MOST_TEXT
"""Largest frame [bytes] that is read whole, so that its sender is told the limit; a larger one cuts the connection."""
TOO_LARGE = f"a frame may have at most {MOST_TEXT >> 20} MiB".encode()
BATCH = 64
"""Largest number of frames after which other clients have their turn."""


class RosbridgeServer:
    """A rosbridge v2 server over WebSocket in a thread of its own.

    It listens on the loopback interface. On another interface it needs a token or a list of allowed topics. Without the
    token, a page in a browser can connect only if a server of this machine serves it; a page from a file cannot.

    Args:
        port: TCP port; 0: any free one, see :attr:`port` after :meth:`start`.
        host: address of the interface.
        token: clients must send it as ``?token=...`` in the URL, or as ``Authorization: Bearer ...``.
        topics: patterns of topics and services that clients may use, such as ``/robot/*``; None: all.

    Raises:
        InputError: the port is not allowed, or the server would be open to everybody.

    >>> RosbridgeServer(port=0).host
    '127.0.0.1'
    """

    name = "rosbridge"

    def __init__(
        self, port: int = PORT, host: str = "127.0.0.1", token: str = "", topics: Sequence[str] | None = None
    ) -> None:
        if not 0 <= port <= 65535:
            raise InputError(f"port {port} must be from 0 to 65535")
        if not _is_loopback(host) and not token and topics is None:
            raise InputError(
                f"a server on {host} is open to everybody; give a token (--bridge-token) or a list of allowed topics"
                " and services (--bridge-topics)"
            )
        self.port, self.host, self.token = port, host, token
        self.topics = None if topics is None else tuple(topics)
        self.failure: BaseException | None = None
        self._graph: RosGraph | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._ready = threading.Event()
        self._end: asyncio.Event | None = None
        self._steps: deque[list[OutgoingMessage]] = deque(maxlen=MOST_STEPS)
        self._sockets: set[web.WebSocketResponse] = set()

    @classmethod
    def of(cls, address: str, host: str = "", token: str = "", topics: Sequence[str] | None = None) -> RosbridgeServer:
        """Return the server of an address on the command line: a port, or nothing.

        Raises:
            InputError: the address is no port.
        """
        if address and not address.isdecimal():
            raise InputError(f"rosbridge:{address[:40]} must be rosbridge or rosbridge:PORT, such as rosbridge:{PORT}")
        return cls(int(address or PORT), host or "127.0.0.1", token, topics)

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Listen, or announce another interface to the clients.

        Raises:
            InputError: the port is in use.
        """
        if self._graph is not None:
            self._call(self._graph.change, interface)
            return
        self._graph = RosGraph(interface, inbox, self._call, self.topics)
        self._thread = threading.Thread(target=self._run, name="rosbridge", daemon=True)
        self._thread.start()
        if not self._ready.wait(STARTUP) or self.failure is not None:
            self._thread.join(STARTUP)
            reason = self.failure.strerror if isinstance(self.failure, OSError) else self.failure
            raise InputError(f"rosbridge cannot listen on {self.host}:{self.port}: {reason}")

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Hand the messages of a step to the thread of the server; if it is slow, the oldest steps are dropped."""
        self._steps.append([OutgoingMessage.of(one) for one in messages])
        self._call(self._deliver)

    def poll(self) -> None:
        """Do nothing: the thread of the server gives what arrives to the inbox."""

    def report(self, level: str, text: str) -> None:
        """Send a status message to all clients that want this level."""

        def tell() -> None:
            for session in self.sessions:
                session.status(level, text)

        self._call(tell)

    def wants(self, topic: str) -> bool:
        """Return whether a client subscribes a topic, or with a final slash one that starts with it."""
        wanted = self._graph.wanted if self._graph is not None else frozenset()
        if not topic.endswith("/"):
            return topic in wanted
        return any(one == topic[:-1] or one.startswith(topic) for one in wanted)

    def stop(self) -> None:
        """Disconnect all clients and stop listening."""
        if self._thread is None or self._loop is None:
            return
        if self._end is not None:
            self._call(self._end.set)
        self._thread.join(STARTUP)

    @property
    def sessions(self) -> list[ClientSession]:
        """The connected clients."""
        return [] if self._graph is None else list(self._graph.sessions)  # type: ignore[arg-type]

    def _call(self, function: Callable[..., Any], *values: Any) -> None:
        """Call a function in the thread of the server; after its end, nothing is called."""
        try:
            if self._loop is not None:
                self._loop.call_soon_threadsafe(function, *values)
        except RuntimeError:  # the loop is closed
            return

    def _deliver(self) -> None:
        assert self._graph is not None
        while self._steps:
            self._graph.deliver(self._steps.popleft())

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except BaseException as error:  # told by start()
            self.failure = error
        finally:
            self._ready.set()

    async def _serve(self) -> None:
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        app = web.Application(client_max_size=MOST_TEXT)
        app.router.add_get("/", self._connect)
        runner = web.AppRunner(app, handle_signals=False, access_log=None, shutdown_timeout=1.0)
        await runner.setup()
        try:
            site = web.TCPSite(runner, self.host, self.port, reuse_address=True)
            await site.start()
            self.port = runner.addresses[0][1]
            self._ready.set()
            await self._end.wait()
            self._deliver()
            await asyncio.gather(
                *(one.close(code=1001, message=b"the run has ended") for one in list(self._sockets)),
                return_exceptions=True,
            )
        finally:
            await runner.cleanup()

    async def _connect(self, request: web.Request) -> web.StreamResponse:
        """Serve one client until it goes."""
        assert self._graph is not None
        if problem := self._problem(request):
            return web.Response(status=403, text=problem)
        if len(self._sockets) >= MOST_CLIENTS:
            return web.Response(status=503, text=f"{MOST_CLIENTS} clients are connected")
        socket = web.WebSocketResponse(heartbeat=HEARTBEAT, max_msg_size=MOST_FRAME, compress=False, timeout=1.0)
        await socket.prepare(request)
        news = asyncio.Event()
        session = ClientSession(self._graph, news.set)
        self._sockets.add(socket)
        sender = asyncio.create_task(_send(socket, session, news))
        try:
            async for message in socket:
                if message.type == WSMsgType.TEXT and len(message.data) > MOST_TEXT:
                    await socket.close(code=WSCloseCode.MESSAGE_TOO_BIG, message=TOO_LARGE)
                elif message.type == WSMsgType.TEXT:
                    session.handle(message.data)
                    await asyncio.sleep(0)
                elif message.type == WSMsgType.BINARY:
                    session.refuse("a frame from a client must be text")
        finally:
            self._sockets.discard(socket)
            session.close()
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)
        return socket

    def _problem(self, request: web.Request) -> str:
        """Return why a client is refused, empty if it is not."""
        bearer = request.headers.get("Authorization", "").removeprefix("Bearer ")
        given = request.query.get("token", "") or bearer
        if self.token:
            return "" if hmac.compare_digest(given.encode(), self.token.encode()) else "the token is missing or wrong"
        origin = request.headers.get("Origin")
        if origin is not None and not _is_local_page(origin):
            return "pages of other sites need a token"
        return ""


async def _send(socket: web.WebSocketResponse, session: ClientSession, news: asyncio.Event) -> None:
    """Send what waits for a client; a slow client makes only this function wait."""
    count = 0
    while not socket.closed:
        news.clear()
        frames, wait = session.take()
        if not frames:
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(news.wait(), wait)
            continue
        for frame in frames:
            try:
                await (socket.send_str(frame) if isinstance(frame, str) else socket.send_bytes(frame))
            except (ConnectionError, RuntimeError):  # the client has gone
                return
        count += 1
        if count % BATCH == 0:
            await asyncio.sleep(0)


def _is_local_page(origin: str) -> bool:
    """Return whether a page comes from a server of this machine.

    A browser says ``null`` for a file, and for a page that another site shows in a frame without rights.
    """
    try:
        return _is_loopback(urllib.parse.urlsplit(origin).hostname or "")
    except ValueError:
        return False


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
