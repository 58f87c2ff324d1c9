"""Senders of what real motion capture systems send: Xsens MVN over UDP and OptiTrack Motive by NatNet.

They need nothing of the product, only the published formats.
"""

from __future__ import annotations

import contextlib
import math
import socket
import struct
import threading
import time
from collections.abc import Sequence

SEGMENTS = [
    "Pelvis", "L5", "L3", "T12", "T8", "Neck", "Head", "RightShoulder", "RightUpperArm", "RightForeArm", "RightHand",
    "LeftShoulder", "LeftUpperArm", "LeftForeArm", "LeftHand", "RightUpperLeg", "RightLowerLeg", "RightFoot",
    "RightToe", "LeftUpperLeg", "LeftLowerLeg", "LeftFoot", "LeftToe",
]  # fmt: skip
T_POSE = [
    (0, 0, 0.96), (0, 0, 1.06), (0, 0, 1.17), (0, 0, 1.27), (0, 0, 1.37), (0, 0, 1.52), (0, 0, 1.61),
    (0, -0.03, 1.46), (0, -0.19, 1.46), (0, -0.49, 1.46), (0, -0.76, 1.46),
    (0, 0.03, 1.46), (0, 0.19, 1.46), (0, 0.49, 1.46), (0, 0.76, 1.46),
    (0, -0.09, 0.96), (0, -0.09, 0.52), (0, -0.09, 0.09), (0.16, -0.09, 0.02),
    (0, 0.09, 0.96), (0, 0.09, 0.52), (0, 0.09, 0.09), (0.16, 0.09, 0.02),
]  # fmt: skip
"""Origins of the segments of an actor in the T-pose [m]."""
PARENTS = [-1, 0, 1, 2, 3, 4, 5, 4, 7, 8, 9, 4, 11, 12, 13, 0, 15, 16, 17, 0, 19, 20, 21]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)


def product(a: Quaternion, b: Quaternion) -> Quaternion:
    (w, x, y, z), (p, q, r, s) = a, b
    return (
        w * p - x * q - y * r - z * s, w * q + x * p + y * s - z * r,
        w * r - x * s + y * p + z * q, w * s + x * r - y * q + z * p,
    )  # fmt: skip


def rotate(q: Quaternion, v: Sequence[float]) -> Vector:
    _, x, y, z = product(product(q, (0.0, v[0], v[1], v[2])), (q[0], -q[1], -q[2], -q[3]))
    return x, y, z


def about(axis: str, angle: float) -> Quaternion:
    half = math.sin(angle / 2)
    return (math.cos(angle / 2), *(half * (axis == item) for item in "xyz"))  # type: ignore[return-value]


def posed(turns: dict[str, Quaternion], where: Vector = (0.0, 0.0, 0.0)) -> list[tuple[Vector, Quaternion]]:
    """Return position and global rotation of each segment; ``turns`` are rotations relative to the parent."""
    result: list[tuple[Vector, Quaternion]] = []
    for k, name in enumerate(SEGMENTS):
        own = turns.get(name, IDENTITY)
        if PARENTS[k] < 0:
            x, y, z = T_POSE[0]
            result.append(((x + where[0], y + where[1], z + where[2]), own))
            continue
        (x, y, z), above = result[PARENTS[k]]
        dx, dy, dz = rotate(above, [a - b for a, b in zip(T_POSE[k], T_POSE[PARENTS[k]], strict=True)])
        result.append(((x + dx, y + dy, z + dz), product(above, own)))
    return result


def walk(t: float) -> list[tuple[Vector, Quaternion]]:
    """Return the pose of an actor who walks along x at 1 m/s and raises the left arm."""
    swing = 0.4 * math.sin(2 * math.pi * t)
    turns = {
        "LeftUpperLeg": about("y", -swing), "RightUpperLeg": about("y", swing),
        "LeftLowerLeg": about("y", 0.3), "RightLowerLeg": about("y", 0.3),
        "LeftUpperArm": about("x", 1.2), "RightUpperArm": about("x", 1.3),
    }  # fmt: skip
    return posed(turns, (t, 0.0, 0.0))


def mxtp(kind: str, payload: bytes, sample: int, t: float, items: int, part: int = 0x80, character: int = 0) -> bytes:
    head = struct.pack(
        ">6sIBBIBBBBHH", f"MXTP{kind}".encode(), sample, part, items, round(t * 1000), character, 23, 0, 0, 0,
        len(payload),
    )  # fmt: skip
    return head + payload


