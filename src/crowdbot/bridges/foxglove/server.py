"""FoxgloveServer: a live WebSocket server for the Foxglove app and other clients of its protocol."""

from __future__ import annotations

import fnmatch
import ipaddress
import logging
import threading
from collections import Counter
from collections.abc import Sequence
from typing import Any

from crowdbot.bridges.fields import message_of
from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.bridges.verbs.definitions import SERVICES, interface_store, request_kind, response_kind
from crowdbot.core import InputError, import_optional
from crowdbot.messages import Messages
from crowdbot.recording import StepMessage

from .decoding import decode_fields
from .listener import ClientListener

PORT = 8765
BACKLOG = 256
"""Messages that wait for a slow client; the oldest are dropped."""
ANSWER_TIME = 60.0
"""Longest real time [s] that a call waits for its answer."""


class FoxgloveServer:
    """A server of the Foxglove WebSocket protocol, with the messages of the recorder as CDR.

    Clients can publish commands (JSON or CDR), call the services (CDR), pause and play. A slow client loses old
    messages. The protocol has no password: it listens on the loopback interface; on another one it needs a list of
    allowed topics.

    Args:
        port: TCP port; 0: any free one, see :attr:`port` after :meth:`start`.
        host: address of the interface.
        topics: patterns of topics and services that clients may use, such as ``/robot/*``; None: all.

    Raises:
        MissingExtra: foxglove-sdk is not installed.
        InputError: the port is not allowed, or the server would be open to everybody.

    >>> FoxgloveServer(port=0).host
    '127.0.0.1'
    """

    name = "foxglove"

    def __init__(self, port: int = PORT, host: str = "127.0.0.1", topics: Sequence[str] | None = None) -> None:
        self._sdk: Any = import_optional("foxglove", "the Foxglove server", "foxglove")
        if not 0 <= port <= 65535:
            raise InputError(f"port {port} must be from 0 to 65535")
        if not _is_loopback(host) and topics is None:
            raise InputError(
                f"a server on {host} is open to everybody; give a list of allowed topics and services, --bridge-topics"
            )
        self.port, self.host = port, host
        self.topics = None if topics is None else tuple(topics)
        self.now = 0
        """Simulated time [ns]."""
        self._server: Any = None
        self._context: Any = None
        self._listener: ClientListener | None = None
        self._channels: dict[str, tuple[str, Any]] = {}
        self._latched: dict[str, StepMessage] = {}
        self._keep: frozenset[str] = frozenset()
        self._again: set[str] = set()
        self._lock = threading.Lock()
        self._wanted: Counter[str] = Counter()
        self._make = Messages()
        self._stopped = threading.Event()

    @classmethod
    def of(cls, address: str, host: str = "", topics: Sequence[str] | None = None) -> FoxgloveServer:
        """Return the server of an address on the command line: a port, or nothing.

        Raises:
            InputError: the address is no port.
        """
        if address and not (address.isdecimal() and len(address) < 6):
            raise InputError(f"foxglove:{address[:40]} must be foxglove or foxglove:PORT, such as foxglove:{PORT}")
        return cls(int(address or PORT), host or "127.0.0.1", topics)

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Listen, or announce another trial to the clients, whose views then begin anew.

        Raises:
            InputError: the port is in use.
        """
        self._keep = frozenset(one.name for one in interface.outputs if one.quality.latched)
        if self._server is None:
            self._context = self._sdk.Context()
            self._open(interface, inbox)
        else:
            self._server.clear_session()
        self._announce(interface)

    def _open(self, interface: RobotInterface, inbox: Inbox) -> None:
        self._listener = listener = ClientListener(self, inbox, self._sdk.websocket)
        logging.getLogger("foxglove").addHandler(logging.NullHandler())  # bad frames are no news for the console
        capability = self._sdk.websocket.Capability
        try:
            self._server = self._sdk.start_server(
                name="crowdbot",
                host=self.host,
                port=self.port,
                capabilities=[capability.ClientPublish, capability.Services, capability.Time],
                server_listener=listener,
                supported_encodings=["cdr", "json"],
                services=self._services(inbox),
                context=self._context,
                playback_time_range=(0, round(interface.trial.duration * 1e9)),
                message_backlog_size=BACKLOG,
            )
        except (RuntimeError, OSError, ValueError) as error:
            raise InputError(f"foxglove cannot listen on {self.host}:{self.port}: {error}") from None
        self.port = int(self._server.port)

    def _announce(self, interface: RobotInterface) -> None:
        """Offer a channel for each output that clients may see, and no others."""
        wanted = {one.name: one.kind for one in interface.outputs if self.allows(one.name)}
        for topic, (kind, channel) in list(self._channels.items()):
            if wanted.get(topic) != kind:
                channel.close()
                del self._channels[topic]
                self._latched.pop(topic, None)
        for topic, kind in wanted.items():
            if topic not in self._channels:
                schema = self._sdk.Schema(name=kind, encoding="ros2msg", data=self._make.definition(kind).encode())
                channel = self._sdk.Channel(topic, message_encoding="cdr", schema=schema, context=self._context)
                self._channels[topic] = (kind, channel)

    def allows(self, name: str) -> bool:
        """Return whether clients may use a topic or service."""
        return self.topics is None or any(fnmatch.fnmatchcase(name, one) for one in self.topics)

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Send the messages of a step; ``/clock`` also sets the time of the clients."""
        for one in messages:
            if one.topic in self._keep:
                self._latched[one.topic] = one
            if one.topic == "/clock":
                self.now = one.nanoseconds
                self._server.broadcast_time(one.nanoseconds)
            if one.topic in self._channels:
                self._channels[one.topic][1].log(one.cdr, log_time=one.nanoseconds)
        self.poll()

    def poll(self) -> None:
        """Send latched messages to new subscribers; what arrives is given to the inbox by the threads of the server."""
        with self._lock:
            again, self._again = self._again, set()
        for topic in again:
            if topic in self._latched and topic in self._channels:
                one = self._latched[topic]
                self._channels[topic][1].log(one.cdr, log_time=one.nanoseconds)

    def report(self, level: str, text: str) -> None:
        """Send a status message to all clients."""
        kinds = self._sdk.websocket.StatusLevel
        levels = {"info": kinds.Info, "warning": kinds.Warning, "error": kinds.Error}
        self._server.publish_status(text, levels.get(level, kinds.Error))

    def wants(self, topic: str) -> bool:
        """Return whether a client subscribes a topic, or with a final slash one that starts with it.

        The time is sent to all clients, so that one that sends commands wants it.
        """
        with self._lock:
            wanted = [one for one, count in self._wanted.items() if count > 0]
        if self._listener is not None and self._listener.has_channels:
            wanted.append("/clock")
        if not topic.endswith("/"):
            return topic in wanted or topic == "/clock"
        return any(one == topic[:-1] or one.startswith(topic) for one in wanted)

    def stop(self) -> None:
        """Disconnect all clients and stop listening."""
        self._stopped.set()
        if self._server is not None:
            self._server.stop()
            for _, channel in self._channels.values():
                channel.close()
            self._channels = {}

    def note_subscription(self, topic: str, change: int) -> None:
        """Count a subscription (1) or its end (-1); called by the threads of the server."""
        with self._lock:
            self._wanted[topic] += change
            if change > 0 and topic in self._keep:
                self._again.add(topic)

    def _services(self, inbox: Inbox) -> list[Any]:
        sdk, found = self._sdk, []
        for name, service in SERVICES.items():
            full = f"/crowdbot/{name}"
            if not self.allows(full):
                continue
            request, response = (
                sdk.MessageSchema(
                    encoding="cdr",
                    schema=sdk.Schema(name=kind, encoding="ros2msg", data=_definition(kind).encode()),
                )
                for kind in (request_kind(service), response_kind(service))
            )
            schema = sdk.ServiceSchema(f"simulation_interfaces/srv/{service.kind}", request=request, response=response)

            def handle(call: Any, full: str = full, service: Any = service) -> bytes:
                return self._answer(call, full, service, inbox)

            found.append(sdk.Service(full, schema=schema, handler=handle))
        return found

    def _answer(self, call: Any, name: str, service: Any, inbox: Inbox) -> bytes:
        """Return the response to a call; runs in a thread of the server, and errors become those of the protocol."""
        fields = decode_fields(call.payload, call.encoding, request_kind(service))
        done, found = threading.Event(), list[dict[str, Any]]()

        def answer(response: dict[str, Any]) -> None:
            found.append(response)
            done.set()

        inbox.call(name, fields, answer, self.name)
        waited = 0.0
        while not done.wait(0.1):
            waited += 0.1
            if self._stopped.is_set() or waited > ANSWER_TIME:
                raise InputError(f"{name} has no answer: the run has ended or is busy")
        kind = response_kind(service)
        return bytes(interface_store().serialize_cdr(message_of(found[0], kind), kind))


def _definition(kind: str) -> str:
    return str(interface_store().generate_msgdef(kind, ros_version=2)[0])


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
