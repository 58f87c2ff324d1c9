"""FoxgloveSession: one client of a Foxglove server and what it asks, without any connection."""

from __future__ import annotations

import functools
import itertools
import json
import re
import struct
import uuid
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from crowdbot.bridges.fields import fields_of, memory_size, message_of
from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import SERVICES, RobotInterface, interface_store, request_kind, response_kind
from crowdbot.bridges.simulation_interfaces import STATE_PAUSED, STATE_PLAYING
from crowdbot.bridges.socket_server import Backlog, MessageQueue
from crowdbot.bridges.socket_transport import SessionGraph
from crowdbot.core import InputError
from crowdbot.recording import StepMessage

MOST_BYTES = 1 << 20
"""Largest message or request of a client [bytes]."""
MOST_ROWS, MOST_REPLIES = 1000, 1000
"""Largest number of channels and of subscriptions of a client, and of frames that wait for it; the oldest go."""
EVENTS = 100
"""Number of messages that wait for a client on a topic of events; of other topics the newest waits."""
STATE, RESET, STEPS = (f"/crowdbot/{name}" for name in ("set_simulation_state", "reset_simulation", "step_simulation"))
MESSAGE, TIME, RESPONSE, PLAYBACK = 1, 2, 3, 5
"""First byte of binary frames to a client."""
LEVELS = {"info": 0, "warning": 1, "error": 2}


def decode_fields(data: bytes, encoding: str, kind: str) -> dict[str, Any]:
    """Return the fields of a message from a client.

    Raises:
        InputError: the encoding is not supported, or the data are not of the type.

    >>> decode_fields(b'{"steps": 3}', "json", "simulation_interfaces/msg/StepSimulation_Request")
    {'steps': 3}
    """
    if len(data) > MOST_BYTES:
        raise InputError(f"a message has {len(data)} bytes; at most {MOST_BYTES} are allowed")
    if encoding == "json":
        return _read_json(data or b"{}")
    if encoding != "cdr":
        raise InputError(f"encoding {encoding[:40]!r} is not supported; use json or cdr")
    store = interface_store()
    if kind not in store.fielddefs:
        raise InputError(f"the message type {kind[:80]!r} is unknown")
    try:
        return fields_of(store.deserialize_cdr(data, kind))
    except Exception:  # rosbags raises many kinds of errors for bytes of another type
        raise InputError(f"a message is no CDR of {kind}") from None


def _read_json(data: str | bytes) -> dict[str, Any]:
    try:
        fields = json.loads(data)
    except (ValueError, RecursionError):
        raise InputError("a message is not JSON") from None
    if not isinstance(fields, dict):
        raise InputError("a message must be a JSON object")
    return fields


@functools.cache
def _schema(kind: str) -> str:
    """Return the definition of a message type with all its parts; the text is slow to make, and each client gets it."""
    return str(interface_store().generate_msgdef(kind, ros_version=2)[0])


