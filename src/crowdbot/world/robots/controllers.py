"""Limits of the base from controller files (YAML) of ROS 1 and 2, and from ros2_control tags."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from crowdbot.core import Element, InputError, parse_number, parse_yaml, read_bytes
from crowdbot.world.urdf import robot_folder

MOST_BYTES = 300_000
MOST_FILES = 60
MOST_DEPTH = 12
LARGEST = 1e6
FOLDERS = ("config", "control", "controllers", "params", "param")
DRIVES = ("diff", "ackermann", "tricycle", "mecanum", "omni", "swerve", "bicycle", "four_wheel", "steering", "skid")
"""Parts of the type or the name of a controller that moves the base."""
NUMBERS = {
    "linear.x.max_velocity": "max_speed", "linear.x.max_acceleration": "max_acceleration",
    "angular.z.max_velocity": "max_turn_rate", "angular.z.max_acceleration": "max_turn_acceleration",
    "wheel_separation": "track", "wheel_track": "track", "rear_wheel_track": "track", "traction_wheels_track": "track",
    "wheel_radius": "radius", "rear_wheels_radius": "radius", "traction_wheels_radius": "radius",
    "kinematics.wheels_radius": "radius", "wheelbase": "wheelbase", "wheel_base": "wheelbase",
    "steering.max_position": "max_steering", "steering.max_velocity": "max_steering_rate",
}  # fmt: skip
"""Parameters of drive controllers, and the names of the drive parameters."""
OF_WHEELS = {"traction.max_velocity": "max_speed", "traction.max_acceleration": "max_acceleration"}
"""Parameters in radians of the wheel."""
SWITCHES = {
    "linear.x.max_velocity": "linear.x.has_velocity_limits",
    "linear.x.max_acceleration": "linear.x.has_acceleration_limits",
    "angular.z.max_velocity": "angular.z.has_velocity_limits",
    "angular.z.max_acceleration": "angular.z.has_acceleration_limits",
}
WHEELS = (
    "left_wheel", "right_wheel", "left_wheel_names", "right_wheel_names", "front_wheels_names", "rear_wheels_names",
    "traction_joint_name", "traction_joints_names", "steering_joint_name", "steering_joints_names",
)  # fmt: skip

LAUNCH_ARGUMENT = re.compile(r"\$\((?:arg|var) [^()]*\)")
"""An argument of the launch file in the name of a joint: a prefix, which is empty by default."""


class ControllerFile(NamedTuple):
    """A drive controller of a file.

    Fields:
        name, kind: name and type of the controller.
        place: the file.
        values: numbers by name, as in drive plugins.
        joints: joints of its wheels.
    """

    name: str
    kind: str
    place: str
    values: dict[str, float]
    joints: tuple[str, ...]


class JointLimits(NamedTuple):
    """Largest speed [rad/s or m/s] and position [rad or m] of the commands of a joint; infinite without limit."""

    velocity: float = math.inf
    position: float = math.inf


def read_controllers(path: Path) -> list[ControllerFile]:
    """Return the controllers of a YAML file that move the base.

    Raises:
        InputError: the file is missing, too large, or not YAML of the supported part.
    """
    if path.is_file() and path.stat().st_size > MOST_BYTES:
        raise InputError(f"{path} has more than {MOST_BYTES} bytes, the maximum of a controller file")
    data = read_bytes(path, "controller", InputError)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{path} is not UTF-8 text") from None
    rows = dict(_flatten(parse_yaml(text, str(path)), ()))
    kinds = {keys[-2]: str(value) for keys, value in rows.items() if len(keys) > 1 and keys[-1] == "type"}
    for keys in rows:  # a file of parameters alone does not give types
        if len(keys) > 1 and keys[-1] in ("left_wheel_names", "left_wheel") and keys[-2] not in kinds:
            kinds[keys[-2]] = f"{keys[-2]} diff_drive"
    controller_files = []
    for name, kind in kinds.items():
        if not any(word in kind.lower() for word in DRIVES):
            continue
        mine = {".".join(keys[keys.index(name) + 1 :]): value for keys, value in rows.items() if name in keys[:-1]}
        values = _values(mine)
        if values or any(key in mine for key in WHEELS):
            controller_files.append(ControllerFile(name, kind, str(path), values, _joints(mine)))
    return controller_files


def _flatten(value: Any, keys: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield the values of nested mappings; ``linear.x: 1`` and ``linear: {x: 1}`` are equal."""
    if isinstance(value, dict) and len(keys) < MOST_DEPTH:
        for key, inner in value.items():
            more = () if key in ("ros__parameters", "/**") else tuple(str(key).strip("/").split("."))
            yield from _flatten(inner, (*keys, *more))
    elif keys:
        yield keys, value


