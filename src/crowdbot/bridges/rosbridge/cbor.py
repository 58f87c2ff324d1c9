"""CBOR (RFC 8949) with typed arrays (RFC 8746), as rosbridge sends it."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from crowdbot.core import InputError

UNSIGNED, NEGATIVE, BYTES, TEXT, LIST, MAPPING, TAG = range(7)
TYPED = {"<u2": 69, "<u4": 70, "<u8": 71, "|i1": 72, "<i2": 77, "<i4": 78, "<i8": 79, "<f4": 85, "<f8": 86}
"""Tags of little-endian arrays by NumPy type; bytes need none."""
FALSE, TRUE, NONE = b"\xf4", b"\xf5", b"\xf6"


def encode_cbor(value: Any) -> bytes:
    """Return a value as CBOR: mappings, lists, arrays, texts, bytes, numbers, True, False and None.

    Raises:
        InputError: the value has another type.

    >>> encode_cbor({"a": [1, -2, 0.5, None]}).hex()
    'a16161840121fb3fe0000000000000f6'
    """
    out = bytearray()
    _write(out, value)
    return bytes(out)


def _head(out: bytearray, major: int, number: int) -> None:
    if number < 24:
        out.append(major << 5 | number)
        return
    for code, size in ((24, 1), (25, 2), (26, 4), (27, 8)):
        if number < 1 << 8 * size:
            out.append(major << 5 | code)
            out += number.to_bytes(size, "big")
            return
    raise InputError(f"{number} is too large for CBOR")


def _write(out: bytearray, value: Any) -> None:
    if value is None or isinstance(value, bool | np.bool_):
        out += NONE if value is None else TRUE if value else FALSE
    elif isinstance(value, int | np.integer):
        number = int(value)
        _head(out, UNSIGNED if number >= 0 else NEGATIVE, number if number >= 0 else -1 - number)
    elif isinstance(value, float | np.floating):
        out += b"\xfb" + struct.pack(">d", float(value))
    elif isinstance(value, str):
        data = value.encode()
        _head(out, TEXT, len(data))
        out += data
    elif isinstance(value, bytes | bytearray):
        _head(out, BYTES, len(value))
        out += value
    elif isinstance(value, dict):
        _head(out, MAPPING, len(value))
        for name, inner in value.items():
            _write(out, name)
            _write(out, inner)
    elif isinstance(value, np.ndarray):
        _array(out, value)
    elif isinstance(value, list | tuple):
        _head(out, LIST, len(value))
        for inner in value:
            _write(out, inner)
    else:
        raise InputError(f"a {type(value).__name__} has no form in CBOR")


def _array(out: bytearray, value: Any) -> None:
    kind = value.dtype.str
    if kind in TYPED:
        _head(out, TAG, TYPED[kind])
    elif kind != "|u1":
        _write(out, value.tolist())
        return
    _write(out, value.tobytes())
