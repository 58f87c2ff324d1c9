"""Frames of the rosbridge protocol: limits, fragments, and messages as JSON, PNG and CBOR."""

from __future__ import annotations

import base64
import functools
import io
import json
import math
import struct
import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from crowdbot.bridges.fields import fields_of, memory_size, plain_fields
from crowdbot.bridges.socket_server import MOST_TEXT
from crowdbot.core import InputError
from crowdbot.recording import StepMessage

DEEPEST = 40
"""Largest depth of a frame."""
MOST_PARTS, MOST_MESSAGES = 10_000, 16
"""Largest number of fragments of a message, and of messages in fragments."""
PAYLOADS, LONGEST_WORD = ("data", "msg", "args", "values"), 1000
"""Members of a frame that may be long, and the largest number of characters of the others: names and words."""
MISSING = object()


def field(frame: Mapping[str, Any], name: str, kinds: type | tuple[type, ...], default: Any = MISSING) -> Any:
    """Return a field of a frame.

    Raises:
        InputError: it is missing, or has another type.

    >>> field({"topic": "/scan"}, "topic", str), field({}, "id", str, "")
    ('/scan', '')
    """
    value = frame.get(name, MISSING)
    if value is MISSING or (value is None and default is not MISSING):
        if default is MISSING:
            raise InputError(f"{frame.get('op')} needs {name!r}")
        return default
    allowed = kinds if isinstance(kinds, tuple) else (kinds,)
    if not isinstance(value, allowed) or (isinstance(value, bool) and bool not in allowed):
        words = " or ".join(kind.__name__ for kind in allowed)
        raise InputError(f"{frame.get('op')}: {name!r} must be of type {words}")
    return value


class FrameReader:
    """Reads the frames of one client.

    >>> reader = FrameReader()
    >>> reader.read('{"op": "fragment", "id": "1", "data": "{\\\\"op\\\\": ", "num": 0, "total": 2}')
    >>> reader.read('{"op": "fragment", "id": "1", "data": "\\\\"x\\\\"}", "num": 1, "total": 2}')
    {'op': 'x'}
    """

    def __init__(self) -> None:
        self._parts: dict[str, dict[int, str]] = {}
        self._totals: dict[str, int] = {}
        self._size = 0

    def read(self, text: str) -> dict[str, Any] | None:
        """Return the object of a frame, None if fragments are missing.

        Raises:
            InputError: the frame is not allowed, with the reason.
        """
        frame = self._load(text)
        if frame.get("op") != "fragment":
            return frame
        whole = self._join(frame)
        if whole is None:
            return None
        frame = self._load(whole)
        if frame.get("op") == "fragment":
            raise InputError("fragments cannot contain fragments")
        return frame

    def _load(self, text: str) -> dict[str, Any]:
        if len(text) > MOST_TEXT:
            raise InputError(f"a frame has {len(text)} characters, at most {MOST_TEXT} are allowed")
        try:
            frame = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise InputError(f"a frame is not JSON: {str(error)[:100]}") from None
        if not isinstance(frame, dict) or not isinstance(frame.get("op"), str):
            raise InputError('a frame must be a JSON object with "op"')
        for name, value in frame.items():
            if name not in PAYLOADS and isinstance(value, str) and len(value) > LONGEST_WORD:
                raise InputError(f"{name[:40]!r} has {len(value)} characters, at most {LONGEST_WORD} are allowed")
        if not isinstance(frame.get("id"), str | int | None):
            raise InputError("id must be a text or a number")
        if _is_deep(frame):
            raise InputError(f"a frame is deeper than {DEEPEST}")
        return frame

    def _join(self, frame: dict[str, Any]) -> str | None:
        name, data = str(field(frame, "id", (str, int)))[:200], field(frame, "data", str)
        number, total = field(frame, "num", int), field(frame, "total", int)
        if not 0 < total <= MOST_PARTS or not 0 <= number < total or self._totals.get(name, total) != total:
            raise InputError("fragment: num and total do not match")
        parts = self._parts.setdefault(name, {})
        self._totals[name] = total
        self._size += len(data) - len(parts.get(number, ""))
        parts[number] = data
        if self._size > MOST_TEXT or len(self._parts) > MOST_MESSAGES:
            self._parts.clear()
            self._totals.clear()
            self._size = 0
            raise InputError(f"fragments wait for more than {MOST_TEXT} characters or {MOST_MESSAGES} messages")
        if len(parts) < total:
            return None
        del self._parts[name], self._totals[name]
        whole = "".join(parts[k] for k in range(total))
        self._size -= len(whole)
        return whole


def _is_deep(value: Any) -> bool:
    """Return whether a value has more than :data:`DEEPEST` levels."""
    level = [value]
    for _ in range(DEEPEST):
        level = [
            inner
            for item in level
            for inner in (item.values() if isinstance(item, dict) else item)
            if isinstance(inner, dict | list)
        ]
        if not level:
            return False
    return True


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


COMPRESSIONS = ("none", "png", "cbor", "cbor-raw")


def dump_json(value: Any) -> str:
    """Return compact JSON; NaN is not allowed in it.

    >>> dump_json({"op": "status"})
    '{"op":"status"}'
    """
    return json.dumps(value, separators=(",", ":"), allow_nan=False, ensure_ascii=False)


