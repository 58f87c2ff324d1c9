"""FoxgloveServer: a live WebSocket server for the Foxglove app, and a layout of the app."""

from __future__ import annotations

import fnmatch
import ipaddress
import json
import logging
import re
import threading
from collections import Counter
from collections.abc import Sequence
from typing import Any, Protocol

from crowdbot.bridges.fields import fields_of, message_of
from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import SERVICES, RobotInterface, interface_store, request_kind, response_kind
from crowdbot.bridges.run_control import PAUSED, PLAYING
from crowdbot.core import InputError, import_optional
from crowdbot.messages import Messages
from crowdbot.recording import StepMessage
from crowdbot.trials import Trial

MOST_BYTES = 1 << 20
"""Largest message or request of a client [bytes]."""


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
        try:
            fields = json.loads(data or b"{}")
        except (ValueError, RecursionError):
            raise InputError("a message is not JSON") from None
        if not isinstance(fields, dict):
            raise InputError("a message must be a JSON object")
        return fields
    if encoding != "cdr":
        raise InputError(f"encoding {encoding[:40]!r} is not supported; use json or cdr")
    store = interface_store()
    if kind not in store.fielddefs:
        raise InputError(f"the message type {kind[:80]!r} is unknown")
    try:
        return fields_of(store.deserialize_cdr(data, kind))
    except Exception:  # rosbags raises many kinds of errors for bytes of another type
        raise InputError(f"a message is no CDR of {kind}") from None


STATE, RESET, STEPS = (f"/crowdbot/{name}" for name in ("set_simulation_state", "reset_simulation", "step_simulation"))
MOST_CHANNELS = 256
"""Largest number of channels that a client may advertise."""


class ServerPart(Protocol):
    """What a listener needs of its server."""

    name: str
    now: int

    def allows(self, name: str) -> bool:
        """Return whether clients may use a topic or service."""

    def report(self, level: str, text: str) -> None:
        """Send a status message to all clients."""

    def note_subscription(self, topic: str, change: int) -> None:
        """Count a subscription (1) or its end (-1)."""


class ClientListener:
    """Takes subscriptions, messages and playback requests of clients.

    Args:
        server: the server.
        inbox: receives commands and calls.
        websocket: module of the SDK.
    """

    def __init__(self, server: ServerPart, inbox: Inbox, websocket: Any) -> None:
        self.server, self.inbox, self.websocket = server, inbox, websocket
        self._channels: dict[tuple[int, int], tuple[str, str, str]] = {}
        self._speed = 1.0
        self._lock = threading.Lock()

    @property
    def has_channels(self) -> bool:
        """Whether a client can send messages."""
        with self._lock:
            return bool(self._channels)

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """Count a subscription."""
        self.server.note_subscription(channel.topic, 1)

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """Count the end of a subscription."""
        self.server.note_subscription(channel.topic, -1)

    def on_client_advertise(self, client: Any, channel: Any) -> None:
        """Note the topic and encoding of a channel of a client."""
        kind = re.sub(r"^(\w+)/(\w+)$", r"\1/msg/\2", channel.schema_name)
        with self._lock:
            if sum(one == client.id for one, _ in self._channels) < MOST_CHANNELS:
                self._channels[client.id, channel.id] = (channel.topic, channel.encoding, kind)

    def on_client_unadvertise(self, client: Any, client_channel_id: int) -> None:
        """Forget a channel of a client."""
        with self._lock:
            self._channels.pop((client.id, client_channel_id), None)

    def on_message_data(self, client: Any, client_channel_id: int, data: bytes) -> None:
        """Give a message to the inbox; what is wrong with it is told to the clients."""
        with self._lock:
            known = self._channels.get((client.id, client_channel_id))
        if known is None:
            return
        topic, encoding, kind = known
        try:
            if not self.server.allows(topic):
                raise InputError(f"{topic!r} is not among the topics that clients may use")
            self.inbox.receive(topic, decode_fields(data, encoding, kind), self.server.name)
        except InputError as error:
            self.server.report("error", str(error))

    def on_playback_control_request(self, request: Any) -> Any:
        """Pause, play, set the speed, or go to a time: later by hurrying, 0 by a new beginning, earlier not at all."""
        playing = request.playback_command == self.websocket.PlaybackCommand.Play
        sought, wanted = False, {"state": {"state": PLAYING if playing else PAUSED}}
        try:
            if not self.server.allows(STATE):
                raise InputError(f"{STATE!r} is not among the services that clients may use")
            self.inbox.call(STATE, wanted, _ignore, self.server.name)
            if request.playback_speed != self._speed:  # the app sends the speed that it shows with every request
                self.inbox.asked_pace.set_rate(request.playback_speed)
                self._speed = request.playback_speed
            if request.seek_time is not None:
                self._seek(request.seek_time, playing)
                sought = True
        except InputError as error:
            self.server.report("error", str(error))
        status = self.websocket.PlaybackStatus.Playing if playing else self.websocket.PlaybackStatus.Paused
        return self.websocket.PlaybackState(
            status=status, current_time=request.seek_time if sought else self.server.now, playback_speed=self._speed,
            did_seek=sought, request_id=request.request_id,
        )  # fmt: skip

    def _seek(self, nanoseconds: int, playing: bool) -> None:
        """Go to a time.

        Raises:
            InputError: the run cannot go there.
        """
        now, step = self.server.now, round(self.inbox.interface.trial.step * 1e9)
        if nanoseconds < step <= now:
            self.inbox.call(RESET, {}, _ignore, self.server.name)
        elif playing or nanoseconds < now:
            self.inbox.asked_pace.hurry_to(nanoseconds, now)
        elif steps := (nanoseconds - now) // step:
            self.inbox.call(STEPS, {"steps": steps}, _ignore, self.server.name)