def mxtp02(pose: list[tuple[Vector, Quaternion]], sample: int, t: float, character: int = 0) -> bytes:
    items = b"".join(struct.pack(">i3f4f", k + 1, *place, *turn) for k, (place, turn) in enumerate(pose))
    return mxtp("02", items, sample, t, len(pose), character=character)


def mxtp12(name: str, character: int = 0) -> bytes:
    text = f"name:{name}\nxmid:00B40001\ncolor:FF8000\n".encode()
    return mxtp("12", struct.pack(">i", len(text)) + text, 0, 0.0, 1, character=character)


def mxtp13(origins: Sequence[Sequence[float]] = T_POSE) -> bytes:
    rows = [
        struct.pack(">i", len(n)) + n.encode() + struct.pack(">3f", *p) for n, p in zip(SEGMENTS, origins, strict=True)
    ]
    return mxtp("13", struct.pack(">i", len(SEGMENTS)) + b"".join(rows) + struct.pack(">i", 0), 0, 0.0, 1)


class Sender(threading.Thread):
    """Sends the walk of an actor to a port at a rate until it is stopped."""

    def __init__(self, port: int, rate: float = 240.0, jitter: float = 0.0) -> None:
        super().__init__(daemon=True)
        self.port, self.rate, self.jitter = port, rate, jitter
        self.end = threading.Event()
        self.sent = 0

    def run(self) -> None:
        start = time.monotonic()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            for datagram in (mxtp12("Anna"), mxtp13()):
                out.sendto(datagram, ("127.0.0.1", self.port))
            while not self.end.wait(max(0.0, start + self.sent / self.rate - time.monotonic())):
                t = self.sent / self.rate
                out.sendto(mxtp02(walk(t), self.sent, 100.0 + t), ("127.0.0.1", self.port))
                self.sent += 1

    def __enter__(self) -> Sender:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.end.set()
        self.join()


BONES = [
    ("Hip", 1, 0, (0.0, 0.95, 0.0)), ("Ab", 2, 1, (0.0, 0.1, 0.0)), ("Chest", 3, 2, (0.0, 0.2, 0.0)),
    ("Neck", 4, 3, (0.0, 0.25, 0.0)), ("Head", 5, 4, (0.0, 0.1, 0.02)),
    ("LShoulder", 6, 3, (0.03, 0.2, 0.0)), ("LUArm", 7, 6, (0.15, 0.0, 0.0)), ("LFArm", 8, 7, (0.29, 0.0, 0.0)),
    ("LHand", 9, 8, (0.25, 0.0, 0.0)),
    ("RShoulder", 10, 3, (-0.03, 0.2, 0.0)), ("RUArm", 11, 10, (-0.15, 0.0, 0.0)),
    ("RFArm", 12, 11, (-0.29, 0.0, 0.0)), ("RHand", 13, 12, (-0.25, 0.0, 0.0)),
    ("LThigh", 14, 1, (0.09, 0.0, 0.0)), ("LShin", 15, 14, (0.0, -0.43, 0.0)), ("LFoot", 16, 15, (0.0, -0.42, 0.0)),
    ("LToe", 17, 16, (0.0, -0.06, 0.14)),
    ("RThigh", 18, 1, (-0.09, 0.0, 0.0)), ("RShin", 19, 18, (0.0, -0.43, 0.0)), ("RFoot", 20, 19, (0.0, -0.42, 0.0)),
    ("RToe", 21, 20, (0.0, -0.06, 0.14)),
]  # fmt: skip
"""Bones of a skeleton of Motive, y up, facing z: name, id, id of the parent, offset [m]."""


def _text(name: str) -> bytes:
    return name.encode() + b"\0"


