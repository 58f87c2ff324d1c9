"""Packets of NatNet 3.0 to 4.1 and later: server information, descriptions and frames of OptiTrack Motive."""

from __future__ import annotations

import struct
from typing import Any, NamedTuple

from .pose_receiver import BadDatagram

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
            found = struct.unpack_from(f"<{form}", self.data, self.place)
        except struct.error:
            raise BadDatagram("a packet ends too early") from None
        self.place += struct.calcsize(f"<{form}")
        return found

    def number(self) -> int:
        """Return a 32-bit integer."""
        return int(self.values("i")[0])

    def count(self) -> int:
        """Return a number of items that are in the packet."""
        found = self.number()
        if not 0 <= found <= MOST_ITEMS:
            raise BadDatagram(f"a packet says that it has {found} items")
        return found

    def name(self) -> str:
        """Return a text that ends with a zero byte."""
        end = self.data.find(b"\0", self.place, self.place + MOST_NAME)
        if end < 0:
            raise BadDatagram("a packet has a name without an end")
        text = self.data[self.place : end].decode("utf-8", errors="replace")
        self.place = end + 1
        return "".join(one for one in text if one.isprintable())

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
    if not all(abs(one) <= 1e12 for one in values):
        raise BadDatagram("a packet has values that are not finite")
    return values