class FoxgloveGraph(SessionGraph):
    """What the clients of a server of Foxglove see.

    Their views begin anew when the topics change; topics that are kept stay subscribed. ``/clock`` is also their time.
    """

    sessions: list[FoxgloveSession]

    def __init__(
        self,
        interface: RobotInterface,
        inbox: Inbox,
        later: Callable[..., Any],
        allowed: Sequence[str] | None = None,
    ) -> None:
        super().__init__(interface, inbox, later, allowed)
        self.speed = 1.0
        """Speed that the clients show."""
        self.latched: dict[str, StepMessage] = {}
        self.channels: dict[str, tuple[int, str]] = {}
        """Number and message type of each topic."""
        self.services = {k: name for k, name in enumerate(SERVICES, 1) if self.allows(f"/crowdbot/{name}")}
        self._numbers = itertools.count(1)
        self.change(interface)

    def change(self, interface: RobotInterface) -> None:
        self.interface, self._session = interface, uuid.uuid4().hex
        self.outputs = {output.name: output for output in interface.outputs if self.allows(output.name)}
        gone = [topic for topic, (_, kind) in self.channels.items() if self._kind(topic) != kind]
        numbers = [self.channels.pop(topic)[0] for topic in gone]
        new = [topic for topic in self.outputs if topic not in self.channels]
        self.channels |= {topic: (next(self._numbers), self.outputs[topic].kind) for topic in new}
        self.latched = {topic: item for topic, item in self.latched.items() if topic in self.channels}
        for session in self.sessions:
            session.forget(gone)
            session.reply(self.server_info())
            session.reply({"op": "unadvertise", "channelIds": numbers})
            session.reply(self.advertisement(new))
        self.collect_subscriptions()

    def deliver(self, messages: Sequence[StepMessage]) -> None:
        for message in messages:
            if message.topic in self.outputs and self.outputs[message.topic].quality.latched:
                self.latched[message.topic] = message
            if message.topic == "/clock":
                self.now = message.nanoseconds
            for session in self.sessions:
                session.offer(message)

    def collect_subscriptions(self) -> None:
        """Collect the topics that clients subscribe; a client that sends commands wants the time."""
        wanted = {topic for session in self.sessions for topic in session.subscriptions.values()}
        self.wanted = frozenset(
            wanted | {"/clock"} if any(session.has_channels for session in self.sessions) else wanted
        )

    def server_info(self) -> dict[str, Any]:
        """Return what a client is told first."""
        seconds, nanoseconds = divmod(round(self.interface.trial.duration * 1e9), 10**9)
        return {
            "op": "serverInfo",
            "name": "crowdbot",
            "capabilities": ["clientPublish", "services", "time", "playbackControl"],
            "supportedEncodings": ["cdr", "json"],
            "sessionId": self._session,
            "dataStartTime": {"sec": 0, "nsec": 0},
            "dataEndTime": {"sec": seconds, "nsec": nanoseconds},
        }

    def advertisement(self, topics: Sequence[str]) -> dict[str, Any]:
        """Return the announcement of channels."""
        rows = [
            {
                "id": self.channels[topic][0],
                "topic": topic,
                "encoding": "cdr",
                "schemaName": self.channels[topic][1],
                "schemaEncoding": "ros2msg",
                "schema": _schema(self.channels[topic][1]),
            }
            for topic in topics
        ]
        return {"op": "advertise", "channels": rows}

    def service_advertisement(self) -> dict[str, Any]:
        """Return the announcement of the services."""

        def schema(kind: str) -> dict[str, str]:
            return {"encoding": "cdr", "schemaName": kind, "schemaEncoding": "ros2msg", "schema": _schema(kind)}

        rows = [
            {
                "id": number,
                "name": f"/crowdbot/{name}",
                "type": f"simulation_interfaces/srv/{SERVICES[name].kind}",
                "request": schema(request_kind(SERVICES[name])),
                "response": schema(response_kind(SERVICES[name])),
            }
            for number, name in self.services.items()
        ]
        return {"op": "advertiseServices", "services": rows}

    def _kind(self, topic: str) -> str:
        return self.outputs[topic].kind if topic in self.outputs else ""


