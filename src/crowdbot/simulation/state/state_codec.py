"""Bytes of a state: a JSON table and the raw arrays in little-endian order, compressed with zstd.

Nothing in the bytes is executed when they are read: no pickle and no names of modules.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

from crowdbot.core import StateError, StateMark, tree

MARK = b"crowdbot state 1\n"
LARGEST = 1 << 28
"""Largest decompressed state [bytes]; a damaged header can claim any size."""
LEVEL = 3


def encode_state(state: Mapping[str, Any]) -> bytes:
    """Return the bytes of a state of :func:`crowdbot.simulation.state_of`.

    Raises:
        StateError: the state is too large.

    >>> state = {"time": 0.5, "ids": np.arange(3)}
    >>> decode_state(encode_state(state))
    {'time': 0.5, 'ids': array([0, 1, 2])}
    """
    import zstandard

    table, arrays = {}, []
    for path, value in state.items():
        if isinstance(value, np.ndarray):
            little = np.ascontiguousarray(value, dtype=value.dtype.newbyteorder("<"))
            arrays.append(little.tobytes())
            table[path] = ["array", little.dtype.str, list(value.shape)]
        else:
            table[path] = list(value) if isinstance(value, StateMark) else value
    head = json.dumps(table, separators=(",", ":")).encode()
    whole = MARK + struct.pack("<Q", len(head)) + head + b"".join(arrays)
    if len(whole) > LARGEST:
        raise StateError(f"a state of {len(whole)} bytes is too large to be stored; at most {LARGEST} are")
    return bytes(zstandard.ZstdCompressor(level=LEVEL).compress(whole))


def decode_state(data: bytes) -> dict[str, Any]:
    """Return the state in bytes of :func:`encode_state`.

    Raises:
        StateError: the bytes are damaged.
    """
    import zstandard

    try:
        size = zstandard.frame_content_size(data)
        if not 0 <= size <= LARGEST:
            raise StateError(f"a state claims {size} bytes; at most {LARGEST} are read")
        whole = zstandard.ZstdDecompressor().decompress(data, max_output_size=size)
        return _parsed(whole)
    except StateError:
        raise
    except (zstandard.ZstdError, struct.error, ValueError, TypeError, OverflowError, RecursionError) as error:
        raise StateError(f"a state is damaged: {str(error)[:80]}") from None


def _parsed(whole: bytes) -> dict[str, Any]:
    place = len(MARK) + 8
    if whole[: len(MARK)] != MARK:
        raise StateError("a state does not begin with its mark")
    (length,) = struct.unpack_from("<Q", whole, len(MARK))
    if length > len(whole) - place:
        raise StateError("the table of a state is longer than the state")
    table = json.loads(whole[place : place + length])
    if not isinstance(table, dict):
        raise StateError("the table of a state is not an object")
    place, found = place + length, dict[str, Any]()
    for path, row in table.items():
        if isinstance(row, list) and row and row[0] == "array":
            found[path], place = _array(path, row, whole, place)
        elif isinstance(row, list):
            if len(row) != 2 or not isinstance(row[0], str):
                raise StateError(f"{path} has no kind and content")
            found[path] = StateMark(*row)
        elif row is None or isinstance(row, tree.SCALARS):
            found[path] = row
        else:
            raise StateError(f"{path} is not a value of a state")
    if place != len(whole):
        raise StateError(f"a state has {len(whole) - place} bytes too many")
    return found


def _array(path: str, row: list[Any], whole: bytes, place: int) -> tuple[Any, int]:
    """Return the array of a row of the table, and the offset after it."""
    _, name, shape = row
    kind = np.dtype(str(name))
    axes = isinstance(shape, list) and len(shape) <= 8 and all(type(n) is int and 0 <= n <= LARGEST for n in shape)
    if kind.kind not in "biuf" or not axes:
        raise StateError(
            f"{path} is an array of {str(name)[:20]!r} with the shape {str(shape)[:40]}, which is not stored"
        )
    count = math.prod(shape)
    size = count * kind.itemsize
    if size > len(whole) - place:
        raise StateError(f"{path} is longer than the state")
    flat = np.frombuffer(whole, dtype=kind, count=count, offset=place)
    if kind.kind == "b" and np.any(np.frombuffer(whole, dtype=np.uint8, count=count, offset=place) > 1):
        raise StateError(f"{path} has values that are neither true nor false")
    return flat.reshape(shape).astype(kind.newbyteorder("=")), place + size
