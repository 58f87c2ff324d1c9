"""Ros1Messages: the messages of the recorder in the encoding and with the checksums of ROS 1."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from .message_store import OWN, Messages

TF = "geometry_msgs/TransformStamped[] transforms\n"
ACTION = "FollowJointTrajectory"
CONTROL = {
    "JointTolerance": "string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration\n",
    f"{ACTION}Goal": (
        "trajectory_msgs/JointTrajectory trajectory\nJointTolerance[] path_tolerance\nJointTolerance[] goal_tolerance\n"
        "duration goal_time_tolerance\n"
    ),
    f"{ACTION}Result": (
        "int32 error_code\nint32 SUCCESSFUL=0\nint32 INVALID_GOAL=-1\nint32 INVALID_JOINTS=-2\n"
        "int32 OLD_HEADER_TIMESTAMP=-3\nint32 PATH_TOLERANCE_VIOLATED=-4\nint32 GOAL_TOLERANCE_VIOLATED=-5\n"
        "string error_string\n"
    ),
    f"{ACTION}Feedback": (
        "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint desired\n"
        "trajectory_msgs/JointTrajectoryPoint actual\ntrajectory_msgs/JointTrajectoryPoint error\n"
    ),
    f"{ACTION}ActionGoal": f"std_msgs/Header header\nactionlib_msgs/GoalID goal_id\n{ACTION}Goal goal\n",
    f"{ACTION}ActionResult": f"std_msgs/Header header\nactionlib_msgs/GoalStatus status\n{ACTION}Result result\n",
    f"{ACTION}ActionFeedback": (
        f"std_msgs/Header header\nactionlib_msgs/GoalStatus status\n{ACTION}Feedback feedback\n"
    ),
}
"""Types of ``control_msgs`` of ROS Noetic for the action FollowJointTrajectory."""


@functools.cache
def _store() -> Any:
    store = get_typestore(Stores.ROS1_NOETIC)
    for name, text in {**OWN, "tf2_msgs/msg/TFMessage": TF}.items():
        store.register(get_types_from_msg(text, name))
    for name, text in CONTROL.items():
        store.register(get_types_from_msg(text, f"control_msgs/msg/{name}"))
    return store


class Ros1Messages:
    """Converts messages between CDR and ROS 1 bytes, and gives the definitions of ROS 1.

    Both encodings have the same fields in the same order, but for the counter ``seq`` of headers (0 here) and a few
    types that grew in ROS 2, such as ``visualization_msgs/Marker``; fields that ROS 1 lacks are left out. Types have
    the names of ROS 2, ``geometry_msgs/msg/Twist``.

    >>> make, ros1 = Messages(), Ros1Messages()
    >>> data = ros1.of_cdr(make.encode_message(make.twist(0.5, 0.1, 0.0)), "geometry_msgs/msg/Twist")
    >>> len(data), ros1.message(data, "geometry_msgs/msg/Twist").linear.x
    (48, 0.5)
    >>> ros1.checksum("geometry_msgs/msg/Twist")
    '9f195f881246fdfa2798d1d3eebca84a'
    """

    def __init__(self) -> None:
        self.store = _store()
        self._plain = Messages().store

    def of_cdr(self, data: bytes, kind: str) -> bytes:
        """Return the ROS 1 bytes of a message from its CDR bytes (little endian)."""
        if _is_equal(kind):
            return bytes(self._plain.cdr_to_ros1(data, kind))
        message = self._convert(self._plain.deserialize_cdr(data, kind), kind)
        return bytes(self.store.serialize_ros1(message, kind))

    def message(self, data: bytes, kind: str) -> Any:
        """Return the message, with the fields of ROS 1, from its ROS 1 bytes.

        Raises:
            SerdeError: the bytes are not of this type.
        """
        return self.store.deserialize_ros1(data, kind)

    def encode(self, message: Any) -> bytes:
        """Return the ROS 1 bytes of a message with the fields of ROS 1."""
        return bytes(self.store.serialize_ros1(message, message.__msgtype__))

    def encode_fields(self, fields: Mapping[str, Any], kind: str) -> bytes:
        """Return the ROS 1 bytes of a message from nested mappings; missing fields are 0 or empty.

        >>> Ros1Messages().encode_fields({"id": "a"}, "actionlib_msgs/msg/GoalID")
        b'\\x00\\x00\\x00\\x00\\x00\\x00\\x00\\x00\\x01\\x00\\x00\\x00a'
        """
        return self.encode(self._fill(fields, kind))

    def _fill(self, fields: Mapping[str, Any], kind: str) -> Any:
        values: dict[str, Any] = {}
        for name, node in self.store.fielddefs[kind][1]:
            if (part := _part(node)) and node[0] == Nodetype.NAME:
                values[name] = self._fill(fields.get(name, {}), part)
            elif part:
                values[name] = [self._fill(item, part) for item in fields.get(name, ())]
            else:
                base = node[1][0] if node[0] == Nodetype.BASE else node[1][0][1][0]
                values[name] = _plain_value(fields.get(name), base, node[0] != Nodetype.BASE)
        return self.store.types[kind](**values)

    def definition(self, kind: str) -> str:
        """Return the definition of a type with all its parts."""
        return str(_definition(kind)[0])

    def checksum(self, kind: str) -> str:
        """Return the md5 sum of a type, which publishers and subscribers compare."""
        return str(_definition(kind)[1])

    def _convert(self, value: Any, kind: str) -> Any:
        """Return a message of ROS 1 with the fields of a message of ROS 2."""
        fields: dict[str, Any] = {}
        for name, (node, detail) in self.store.fielddefs[kind][1]:
            inner: Any = getattr(value, name if hasattr(value, name) else name.lower(), 0)  # 0: seq of headers
            if node == Nodetype.NAME:
                inner = self._convert(inner, detail)
            elif node != Nodetype.BASE and detail[0][0] == Nodetype.NAME:
                inner = [self._convert(item, detail[0][1]) for item in inner]
            fields[name] = inner
        return self.store.types[kind](**fields)


@functools.cache
def _definition(kind: str) -> tuple[str, str]:
    definition: tuple[str, str] = _store().generate_msgdef(kind, ros_version=1)
    return definition


@functools.cache
def _is_equal(kind: str) -> bool:
    """Return whether a type has the same fields in both, but for the counter of headers."""
    if kind == "std_msgs/msg/Header":
        return True
    ours, theirs = Messages().store.fielddefs[kind][1], _store().fielddefs[kind][1]
    if [(name.lower(), node) for name, node in ours] != [(name.lower(), node) for name, node in theirs]:
        return False
    return all(_is_equal(part) for _, node in ours if (part := _part(node)))


def _plain_value(value: Any, base: str, many: bool) -> Any:
    """Return a number or text, or an array of them, as rosbags writes it."""
    if base == "string":
        return list(value or ()) if many else str(value or "")
    return np.array(() if value is None else value, dtype=base) if many else value or 0


def _part(node: Any) -> str:
    """Return the message type of a field, empty if it is a number or text."""
    kind, detail = node
    if kind == Nodetype.NAME:
        return str(detail)
    return str(detail[0][1]) if kind != Nodetype.BASE and detail[0][0] == Nodetype.NAME else ""
