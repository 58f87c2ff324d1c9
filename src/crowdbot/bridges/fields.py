"""Messages as nested mappings, and back: the form of JSON transports and of requests and responses."""

from __future__ import annotations

import base64
import binascii
import math
import sys
from collections.abc import Mapping
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype

from crowdbot.core import InputError

from .interface import interface_store

DEEPEST, LONGEST = 32, 1 << 22
"""Largest depth of a message, and number of elements of an array."""
RANGES = {f"{sign}int{size}": size for sign in ("", "u") for size in (8, 16, 32, 64)}


def fields_of(message: Any) -> dict[str, Any]:
    """Return the fields of a message; arrays stay NumPy arrays.

    >>> from crowdbot.messages import Messages
    >>> fields_of(Messages().twist(0.5, 0.1, 0.0))["linear"]
    {'x': 0.5, 'y': 0.0, 'z': 0.0}
    """
    result: dict[str, Any] = {}
    for name, value in vars(message).items():
        if name == "__msgtype__":
            continue
        if hasattr(value, "__msgtype__"):
            result[name] = fields_of(value)
        elif isinstance(value, list) and value and hasattr(value[0], "__msgtype__"):
            result[name] = [fields_of(item) for item in value]
        else:
            result[name] = value
    return result


def plain_fields(message: Any) -> dict[str, Any]:
    """Return the fields of a message for JSON, as rosbridge writes them.

    Bytes (``uint8[]``) are base64 text; NaN and infinite numbers are None.

    >>> from crowdbot.messages import Messages
    >>> plain_fields(Messages().joint_states(0, {"HeadYaw": (0.5, float("nan"))}))["velocity"]
    [None]
    """
    return {name: _plain(value) for name, value in fields_of(message).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(inner) for name, inner in value.items()}
    if isinstance(value, np.ndarray):
        if value.dtype == np.uint8:
            return base64.b64encode(value.tobytes()).decode()
        rows = value.tolist()
        return rows if value.dtype.kind != "f" or np.isfinite(value).all() else [_plain(row) for row in rows]
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def stamp_fields(nanoseconds: int) -> dict[str, int]:
    """Return the fields of a ``builtin_interfaces/Time`` or ``Duration`` [ns].

    >>> stamp_fields(1_500_000_000)
    {'sec': 1, 'nanosec': 500000000}
    """
    return {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}


def memory_size(value: Any) -> int:
    """Return about how much memory a message or nested mapping takes [bytes].

    >>> memory_size({"data": "x" * 1000}) > 1000
    True
    """
    size, rest = 0, [value]
    while rest:
        value = rest.pop()
        size += value.nbytes if isinstance(value, np.ndarray) else sys.getsizeof(value)
        if isinstance(value, Mapping):
            rest += value.keys()
            rest += value.values()
        elif isinstance(value, list | tuple):
            rest += value
        elif hasattr(value, "__msgtype__"):
            rest += vars(value).values()
    return size


def message_of(fields: Mapping[str, Any], kind: str) -> Any:
    """Return the message of a type from nested mappings; missing fields are 0 or empty.

    Raises:
        InputError: the type is unknown, a field does not exist or has another type; the field is named.

    >>> message_of({"linear": {"x": 0.5}}, "geometry_msgs/msg/Twist").angular.z
    0.0
    """
    return _message(fields, kind, kind.rpartition("/")[2], 0)


def _message(fields: Any, kind: str, place: str, depth: int) -> Any:
    store = interface_store()
    if kind not in store.fielddefs:
        raise InputError(f"{place}: the message type {kind!r} is unknown")
    if not isinstance(fields, Mapping):
        raise InputError(f"{place} must be an object")
    if depth > DEEPEST:
        raise InputError(f"{place} is too deep")
    parts = dict(store.fielddefs[kind][1])
    for name in fields:
        if name not in parts:
            raise InputError(f"{place} has no field {str(name)[:40]!r}; it has {', '.join(parts)}")
    values = {name: _value(fields.get(name), node, f"{place}.{name}", depth) for name, node in parts.items()}
    return store.types[kind](**values)


def _value(value: Any, node: Any, place: str, depth: int) -> Any:
    kind, detail = node
    if kind == Nodetype.NAME:
        return _message({} if value is None else value, detail, place, depth + 1)
    if kind == Nodetype.BASE:
        return _number(value, detail[0], place)
    inner, size = detail
    count = size if kind == Nodetype.ARRAY else 0
    rows = _rows(value, inner, count, place)
    if kind == Nodetype.ARRAY and len(rows) != count:
        raise InputError(f"{place} must have {count} elements, not {len(rows)}")
    if inner[0] == Nodetype.BASE and inner[1][0] not in ("string", "bool"):
        dtype = np.dtype({"octet": "uint8", "byte": "uint8", "char": "uint8"}.get(inner[1][0], inner[1][0]))
        try:
            return np.array([math.nan if row is None else row for row in rows], dtype=dtype)
        except (TypeError, ValueError, OverflowError):
            raise InputError(f"{place} must be a list of {inner[1][0]}") from None
    return [_value(row, inner, f"{place}[{k}]", depth) for k, row in enumerate(rows)]


def _rows(value: Any, inner: Any, count: int, place: str) -> Any:
    if value is None:
        return [None if inner[0] == Nodetype.NAME else _empty(inner[1][0])] * count
    if isinstance(value, str) and inner[0] == Nodetype.BASE and inner[1][0] in ("uint8", "octet", "byte", "char"):
        try:
            return list(base64.b64decode(value, validate=True))
        except (binascii.Error, ValueError):
            raise InputError(f"{place} must be base64") from None
    if isinstance(value, bytes | bytearray):
        return list(value)
    if isinstance(value, np.ndarray):
        return value.tolist()
    if not isinstance(value, list | tuple) or len(value) > LONGEST:
        raise InputError(f"{place} must be a list")
    return value


def _empty(kind: str) -> Any:
    return "" if kind == "string" else 0


def _number(value: Any, kind: str, place: str) -> Any:
    if kind == "string":
        if value is not None and not isinstance(value, str):
            raise InputError(f"{place} must be a text")
        return value or ""
    if kind == "bool":
        if value is not None and not isinstance(value, bool | int):
            raise InputError(f"{place} must be true or false")
        return bool(value)
    if kind.startswith("float"):
        if value is None:
            return 0.0
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{place} must be a number")
        return float(value)
    number = 0 if value is None else value
    size = RANGES.get(kind, 8)
    low = -(1 << size - 1) if kind.startswith("int") else 0
    high = (1 << size - (kind.startswith("int"))) - 1
    if isinstance(number, bool) or not isinstance(number, int) or not low <= number <= high:
        raise InputError(f"{place} must be a whole number from {low} to {high}")
    return number
