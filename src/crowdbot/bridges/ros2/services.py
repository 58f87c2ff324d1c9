"""Services of a ROS 2 node: those of ``std_srvs``, and of ``simulation_interfaces`` where it is installed."""

from __future__ import annotations

import array
import importlib
import queue
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.plain_services import PLAIN_SERVICES, PlainService
from crowdbot.bridges.verbs.definitions import PACKAGE, SERVICES
from crowdbot.bridges.verbs.results import FAILED, result
from crowdbot.core import InputError

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
        return [_plain(one) for one in value]
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
    return [_typed(one, inner[1], _new(inner[1])) for one in value]


def _new(kind: str) -> Any:
    """Return an empty message of a type, None for a number or text."""
    package, sign, name = kind.partition("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)() if sign else None


CALLS = 4
"""Number of calls that can wait for the simulation at the same time; the node needs as many threads."""
ANSWER_TIME = 600.0
"""Longest real time [s] that a call waits for the simulation."""
UNANSWERED = "the simulation does not answer"


def service_class(package: str, kind: str) -> Any:
    """Return the class of a service type of the ROS installation; None if its package is not installed."""
    try:
        return getattr(importlib.import_module(f"{package}.srv"), kind, None)
    except ImportError:
        return None


def add_services(node: Any, inbox: Inbox, sender: str) -> tuple[str, ...]:
    """Offer the services on a node, and return the types that are not installed.

    A callback blocks its thread until the simulation has answered, which ends with the run at the latest.

    Args:
        node: node of rclpy, in an executor with :data:`CALLS` threads.
        inbox: receives the calls.
        sender: name of the transport.
    """
    missing: dict[str, None] = {}
    group = importlib.import_module("rclpy.callback_groups").ReentrantCallbackGroup()
    for name, plain in PLAIN_SERVICES.items():
        found = service_class("std_srvs", plain.kind)
        if found is None:
            missing[f"std_srvs/srv/{plain.kind}"] = None
        else:
            node.create_service(found, name, _plain_callback(plain, node, inbox, sender), callback_group=group)
    for short, definition in SERVICES.items():
        found = service_class(PACKAGE, definition.kind)
        if found is None:
            missing[f"{PACKAGE}/srv/{definition.kind}"] = None
        else:
            name = f"/crowdbot/{short}"
            node.create_service(found, name, _callback(name, inbox, sender), callback_group=group)
    return tuple(missing)


def _plain_callback(service: PlainService, node: Any, inbox: Inbox, sender: str) -> Callable[[Any, Any], Any]:
    def call(request: Any, response: Any) -> Any:
        found: queue.SimpleQueue[str] = queue.SimpleQueue()
        try:
            service.call(inbox, found.put, sender)
            problem = found.get(timeout=ANSWER_TIME)
        except (InputError, queue.Empty) as error:
            problem = str(error) or UNANSWERED
        if service.kind == "Trigger":
            return fill_message(response, {"success": not problem, "message": problem})
        if problem:  # Empty has no place for it
            node.get_logger().error(problem)
        return response

    return call


def _callback(name: str, inbox: Inbox, sender: str) -> Callable[[Any, Any], Any]:
    def call(request: Any, response: Any) -> Any:
        found: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        try:
            inbox.call(name, message_fields(request), found.put, sender)
            fields = found.get(timeout=ANSWER_TIME)
        except (InputError, queue.Empty) as error:
            fields = result(FAILED, str(error) or UNANSWERED)
        return fill_message(response, fields)

    return call
