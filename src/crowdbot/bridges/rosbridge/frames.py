"""Frames from clients: limits on size and depth, fragments put together."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from crowdbot.core import InputError

MOST_TEXT = 4 << 20
"""Largest size of a frame, and of all waiting fragments of a client [characters]: a camera image fits."""
DEEPEST = 40
"""Largest depth of a frame."""
MOST_PARTS, MOST_MESSAGES = 10_000, 16
"""Largest number of fragments of a message, and of messages in fragments."""
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
            for one in level
            for inner in (one.values() if isinstance(one, dict) else one)
            if isinstance(inner, dict | list)
        ]
        if not level:
            return False
    return True