class OutgoingMessage:
    """A message for the subscribers of a topic, encoded at most once in each form.

    Args:
        topic, kind: topic and message type.
        nanoseconds: time [ns].
        plain: returns the fields for JSON.
        rich: returns the fields with NumPy arrays, for CBOR.
        cdr: returns the CDR bytes, for ``cbor-raw``; None: not available.
        memory: returns about how much memory the message takes [bytes]; None: that of the fields.

    >>> message = OutgoingMessage("/chat", "std_msgs/msg/String", 0, lambda: {"data": "hi"})
    >>> message.frames("none", None, "1")
    ['{"op":"publish","topic":"/chat","msg":{"data":"hi"}}']
    """

    def __init__(
        self,
        topic: str,
        kind: str,
        nanoseconds: int,
        plain: Callable[[], Any],
        rich: Callable[[], Any] | None = None,
        cdr: Callable[[], bytes] | None = None,
        memory: Callable[[], int] | None = None,
    ) -> None:
        self.topic, self.kind, self.nanoseconds = topic, kind, nanoseconds
        self._plain, self._rich, self._cdr = plain, rich or plain, cdr
        self._memory = memory or (lambda: memory_size(self._rich()))

    @classmethod
    def of(cls, step: StepMessage) -> OutgoingMessage:
        """Return the message of a step."""
        return cls(
            step.topic,
            step.kind,
            step.nanoseconds,
            lambda: plain_fields(step.message),
            lambda: fields_of(step.message),
            lambda: step.cdr,
            lambda: memory_size(step.content),
        )

    @classmethod
    def relayed(cls, topic: str, kind: str, nanoseconds: int, fields: Any) -> OutgoingMessage:
        """Return a message of another client, kept as text: its objects take up to 20 times as much memory."""
        row = {"op": "publish", "topic": topic, "msg": fields}
        try:
            text, finite = dump_json(row), True
        except ValueError:  # with NaN, which only CBOR can tell
            text, finite = json.dumps(row), False
        message = cls(topic, kind, nanoseconds, lambda: json.loads(text)["msg"], memory=lambda: sys.getsizeof(text))
        if finite:
            message._json = text
        return message

    def frames(self, compression: str, fragment_size: int | None, number: str) -> list[str | bytes]:
        """Return the WebSocket frames: text, or bytes for CBOR.

        Args:
            compression: one of :data:`COMPRESSIONS`.
            fragment_size: largest number of characters of a text frame; None: no limit.
            number: id of the fragments.
        """
        if compression == "cbor":
            return [self._cbor]
        if compression == "cbor-raw" and self._cdr is not None:
            return [self._cbor_raw]
        text = self._png if compression == "png" else self._json
        return list(fragments(text, fragment_size, number))

    @functools.cached_property
    def memory(self) -> int:
        """About how much memory the message takes [bytes], without its frames."""
        return self._memory()

    @functools.cached_property
    def _json(self) -> str:
        rich, rows = self._rich(), list[str]()
        for name, value in self._plain().items():
            is_base64 = isinstance(value, str) and isinstance(rich[name], np.ndarray)
            # base64 needs no escapes: json would look for them in each character of an image, for 2 ms
            rows.append(f'"{name}":"{value}"' if is_base64 else f"{dump_json(name)}:{dump_json(value)}")
        return f'{{"op":"publish","topic":{dump_json(self.topic)},"msg":{{{",".join(rows)}}}}}'

    @functools.cached_property
    def _png(self) -> str:
        return png_frame(self._json)

    @functools.cached_property
    def _cbor(self) -> bytes:
        return encode_cbor({"op": "publish", "topic": self.topic, "msg": self._rich()})

    @functools.cached_property
    def _cbor_raw(self) -> bytes:
        assert self._cdr is not None
        seconds, rest = divmod(self.nanoseconds, 10**9)
        raw = {"secs": seconds, "nsecs": rest, "bytes": self._cdr()}
        return encode_cbor({"op": "publish", "topic": self.topic, "msg": raw})


def fragments(text: str, size: int | None, number: str) -> list[str]:
    """Return a frame, or its fragments if it is longer than ``size`` characters.

    >>> [json.loads(one)["data"] for one in fragments('{"op":"x"}', 6, "1")]
    ['{"op":', '"x"}']
    """
    if size is None or len(text) <= size:
        return [text]
    total = -(-len(text) // size)
    return [
        dump_json({"op": "fragment", "id": number, "data": text[k * size : (k + 1) * size], "num": k, "total": total})
        for k in range(total)
    ]


def png_frame(text: str) -> str:
    """Return a frame whose data are a PNG of the bytes of a text, as rosbridge_suite makes it.

    >>> json.loads(png_frame('{"op":"status"}'))["op"]
    'png'
    """
    from PIL import Image

    data = text.encode()
    width = max(1, math.isqrt(len(data) // 3))
    height = max(1, -(-len(data) // (3 * width)))
    image = Image.frombytes("RGB", (width, height), data.ljust(3 * width * height, b"\n"))
    with io.BytesIO() as buffer:
        image.save(buffer, "PNG")
        return dump_json({"op": "png", "data": base64.b64encode(buffer.getvalue()).decode()})
