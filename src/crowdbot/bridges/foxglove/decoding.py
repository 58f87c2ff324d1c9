"""Messages of Foxglove clients: JSON or CDR to fields."""

from __future__ import annotations

import json
from typing import Any

from crowdbot.bridges.fields import fields_of
from crowdbot.bridges.verbs.definitions import interface_store
from crowdbot.core import InputError

MOST_BYTES = 1 << 20
"""Largest message or request of a client [bytes]."""


def decode_fields(data: bytes, encoding: str, kind: str) -> dict[str, Any]:
    """Return the fields of a message from a client.

    Raises:
        InputError: the encoding is not supported, or the data are not of the type.

    >>> decode_fields(b'{"steps": 3}', "json", "simulation_interfaces/msg/StepSimulation_Request")
    {'steps': 3}
    """
    if len(data) > MOST_BYTES:
        raise InputError(f"a message has {len(data)} bytes; at most {MOST_BYTES} are allowed")
    if encoding == "json":
        try:
            fields = json.loads(data or b"{}")
        except (ValueError, RecursionError):
            raise InputError("a message is not JSON") from None
        if not isinstance(fields, dict):
            raise InputError("a message must be a JSON object")
        return fields
    if encoding != "cdr":
        raise InputError(f"encoding {encoding[:40]!r} is not supported; use json or cdr")
    store = interface_store()
    if kind not in store.fielddefs:
        raise InputError(f"the message type {kind[:80]!r} is unknown")
    try:
        return fields_of(store.deserialize_cdr(data, kind))
    except Exception:  # rosbags raises many kinds of errors for bytes of another type
        raise InputError(f"a message is no CDR of {kind}") from None
