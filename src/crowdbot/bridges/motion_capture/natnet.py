"""NatNet: live skeletons and rigid bodies of OptiTrack Motive."""

from __future__ import annotations

import ipaddress
import select
import socket
import struct
import sys
from collections.abc import Iterable
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .motion_files import FROM_Y_UP
from .pose_stream import AGAIN, BadDatagram, MotionSample, ServerStream, bind_socket, checked_pose
from .retargeting import SourceSkeleton, to_matrices

CONNECT, SERVER_INFO, REQUEST, RESPONSE, REQUEST_DESCRIPTIONS, DESCRIPTIONS, FRAME, KEEP_ALIVE = 0, 1, 2, 3, 4, 5, 7, 10
MOST_NAME = 256
MOST_ITEMS = 4096
Version = tuple[int, int]


class ServerInfo(NamedTuple):
    """What a server says of itself: its name, the version of the protocol and where it sends frames."""

    application: str
    version: Version
    data_port: int | None
    multicast: str | None


class BoneDescription(NamedTuple):
    """A rigid body or bone: name, id, id of the parent (0 without one) and offset from it [m]."""

    name: str
    number: int
    parent: int
    offset: tuple[float, float, float]


class Body(NamedTuple):
    """Pose of a rigid body or bone in the axes of the server; ``rotation`` is x, y, z, w."""

    number: int
    position: tuple[float, float, float]
    rotation: tuple[float, float, float, float]
    valid: bool


class Frame(NamedTuple):
    """Poses of one instant: rigid bodies, and bones by the id of their skeleton; ``time`` since the start [s]."""

    number: int
    time: float
    bodies: list[Body]
    skeletons: dict[int, list[Body]]


class Packet:
    """Reads values one after the other, within the bounds of a datagram.

    >>> Packet(b"\\x01\\x00\\x00\\x00", 0).number()
    1
    """

    def __init__(self, data: bytes, place: int) -> None:
        self.data, self.place = data, place

    def values(self, form: str) -> tuple[Any, ...]:
        """Return values in a little-endian ``struct`` format."""
        try:
            result = struct.unpack_from(f"<{form}", self.data, self.place)
        except struct.error:
            raise BadDatagram("a packet ends too early") from None
        self.place += struct.calcsize(f"<{form}")
        return result

    def number(self) -> int:
        """Return a 32-bit integer."""
        return int(self.values("i")[0])

    def count(self) -> int:
        """Return a number of items that are in the packet."""
        result = self.number()
        if not 0 <= result <= MOST_ITEMS:
            raise BadDatagram(f"a packet says that it has {result} items")
        return result

    def name(self) -> str:
        """Return a text that ends with a zero byte."""
        end = self.data.find(b"\0", self.place, self.place + MOST_NAME)
        if end < 0:
            raise BadDatagram("a packet has a name without an end")
        text = self.data[self.place : end].decode("utf-8", errors="replace")
        self.place = end + 1
        return "".join(item for item in text if item.isprintable())

    def skip(self, size: int) -> None:
        """Pass over bytes."""
        if size < 0 or self.place + size > len(self.data):
            raise BadDatagram("a packet ends too early")
        self.place += size


def read_server(data: bytes) -> ServerInfo:
    """Return the answer to a connection."""
    packet = Packet(data, 4)
    packet.skip(256)
    application = data[4:260].split(b"\0")[0].decode("utf-8", errors="replace")
    packet.values("4B")
    major, minor, _, _ = packet.values("4B")
    if (major, minor) < (3, 0):
        raise BadDatagram(f"NatNet {major}.{minor} is too old; 3.0 (Motive 2) or newer is needed")
    if len(data) < packet.place + 15:
        return ServerInfo(application, (major, minor), None, None)
    packet.values("Q")
    port, is_multicast, *address = packet.values("H?4B")
    return ServerInfo(application, (major, minor), port, ".".join(map(str, address)) if is_multicast else None)


