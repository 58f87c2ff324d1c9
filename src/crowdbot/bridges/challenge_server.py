"""ChallengeServer: the TCP server of the CrowdBot challenge (ICRA 2021), to which its clients connect unchanged.

A request is ``clock=0.1;vel_cmd=1.0 10.0;sim_control=i;``: time [s], speed [m/s] and turn rate [deg/s], and a letter.
It has no other end than the last semicolon. A reply is ``clock=3#0.1;crowd=3#0.1 2 (0 1.0 2.0) (1 ...);...;@``: topic,
number of the reply, and payload. The text ``stop`` ends the simulation.
"""

from __future__ import annotations

import base64
import contextlib
import io
import math
import socket
import threading
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from crowdbot.bridges.fields import stamp_fields
from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.bridges.simulation_interfaces import STATE_QUITTING
from crowdbot.bridges.transport import is_among
from crowdbot.core import InputError
from crowdbot.recording import StepMessage

LONGEST = 4096
"""Largest size of a request [bytes]."""
SCAN = "sensor_msgs/msg/LaserScan"
NO_PICTURE, QUALITY = "JPG", 80
"""Payload of the camera while there is no picture, and quality of pictures."""
CONTROLS = "inprfls"
"""Letters of ``sim_control``: idle, next, previous, reset, first, last, stop."""


class ChallengeRequest(NamedTuple):
    """A request of a client.

    Fields:
        clock: time up to which the simulation runs [s]; None: none is given.
        commands: speed [m/s] and turn rate [rad/s] by name of the robot; empty: the first robot.
        control: a letter of :data:`CONTROLS`.
    """

    clock: float | None
    commands: Mapping[str, tuple[float, float]]
    control: str


def read_request(text: str) -> ChallengeRequest:
    """Return the request of a text.

    Raises:
        InputError: the text is no request.

    >>> read_request("clock=0.1;vel_cmd=1.0 90.0;sim_control=i;").clock
    0.1
    """
    clock: float | None = None
    commands: dict[str, tuple[float, float]] = {}
    control = "i"
    if text.strip() == "stop":
        return ChallengeRequest(None, {}, "s")
    for part in text.split(";"):
        key, sign, value = part.strip().partition("=")
        if not key and not value:
            continue
        if not sign:
            raise InputError(f"{part[:40]!r} must be key=value")
        if key == "clock":
            clock = _numbers(key, value, 1)[0]
        elif key == "vel_cmd" or key.startswith("vel_cmd_"):
            speed, turn = _numbers(key, value, 2)
            commands[key.removeprefix("vel_cmd").removeprefix("_")] = (speed, math.radians(turn))
        elif key == "sim_control":
            control = value.strip()
            if len(control) != 1 or control not in CONTROLS:
                raise InputError(f"sim_control={value[:20]!r} must be one of {', '.join(CONTROLS)}")
        else:
            raise InputError(f"there is no key {key[:40]!r}; keys are clock, vel_cmd, vel_cmd_NAME and sim_control")
    if clock is not None and not 0.0 <= clock <= 1e6:
        raise InputError(f"clock={clock:g} must be from 0 to 1e6 s")
    return ChallengeRequest(clock, commands, control)


def _numbers(key: str, value: str, count: int) -> list[float]:
    try:
        numbers = [float(word) for word in value.split()]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        raise InputError(f"{key}={value[:40]!r} must have {count} finite numbers")
    return numbers


def encode_picture(image: Any) -> str:
    """Return a ``sensor_msgs/Image`` of colours as a JPEG file in base64."""
    from PIL import Image  # slow to import, and needed for robots with cameras only

    size = (int(image.width), int(image.height))
    stream = io.BytesIO()
    Image.frombytes("RGB", size, bytes(image.data)).save(stream, "JPEG", quality=QUALITY)
    return base64.b64encode(stream.getvalue()).decode()


def encode_scan(scan: Any) -> str:
    """Return a ``sensor_msgs/LaserScan`` as text: time [s], angle of the first beam and to the next [deg], ranges [m].

    Angles count counter-clockwise from the front of the sensor. ``inf`` is nothing within the range, ``-inf`` something
    nearer than the range, and ``nan`` a failure (REP-117). Nothing says whom a beam has met. A range has at most 12
    characters, with the space.
    """
    stamp = scan.header.stamp
    angles = (math.degrees(scan.angle_min), math.degrees(scan.angle_increment))
    head = (stamp.sec + stamp.nanosec / 1e9, *angles)
    return " ".join([*(f"{value:.9g}" for value in head), *(f"{value:.6g}" for value in scan.ranges.tolist())])


def format_reply(number: int, payloads: Mapping[str, str]) -> bytes:
    """Return a reply.

    >>> format_reply(3, {"clock": "0.1", "report": ""})
    b'clock=3#0.1;report=3#;@'
    """
    return "".join(f"{topic}={number}#{payload};" for topic, payload in payloads.items()).encode() + b"@"


