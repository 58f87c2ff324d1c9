"""Parts of a robot that its type brings: replaced with the type, and described with what a trial overrides."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterable, Iterator, Sequence
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any

from crowdbot.core import Element, builtin_name
from crowdbot.sensors import Sensor
from crowdbot.world import Drive

if TYPE_CHECKING:
    from crowdbot.trials.robot import RobotSpec


logger = logging.getLogger(__name__)

ATTRIBUTES = ("radius", "height", "mass", "latency", "rider", "default-sensors")
CHILDREN = ("drive", "sensor", "joint")
"""Attributes and elements of ``<robot>`` that belong to the body of its type."""
MOST_ROBOTS = 20
"""Largest number of robots of which each has a line."""
_remarks: ContextVar[list[str] | None] = ContextVar("_remarks", default=None)
"""Lines of the log that wait for the end of :func:`remarks_at_end`; None outside of it."""


@contextlib.contextmanager
def remarks_at_end() -> Iterator[list[str]]:
    """Log the lines about replaced robots at the end of the outermost block, and not if an error ends it.

    An error, such as a robot that does not exist, is then not preceded by remarks about what it would replace. Also a
    decorator of functions.
    """
    outer = _remarks.get()
    if outer is not None:
        yield outer
        return
    lines: list[str] = []
    token = _remarks.set(lines)
    try:
        yield lines
    finally:
        _remarks.reset(token)
    for line in lines:
        logger.info("%s", line)


def replace_robot(robot: Element, kind: str) -> None:
    """Set the type of a robot; its body, drive and sensors become those of the type.

    Radius, height, mass, latency, rider, ``<drive>``, ``<sensor>`` and ``<joint>`` of the element describe the robot
    that is replaced and are removed; one line of the log names them. Start, goal, navigator and faults stay. The line
    is logged at the end of :func:`remarks_at_end`, if the caller uses it.

    Args:
        robot: element ``<robot>`` of a trial, changed in place.
        kind: built-in robot or robot folder.

    >>> robot = Element("robot", {"x": "0", "radius": "0.4"}, [Element("goal"), Element("drive")])
    >>> replace_robot(robot, "pepper")
    >>> robot.attributes, [child.tag for child in robot.children]
    ({'x': '0', 'type': 'pepper'}, ['goal'])
    """
    gone = [_attribute(name, robot.attributes.pop(name)) for name in ATTRIBUTES if name in robot.attributes]
    gone += [_element(child) for child in robot.children if child.tag in CHILDREN]
    robot.children = [child for child in robot.children if child.tag not in CHILDREN]
    robot.attributes["type"] = kind
    if gone:
        name = robot.attributes.get("name", "robot")
        line = f"robot {name!r} becomes {kind}, with its own drive and sensors instead of {', '.join(gone)}"
        with remarks_at_end() as lines:
            lines.append(line)


def describe_robot(robot: RobotSpec) -> str:
    """Describe a robot in one line: type, drive, maximum speed, size, sensors, and what the trial overrides.

    The line also says whether shapes of the robot are replaced, since meshes are missing.

    >>> from crowdbot.navigation import Straight
    >>> from crowdbot.trials import RobotGoal, RobotSpec
    >>> from crowdbot.world import DifferentialDrive
    >>> robot = RobotSpec(type="differential", x=0, y=0, goal=RobotGoal(5, 0), navigator=Straight(),
    ...     drive=DifferentialDrive(max_speed=0.4))
    >>> line, overrides = describe_robot(robot).split("; ")
    >>> line.partition(", radius")[0]
    "robot 'robot' is differential: differential-drive, at most 0.4 m/s"
    >>> overrides
    'the trial overrides drive (differential: differential-drive, at most 1 m/s)'
    """
    sensors = ", ".join(f"{mount.name} ({_kind(mount.sensor, Sensor)})" for mount in robot.sensors)
    line = (
        f"robot {robot.name!r} is {robot.type or 'a disc'}: {_drive(robot.drive)}, radius {robot.radius:.3g} m,"
        f" {f'sensors {sensors}' if sensors else 'no sensors'}"
    )
    lost = robot.body.model.replaced_colliders if robot.type else 0
    if lost:
        links = "a link" if lost == 1 else f"{lost} links"
        line += (
            f"; meshes of {links} are missing or broken and replaced by other shapes, see crowdbot check {robot.type}"
        )
    overrides = [*_overrides(robot)]
    return f"{line}; the trial overrides {', '.join(overrides)}" if overrides else line


def robot_lines(trials: Iterable[tuple[str, Sequence[RobotSpec]]]) -> list[str]:
    """Return a line for each robot that differs, with the name of its trial if the trials have different robots.

    Args:
        trials: name and robots of each trial; a name may be there several times, with a different robot each time.
    """
    rows: dict[str, dict[str, None]] = {}
    for name, robots in trials:
        rows.setdefault(name, {}).update(dict.fromkeys(map(describe_robot, robots)))
    if len({tuple(row) for row in rows.values()}) <= 1:
        lines = [line for row in list(rows.values())[:1] for line in row]
    else:
        lines = [f"{name}: {line}" for name, row in rows.items() for line in row]
    more = len(lines) - MOST_ROBOTS
    return [*lines[:MOST_ROBOTS], *([f"and {more} more robots"] if more > 0 else [])]


def override_remarks(robots: Iterable[RobotSpec]) -> list[str]:
    """Describe the robots of a trial that override something of their type, each in one line."""
    return [describe_robot(robot) for robot in robots if any(_overrides(robot))]


def _overrides(robot: RobotSpec) -> Iterator[str]:
    """Yield what a trial overrides of the type of a robot; nothing for a robot without a type."""
    if not robot.type:
        return
    usual = robot.usual
    if robot.drive != usual["drive"]:
        yield f"drive ({robot.type}: {_drive(usual['drive'])})"
    for name, unit in (("radius", "m"), ("latency", "s")):
        if getattr(robot, name) != usual[name]:
            yield f"{name} ({robot.type}: {usual[name]:.3g} {unit})"
    if not robot.default_sensors:
        yield "all sensors"
    own = {mount.name: mount for mount in robot.type_sensors}
    for mount in robot.sensors:
        if own.get(mount.name) != mount:
            yield f"sensor {mount.name}" if mount.name in own else f"sensor {mount.name} (added)"


def _drive(drive: Drive) -> str:
    speed = getattr(drive, "max_speed", None)
    limit = "" if speed is None else f", at most {speed:.3g} m/s"
    return f"{_kind(drive, Drive)}{limit}"


def _kind(part: Any, contract: type) -> str:
    return builtin_name(type(part), contract)


def _attribute(name: str, value: str) -> str:
    return f'{name}="{value}"'


def _element(element: Element) -> str:
    words = [element.tag, *(_attribute(name, value) for name, value in element.attributes.items())]
    return f"<{' '.join(words)}>"