def read_descriptions(data: bytes, version: Version) -> tuple[list[BoneDescription], dict[int, tuple[str, list[Any]]]]:
    """Return the rigid bodies, and the skeletons with their names and bones by their id."""
    packet, bodies, skeletons = Packet(data, 4), list[BoneDescription](), dict[int, tuple[str, list[Any]]]()
    for _ in range(packet.count()):
        kind = packet.number()
        size = packet.number() if version >= (4, 1) else None
        end = None if size is None else packet.place + size
        if kind == 0:
            packet.name()
            for _ in range(packet.count()):
                packet.name()
        elif kind == 1:
            bodies.append(_read_bone(packet, version))
        elif kind == 2:
            name, number = packet.name(), packet.number()
            skeletons[number] = (name, [_read_bone(packet, version) for _ in range(packet.count())])
        elif end is None:
            break  # force plates, devices and cameras come last; their size is not known
        if end is not None:
            if end < packet.place or end > len(data):
                raise BadDatagram("a description has a wrong size")
            packet.place = end
    return bodies, skeletons


def _read_bone(packet: Packet, version: Version) -> BoneDescription:
    name, number, parent = packet.name(), packet.number(), packet.number()
    offset = _finite(packet.values("3f"))
    if version >= (4, 2):
        packet.values("4f")
    markers = packet.count()
    packet.skip(markers * 16)
    if version >= (4, 0):
        for _ in range(markers):
            packet.name()
    return BoneDescription(name, number, parent, (offset[0], offset[1], offset[2]))


def read_frame(data: bytes, version: Version) -> Frame:
    """Return the rigid bodies and skeletons of a frame."""
    packet = Packet(data, 4)
    number = packet.number()
    for _ in range(_section(packet, version)):  # marker sets
        packet.name()
        packet.skip(12 * packet.count())
    packet.skip(12 * _section(packet, version))  # unlabeled markers
    bodies = [_read_body(packet) for _ in range(_section(packet, version))]
    skeletons = {}
    for _ in range(_section(packet, version)):
        skeleton = packet.number()
        skeletons[skeleton] = [_read_body(packet) for _ in range(packet.count())]
    if version >= (4, 1):
        _, size = packet.count(), packet.number()  # assets
        packet.skip(size)
    packet.skip(26 * _section(packet, version))  # labeled markers
    for _ in range(2):  # force plates and devices
        for _ in range(_section(packet, version)):
            packet.number()
            for _ in range(packet.count()):
                packet.skip(4 * packet.count())
    packet.values("II")
    (time,) = _finite(packet.values("d"))
    return Frame(number, time, bodies, skeletons)


def _section(packet: Packet, version: Version) -> int:
    """Return the number of items of a section; from 4.1 on it is followed by the size in bytes."""
    count = packet.count()
    if version >= (4, 1):
        packet.number()
    return count


def _read_body(packet: Packet) -> Body:
    number = packet.number()
    x, y, z, *rotation = packet.values("7f")
    _, flags = packet.values("fH")
    qx, qy, qz, qw = rotation
    return Body(number, (x, y, z), (qx, qy, qz, qw), bool(flags & 1))


def _finite(values: tuple[float, ...]) -> tuple[float, ...]:
    if not all(abs(value) <= 1e12 for value in values):
        raise BadDatagram("a packet has values that are not finite")
    return values


PORT, DATA_PORT = 1510, 1511
"""Default ports of the server for commands and for multicast frames."""
LOCAL_OFFSET = 0.003
"""Largest difference [m] between positions and offsets of bones if they are relative to their parents."""


