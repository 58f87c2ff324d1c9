"""Names and formats shared by the writer and the reader of episode files."""

from __future__ import annotations

import importlib
import json
import math
import platform
from collections.abc import Mapping
from typing import Any

import numpy as np

METADATA = "crowdbot"
"""Name of the metadata record at the start."""
ADDED_ROBOTS = "crowdbot.robots"
"""Name of the metadata record of the robots that orders have added; the last one counts."""
ENDING = "crowdbot.end"
"""Name of the metadata record at the end; missing in files of killed runs."""
KEYS = ("format", "trial", "trial_name", "seed", "version", "walls", "robots")
"""Required keys of the record at the start (text values)."""
END_KEYS = ("digest", "outcome", "steps", "people", "metrics")
"""Required keys of the record at the end."""
FORMAT = "3"
"""Format of episode files; other formats are rejected."""
DIGEST = "/crowdbot/digest"
"""Topic of the digest up to each recorded step, as if interrupted there."""
TWIST = ("linear_x", "angular_z", "linear_y")
"""Columns of forward speed [m/s], turn rate [rad/s] and leftward speed [m/s], named as in ROS."""
ORDERS = "/crowdbot/orders"
"""Topic of the orders from outside, as JSON."""
CONTACTS = "/crowdbot/contacts"
"""Topic of the contacts of robots."""
GROUND_TRUTH = "/ground_truth/odom"
"""Topic of the true pose of a robot, after its name."""
REACTION_TOPIC = "/crowdbot/reactions"
"""Topic of the reactions to robots that are in force, as JSON: ids of people by kind of reaction."""
GESTURE_TOPIC = "/crowdbot/gestures"
"""Topic of the gestures of people to robots, as JSON: ids of people by gesture."""


def versions() -> dict[str, str]:
    """Return what an episode depends on to the last bit: versions of packages, and the processor."""
    # numba takes longer to import than the rest of this package; many commands need no kernel
    import llvmlite.binding
    import numba

    door = importlib.import_module(
        "crowdbot"
    )  # crowdbot imports this package, so it cannot be imported at module level
    return {
        "version": str(door.__version__),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
        "processor": llvmlite.binding.get_host_cpu_name(),
    }


def heading_of(quaternion: Any) -> float:
    """Return the heading [rad] of a rotation about z."""
    return 2.0 * math.atan2(quaternion.z, quaternion.w)


def as_json(value: Any) -> str:
    """Return JSON; NaN is written as null, infinity as ``inf`` and ``-inf``.

    >>> as_json({"a": float("inf"), "b": [1.5, float("nan")]})
    '{"a": "inf", "b": [1.5, null]}'
    """
    return json.dumps(_plain(value), allow_nan=False)


def from_json(text: str) -> dict[str, float]:
    """Return the numbers by name from JSON of :func:`as_json`.

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
