"""VrpnStream: rigid bodies from a VRPN server, such as Vicon Tracker, Motive or Qualisys, over TCP."""

from __future__ import annotations

import select
import socket
import struct
from collections.abc import Iterable, Iterator

from crowdbot.core import InputError

from .pose_stream import AGAIN, WAIT, BadDatagram, MotionSample, ServerStream, checked_pose
from .retargeting import to_matrices

PORT = 3883
"""Default port of a VRPN server."""
COOKIE = b"vrpn: ver. 07.35  0".ljust(24, b"\0")
"""Version of the protocol, and no log at the other side. The first digits of the version must agree."""
SAME = len(b"vrpn: ver. 07")
HEADER = struct.Struct(">6i")
"""Length without padding, time [s] and [us], sender, type, number."""
POSE = struct.Struct(">ii7d")
"""Sensor, padding, position [m], quaternion x y z w."""
SENDER, TYPE = -1, -2
"""Types of messages that describe a sender or a type."""
POSE_TYPE = "vrpn_Tracker Pos_Quat"
LONGEST, MOST_NAMES, MOST_TEXT = 65536, 2000, 200
"""Bounds of a message [bytes], of the described names, and of a name."""


class VrpnStream(ServerStream):
    """Receives the poses of the trackers of a VRPN server (version 07), z up.

    A subject has the name of its tracker; sensors other than 0 are called ``NAME/1``, and so on. When the connection is
    lost, the stream connects again.

    Args:
        server: address of the server.
        port: its port; None: 3883.
        monotonic: local clock [s].
        timeout: longest time [s] to wait for the server.

    Raises:
        InputError: (when opened) the server does not answer, or does not speak VRPN.

    >>> VrpnStream("192.168.0.5").port
    3883
    """

    default_port = PORT

    def prepare(self) -> None:
        self._buffer = bytearray()
        self._broken = False
        self._senders: dict[int, str] = {}
        self._types: dict[int, str] = {}
        self._numbers: dict[str, int] = {}

    def open_socket(self) -> socket.socket:
        try:
            connection = socket.create_connection((self.server, self.port), timeout=self.timeout)
        except OSError as error:
            reason = error.strerror or error
            raise InputError(f"cannot reach the VRPN server {self.server}:{self.port}: {reason}") from None
        try:
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            connection.sendall(COOKIE)
            found = _receive(connection, len(COOKIE))
        except OSError:
            found = b""
        if found[:SAME] != COOKIE[:SAME]:
            connection.close()
            said = f"says {found[:16].decode('ascii', 'replace')!r}" if found else "says nothing"
            raise InputError(f"the server {self.server}:{self.port} {said}, not {COOKIE[:16].decode()!r} as VRPN does")
        self._buffer.clear()
        self._broken = False
        self._senders, self._types = {}, {}
        return connection

    def _receive(self, connection: socket.socket) -> None:
        while not self._end.is_set():
            try:
                if select.select([connection], [], [], WAIT)[0]:
                    data = connection.recv(LONGEST)
                    if not data:
                        raise OSError("the server has closed the connection")
                    self.take(data, f"{self.server}:{self.port}", self.monotonic())
                    if self._broken:
                        raise OSError(self.reason)
            except OSError as error:
                self._refuse(str(error))
                connection.close()
                connection = self._connect_again() or connection
        connection.close()

    def _connect_again(self) -> socket.socket | None:
        while not self._end.wait(AGAIN):
            try:
                return self.open_socket()
            except InputError as error:
                self._refuse(str(error))
        return None

    def decode(self, data: bytes) -> Iterable[tuple[str, MotionSample]]:
        """Return the samples in some bytes of the connection; a part of a message waits for the rest.

        Raises:
            BadDatagram: the bytes are no VRPN; the stream connects again.
        """
        self._buffer += data
        result: list[tuple[str, MotionSample]] = []
        for when, sender, kind, body in self._messages():
            try:
                if kind == SENDER:
                    _note(self._senders, sender, body)
                elif kind == TYPE:
                    _note(self._types, sender, body)
                elif self._types.get(kind) == POSE_TYPE and sender in self._senders:
                    result.append(self._sample(self._senders[sender], when, body))
            except BadDatagram as error:  # the next message is where its length says
                self._refuse(str(error))
        return result

    def _messages(self) -> Iterator[tuple[float, int, int, bytes]]:
        """Remove whole messages from the buffer; return their time [s], sender, type and content."""
        while len(self._buffer) >= HEADER.size:
            length, seconds, micro, sender, kind, _ = HEADER.unpack_from(self._buffer)
            if not HEADER.size <= length <= LONGEST:
                self._broken = True
                raise BadDatagram(f"a message of {length} bytes")
            whole = length + -length % 8
            if len(self._buffer) < whole:
                return
            body = bytes(self._buffer[HEADER.size : length])
            del self._buffer[:whole]
            yield seconds + 1e-6 * micro, sender, kind, body

    def _sample(self, name: str, when: float, body: bytes) -> tuple[str, MotionSample]:
        if len(body) < POSE.size:
            raise BadDatagram(f"a pose of {len(body)} bytes")
        sensor, _, *values = POSE.unpack_from(body)
        x, y, z, w = values[3:]
        position, turn = checked_pose([values[:3]], [[w, x, y, z]])
        subject = name if sensor == 0 else f"{name}/{sensor}"
        if subject not in self._numbers and len(self._numbers) >= MOST_NAMES:
            raise BadDatagram("too many trackers")
        self._numbers[subject] = number = self._numbers.get(subject, -1) + 1
        return subject, MotionSample(number, when, position, to_matrices(turn))


def _note(names: dict[int, str], number: int, body: bytes) -> None:
    """Note the name of a sender or type."""
    if len(body) < 4 or len(names) >= MOST_NAMES:
        raise BadDatagram("a name without a length, or too many names")
    (length,) = struct.unpack_from(">i", body)
    if not 0 < length <= min(MOST_TEXT, len(body) - 4):
        raise BadDatagram(f"a name of {length} bytes")
    names[number] = body[4 : 4 + length].split(b"\0", 1)[0].decode("utf-8", "replace")


def _receive(connection: socket.socket, count: int) -> bytes:
    found = b""
    while len(found) < count:
        part = connection.recv(count - len(found))
        if not part:
            break
        found += part
    return found
