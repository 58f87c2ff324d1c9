"""Conversion of a maker's robot file to a robot folder with ``robot.xml``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import Element, RobotError, format_xml
from crowdbot.world.urdf import RobotModel, parse_robot_file, read_urdf

from .base_drive import choose_drive, rollers_of, turns_wheels
from .base_kind import BaseKind, recognize_base
from .gazebo_tags import DriveParameters, find_sensors, read_drive_parameters

__all__ = ["Guess", "RobotFolder", "import_robot"]

GROUND_LINK = "drive_center"
GRAVITY = 9.81


class Guess(NamedTuple):
    """A value of a robot folder: what, its value, where it is from, and how to change it."""

    what: str
    value: str
    source: str
    change: str


@dataclass
class RobotFolder:
    """The files of a robot folder.

    Fields:
        name: name of the robot.
        texts: text files by path in the folder.
        copies: mesh files to copy, by path in the folder.
        guesses: table of everything that is recognized or guessed.
        remarks: sentences about repairs and parts that are left out.
        kind: kind of base.
    """

    name: str
    texts: dict[str, str] = field(default_factory=dict)
    copies: dict[str, Path] = field(default_factory=dict)
    guesses: list[Guess] = field(default_factory=list)
    remarks: tuple[str, ...] = ()
    kind: str = ""

    def guess(self, what: str, value: str, source: str, change: str) -> None:
        """Add a row to the table."""
        self.guesses.append(Guess(what, value, source, change))


def import_robot(
    source: Path,
    name: str,
    *,
    packages: Mapping[str, Path] | None = None,
    arguments: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
    kind: str = "",
) -> RobotFolder:
    """Return the robot folder of a URDF or xacro file.

    Args:
        source: the file.
        name: name of the robot.
        packages, arguments, environment: as in :func:`read_urdf`.
        kind: kind of base, see :data:`BASE_KINDS` (default: recognized).

    Raises:
        RobotError: the file has errors, or has neither shapes nor mass.
        InputError: ``kind`` is unknown.
    """
    document = parse_robot_file(source, packages=packages, arguments=arguments, environment=environment)
    model = read_urdf(source, packages=packages, arguments=arguments, environment=environment, colliders="hull")
    if model.mass <= 0.0 or not any(link.collisions or link.visuals for link in model.links.values()):
        raise RobotError(f"{source}: the robot has no shapes or no mass; crowdbot needs both")
    parameters = read_drive_parameters(document.root)
    base = recognize_base(model, parameters.plugins, kind)
    made = RobotFolder(name, remarks=model.warnings, kind=base.kind)
    made.guess("kind of base", base.kind, base.why, "--base KIND")
    made.guess("mass", f"{model.mass:.4g} kg", "<inertial> of the file", f"<mass> in {name}.urdf")
    wheeled = turns_wheels(model, base)
    root = _robot_element(made, model, base, parameters, wheeled)
    _sensor_elements(made, root, document.root, model)
    urdf = _expanded(made, document.root, model, base, wheeled)
    _add_motors(made, urdf, model, base, parameters, wheeled)
    made.texts = {f"{name}.urdf": format_xml(urdf), "robot.xml": format_xml(root)}
    return made


def _number(value: float) -> str:
    return f"{value:.9g}"


def _robot_element(
    made: RobotFolder, model: RobotModel, base: BaseKind, parameters: DriveParameters, wheeled: bool
) -> Element:
    """Return <robot> with its drive and wheels."""
    name = made.name
    root = Element("robot", {"name": name, "urdf": f"{name}.urdf", "base": "wheels" if wheeled else "planar"})
    root.attributes["about"] = f"{base.kind} base, from {model.name}"
    how = "its wheels are turned by motors" if wheeled else "the base is moved directly"
    made.guess("physics world", root.attributes["base"], f"{base.kind} base: {how}", "base= in robot.xml")
    drive, rows = choose_drive(model, base, parameters.values, wheeled)
    made.guess("drive", drive, f"{base.kind} base", "type= of <drive> in robot.xml")
    for key, value, source in rows:
        made.guess(key, f"{value:.4g}", source, f"{key}= of <drive> in robot.xml")
    root.children.append(Element("drive", {"type": drive} | {key: _number(value) for key, value, _ in rows}))
    if not len(model.points()):
        made.guess("footprint", "outline of the visuals", "the file has no colliders", "<footprint> in robot.xml")
        root.children.append(Element("footprint", {"radius": _number(_reach(model))}))
    if wheeled:
        for wheel in base.wheels:
            row = {"joint": wheel.joint, "radius": _number(wheel.radius)}
            row |= {"steering": wheel.steering} if wheel.steering else {}
            row |= {} if wheel.joint in base.driven else {"driven": "false"}
            rollers = rollers_of(base, wheel)
            row |= {} if rollers is None else {"rollers": _number(rollers)}
            if rollers:
                side = f"{math.degrees(rollers):+.0f} degrees"
                made.guess(f"rollers {wheel.joint}", side, "usual arrangement", "rollers= of <wheel> in robot.xml")
            if wheel.joint in base.driven or wheel.steering:
                root.children.append(Element("wheel", row))
    for wheel in base.wheels:
        made.guess(f"wheel {wheel.joint}", f"radius {wheel.radius:.4g} m", "its shape", "<wheel> in robot.xml")
    for link in base.castors:
        made.guess(f"castor {link}", "glides", "it touches the ground without a motor", f"<mu1> in {name}.urdf")
    return root


def _reach(model: RobotModel) -> float:
    poses = model.poses()
    rows = [
        (poses[name] @ part.origin, part.shape.points()) for name, link in model.links.items() for part in link.visuals
    ]
    return max(math.hypot(*(matrix[:2, :3] @ row + matrix[:2, 3])) for matrix, points in rows for row in points)


def _sensor_elements(made: RobotFolder, root: Element, source: Element, model: RobotModel) -> None:
    """Add the sensors of Gazebo tags."""
    for one in find_sensors(source):
        link = one.link or model.root
        if not one.attributes or link not in model.links:
            why = "there is no such link" if one.attributes else "its type is not supported"
            made.guess(f"sensor {one.name}", "left out", f"{one.source}; {why}", "<sensor> in robot.xml")
            continue
        root.children.append(Element("sensor", {"name": one.name, "link": link} | one.attributes))
        made.guess(f"sensor {one.name}", one.attributes["type"], one.source, "<sensor> in robot.xml")
    if not root.each("sensor"):
        made.guess("sensors", "none", "no <sensor> in <gazebo> tags", "<sensor> in robot.xml")


def _expanded(made: RobotFolder, source: Element, model: RobotModel, base: BaseKind, wheeled: bool) -> Element:
    """Return <robot> with links, joints and materials, and meshes in the folder."""
    kept = [child for child in source.children if child.tag in ("link", "joint", "material")]
    root = Element("robot", {"name": made.name}, [_copy(child) for child in kept])
    names: dict[str, str] = {}
    for element in _all(root):
        if element.tag == "mesh" and "filename" in element.attributes:
            reference = element.attributes["filename"].strip()
            path = model.meshes.get(reference)
            element.attributes["filename"] = names.setdefault(reference, _mesh_name(path, reference, names))
            if path is not None:
                made.copies[element.attributes["filename"]] = path
    if abs(base.rear) > 0.005 and base.wheels and base.kind != "planar":
        root.children.append(Element("link", {"name": GROUND_LINK}))
        joint = Element("joint", {"name": f"{GROUND_LINK}_joint", "type": "fixed"})
        joint.children = [Element("parent", {"link": GROUND_LINK}), Element("child", {"link": model.root})]
        joint.children.append(Element("origin", {"xyz": f"{_number(-base.rear)} 0 0"}))
        root.children.append(joint)
        made.guess(
            "centre of turning", f"x = {base.rear:.4g} m", "axle of the wheels", f"{GROUND_LINK} in {made.name}.urdf"
        )
    gliding = [*base.castors, *([] if wheeled else [wheel.link for wheel in base.wheels])]
    for name, link in model.links.items():
        friction = 0.0 if name in gliding or (not wheeled and name in _feet(model, base)) else link.friction
        if friction is not None:
            root.children.append(Element("gazebo", {"reference": name}, [Element("mu1", {"value": _number(friction)})]))
    return root


def _feet(model: RobotModel, base: BaseKind) -> set[str]:
    return {model.joints[name].child for name in base.legs}


def _mesh_name(path: Path | None, reference: str, names: Mapping[str, str]) -> str:
    """Return a new file name in ``meshes``."""
    file = Path(reference.rpartition("/")[2] if path is None else path.name)
    plain = "".join(letter if letter.isalnum() or letter in "_-" else "_" for letter in file.stem)[:60] or "mesh"
    ending = file.suffix.lower()[:6]
    name, number = f"meshes/{plain}{ending}", 2
    while name in names.values():
        name, number = f"meshes/{plain}-{number}{ending}", number + 1
    return name


def _add_motors(
    made: RobotFolder, root: Element, model: RobotModel, base: BaseKind, parameters: DriveParameters, wheeled: bool
) -> None:
    """Add motors of wheels and other joints, and limits that the file does not give."""
    elements = {joint.attributes.get("name", ""): joint for joint in root.each("joint")}
    wheels = {wheel.joint: wheel for wheel in base.wheels}
    swivels = {_parent_of(model, link) for link in base.castors} - {model.root}
    motors: dict[str, str] = {}
    for joint in model.movable:
        if joint.size != 1 or joint.child in base.castors or (joint.child in swivels and not joint.motor.kind):
            continue
        wheel = wheels.get(joint.name)
        if wheel is not None and not (wheeled and joint.name in base.driven):
            continue
        motors[joint.name] = "velocity" if wheel else "position"
        if joint.motor.kind != motors[joint.name]:
            source = "no transmission gives it" if not joint.motor.kind else f"instead of {joint.motor.kind}"
            change = f"<ros2_control> in {made.name}.urdf"
            made.guess(f"motor of {joint.name}", motors[joint.name], source, change)
        if not 0.0 < joint.motor.effort < math.inf:
            effort = max(10.0, model.mass)
            if wheel:  # skid-steer wheels also push against the friction of the others
                share = (2.0 if base.kind == "skid-steer" else 1.0) / max(1, len(base.driven))
                effort = share * model.mass * GRAVITY * wheel.radius
            effort = parameters.values.get("effort", effort) if wheel else effort
            limit = next(iter(elements[joint.name].each("limit")), None)
            if limit is None:
                limit = Element("limit")
                elements[joint.name].children.append(limit)
            limit.attributes["effort"] = _number(effort)
            if not 0.0 < joint.motor.velocity < math.inf:
                limit.attributes["velocity"] = _number(3.0 / wheel.radius if wheel else 2.0)
            made.guess(f"effort of {joint.name}", f"{effort:.3g}", "guess", f"<limit> in {made.name}.urdf")
    if motors:
        root.children.append(_control(motors))


def _parent_of(model: RobotModel, link: str) -> str:
    return next((joint.parent for joint in model.joints.values() if joint.child == link), "")


def _control(motors: Mapping[str, str]) -> Element:
    """Return <ros2_control> with the command types of joints."""
    rows = [
        Element("joint", {"name": name}, [Element("command_interface", {"name": kind})])
        for name, kind in motors.items()
    ]
    return Element("ros2_control", {"name": "motors", "type": "system"}, rows)


def _copy(element: Element) -> Element:
    children = [_copy(child) for child in element.children]
    return Element(element.tag, dict(element.attributes), children, stray=element.stray)


def _all(element: Element) -> list[Element]:
    found, waiting = [], [element]
    while waiting:
        found.append(waiting.pop())
        waiting.extend(found[-1].children)
    return found
