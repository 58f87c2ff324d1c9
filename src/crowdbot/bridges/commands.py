"""Commands in messages: velocities, goals, joint targets and orders of other programs become orders."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from crowdbot.core import InputError
from crowdbot.messages import MAP
from crowdbot.simulation import GoalOrder, JointOrder, Order, VelocityOrder, read_order

Fields = Mapping[str, Any]
MOST_JOINTS = 200


def read_number(fields: Any, *path: str) -> float:
    """Return a number of nested fields, 0 if it is missing.

    Raises:
        InputError: it is not a finite number.

    >>> read_number({"linear": {"x": 0.5}}, "linear", "x"), read_number({}, "linear", "x")
    (0.5, 0.0)
    """
    value = fields
    for word in path:
        if not isinstance(value, Mapping):
            raise InputError(f"{'.'.join(path)}: {word} is in a {type(value).__name__}, it must be in an object")
        value = value.get(word, 0.0 if word == path[-1] else {})
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{'.'.join(path)} = {str(value)[:40]!r} must be a finite number")
    return float(value)


def read_point(fields: Any, *path: str) -> tuple[float, float]:
    """Return x and y of a point."""
    return read_number(fields, *path, "x"), read_number(fields, *path, "y")


def read_heading(fields: Any, *path: str) -> float:
    """Return the heading [rad] of a quaternion; one of zeros is the identity.

    >>> read_heading({"z": 1.0, "w": 0.0}) == math.pi
    True
    """
    x, y, z, w = (read_number(fields, *path, axis) for axis in "xyzw")
    if x == y == z == w == 0.0:
        return 0.0
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def read_twist(fields: Fields, robot: str, sender: str) -> list[Order]:
    """Return the command of ``geometry_msgs/Twist`` or ``TwistStamped``."""
    twist = fields.get("twist", fields)
    if not isinstance(twist, Mapping) or not ({"linear", "angular"} & {*twist}):
        raise InputError("a command needs linear and angular, as in geometry_msgs/Twist")
    return [
        VelocityOrder(
            robot=robot,
            forward=read_number(twist, "linear", "x"),
            turn=read_number(twist, "angular", "z"),
            left=read_number(twist, "linear", "y"),
            source=sender,
        )
    ]


def read_goal(fields: Fields, robot: str, sender: str) -> list[Order]:
    """Return the goal of ``geometry_msgs/PoseStamped``, in the frame of the map."""
    if not isinstance(fields.get("pose"), Mapping):
        raise InputError("a goal needs pose, as in geometry_msgs/PoseStamped")
    header = fields.get("header", {})
    frame = header.get("frame_id", "") if isinstance(header, Mapping) else ""
    if frame not in ("", MAP):
        raise InputError(f"a goal must be in the frame {MAP!r}, not {str(frame)[:40]!r}")
    x, y = read_point(fields, "pose", "position")
    return [GoalOrder(robot=robot, x=x, y=y, source=sender)]


def read_joints(fields: Fields, robot: str, sender: str) -> list[Order]:
    """Return the joint targets of ``sensor_msgs/JointState``: names and positions."""
    return _joints(fields.get("name"), fields.get("position"), robot, sender)


def read_trajectory(fields: Fields, robot: str, sender: str) -> list[Order]:
    """Return the joint targets of ``trajectory_msgs/JointTrajectory``: its last point."""
    points = fields.get("points")
    if not _is_list(points) or not points or not isinstance(points[-1], Mapping):
        raise InputError("a trajectory needs points with positions")
    return _joints(fields.get("joint_names"), points[-1].get("positions"), robot, sender)


def _joints(names: Any, positions: Any, robot: str, sender: str) -> list[Order]:
    positions = positions.tolist() if hasattr(positions, "tolist") else positions
    if not _is_list(names) or not _is_list(positions) or len(names) != len(positions) or len(names) > MOST_JOINTS:
        raise InputError("joint targets need as many names as positions")
    if not all(isinstance(name, str) for name in names):
        raise InputError("names of joints must be texts")
    return [
        JointOrder(robot=robot, joint=name, position=read_number({"position": value}, "position"), source=sender)
        for name, value in zip(names, positions, strict=True)
    ]


def read_order_text(fields: Fields, robot: str, sender: str) -> list[Order]:
    """Return the order of ``std_msgs/String`` as JSON, see :func:`crowdbot.simulation.read_order`."""
    if not isinstance(fields.get("data"), str):
        raise InputError("an order needs data with JSON, as in std_msgs/String")
    return [read_order(fields["data"])]


def read_clock(fields: Fields, robot: str, sender: str) -> list[Order]:
    """Check ``rosgraph_msgs/Clock``; it gives no order."""
    for word in ("sec", "nanosec"):
        value = read_number(fields, "clock", word)
        if value < 0 or value > 1e10 or value != int(value):
            raise InputError(f"clock.{word} = {value:g} must be a whole number from 0")
    if "clock" not in fields:
        raise InputError("a time needs clock, as in rosgraph_msgs/Clock")
    return []


def _is_list(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str | bytes)


READERS: dict[str, Callable[[Fields, str, str], list[Order]]] = {
    "geometry_msgs/msg/Twist": read_twist,
    "geometry_msgs/msg/TwistStamped": read_twist,
    "geometry_msgs/msg/PoseStamped": read_goal,
    "sensor_msgs/msg/JointState": read_joints,
    "trajectory_msgs/msg/JointTrajectory": read_trajectory,
    "std_msgs/msg/String": read_order_text,
    "rosgraph_msgs/msg/Clock": read_clock,
}
"""Functions that read the messages of input topics, by type: fields, robot, sender."""