PORT = 25001
LOOK = 0.1
"""Longest real time [s] until a thread sees that the run has ended."""
LATEST = 60.0
"""Longest real time [s] of a step that a client waits for."""


class ChallengeServer:
    """A server for one client that drives in lock step: with ``--clock follow``, each request moves the time.

    The reply has the topics ``clock``, ``crowd`` (people: number x y), ``odom`` of the first robot (x y theta and their
    velocities in the same frame, in m and degrees), ``report`` (contacts), ``lidar`` (the latest scan of the first
    laser of this robot; those of others are ``lidar_NAME``) and ``camera`` (the latest picture of its first colour
    camera). The list of scenarios is the one trial, so that next, previous, first, last and reset all begin it again.

    Args:
        port: TCP port; 0: any free one, see :attr:`port` after :meth:`start`.

    Raises:
        InputError: the port is not allowed.

    >>> ChallengeServer().port
    25001
    """

    name = "tcp"

    def __init__(self, port: int = PORT) -> None:
        if not 0 <= port <= 65535:
            raise InputError(f"port {port} must be from 0 to 65535")
        self.port = port
        self._listener: socket.socket | None = None
        self._thread: threading.Thread | None = None
        self._ended = False
        self._state = threading.Condition()
        self._payloads: dict[str, str] = {}
        self._now, self._step, self._number, self._contacts = -1, 1, 0, list[str]()
        self._told: int | None = None
        self._interface: RobotInterface | None = None
        self._inbox: Inbox | None = None
        self._camera, self._lasers = "", dict[str, str]()
        self._picture: Any = None
        self._scans: dict[str, Any] = {}

    @classmethod
    def of(cls, address: str) -> ChallengeServer:
        """Return the server of an address on the command line: a port, or nothing.

        Raises:
            InputError: the address is no port.
        """
        if address and not address.isdecimal():
            raise InputError(f"tcp:{address[:40]} must be tcp or tcp:PORT, such as tcp:{PORT}")
        return cls(int(address or PORT))

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Listen, or forget the state of the last run.

        Raises:
            InputError: the port is in use, or the trial has no robot.
        """
        if not interface.trial.robots:
            raise InputError(f"the bridge tcp needs a robot, and trial {interface.trial.name!r} has none")
        with self._state:
            self._interface, self._inbox, self._payloads, self._now = interface, inbox, {}, -1
            self._camera, self._picture = _colour_image(interface), None
            self._lasers, self._scans = _lasers(interface), {}
            self._step = round(interface.trial.step * 1e9)
        if self._listener is not None:
            return
        try:
            self._listener = socket.create_server(("127.0.0.1", self.port))
        except OSError as error:
            raise InputError(f"tcp cannot listen on 127.0.0.1:{self.port}: {error.strerror}") from None
        self.port = self._listener.getsockname()[1]
        self._listener.settimeout(LOOK)
        self._thread = threading.Thread(target=self._serve, name="tcp", daemon=True)
        self._thread.start()

    def wants(self, topic: str) -> bool:
        """Return whether a topic is part of the replies, or with a final slash one that starts with it."""
        sent = ("/clock", "/people", self._odometry, self._camera, "/crowdbot/contacts", *self._lasers)
        return is_among(topic, sent)

    @property
    def _robot(self) -> str:
        assert self._interface is not None
        return self._interface.trial.robots[0].name

    @property
    def _odometry(self) -> str:
        return f"/{self._robot}/odom"

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Keep what the next reply says."""
        with self._state:
            for message in messages:
                if message.topic == self._camera:
                    self._picture = message.message
                elif message.topic in self._lasers:
                    self._scans[message.topic] = message.message
                elif message.topic in ("/people", self._odometry, "/crowdbot/contacts"):
                    self._keep(message)
            if messages:
                self._now = messages[-1].nanoseconds
                self._payloads["clock"] = f"{self._now / 1e9:.9g}"
            self._state.notify_all()

    def _keep(self, step_message: StepMessage) -> None:
        stamp = f"{step_message.nanoseconds / 1e9:.9g}"
        if step_message.topic == "/people":
            people = step_message.message.people
            rows = [f"({k} {man.position.x:.9g} {man.position.y:.9g})" for k, man in enumerate(people)]
            self._payloads["crowd"] = " ".join([stamp, str(len(rows)), *rows])
        elif step_message.topic == self._odometry:
            self._payloads["odom"] = " ".join([stamp, *(f"{value:.9g}" for value in _planar(step_message.message))])
        else:
            self._contacts += [f"{man.robot} {man.other}" for man in step_message.message.contacts]

    def poll(self) -> None:
        """Do nothing: a thread serves the client."""

    def report(self, level: str, text: str) -> None:
        """Do nothing: the protocol has no messages about problems."""

    def stop(self) -> None:
        """Disconnect the client and stop listening."""
        with self._state:
            self._ended = True
            self._state.notify_all()
        if self._thread is not None:
            self._thread.join()
        if self._listener is not None:
            self._listener.close()

    def _serve(self) -> None:
        assert self._listener is not None
        while not self._ended:
            try:
                client, _ = self._listener.accept()
            except TimeoutError:
                continue
            with client, contextlib.suppress(OSError):
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                client.settimeout(LOOK)
                self._talk(client)

    def _talk(self, client: socket.socket) -> None:
        """Answer the requests of a client until it goes or sends what is no request."""
        text, self._told = b"", None
        while not self._ended:
            try:
                part = client.recv(LONGEST)
            except TimeoutError:
                continue
            text += part
            if not part or len(text) > LONGEST:
                return
            if not text.endswith(b";") and text.strip() != b"stop":
                continue
            try:
                request = read_request(text.decode("utf-8", "replace"))
                self._take(request)
            except InputError:  # the protocol has no words for errors
                return
            text = b""
            client.settimeout(LATEST)
            client.sendall(self._reply())
            client.settimeout(LOOK)
            if request.control == "s":
                return

    def _take(self, request: ChallengeRequest) -> None:
        """Give a request to the simulation and wait until it has come to its time.

        A command answers the instant of the latest reply: a client has one request on its way.
        """
        assert self._inbox is not None
        if request.control != "i":
            self._control(request.control)
            self._told = None
        names = {robot.name for robot in self._interface.trial.robots} if self._interface else set()
        for name, (speed, turn) in request.commands.items():
            if not name or name in names:
                twist = {"linear": {"x": speed}, "angular": {"z": turn}}
                self._inbox.receive(f"/{name or self._robot}/cmd_vel", twist, self.name, self._told)
        target = None
        if request.clock is not None and any(
            input_topic.name == "/clock" for input_topic in self._inbox.interface.inputs
        ):
            target = round(request.clock * 1e9)
            self._inbox.receive("/clock", {"clock": stamp_fields(target)}, self.name)
        with self._state:
            self._state.wait_for(lambda: self._ended or self._is_at(target), LATEST)

    def _is_at(self, target: int | None) -> bool:
        return self._now >= 0 and (target is None or self._now + self._step > target)

    def _control(self, letter: str) -> None:
        """Begin the trial again, or end the simulation."""
        assert self._inbox is not None
        done = threading.Event()
        service, request = "reset_simulation", dict[str, Any]()
        if letter == "s":
            service, request = "set_simulation_state", {"state": {"state": STATE_QUITTING}}
        self._inbox.call(f"/crowdbot/{service}", request, lambda _: done.set(), self.name)
        while not done.wait(LOOK) and not self._ended:
            continue

    def _reply(self) -> bytes:
        with self._state:
            self._number, self._told = self._number + 1, self._now if self._now >= 0 else None
            report, self._contacts = "|".join(self._contacts), []
            picture = NO_PICTURE if self._picture is None else encode_picture(self._picture)
            scans = {self._lasers[topic]: encode_scan(scan) for topic, scan in self._scans.items()}
            payloads = {"clock": "0", **self._payloads, "report": report, "lidar": "", **scans, "camera": picture}
            return format_reply(self._number, payloads)


