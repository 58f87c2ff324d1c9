"""RosbridgeServer: a rosbridge v2 server for roslibpy, roslib.js, Foxglove and other clients."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.bridges.socket_server import SocketServer, access_of, port_of
from crowdbot.recording import StepMessage

from .frames import OutgoingMessage
from .graph import RosGraph
from .session import ClientSession

PORT = 9090
MOST_STEPS = 200
"""Largest number of steps whose messages wait for the thread of the server."""


class RosbridgeServer:
    """A rosbridge v2 server over WebSocket in a thread of its own.

    It listens on the loopback interface. On another interface it needs a token or a list of allowed topics. A page in a
    browser needs the token, or its origin must be allowed; a page from a file has none.

    Args:
        port: TCP port; 0: any free one, see :attr:`port` after :meth:`start`.
        host: address of the interface.
        token: clients must send it as ``?token=...`` in the URL, or as ``Authorization: Bearer ...``.
        topics: patterns of topics and services that clients may use, such as ``/robot/*``; None: all.
        origins: pages that may connect without the token, such as ``http://localhost:8080``.

    Raises:
        InputError: the port is not allowed, or the server would be open to everybody.

    >>> RosbridgeServer(port=0).host
    '127.0.0.1'
    """

    name = "rosbridge"

    def __init__(
        self,
        port: int = PORT,
        host: str = "127.0.0.1",
        token: str = "",
        topics: Sequence[str] | None = None,
        origins: Sequence[str] = (),
    ) -> None:
        access = access_of(self.name, host, token, topics, origins)
        self.host, self.token = host, token
        self.topics = None if topics is None else tuple(topics)
        self._graph: RosGraph | None = None
        self._server = SocketServer(self.name, host, port, access, self._session)
        self._steps: deque[list[OutgoingMessage]] = deque(maxlen=MOST_STEPS)

    @classmethod
    def of(
        cls,
        address: str,
        host: str = "",
        token: str = "",
        topics: Sequence[str] | None = None,
        origins: Sequence[str] = (),
    ) -> RosbridgeServer:
        """Return the server of an address on the command line: a port, or nothing.

        Raises:
            InputError: the address is no port.
        """
        return cls(port_of(cls.name, address, PORT), host or "127.0.0.1", token, topics, origins)

    @property
    def port(self) -> int:
        """The TCP port."""
        return self._server.port

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Listen, or announce another interface to the clients.

        Raises:
            InputError: the port is in use.
        """
        if self._graph is not None:
            self._server.call(self._graph.change, interface)
            return
        self._graph = RosGraph(interface, inbox, self._server.call, self.topics)
        self._server.start()

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Hand the messages of a step to the thread of the server; if it is slow, the oldest steps are dropped."""
        self._steps.append([OutgoingMessage.of(message) for message in messages])
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
        wanted = self._graph.wanted if self._graph is not None else frozenset()
        if not topic.endswith("/"):
            return topic in wanted
        return any(item == topic[:-1] or item.startswith(topic) for item in wanted)

    def stop(self) -> None:
        """Disconnect all clients and stop listening."""
        self._server.stop()

    @property
    def sessions(self) -> list[ClientSession]:
        """The connected clients."""
        return [] if self._graph is None else list(self._graph.sessions)  # type: ignore[arg-type]

    def _session(self, wake: Callable[[], None]) -> ClientSession:
        assert self._graph is not None
        return ClientSession(self._graph, wake)

    def _deliver(self) -> None:
        assert self._graph is not None
        while self._steps:
            self._graph.deliver(self._steps.popleft())
