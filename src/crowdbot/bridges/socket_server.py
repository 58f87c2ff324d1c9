"""SocketServer: WebSocket clients of a bridge, who may connect, and what waits for slow ones."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import threading
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, Generic, Protocol, TypeVar, cast

from aiohttp import WSCloseCode, WSMsgType, web
from aiohttp.http_exceptions import HttpProcessingError

from crowdbot.core import AccessPolicy, InputError, close_listener, is_loopback

MOST_TEXT = 4 << 20
"""Largest size of a frame [characters or bytes]: a camera image fits."""
MOST_FRAME = 2 * MOST_TEXT
"""Largest frame [bytes] that is read whole, so that its sender is told the limit; a larger one cuts the connection."""
MOST_CLIENTS = 64
HEARTBEAT = 10.0
"""Real time [s] between two pings; a client that does not answer in half of it is disconnected."""
STARTUP = 10.0
TOO_LARGE = f"a frame may have at most {MOST_TEXT >> 20} MiB".encode()
LOG = logging.getLogger(f"{__name__}.requests")
LOG.addFilter(lambda record: not isinstance((record.exc_info or (None, None))[1], HttpProcessingError))
"""What is no HTTP is answered with 400 and is no news for the console."""
ROUND = 1 << 20
"""Size [bytes] after which a client must have read what it was sent before it is sent more."""
MOST_WAITING = 32 << 20
"""Largest size [bytes] of all that waits for one client: a few camera images."""
Item = TypeVar("Item")


class Backlog:
    """What waits for one client, over all its queues.

    Attributes:
        size: size of what waits [bytes].
        limit: largest size [bytes].
    """

    def __init__(self, limit: int = MOST_WAITING) -> None:
        self.size, self.limit = 0, limit


class MessageQueue(Generic[Item]):
    """Messages that wait for a client. The oldest ones make room for a new one, in number and in bytes.

    A message that has no room then either, since other queues of the client are full, is dropped.

    Args:
        backlog: what waits for the client, shared by its queues.
        depth: largest number of messages.

    >>> queue = MessageQueue(Backlog(limit=100), depth=2)
    >>> [queue.append(word, size) for word, size in (("a", 10), ("b", 20), ("c", 30), ("d", 90))]
    [0, 0, 1, 2]
    >>> len(queue), queue.popleft()
    (1, 'd')
    """

    def __init__(self, backlog: Backlog, depth: int) -> None:
        self._backlog, self.depth = backlog, depth
        self._items: deque[tuple[Item, int]] = deque()

    def __len__(self) -> int:
        return len(self._items)

    def append(self, item: Item, size: int) -> int:
        """Let a message of a size [bytes] wait; return how many messages were dropped."""
        dropped = 0
        while self._items and (len(self._items) >= self.depth or self._backlog.size + size > self._backlog.limit):
            self.popleft()
            dropped += 1
        if self._backlog.size + size > self._backlog.limit:
            return dropped + 1
        self._items.append((item, size))
        self._backlog.size += size
        return dropped

    def popleft(self) -> Item:
        """Return the oldest message, which does not wait any longer."""
        item, size = self._items.popleft()
        self._backlog.size -= size
        return item

    def clear(self) -> list[Item]:
        """Return all messages, of which none waits any longer."""
        return [self.popleft() for _ in range(len(self._items))]


class SocketSession(Protocol):
    """One client of a server, without any connection. All is called in the thread of the server."""

    def handle(self, data: str | bytes) -> None:
        """Do what a frame of the client asks. Nothing that a client sends raises an exception."""

    def take(self) -> tuple[list[str | bytes], float | None]:
        """Return the next frames, or the time [s] until there are some (None: nothing waits)."""

    def status(self, level: str, text: str) -> None:
        """Tell the client about a problem, if it wants to know of this level."""

    def close(self) -> None:
        """Forget the client."""


def access_of(kind: str, host: str, token: str, topics: Sequence[str] | None, origins: Sequence[str]) -> AccessPolicy:
    """Return the rule of who may connect to a server of a bridge.

    Raises:
        InputError: the server would be open to everybody.
    """
    if not is_loopback(host) and not token and topics is None:
        raise InputError(
            f"{kind}: a server on {host} is open to everybody; give a token (--bridge-token) or a list of allowed"
            " topics and services (--bridge-topics)"
        )
    return AccessPolicy(host, token, tuple(origins), asks=bool(token))


def port_of(kind: str, address: str, usual: int) -> int:
    """Return the port of an address on the command line: a number, or nothing.

    Raises:
        InputError: the address is no port.

    >>> port_of("foxglove", "", 8765)
    8765
    """
    if address and not (address.isdecimal() and address.isascii() and len(address) < 7):
        raise InputError(f"{kind}:{address[:40]} must be {kind} or {kind}:PORT, such as {kind}:{usual}")
    return int(address or usual)


class SocketServer:
    """A WebSocket server in a thread of its own.

    A client is sent what waits for it when it has answered a ping that followed the messages before. So what a slow
    client has not read is neither in buffers of the network nor old: its session holds the newest.

    Args:
        name: name of the transport, for messages.
        host, port: address; port 0: any free one, see :attr:`port` after :meth:`start`.
        access: who may connect.
        session: makes the session of a client; its argument wakes the sender.
        protocols: subprotocols of which clients must offer one; empty: none.

    Raises:
        InputError: there is no such port.
    """

    def __init__(
        self,
        name: str,
        host: str,
        port: int,
        access: AccessPolicy,
        session: Callable[[Callable[[], None]], SocketSession],
        protocols: Sequence[str] = (),
    ) -> None:
        if not 0 <= port <= 65535:
            raise InputError(f"port {port} must be from 0 to 65535")
        self.name, self.host, self.port, self.access = name, host, port, access
        self._make, self._protocols = session, protocols
        self._failure: BaseException | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._ready = threading.Event()
        self._end: asyncio.Event | None = None
        self._sockets: set[web.WebSocketResponse] = set()

    def start(self) -> None:
        """Listen.

        Raises:
            InputError: the port is in use.
        """
        self._thread = threading.Thread(target=self._run, name=self.name, daemon=True)
        self._thread.start()
        if not self._ready.wait(STARTUP) or self._failure is not None:
            self._thread.join(STARTUP)
            reason = self._failure.strerror if isinstance(self._failure, OSError) else self._failure
            raise InputError(f"{self.name} cannot listen on {self.host}:{self.port}: {reason}")

    def call(self, function: Callable[..., Any], *values: Any) -> None:
        """Call a function in the thread of the server, from any thread; after its end, nothing is called."""
        try:
            if self._loop is not None:
                self._loop.call_soon_threadsafe(function, *values)
        except RuntimeError:  # the loop is closed
            return

    def stop(self) -> None:
        """Disconnect all clients and stop listening."""
        if self._thread is not None:
            if self._end is not None:
                self.call(self._end.set)
            self._thread.join(STARTUP)

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except BaseException as error:  # told by start()
            self._failure = error
        finally:
            self._ready.set()

    async def _serve(self) -> None:
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        app = web.Application(client_max_size=MOST_TEXT)
        app.router.add_get("/", self._connect)
        runner = web.AppRunner(app, handle_signals=False, access_log=None, shutdown_timeout=1.0, logger=LOG)
        await runner.setup()
        try:
            server = cast("web.Server", runner.server)
            listener = await self._loop.create_server(server, self.host, self.port, reuse_address=True)
            self.port = listener.sockets[0].getsockname()[1]
            self._ready.set()
            await self._end.wait()
            await close_listener(listener)
            await asyncio.gather(
                *(
                    socket.close(code=WSCloseCode.GOING_AWAY, message=b"the run has ended")
                    for socket in list(self._sockets)
                ),
                return_exceptions=True,
            )
        finally:
            await runner.cleanup()

    async def _connect(self, request: web.Request) -> web.StreamResponse:
        """Serve one client until it goes."""
        headers = request.headers
        token = request.query.get("token") or headers.get("Authorization", "").removeprefix("Bearer ")
        if problem := self.access.refusal(headers.get("Host"), headers.get("Origin"), token, given=True):
            return web.Response(status=403, text=f"{problem}\n")
        if len(self._sockets) >= MOST_CLIENTS:
            return web.Response(status=503, text=f"{MOST_CLIENTS} clients are connected\n")
        socket = web.WebSocketResponse(
            heartbeat=HEARTBEAT,
            max_msg_size=MOST_FRAME,
            compress=False,
            timeout=1.0,
            autoping=False,
            protocols=self._protocols,
        )
        await socket.prepare(request)
        if self._protocols and socket.ws_protocol not in self._protocols:
            offer = f"offer {' or '.join(self._protocols)}"
            await socket.close(code=WSCloseCode.PROTOCOL_ERROR, message=offer.encode())
            return socket
        news, credit = asyncio.Event(), asyncio.Event()
        session = self._make(news.set)
        self._sockets.add(socket)
        sender = asyncio.create_task(_send(socket, session, news, credit))
        try:
            async for message in socket:
                if message.type == WSMsgType.PONG:
                    credit.set()
                elif message.type == WSMsgType.PING:
                    with contextlib.suppress(ConnectionError, RuntimeError):
                        await socket.pong(message.data)
                elif len(message.data) > MOST_TEXT:
                    await socket.close(code=WSCloseCode.MESSAGE_TOO_BIG, message=TOO_LARGE)
                else:
                    session.handle(message.data)
                    await asyncio.sleep(0)  # the others have their turn
        finally:
            self._sockets.discard(socket)
            session.close()
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)
        return socket


async def _send(
    socket: web.WebSocketResponse, session: SocketSession, news: asyncio.Event, credit: asyncio.Event
) -> None:
    """Send what waits for a client, in rounds; a slow client makes only this function wait."""
    while not socket.closed:
        news.clear()
        size, wait = 0, None
        try:
            while size < ROUND:
                frames, wait = session.take()
                if not frames:
                    break
                for frame in frames:
                    await (socket.send_str(frame) if isinstance(frame, str) else socket.send_bytes(frame))
                    size += len(frame)
                await asyncio.sleep(0)  # a command that answers the first message is not kept waiting by an image
            if size:
                credit.clear()
                await socket.ping(b"round")
        except (ConnectionError, RuntimeError):  # the client has gone
            return
        if size:
            await credit.wait()
        elif wait != 0.0:
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(news.wait(), wait)