def _colour_image(interface: RobotInterface) -> str:
    """Return the topic of the first colour camera of the first robot, empty without one."""
    robot = interface.trial.robots[0].name
    names = [output.name for output in interface.outputs if output.robot == robot and output.about == "RGBCamera"]
    return next((name for name in names if name.endswith("/image")), "")


def _lasers(interface: RobotInterface) -> dict[str, str]:
    """Return the topics of replies by the topics of the lasers of the first robot: ``lidar``, then ``lidar_NAME``."""
    robot = interface.trial.robots[0].name
    topics = [item.name for item in interface.outputs if item.robot == robot and item.kind == SCAN and not item.truth]
    return {topic: f"lidar_{topic.rpartition('/')[2]}" if k else "lidar" for k, topic in enumerate(topics)}


def _planar(message: Any) -> tuple[float, ...]:
    """Return x, y [m], heading [deg] of an odometry message, and their velocities in the same frame."""
    place, turn = message.pose.pose.position, message.pose.pose.orientation
    heading = 2.0 * math.atan2(turn.z, turn.w)
    cos, sin = math.cos(heading), math.sin(heading)
    forward, left = message.twist.twist.linear.x, message.twist.twist.linear.y
    angles = (math.degrees(math.remainder(heading, math.tau)), math.degrees(message.twist.twist.angular.z))
    return place.x, place.y, angles[0], cos * forward - sin * left, sin * forward + cos * left, angles[1]