def _ignore(response: object) -> None:
    """Take a response that nobody waits for."""


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


def foxglove_layout(trial: Trial) -> dict[str, Any]:
    """Return the layout for the first robot of a trial; write it as JSON and import it in the app.

    Args:
        trial: a trial with a robot.

    >>> from crowdbot.trials import load_trial
    >>> layout = foxglove_layout(load_trial("frontal"))
    >>> sorted(layout["configById"])
    ['3D!scene', 'Plot!speed', 'Teleop!drive']
    """
    interface, robot = RobotInterface.of(trial), trial.robots[0].name
    images = [one.name for one in interface.outputs if one.robot == robot and one.kind == "sensor_msgs/msg/Image"]
    panels: dict[str, Any] = {
        "3D!scene": _scene(interface, robot),
        "Plot!speed": _plot(robot),
        "Teleop!drive": _teleop(robot),
    }
    right: Any = {"direction": "column", "first": "Plot!speed", "second": "Teleop!drive", "splitPercentage": 50}
    if images:
        panels["Image!camera"] = {"imageMode": {"imageTopic": images[0]}, "cameraState": {}}
        right = {"direction": "column", "first": "Image!camera", "second": right, "splitPercentage": 40}
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {"direction": "row", "first": "3D!scene", "second": right, "splitPercentage": 70},
    }


def _scene(interface: RobotInterface, robot: str) -> dict[str, Any]:
    shown = {"sensor_msgs/msg/LaserScan", "sensor_msgs/msg/PointCloud2", "nav_msgs/msg/OccupancyGrid"}
    topics = {one.name: {"visible": True} for one in interface.outputs if one.kind in shown}
    return {
        "cameraState": {
            "perspective": True, "distance": 14.0, "phi": 50.0, "thetaOffset": 45.0, "targetOffset": [0, 0, 0],
            "target": [0, 0, 0], "targetOrientation": [0, 0, 0, 1], "fovy": 45.0, "near": 0.1, "far": 500.0,
        },
        "followMode": "follow-position",
        "followTf": f"{robot}/base_link",
        "scene": {},
        "transforms": {},
        "topics": {"/crowd/markers": {"visible": True}} | topics,
        "layers": {
            "grid": {"layerId": "foxglove.Grid", "instanceId": "grid", "visible": True, "size": 40, "divisions": 40},
            "urdf": {
                "layerId": "foxglove.Urdf", "instanceId": "urdf", "visible": True, "sourceType": "topic",
                "topic": f"/{robot}/robot_description", "framePrefix": "",
            },
        },
        "publish": {"type": "pose", "poseTopic": f"/{robot}/goal_pose"},
    }  # fmt: skip


def _plot(robot: str) -> dict[str, Any]:
    odometry = f"/{robot}/ground_truth/odom.twist.twist"
    paths = {"forward": f"{odometry}.linear.x", "turn": f"{odometry}.angular.z"}
    return {
        "title": "speed",
        "xAxisVal": "timestamp",
        "followingViewWidth": 30,
        "paths": [
            {"value": path, "label": label, "enabled": True, "timestampMethod": "receiveTime"}
            for label, path in paths.items()
        ],
    }  # fmt: skip


def _teleop(robot: str) -> dict[str, Any]:
    buttons = {
        "up": ("linear-x", 0.5),
        "down": ("linear-x", -0.3),
        "left": ("angular-z", 0.8),
        "right": ("angular-z", -0.8),
    }
    found: dict[str, Any] = {"topic": f"/{robot}/cmd_vel", "publishRate": 10}
    return found | {f"{name}Button": {"field": field, "value": value} for name, (field, value) in buttons.items()}
