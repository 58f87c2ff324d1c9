"""Live poses of Xsens MVN suits."""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .pose_stream import FARTHEST, BadDatagram, MotionSample, PoseReceiver, bind_socket, checked_pose
from .retargeting import SourceSkeleton, to_matrices

SEGMENTS = (
    "Pelvis", "L5", "L3", "T12", "T8", "Neck", "Head",
    "RightShoulder", "RightUpperArm", "RightForeArm", "RightHand",
    "LeftShoulder", "LeftUpperArm", "LeftForeArm", "LeftHand",
    "RightUpperLeg", "RightLowerLeg", "RightFoot", "RightToe",
    "LeftUpperLeg", "LeftLowerLeg", "LeftFoot", "LeftToe",
)  # fmt: skip
"""Names of the segments in the order of their ids, which begin with 1."""
PARENTS = (-1, 0, 1, 2, 3, 4, 5, 4, 7, 8, 9, 4, 11, 12, 13, 0, 15, 16, 17, 0, 19, 20, 21)
LEG = 0.86
"""Length of the leg of the default rest pose from hip to ankle [m]."""


def xsens_skeleton(origins: Floats | None = None, leg: float = LEG) -> SourceSkeleton:
    """Return the segments of an actor in the T-pose, in which all orientations are identity.

    Args:
        origins: origins of the segments in the T-pose ``[23, 3]`` [m], as in MXTP13 datagrams and MVNX files (default:
            an actor of average proportions).
        leg: length of the leg of the default actor [m].

    >>> round(xsens_skeleton(leg=0.9).leg_length("l"), 3)
    0.9
    """
    return SourceSkeleton(SEGMENTS, PARENTS, _average() * (leg / LEG) if origins is None else origins)


def _average() -> Floats:
    """Return the origins of the segments of an actor of average proportions, 1.75 m tall."""
    trunk = [(0, 0, 0.95), (0, 0, 1.05), (0, 0, 1.16), (0, 0, 1.26), (0, 0, 1.36), (0, 0, 1.5), (0.02, 0, 1.59)]
    arm = [(0, 0.03, 1.45), (0, 0.18, 1.45), (0, 0.47, 1.45), (0, 0.73, 1.45)]
    foot = 0.95 - LEG
    leg = [(0, 0.09, 0.95), (0, 0.09, 0.95 - 0.44), (0, 0.09, foot), (0.15, 0.09, 0.02)]
    right = [[(x, -y, z) for x, y, z in limb] for limb in (arm, leg)]
    return np.array([*trunk, *right[0], *arm, *right[1], *leg], dtype=np.float64)


PORT = 9763
"""Default port of the network streamer."""
HEADER = struct.Struct(">6sIBBIBBBBHH")
ITEM = np.dtype([("id", ">i4"), ("position", ">f4", 3), ("rotation", ">f4", 4)])
"""Largest coordinate [m]."""
MOST_NAME = 100
CENTIMETERS = 2.0
"""A thigh with a longer length is in centimetres; the specification names both units."""
LEG_CHANGE = 0.02
"""Relative change of the length of the legs from which on the rest pose is scaled anew."""


class _Header(NamedTuple):
    kind: str
    sample: int
    part: int
    items: int
    milliseconds: int
    character: int
    payload: bytes


class _Character:
    """What is known of one character: name, rest pose and the parts of the current sample."""

    def __init__(self) -> None:
        self.name = ""
        self.scaled = False
        self.skeleton: SourceSkeleton | None = None
        self.sample = -1
        self.parts: dict[int, bytes] = {}
        self.last = -1


class XsensStream(PoseReceiver):
    """Receives poses of people from MVN Analyze or MVN Animate.

    In MVN, add the address and port of this computer under Options, Network Streamer, and select "Position +
    Orientation (Quaternion)" (MXTP02) with z up. Subjects are called by the number of the character (``0``) or, if meta
    data (MXTP12) is streamed too, also by its name. Scale information (MXTP13) gives the proportions of the actor;
    without it, those of an average actor are scaled to the length of the legs. Props and fingers are not used.

    Source: MVN real-time network streaming protocol specification, revision N, 2018.

    Args:
        host: address to listen on (default: this computer only; ``0.0.0.0``: all networks).
        port: UDP port; 0: a free one.
        monotonic: local clock [s].

    >>> with XsensStream(port=0) as stream:
    ...     stream.subjects(), stream.port > 0
    ((), True)
    """

    def __init__(
        self, host: str = "127.0.0.1", port: int = PORT, monotonic: Callable[[], float] = time.monotonic
    ) -> None:
        super().__init__(monotonic)
        self.host, self.port = host, port
        self._characters: dict[int, _Character] = {}

    def open_socket(self) -> socket.socket:
        connection = bind_socket(self.host, self.port)
        self.port = int(connection.getsockname()[1])
        return connection

    def decode(self, data: bytes) -> Iterable[tuple[str, MotionSample]]:
        # sample in a datagram; none if it is not the last part of one, or has other data
        header = _read_header(data)
        character = self._characters.get(header.character)
        if character is None:
            if len(self._characters) >= 16:
                raise BadDatagram("more than 16 characters")
            character = self._characters[header.character] = _Character()
        if header.kind == "12":
            character.name = _read_name(header.payload) or character.name
        elif header.kind == "13":
            origins = _read_origins(header.payload)
            if origins is not None:
                character.skeleton, character.scaled = _checked(origins), True
        elif header.kind == "02":
            return self._pose(character, header)
        elif header.kind in ("01", "03", "05"):
            wanted = "select Position + Orientation (Quaternion) in the network streamer"
            raise BadDatagram(f"MXTP{header.kind} is not supported; {wanted}")
        return []

    def _pose(self, character: _Character, header: _Header) -> Iterable[tuple[str, MotionSample]]:
        if header.sample != character.sample:
            character.sample, character.parts, character.last = header.sample, {}, -1
        character.parts[header.part & 0x7F] = _items(header)
        if header.part & 0x80:
            character.last = header.part & 0x7F
        if character.last < 0 or len(character.parts) <= character.last:
            return []
        data = b"".join(part for _, part in sorted(character.parts.items()))
        character.sample = -1
        position, quaternion = _body(data)
        if float(np.linalg.norm(position[15] - position[16])) > CENTIMETERS:
            position = position * 0.01
        skeleton = self._skeleton(character, position)
        rotation = to_matrices(quaternion)
        sample = MotionSample(header.sample, header.milliseconds / 1000.0, position, rotation, skeleton)
        names = [str(header.character), *([character.name] if character.name else [])]
        return [(name, sample) for name in names]

    @staticmethod
    def _skeleton(character: _Character, position: Floats) -> SourceSkeleton:
        """Return the rest pose; without scale information, one that fits the length of the legs."""
        known = character.skeleton
        if known is not None and character.scaled:
            return known
        legs = np.linalg.norm(np.diff(position[[15, 16, 17, 19, 20, 21]], axis=0), axis=1)
        length = float(legs[0] + legs[1] + legs[3] + legs[4]) / 2.0
        if known is None or abs(known.leg_length("l") - length) > LEG_CHANGE * length:
            try:
                known = character.skeleton = xsens_skeleton(leg=length)
            except InputError as error:
                raise BadDatagram(str(error)) from None
        return known


