"""TCPROS: frames and connection headers of the topics and services of ROS 1.

Every frame is its length in 4 bytes, little endian, and its bytes. The first frame of each side is its header: fields
``name=value``, each as a frame. Source: wiki.ros.org/ROS/TCPROS.
"""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Mapping

from crowdbot.core import InputError

SIZE = struct.Struct("<I")
MOST_HEADER, MOST_BYTES = 1 << 16, 1 << 22
"""Largest header, and largest message that is received [bytes]."""
GREETING = 5.0
"""Longest real time [s] until the other side has sent its header."""
ROS_ERRORS = (InputError, OSError, EOFError, TimeoutError)
"""Errors of a connection that ends: a wrong frame, a broken connection, its end, and silence."""


def pack_frame(data: bytes) -> bytes:
    """Return a frame.

    >>> pack_frame(b"ab")
    b'\\x02\\x00\\x00\\x00ab'
    """
    return SIZE.pack(len(data)) + data


def pack_header(fields: Mapping[str, str]) -> bytes:
    """Return the frame of a connection header.

    >>> pack_header({"a": "b"})
    b'\\x07\\x00\\x00\\x00\\x03\\x00\\x00\\x00a=b'
    """
    return pack_frame(b"".join(pack_frame(f"{name}={value}".encode()) for name, value in fields.items()))


def unpack_header(data: bytes) -> dict[str, str]:
    """Return the fields of a connection header.

    Raises:
        InputError: the bytes are no header.

    >>> unpack_header(pack_header({"topic": "/scan"})[4:])
    {'topic': '/scan'}
    """
    fields, at = {}, 0
    while at < len(data):
        if at + SIZE.size > len(data):
            raise InputError("a TCPROS header ends within a field")
        (size,) = SIZE.unpack_from(data, at)
        at += SIZE.size
        name, sign, value = data[at : at + size].decode(errors="replace").partition("=")
        if at + size > len(data) or not sign:
            raise InputError("a field of a TCPROS header must be name=value")
        fields[name] = value
        at += size
    return fields


async def read_frame(reader: asyncio.StreamReader, most: int = MOST_BYTES) -> bytes:
    """Return the bytes of the next frame.

    Raises:
        InputError: the frame is too long.
        EOFError: the other side has closed the connection.
    """
    (size,) = SIZE.unpack(await reader.readexactly(SIZE.size))
    if size > most:
        raise InputError(f"a TCPROS frame has {size} bytes; at most {most} are allowed")
    return await reader.readexactly(size)


async def read_header(reader: asyncio.StreamReader) -> dict[str, str]:
    """Return the connection header of the other side.

    Raises:
        InputError: it sends no header.
        EOFError, TimeoutError: it sends nothing.
    """
    return unpack_header(await asyncio.wait_for(read_frame(reader, MOST_HEADER), GREETING))
