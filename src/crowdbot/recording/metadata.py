"""What the writer and the reader of an episode file agree on."""

from __future__ import annotations

import importlib
import json
import math
import platform
from collections.abc import Mapping
from typing import Any

import numba
import numpy as np

__all__ = [
    "CONTACTS",
    "DIGEST",
    "ENDING",
    "END_KEYS",
    "FORMAT",
    "KEYS",
    "METADATA",
    "as_json",
    "from_json",
    "heading_of",
    "versions",
]

METADATA = "crowdbot"
"""Name of the metadata record that stands at the beginning."""
ENDING = "crowdbot.end"
"""Name of the metadata record at the end; the file of a run that was killed has none."""
KEYS = ("trial", "trial_name", "seed", "version", "walls", "robots")
"""What the record at the beginning must hold, each as text."""
END_KEYS = ("digest", "outcome", "steps", "people", "metrics")
"""What the record at the end must hold; in format 1 one record held everything, and stood at the end."""
FORMAT = "2"
DIGEST = "/crowdbot/digest"
"""Topic of the digest up to each recorded instant, as it is when the run is interrupted there."""
CONTACTS = "/crowdbot/contacts"
"""Topic of the contacts of robots."""


def versions() -> dict[str, str]:
    """Return the versions that an episode depends on."""
    door = importlib.import_module("crowdbot")  # the front door opens on this room, so it is not imported above
    return {
        "version": str(door.__version__),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


def heading_of(quaternion: Any) -> float:
    """Return the heading [rad] of a rotation about z."""
    return 2.0 * math.atan2(quaternion.z, quaternion.w)


def as_json(value: Any) -> str:
    """Return JSON; numbers that JSON does not know are null (NaN) and the words ``inf`` and ``-inf``.

    >>> as_json({"a": float("inf"), "b": [1.5, float("nan")]})
    '{"a": "inf", "b": [1.5, null]}'
    """
    return json.dumps(_plain(value), allow_nan=False)


def from_json(text: str) -> dict[str, float]:
    """Return the numbers by name that :func:`as_json` has written.

    >>> from_json('{"a": "inf", "b": null, "c": 1.5}')
    {'a': inf, 'b': nan, 'c': 1.5}
    """
    return {key: math.nan if value is None else float(value) for key, value in json.loads(text).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value