def _values(rows: Mapping[str, Any]) -> dict[str, float]:
    """Return the numbers above 0 whose limit is switched on."""
    values: dict[str, float] = {}
    for key, name in NUMBERS.items():
        value = _positive(rows.get(key))
        if value is not None and rows.get(SWITCHES.get(key, ""), True) is not False:
            values.setdefault(name, value)
    for key, name in OF_WHEELS.items():
        value = _positive(rows.get(key))
        if value is not None and "radius" in values:
            values.setdefault(name, value * values["radius"])
    return values


def _positive(value: Any) -> float | None:
    """Return a number above 0 and below a million, otherwise None."""
    if not isinstance(value, int | float) or isinstance(value, bool) or not 0.0 < value < LARGEST:
        return None
    return float(value)


def _joints(rows: Mapping[str, Any]) -> tuple[str, ...]:
    names: list[str] = []
    for key in WHEELS:
        value = rows.get(key)
        rows_of = value if isinstance(value, list) else [value]
        names += [LAUNCH_ARGUMENT.sub("", item) for item in rows_of if isinstance(item, str)]
    return tuple(dict.fromkeys(names))


def find_controller_files(
    source: Path, root: Element, joints: Sequence[str], find: Callable[[str], Path | None]
) -> tuple[list[ControllerFile], list[str]]:
    """Return the drive controllers of files that the robot file names or that are beside it, and remarks.

    A file is named by ``<parameters>`` of a ros2_control plugin. Otherwise the YAML files beside the robot file and in
    the folders ``config``, ``control``, ``controllers`` and ``params`` of its package are searched for a controller
    whose wheels are joints of the robot.

    Args:
        source: the robot file.
        root: its root element, with xacro expanded.
        joints: names of the joints of the robot.
        find: returns the path of a file that the robot file names, or None.
    """
    remarks: list[str] = []
    for plugin in [item for outer in root.each("gazebo") for item in outer.each("plugin")]:
        for inner in plugin.each("parameters"):
            try:
                path = find(inner.stray.strip())
                rows = read_controllers(path) if path is not None else []
            except InputError as error:
                remarks.append(f"the controller file {inner.stray.strip()[:100]!r} is not used: {error}")
                continue
            if path is None:
                remarks.append(f"the controller file {inner.stray.strip()[:100]!r} is missing; give --controllers FILE")
            if rows:
                return rows, remarks
    for path in _beside(source):
        try:
            rows = [
                controller
                for controller in read_controllers(path)
                if controller.joints and set(controller.joints) <= set(joints)
            ]
        except InputError:  # a YAML file of something else
            continue
        if rows:
            return rows, remarks
    return [], remarks


def _beside(source: Path) -> list[Path]:
    home, found = robot_folder(source), []
    for folder in dict.fromkeys((source.resolve().parent, *(home / name for name in FOLDERS))):
        try:
            rows = sorted(folder.glob("*.y*ml"))[:MOST_FILES] if folder.is_dir() else []
        except OSError:
            continue
        found += [path for path in rows if path.suffix in (".yaml", ".yml") and _is_near(path, home)]
    return found


def _is_near(path: Path, home: Path) -> bool:
    try:
        return path.resolve().is_relative_to(home) and path.is_file() and path.stat().st_size <= MOST_BYTES
    except (OSError, RuntimeError):
        return False


def read_joint_limits(root: Element) -> dict[str, JointLimits]:
    """Return the limits of commands in ``<ros2_control>`` by joint."""
    joint_limits: dict[str, JointLimits] = {}
    for joint in [item for outer in root.each("ros2_control") for item in outer.each("joint")]:
        limits = JointLimits()
        for interface in joint.each("command_interface"):
            kind = interface.attributes.get("name", "")
            largest = _largest(interface)
            if kind in ("velocity", "position") and largest > 0.0:
                limits = limits._replace(**{kind: min(largest, getattr(limits, kind))})
        if limits != JointLimits():
            joint_limits[joint.attributes.get("name", "")] = limits
    return joint_limits


def _largest(interface: Element) -> float:
    """Return the maximum of a command interface, or infinity."""
    for param in interface.each("param"):
        if param.attributes.get("name") == "max":
            try:
                return parse_number(param.stray)
            except InputError:
                return math.inf
    return math.inf
