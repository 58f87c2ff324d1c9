"""SocketTransport: what the transports over a WebSocket server have in common."""

from __future__ import annotations

import fnmatch
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, Generic, Self, TypeVar

from crowdbot.recording import StepMessage

from .inbox import Inbox
from .interface import RobotInterface
from .socket_server import SocketServer, SocketSession, access_of, port_of
from .transport import is_among

MOST_STEPS = 200
"""Largest number of steps whose messages wait for the thread of the server."""


Session = TypeVar("Session", bound=SocketSession)


class SessionGraph(ABC):
    """What the clients of a server see; used in the thread of the server, but for :attr:`wanted` and :attr:`now`.

    Args:
        interface: topics and services of the simulation.
        inbox: receives commands and calls.
        later: calls a function with arguments in the thread of the server, from any thread.
        allowed: patterns of topics and services that clients may use, such as ``/robot/*``; None: all.

    Attributes:
        sessions: the connected clients.
        wanted: topics that clients subscribe; replaced as a whole, so that other threads can read it.
        now: simulated time [ns].
    """

    sessions: list[Any]

    def __init__(
        self, interface: RobotInterface, inbox: Inbox, later: Callable[..., Any], allowed: Sequence[str] | None = None
    ) -> None:
        self.interface, self.inbox, self.later, self.allowed = interface, inbox, later, allowed
        self.sessions, self.wanted, self.now = [], frozenset[str](), 0

    def allows(self, name: str) -> bool:
        """Return whether clients may use a topic or service."""
        return self.allowed is None or any(fnmatch.fnmatchcase(name, pattern) for pattern in self.allowed)

    @abstractmethod
    def change(self, interface: RobotInterface) -> None:
        """Announce other topics and services to the clients."""

    @abstractmethod
    def deliver(self, messages: Sequence[Any]) -> None:
        """Give the messages of a step to the clients that subscribe their topics."""


class SocketTransport(Generic[Session]):
    """A transport whose clients connect by WebSocket; a server in a thread of its own.

    It listens on the loopback interface; on another one it needs a token or a list of allowed topics. A page in a
    browser needs the token, or its origin must be allowed; a page from a file has none.

    Args:
        port: TCP port; 0: any free one, see :attr:`port` after :meth:`start`; None: the usual one.
        host: address of the interface.
        token: clients must send it as ``?token=...`` in the URL, or as ``Authorization: Bearer ...``.
        topics: patterns of topics and services that clients may use, such as ``/robot/*``; None: all.
        origins: pages that may connect without the token, such as ``http://localhost:8080``.

    Raises:
        InputError: the port is not allowed, or the server would be open to everybody.
    """

    name = ""
    usual_port = 0
    protocols: tuple[str, ...] = ()
    """Subprotocols of which clients must offer one; empty: none."""
    graph: type[SessionGraph]
    """Class of what the clients see."""
    session: Callable[[Any, Callable[[], None]], Session]
    """Class of a client; it takes the graph, and a function that wakes its sender."""

    def __init__(
        self,
        port: int | None = None,
        host: str = "127.0.0.1",
        token: str = "",
        topics: Sequence[str] | None = None,
        origins: Sequence[str] = (),
    ) -> None:
        access = access_of(self.name, host, token, topics, origins)
        self.host, self.topics = host, None if topics is None else tuple(topics)
        self._graph: SessionGraph | None = None
        port = self.usual_port if port is None else port
        self._server = SocketServer(self.name, host, port, access, self._session, self.protocols)
        self._steps: deque[Sequence[Any]] = deque(maxlen=MOST_STEPS)

    @classmethod
    def of(
        cls,
        address: str,
        host: str = "",
        token: str = "",
        topics: Sequence[str] | None = None,
        origins: Sequence[str] = (),
    ) -> Self:
        """Return the server of an address on the command line: a port, or nothing.

        Raises:
            InputError: the address is no port.
        """
        return cls(port_of(cls.name, address, cls.usual_port), host or "127.0.0.1", token, topics, origins)

    @property
    def port(self) -> int:
        """The TCP port."""
        return self._server.port

    @property
    def now(self) -> int:
        """Simulated time [ns] of the clients."""
        return 0 if self._graph is None else self._graph.now

    @property
    def sessions(self) -> list[Session]:
        """The connected clients."""
        return [] if self._graph is None else list(self._graph.sessions)

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Listen, or announce the topics of another trial to the clients.

        Raises:
            InputError: the port is in use.
        """
        if self._graph is not None:
            self._server.call(self._graph.change, interface)
            return
        self._graph = self.graph(interface, inbox, self._server.call, self.topics)
        self._server.start()

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Hand the messages of a step to the thread of the server; if it is slow, the oldest steps are dropped."""
        self._steps.append(self.outgoing(messages))
        self._server.call(self._deliver)

    def poll(self) -> None:
        """Do nothing: the thread of the server gives what arrives to the inbox."""

    def report(self, level: str, text: str) -> None:
        """Send a status message to all clients that want this level."""

        def tell() -> None:
            for session in self.sessions:
                session.status(level, text)

        self._server.call(tell)

    def wants(self, topic: str) -> bool:
        """Return whether a client subscribes a topic, or with a final slash one that starts with it."""
        return self._graph is not None and is_among(topic, self._graph.wanted)

    def stop(self) -> None:
        """Disconnect all clients and stop listening."""
        self._server.stop()

    def outgoing(self, messages: Sequence[StepMessage]) -> Sequence[Any]:
        """Return the messages of a step as the graph takes them; called in the thread of the simulation."""
        return messages

    def _session(self, wake: Callable[[], None]) -> Session:
        return self.session(self._graph, wake)

    def _deliver(self) -> None:
        assert self._graph is not None
        while self._steps:
            self._graph.deliver(self._steps.popleft())
