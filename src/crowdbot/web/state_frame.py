"""StateFrame: arrays of one instant as bytes for the browser."""

from __future__ import annotations

import functools
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

MAGIC = b"CBF1"
HEADER = struct.Struct("<4s4x8sII d")
SECTION = struct.Struct("<8sHHI")
TYPES: tuple[np.dtype[Any], ...] = tuple(np.dtype(name) for name in ("<f4", "<i2", "<u2", "|u1", "<i4", "<u4", "<f8"))
"""Types of the arrays; the position is the code in the frame."""


@dataclass(frozen=True)
class StateFrame:
    """Named arrays of one instant, as the server sends them over the WebSocket.

    A frame is little-endian: a header of 32 bytes (``CBF1``, 4 bytes of padding, the channel in 8 bytes of ASCII, the
    sequence number, the number of sections, and the time [s] as float64), one entry of 16 bytes for each section (name
    in 8 bytes of ASCII, code of the type, number of columns, number of values), and the values of each section, which
    begin at a multiple of 8 bytes.

    Args:
        channel: what the frame shows, at most 8 ASCII letters, such as ``crowd``. A window holds only the newest frame
            of each channel.
        time: simulated or recorded time [s].
        arrays: arrays [n] or [n, columns] by names of at most 8 ASCII letters.
        sequence: number of the frame in its window; the window sets it.

    Raises:
        InputError: a name is too long, or the type of an array is not one of those of the frame.

    >>> frame = StateFrame("crowd", 0.5, {"people": np.array([[1.0, 2.0]], dtype=np.float32)})
    >>> StateFrame.decode(frame.encode()).arrays["people"].tolist()
    [[1.0, 2.0]]
    """

    channel: str
    time: float
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    sequence: int = 0

    def encode(self) -> bytes:
        """Return the bytes of the frame."""
        entries, values, offset = [], [], HEADER.size + SECTION.size * len(self.arrays)
        for name, array in self.arrays.items():
            columns = 1 if array.ndim == 1 else array.shape[1]
            entries.append(SECTION.pack(_name(name), _code(name, array), columns, array.size))
            padding = -offset % 8
            values.append(b"\0" * padding + np.ascontiguousarray(array).tobytes())
            offset += padding + array.nbytes
        header = HEADER.pack(MAGIC, _name(self.channel), self.sequence, len(self.arrays), self.time)
        return b"".join((header, *entries, *values))

    @staticmethod
    def decode(data: bytes) -> StateFrame:
        """Return the frame in ``data``.

        Raises:
            InputError: the bytes are not a whole frame.
        """
        try:
            magic, channel, sequence, count, time = HEADER.unpack_from(data)
            if magic != MAGIC:
                raise InputError(f"a state frame starts with {magic!r}, expected {MAGIC!r}")
            offset = HEADER.size + SECTION.size * count
            arrays = {}
            for number in range(count):
                name, code, columns, size = SECTION.unpack_from(data, HEADER.size + SECTION.size * number)
                offset += -offset % 8
                array = np.frombuffer(data, TYPES[code], size, offset)
                arrays[_text(name)] = array if columns == 1 else array.reshape(-1, columns)
                offset += array.nbytes
        except (struct.error, ValueError, IndexError) as error:
            raise InputError(f"a state frame of {len(data)} bytes is not whole: {error}") from None
        return StateFrame(_text(channel), time, arrays, sequence)


@functools.lru_cache(maxsize=1024)
def _name(text: str) -> bytes:
    data = text.encode("ascii", "replace")
    if not 0 < len(data) <= 8 or not text.isascii():
        raise InputError(f"name in a state frame = {text!r}: expected 1 to 8 ASCII letters")
    return data


def _text(data: bytes) -> str:
    return data.rstrip(b"\0").decode("ascii", "replace")


def _code(name: str, array: NDArray[Any]) -> int:
    code = _code_of(array.dtype) if array.ndim in (1, 2) else None
    if code is None:
        raise InputError(
            f"array {name} in a state frame has type {array.dtype} and shape {array.shape}: expected one or two "
            "axes of " + ", ".join(item.name for item in TYPES)
        )
    return code


@functools.cache
def _code_of(dtype: np.dtype[Any]) -> int | None:
    """Return the code of a type, None if there is none; comparing types takes longer than copying a small array."""
    little = dtype.newbyteorder("<")
    return TYPES.index(little) if little in TYPES else None
