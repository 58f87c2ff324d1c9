"""Messages of rclpy and nested mappings: the types of a user's ROS installation, read and filled by field names."""

from __future__ import annotations

import array
import importlib
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

TYPES = {"float": float, "double": float, "boolean": bool, "string": str}
"""Python types of the numbers and texts of ROS; all others are whole numbers."""


def message_fields(message: Any) -> dict[str, Any]:
    """Return the fields of a message of rclpy; arrays become lists.

    >>> class Steps:
    ...     steps = 3
    ...     def get_fields_and_field_types(self):
    ...         return {"steps": "uint64"}
    >>> message_fields(Steps())
    {'steps': 3}
    """
    return {name: _plain(getattr(message, name)) for name in message.get_fields_and_field_types()}


def _plain(value: Any) -> Any:
    if hasattr(value, "get_fields_and_field_types"):
        return message_fields(value)
    if isinstance(value, array.array | np.ndarray):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value


def fill_message(message: Any, fields: Mapping[str, Any]) -> Any:
    """Set the fields of a message of rclpy that a mapping has, and return it; others stay 0 or empty.

    Args:
        message: the message.
        fields: nested mappings.
    """
    for name, kind in message.get_fields_and_field_types().items():
        if name in fields:
            setattr(message, name, _typed(fields[name], kind, getattr(message, name)))
    return message


def _typed(value: Any, kind: str, now: Any) -> Any:
    """Return a value of a type, such as ``double``, ``geometry_msgs/Point`` or ``sequence<string>``."""
    if hasattr(now, "get_fields_and_field_types"):
        return fill_message(now, value)
    inner = re.fullmatch(r"sequence<(.*?)(?:, *\d+)?>", kind) or re.fullmatch(r"(.*)\[\d+\]", kind)
    if inner is None:
        return TYPES.get(kind, int)(value)
    return [_typed(item, inner[1], _new(inner[1])) for item in value]


def _new(kind: str) -> Any:
    """Return an empty message of a type, None for a number or text."""
    return ros_class(kind.replace("/", "/msg/"))() if "/" in kind else None


def ros_class(kind: str) -> Any:
    """Return the class of a type of the ROS installation; None if its package is not installed.

    Args:
        kind: such as ``geometry_msgs/msg/Twist``, ``std_srvs/srv/Trigger`` or ``nav2_msgs/action/NavigateToPose``.
    """
    package, folder, name = kind.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.{folder}"), name, None)
    except ImportError:
        return None