class Motive(threading.Thread):
    """A NatNet server with one rigid body and one skeleton that walk along z; it answers on a port of its own.

    Args:
        version: version of the protocol.
        local: whether bones are relative to their parents.
        multicast: group to which frames are sent; None: to each client.
        up_axis: answer to the request ``UpAxis``; None: no answer.
    """

    def __init__(
        self, version: tuple[int, int] = (4, 1), local: bool = False, multicast: str | None = None, rate: float = 120.0,
        up_axis: int | None = 1,
    ) -> None:  # fmt: skip
        super().__init__(daemon=True)
        self.version, self.local, self.multicast, self.rate = version, local, multicast, rate
        self.up_axis = up_axis
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.001)
        self.port = self.socket.getsockname()[1]
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            self.data_port = free.getsockname()[1]
        self.end = threading.Event()
        self.clients: set[tuple[str, int]] = set()
        self.sent = self.alive = 0

    def run(self) -> None:
        start = time.monotonic()
        with self.socket:
            if self.multicast:
                self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
            while not self.end.is_set():
                with contextlib.suppress(TimeoutError):
                    self.answer(*self.socket.recvfrom(4096))
                if time.monotonic() - start >= self.sent / self.rate:
                    data = self.frame(self.sent, self.sent / self.rate)
                    self.sent += 1
                    goals = {(self.multicast, self.data_port)} if self.multicast else self.clients
                    for client in goals:
                        self.socket.sendto(data, client)

    def answer(self, data: bytes, client: tuple[str, int]) -> None:
        kind, _ = struct.unpack_from("<HH", data)
        if kind == 0:
            self.clients.add(client)
            self.socket.sendto(self.server_info(), client)
        elif kind == 4:
            self.socket.sendto(self.descriptions(), client)
        elif kind == 2 and data[4:].startswith(b"UpAxis") and self.up_axis is not None:
            self.socket.sendto(struct.pack("<HHi", 3, 4, self.up_axis), client)
        elif kind == 10:
            self.alive += 1

    def server_info(self) -> bytes:
        group = socket.inet_aton(self.multicast or "0.0.0.0")
        body = b"Motive".ljust(256, b"\0") + bytes([3, 1, 0, 0]) + bytes([*self.version, 0, 0])
        body += struct.pack("<QH?", 10_000_000, self.data_port, self.multicast is not None) + group
        return struct.pack("<HH", 1, len(body)) + body

    def bone(self, name: str, number: int, parent: int, offset: Sequence[float]) -> bytes:
        body = _text(name) + struct.pack("<ii3f", number, parent, *offset)
        if self.version >= (4, 2):
            body += struct.pack("<4f", 0, 0, 0, 1)
        return body + struct.pack("<i", 0)

    def descriptions(self) -> bytes:
        skeleton = _text("Anna") + struct.pack("<ii", 1, len(BONES))
        skeleton += b"".join(self.bone(f"Anna_{name}", *rest) for name, *rest in BONES)
        parts = [(1, self.bone("Cart", 7, -1, (0.0, 0.0, 0.0))), (2, skeleton)]
        body = struct.pack("<i", len(parts))
        for kind, part in parts:
            body += struct.pack("<i", kind)
            body += (struct.pack("<i", len(part)) if self.version >= (4, 1) else b"") + part
        return struct.pack("<HH", 5, len(body)) + body

    def frame(self, number: int, t: float) -> bytes:
        """Return a frame: the cart turns about the vertical, the skeleton walks in the T-pose."""
        half = math.sin(0.25 * t)
        cart = struct.pack("<i3f4ffH", 7, 1.0, 0.3, 0.5 * t, 0.0, half, 0.0, math.cos(0.25 * t), 0.0, 1)
        rows, places = b"", {0: (0.0, 0.0, t)}
        for _, bone, parent, offset in BONES:
            places[bone] = tuple(a + b for a, b in zip(places[parent], offset, strict=True))
            here = offset if self.local and parent else places[bone]
            rows += struct.pack("<i3f4ffH", (1 << 16) | bone, *here, 0.0, 0.0, 0.0, 1.0, 0.0, 1)
        body = struct.pack("<i", number)
        for count, part in ((0, b""), (0, b""), (1, cart), (1, struct.pack("<ii", 1, len(BONES)) + rows)):
            body += self.section(count, part)
        if self.version >= (4, 1):
            body += self.section(0, b"")
        body += self.section(0, b"") * 3
        body += struct.pack("<IId3QH", 0, 0, t, 0, 0, 0, 0) + struct.pack("<i", 0)
        return struct.pack("<HH", 7, len(body)) + body

    def section(self, count: int, part: bytes) -> bytes:
        return struct.pack("<i", count) + (struct.pack("<i", len(part)) if self.version >= (4, 1) else b"") + part

    def __enter__(self) -> Motive:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.end.set()
        self.join()