class FoxgloveSession:
    """Takes the frames of a client in the protocol ``foxglove.sdk.v1``, and holds the frames for it.

    Every error is answered with a status message; nothing that a client sends raises an exception.

    Args:
        graph: topics and services.
        wake: called when frames wait.
    """

    def __init__(self, graph: FoxgloveGraph, wake: Callable[[], None]) -> None:
        self.graph, self.wake = graph, wake
        self.subscriptions: dict[int, str] = {}
        """Topics by the number that the client gives its subscription."""
        self._backlog = Backlog()
        self._waiting: dict[int, MessageQueue[StepMessage]] = {}
        self._channels: dict[int, tuple[str, str, str]] = {}
        self._replies = MessageQueue[str | bytes](self._backlog, MOST_REPLIES)
        self._time: int | None = None
        graph.sessions.append(self)
        for frame in (graph.server_info(), graph.advertisement([*graph.channels]), graph.service_advertisement()):
            self.reply(frame)

    @property
    def has_channels(self) -> bool:
        """Whether the client can send messages."""
        return bool(self._channels)

    def handle(self, data: str | bytes) -> None:
        """Do what a frame of the client asks."""
        try:
            if isinstance(data, str):
                self._operate(_read_json(data))
            else:
                self._operate_bytes(data)
        except InputError as error:
            self.status("error", str(error))
        except (struct.error, RecursionError, ValueError, TypeError, AttributeError, KeyError, IndexError) as error:
            self.status("error", f"the frame has a wrong form: {str(error)[:100]}")

    def status(self, level: str, text: str) -> None:
        """Send a status message."""
        self.reply({"op": "status", "level": LEVELS[level], "message": text})

    def reply(self, frame: Mapping[str, Any] | bytes) -> None:
        """Send a frame; the oldest are dropped if the client does not read them."""
        data = frame if isinstance(frame, bytes) else json.dumps(frame)
        self._replies.append(data, len(data))
        self.wake()

    def offer(self, message: StepMessage) -> None:
        """Let a message wait in each subscription of its topic, and its time if it is that of the clock."""
        if message.topic == "/clock":
            self._time = message.nanoseconds
            self.wake()
        for number, topic in self.subscriptions.items():
            if topic == message.topic:
                self._waiting[number].append(message, memory_size(message.content))
                self.wake()

    def take(self) -> tuple[list[str | bytes], float | None]:
        """Return the frames that wait."""
        frames = self._replies.clear()
        if self._time is not None:
            frames.append(struct.pack("<BQ", TIME, self._time))
            self._time = None
        for number, waiting in self._waiting.items():
            head = (MESSAGE, number)
            frames += [struct.pack("<BIQ", *head, item.nanoseconds) + item.cdr for item in waiting.clear()]
        return frames, None

    def forget(self, topics: Sequence[str]) -> None:
        """End the subscriptions of topics that are no more."""
        for number in [number for number, topic in self.subscriptions.items() if topic in topics]:
            del self.subscriptions[number]
            self._waiting.pop(number).clear()

    def close(self) -> None:
        """Forget the client."""
        self.graph.sessions.remove(self)
        self.graph.collect_subscriptions()

    def _operate(self, frame: Mapping[str, Any]) -> None:
        operations: dict[str, tuple[str, Callable[[Any], None]]] = {
            "subscribe": ("subscriptions", self._subscribe),
            "unsubscribe": ("subscriptionIds", self._unsubscribe),
            "advertise": ("channels", self._advertise),
            "unadvertise": ("channelIds", self._unadvertise),
        }
        name = frame.get("op")
        if name not in operations:
            raise InputError(f"the operation {str(name)[:40]!r} is unknown; known are {', '.join(operations)}")
        rows, operate = operations[name]
        for row in frame[rows]:
            operate(row)
        self.graph.collect_subscriptions()

    def _subscribe(self, row: Mapping[str, Any]) -> None:
        number, channel = _number(row["id"]), _number(row["channelId"])
        topic = next((topic for topic, (own, _) in self.graph.channels.items() if own == channel), None)
        if topic is None or number in self.subscriptions:
            raise InputError(f"subscription {number}: channel {channel} does not exist, or the number is in use")
        if len(self.subscriptions) >= MOST_ROWS:
            raise InputError(f"{MOST_ROWS} subscriptions are too many")
        output = self.graph.outputs[topic]
        depth = 1 if output.rate or output.quality.latched else EVENTS
        self.subscriptions[number], self._waiting[number] = topic, MessageQueue(self._backlog, depth)
        if topic in self.graph.latched:
            self.offer(self.graph.latched[topic])

    def _unsubscribe(self, number: Any) -> None:
        if self.subscriptions.pop(_number(number), None) is None:
            raise InputError(f"there is no subscription {number}")
        self._waiting.pop(_number(number)).clear()

    def _advertise(self, row: Mapping[str, Any]) -> None:
        number, topic, encoding, kind = (row[name] for name in ("id", "topic", "encoding", "schemaName"))
        if not all(isinstance(item, str) and len(item) < 200 for item in (topic, encoding, kind)):
            raise InputError("a channel needs topic, encoding and schemaName, each a text below 200 characters")
        if len(self._channels) >= MOST_ROWS:
            raise InputError(f"{MOST_ROWS} channels are too many")
        self._channels[_number(number)] = (topic, encoding, re.sub(r"^(\w+)/(\w+)$", r"\1/msg/\2", kind))

    def _unadvertise(self, number: Any) -> None:
        self._channels.pop(_number(number), None)

    def _operate_bytes(self, data: bytes) -> None:
        operations = {1: self._take_message, 2: self._call, 3: self._control_playback}
        if data[:1] not in (b"\1", b"\2", b"\3"):
            raise InputError("the first byte of a binary frame must be 1 (message), 2 (service call) or 3 (playback)")
        operations[data[0]](data)

    def _take_message(self, data: bytes) -> None:
        (number,) = struct.unpack_from("<I", data, 1)
        if number not in self._channels:
            raise InputError(f"channel {number} is not advertised")
        topic, encoding, kind = self._channels[number]
        self._check(topic, "topics")
        self.graph.inbox.receive(topic, decode_fields(data[5:], encoding, kind), "foxglove")

    def _call(self, data: bytes) -> None:
        service, number, size = struct.unpack_from("<III", data, 1)
        encoding = data[13 : 13 + size].decode()
        try:
            if service not in self.graph.services:
                raise InputError(f"there is no service {service}")
            name = self.graph.services[service]
            kind = response_kind(SERVICES[name])

            def respond(response: Mapping[str, Any]) -> None:
                payload = bytes(interface_store().serialize_cdr(message_of(response, kind), kind))
                self.reply(struct.pack("<BIII3s", RESPONSE, service, number, 3, b"cdr") + payload)

            request = decode_fields(data[13 + size :], encoding, request_kind(SERVICES[name]))
            self.graph.inbox.call(
                f"/crowdbot/{name}", request, lambda response: self.graph.later(respond, response), "foxglove"
            )
        except InputError as error:
            self.reply({"op": "serviceCallFailure", "serviceId": service, "callId": number, "message": str(error)})

    def _control_playback(self, data: bytes) -> None:
        """Pause, play, set the speed, or go to a time: later by hurrying, 0 by a new beginning, earlier not at all."""
        command, speed, seeks, time, size = struct.unpack_from("<BfBQI", data, 1)
        name, graph = data[19 : 19 + size], self.graph
        if command not in (0, 1) or len(name) < size:
            raise InputError(f"playback command {command} must be 0 (play) or 1 (pause), with a request id")
        sought, playing = False, command == 0
        try:
            self._check(STATE, "services")
            graph.inbox.call(
                STATE, {"state": {"state": STATE_PLAYING if playing else STATE_PAUSED}}, _ignore, "foxglove"
            )
            if speed != graph.speed:  # the app sends the speed that it shows with every request
                graph.inbox.asked_pace.set_rate(speed)
                graph.speed = speed
            if seeks:
                self._seek(time, playing)
                sought = True
        except InputError as error:
            self.status("error", str(error))
        state = (not playing, time if sought else graph.now, graph.speed, sought, len(name))
        self.reply(struct.pack("<BBQfBI", PLAYBACK, *state) + name)

    def _seek(self, nanoseconds: int, playing: bool) -> None:
        """Go to a time.

        Raises:
            InputError: the run cannot go there.
        """
        inbox, now = self.graph.inbox, self.graph.now
        step = round(inbox.interface.trial.step * 1e9)
        if nanoseconds < step <= now:
            inbox.call(RESET, {}, _ignore, "foxglove")
        elif playing or nanoseconds < now:
            inbox.asked_pace.hurry_to(nanoseconds, now)
        elif steps := (nanoseconds - now) // step:
            inbox.call(STEPS, {"steps": steps}, _ignore, "foxglove")

    def _check(self, name: str, what: str) -> None:
        if not self.graph.allows(name):
            raise InputError(f"{name!r} is not among the {what} that clients may use")


def _number(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 1 << 32:
        raise InputError(f"a number of a channel or subscription must be from 0 to 4294967295, not {str(value)[:40]!r}")
    return value


def _ignore(response: object) -> None:
    """Take a response that nobody waits for."""