class NatNetStream(ServerStream):
    """Receives rigid bodies and skeletons from Motive 2 or newer (NatNet 3.0 to 4.x), by unicast or multicast.

    Subjects are called as in Motive. The server says which axis is up; without an answer, it is y, as by default. The
    bones of a skeleton may be streamed in global or local coordinates.

    Args:
        server: address of the computer that runs Motive.
        port: command port of the server; None: 1510.
        monotonic: local clock [s].
        timeout: longest time [s] to wait for the server.

    Raises:
        InputError: (when opened) the server does not answer, or is too old.
    """

    default_port = PORT

    def prepare(self) -> None:
        self.info: ServerInfo | None = None
        self.axes = FROM_Y_UP
        self._names: dict[int, str] = {}
        self._skeletons: dict[int, tuple[str, tuple[int, ...], SourceSkeleton, Floats]] = {}
        self._command: socket.socket | None = None
        self._sent = -1e9

    def open_socket(self) -> socket.socket:
        # socket for answers and unicast frames
        try:
            local = "127.0.0.1" if ipaddress.ip_address(self.server).is_loopback else ""
        except ValueError:
            local = ""
        return bind_socket(local, 0)

    def name_sender(self, address: tuple[str, int]) -> str:
        # address of the sender: a server sends from more than one port
        return address[0]

    def begin(self, connection: socket.socket) -> socket.socket:
        self._wait(connection)
        self._command = connection
        if self.info is None or self.info.multicast is None:
            return connection
        return _join(self.info.multicast, self.info.data_port or DATA_PORT, connection.getsockname()[0])

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        super().__exit__(kind, error, trace)
        if self._command is not None:
            self._command.close()

    def _wait(self, connection: socket.socket) -> None:
        end, asked = self.monotonic() + self.timeout, -1e9
        described = False
        while not described:
            now = self.monotonic()
            if now > end:
                what = "does not answer" if self.info is None else "does not describe its bodies"
                reason = f" ({self.reason})" if self.reason else ""
                raise InputError(
                    f"the NatNet server {self.server}:{self.port} {what} within {self.timeout:g} s; is Broadcast Frame"
                    f" Data on in Motive?{reason}"
                )
            if now - asked > AGAIN:
                asked = now
                self._ask(connection)
            if select.select([connection], [], [], 0.05)[0]:
                described = self._answer(connection)

    def _ask(self, connection: socket.socket) -> None:
        try:
            if self.info is None:
                self._send(connection, CONNECT, b"Ping\0")
            else:
                self._send(connection, REQUEST, b"UpAxis\0")
                self._send(connection, REQUEST_DESCRIPTIONS, b"")
        except OSError as error:
            raise InputError(f"cannot reach the NatNet server {self.server}:{self.port}: {error}") from None

    def _answer(self, connection: socket.socket) -> bool:
        """Take an answer of the server and return whether its bodies are known."""
        try:
            data, _ = connection.recvfrom(65536)
            kind = _kind(data)
            if kind == SERVER_INFO:
                self.info = read_server(data)
                self._ask(connection)
            elif kind == DESCRIPTIONS:
                self._describe(data)
                return True
            elif kind == RESPONSE:
                self._take_axis(data)
        except BadDatagram as error:
            self._refuse(str(error))
            if self.info is None and "too old" in str(error):
                raise InputError(f"the NatNet server {self.server}:{self.port}: {error}") from None
        except OSError as error:
            self._refuse(str(error))
        return False

    def _send(self, connection: socket.socket, kind: int, payload: bytes) -> None:
        connection.sendto(struct.pack("<HH", kind, len(payload)) + payload, (self.server, self.port))

    def keep_alive(self, connection: socket.socket) -> None:
        # tell a unicast server that this client is there
        now = self.monotonic()
        if now - self._sent > AGAIN:
            self._sent = now
            try:
                self._send(self._command or connection, KEEP_ALIVE, b"")
            except OSError as error:
                self._refuse(str(error))

    def decode(self, data: bytes) -> Iterable[tuple[str, MotionSample]]:
        kind = _kind(data)
        if kind == DESCRIPTIONS:
            self._describe(data)
        elif kind == RESPONSE:
            self._take_axis(data)
        elif kind == FRAME and self.info is not None:
            return list(self._samples(read_frame(data, self.info.version)))
        return []

    def _take_axis(self, data: bytes) -> None:
        if len(data) == 8 and struct.unpack_from("<i", data, 4)[0] == 2:
            self.axes = np.eye(3)

    def _describe(self, data: bytes) -> None:
        bodies, skeletons = read_descriptions(data, self.info.version if self.info else (3, 0))
        self._names = {body.number: body.name for body in bodies}
        found = {}
        for number, (name, bones) in skeletons.items():
            skeleton = self._skeleton(name, bones)
            offsets = np.array([bone.offset for bone in bones])
            found[number] = (name, tuple(bone.number for bone in bones), skeleton, offsets)
        self._skeletons = found

    def _skeleton(self, name: str, bones: list[BoneDescription]) -> SourceSkeleton:
        """Return a skeleton in the T-pose, in which Motive gives all bones no rotation."""
        index = {bone.number: k for k, bone in enumerate(bones)}
        parents = [index.get(bone.parent, -1) for bone in bones]
        rest = np.zeros((len(bones), 3))
        for k, (bone, parent) in enumerate(zip(bones, parents, strict=True)):
            if parent >= k:
                raise BadDatagram(f"the bones of {name!r} are not in the order of the hierarchy")
            rest[k] = self.axes @ np.array(bone.offset) + (rest[parent] if parent >= 0 else 0.0)
        names = tuple(bone.name.removeprefix(f"{name}_") for bone in bones)
        if not len(rest):
            raise BadDatagram(f"skeleton {name!r} has no bones")
        rest -= [*rest[0, :2], rest[:, 2].min() - 0.02]
        try:
            return SourceSkeleton(tuple(_long_name(name) for name in names), tuple(parents), rest)
        except InputError as error:
            raise BadDatagram(f"{name!r}: {error}") from None

    def _samples(self, frame: Frame) -> Iterable[tuple[str, MotionSample]]:
        for body in frame.bodies:
            if body.valid and body.number in self._names:
                position, rotation = self._poses([body])
                yield self._names[body.number], MotionSample(frame.number, frame.time, position, rotation)
        for number, bones in frame.skeletons.items():
            if number in self._skeletons:
                yield self._skeleton_sample(number, bones, frame)

    def _skeleton_sample(self, number: int, bones: list[Body], frame: Frame) -> tuple[str, MotionSample]:
        name, numbers, skeleton, offsets = self._skeletons[number]
        own = {bone.number & 0xFFFF: bone for bone in bones}
        missing = [number for number in numbers if number not in own]
        if missing:
            raise BadDatagram(f"a frame lacks {len(missing)} bones of {name!r}")
        ordered = [own[number] for number in numbers]
        position, rotation = self._poses(ordered)
        places = np.array([bone.position for bone in ordered])
        if np.all(np.abs(places[1:] - offsets[1:]) < LOCAL_OFFSET):
            for k, parent in enumerate(skeleton.parents):
                if parent >= 0:
                    position[k] = position[parent] + rotation[parent] @ position[k]
                    rotation[k] = rotation[parent] @ rotation[k]
        return name, MotionSample(frame.number, frame.time, position, rotation, skeleton)

    def _poses(self, bodies: list[Body]) -> tuple[Floats, Floats]:
        """Return positions [m] and rotation matrices with x forward, y left, z up."""
        position = np.array([body.position for body in bodies])
        quaternion = np.array([[body.rotation[3], *body.rotation[:3]] for body in bodies])
        position, quaternion = checked_pose(position, quaternion)
        return position @ self.axes.T, self.axes @ to_matrices(quaternion) @ self.axes.T


def _join(group: str, port: int, local: str) -> socket.socket:
    """Return a socket that receives the datagrams of a multicast group."""
    connection = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        connection.bind((local if sys.platform == "win32" else group, port))  # Windows binds to own addresses only
        member = socket.inet_aton(group) + socket.inet_aton(local)
        connection.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
    except OSError as error:
        connection.close()
        raise InputError(f"cannot receive from the multicast group {group}:{port}: {error.strerror or error}") from None
    return connection


def _kind(data: bytes) -> int:
    if len(data) < 4:
        raise BadDatagram(f"{len(data)} bytes are less than a header")
    kind, size = struct.unpack_from("<HH", data)
    if size != len(data) - 4:
        raise BadDatagram(f"the payload has {len(data) - 4} bytes, the header says {size}")
    return int(kind)


def _long_name(name: str) -> str:
    """Return the name of a bone with its side and part in full: Motive calls a left forearm LFArm."""
    return {"LHand": "LeftHand", "RHand": "RightHand", "LFoot": "LeftFoot", "RFoot": "RightFoot"}.get(name, name)