def _read_header(data: bytes) -> _Header:
    if len(data) < HEADER.size:
        raise BadDatagram(f"{len(data)} bytes are less than a header")
    mark, sample, part, items, milliseconds, character, _, _, _, _, size = HEADER.unpack_from(data)
    if mark[:4] != b"MXTP" or not mark[4:].isdigit():
        raise BadDatagram("this is no MXTP datagram")
    payload = data[HEADER.size :]
    if size not in (0, len(payload)):  # senders before MVN 2019 leave the size 0
        raise BadDatagram(f"the payload has {len(payload)} bytes, the header says {size}")
    return _Header(mark[4:].decode("ascii"), sample, part, items, milliseconds, character, payload)


def _items(header: _Header) -> bytes:
    if len(header.payload) != header.items * ITEM.itemsize:
        raise BadDatagram(f"{header.items} segments need {header.items * ITEM.itemsize} bytes")
    return header.payload


def _body(data: bytes) -> tuple[Floats, Floats]:
    """Return positions [m] and quaternions of the 23 body segments."""
    rows = np.frombuffer(data, dtype=ITEM)
    rows = rows[(rows["id"] >= 1) & (rows["id"] <= len(SEGMENTS))]
    order = rows["id"] - 1
    if len(rows) != len(SEGMENTS) or len(np.unique(order)) != len(SEGMENTS):
        raise BadDatagram(f"a pose has {len(rows)} body segments instead of {len(SEGMENTS)}")
    position, quaternion = np.empty((len(SEGMENTS), 3)), np.empty((len(SEGMENTS), 4))
    position[order], quaternion[order] = rows["position"], rows["rotation"]
    return checked_pose(position, quaternion)


def _read_name(payload: bytes) -> str:
    """Return the name in meta data, which has lines such as ``name:Anna``; empty without one."""
    if len(payload) >= 4 and struct.unpack_from(">i", payload)[0] == len(payload) - 4:
        payload = payload[4:]  # strings are preceded by their size
    for line in payload.decode("utf-8", errors="replace").splitlines():
        tag, _, value = line.partition(":")
        if tag.strip() == "name":
            return "".join(item for item in value.strip() if item.isprintable())[:MOST_NAME]
    return ""


def _read_origins(payload: bytes) -> Floats | None:
    """Return the origins of the body segments in the T-pose [m]; None if the datagram has points only."""
    place, found = 4, {}
    if len(payload) < 4:
        raise BadDatagram("scale information is too short")
    (count,) = struct.unpack_from(">i", payload)
    if not 0 <= count <= 100:
        raise BadDatagram(f"scale information has {count} segments")
    for _ in range(count):
        if len(payload) < place + 4:
            raise BadDatagram("scale information is too short")
        (size,) = struct.unpack_from(">i", payload, place)
        if not 0 <= size <= MOST_NAME or len(payload) < place + 16 + size:
            raise BadDatagram("scale information has a name that is too long")
        name = payload[place + 4 : place + 4 + size].decode("utf-8", errors="replace").replace(" ", "")
        found[name.lower()] = struct.unpack_from(">fff", payload, place + 4 + size)
        place += 16 + size
    if count == 0:
        return None
    missing = [name for name in SEGMENTS if name.lower() not in found]
    if missing:
        raise BadDatagram(f"scale information lacks {', '.join(missing)[:100]}")
    return np.array([found[name.lower()] for name in SEGMENTS], dtype=np.float64)


def _checked(origins: Floats) -> SourceSkeleton:
    if not np.all(np.abs(origins) <= FARTHEST):
        raise BadDatagram("scale information has values that are not finite or out of range")
    origins = origins - [*origins[0, :2], 0.0]
    try:
        return xsens_skeleton(origins)
    except InputError as error:
        raise BadDatagram(str(error)) from None
