"""URDF file of a robot folder: links and joints of the maker's file, meshes, masses, friction and motors."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from crowdbot.core import Element, RobotError
from crowdbot.typing import Floats
from crowdbot.world.urdf import (
    Cylinder,
    Joint,
    Link,
    LinkInertia,
    LinkShape,
    RobotDocument,
    RobotModel,
    replacement_shape,
)
from crowdbot.world.urdf.inertia import DENSITY
from crowdbot.world.urdf.transforms import across

from .base_kind import BaseKind, FoundWheel
from .gazebo_tags import SAME
from .guess_table import DERIVED, DOUBTFUL, FILE, GUESS, GuessTable
from .wheel import resistance, weak_motor

GRAVITY = 9.81
WHEEL_NAMES = ("wheel", "whl")
WHEEL_WIDTH = 0.4
"""Width of a guessed wheel by its radius."""
LIGHTEST, HEAVIEST = 10.0, 1e4
"""Usual densities [kg/m3] of the box around a robot: ten times that of air, and that of steel."""
SMALLEST_WHEEL, LARGEST_WHEEL = 0.005, 2.0
"""Limits [m] of the radius of a guessed wheel."""
PAIR_TOLERANCE = 0.02
"""Largest difference [m] of the places of two wheels at both sides."""


def format_number(value: float) -> str:
    """Return a number with 9 digits.

    >>> format_number(0.1)
    '0.1'
    """
    return f"{value:.9g}"


def copy_elements(source: Element, name: str) -> Element:
    """Return <robot> with copies of links, joints and materials."""
    kept = [child for child in source.children if child.tag in ("link", "joint", "material")]
    return Element("robot", {"name": name}, [_copy(child) for child in kept])


def _copy(element: Element) -> Element:
    children = [_copy(child) for child in element.children]
    return Element(element.tag, dict(element.attributes), children, stray=element.stray)


def _all(element: Element) -> list[Element]:
    found, waiting = [], [element]
    while waiting:
        found.append(waiting.pop())
        waiting.extend(found[-1].children)
    return found


def copy_meshes(root: Element, model: RobotModel) -> dict[str, Path]:
    """Name meshes by their place in the robot folder, and return the files to copy by that place.

    A mesh with material files or textures gets a folder of its own. A mesh that was not found keeps a name, so that it
    can be added later.
    """
    names: dict[str, str] = {}
    copies: dict[str, Path] = {}
    for element in _all(root):
        if element.tag == "texture":
            element.attributes.pop("filename", None)
        if element.tag != "mesh" or "filename" not in element.attributes:
            continue
        reference = element.attributes["filename"].strip()
        path, beside = model.meshes.get(reference), model.mesh_files.get(reference, {})
        name = names.setdefault(reference, _mesh_name(path, reference, names, bool(beside)))
        element.attributes["filename"] = name
        if path is not None:
            copies[name] = path
        for inner, file in beside.items():
            copies[f"{name.rpartition('/')[0]}/{_place_of(inner, file)}"] = file
    return copies


def _mesh_name(path: Path | None, reference: str, names: Mapping[str, str], folder: bool) -> str:
    """Return a new file name in ``meshes``."""
    file = Path(reference.rpartition("/")[2] if path is None else path.name)
    plain = "".join(letter if letter.isalnum() or letter in "_-" else "_" for letter in file.stem)[:60] or "mesh"
    ending = file.suffix.lower()[:6]
    for number in range(1, len(names) + 2):
        stem = plain if number == 1 else f"{plain}-{number}"
        name = f"meshes/{stem}/{stem}{ending}" if folder else f"meshes/{stem}{ending}"
        if name not in names.values():
            break
    return name


def _place_of(name: str, file: Path) -> str:
    """Return where a file of a mesh is put beside it: the name in the mesh if it is a plain path below it."""
    plain = name.strip().replace("\\", "/").removeprefix("./")
    safe = re.fullmatch(r"[\w][\w .+-]*(?:/[\w][\w .+-]*){0,4}", plain, re.ASCII) is not None and len(plain) < 120
    return plain if safe else file.name


def add_masses(table: GuessTable, root: Element, model: RobotModel, urdf: str) -> float:
    """Write the masses that the file does not give, list them and the total, and return the total mass [kg]."""
    known = sum(any(_has_mass(inner) for inner in link.each("inertial")) for link in root.each("link"))
    why = "it moves, and has no <inertial>" if known else "no link has <inertial>: density of water"
    total = guessed = 0.0
    for element in root.each("link"):
        name = element.attributes.get("name", "")
        inertial = model.links[name].inertial
        if inertial is None:
            continue
        mass = inertial.mass
        if not any(_has_mass(inner) for inner in element.each("inertial")):
            mass = table.number(f"mass of {name}", mass, why, f"<mass> in {urdf}", GUESS, unit="kg")
            element.children = [child for child in element.children if child.tag != "inertial"]
            element.children.append(_inertial(mass, inertial))
            guessed += mass
        total += mass
    source = f"<inertial> of {known} links" + (f"; {guessed:.4g} kg are guesses" if guessed else "")
    status, points = DERIVED if guessed else FILE, model.points()
    around = float(np.prod(np.ptp(points, axis=0))) if len(points) else 0.0
    if around > 0.0 and not LIGHTEST <= total / around <= HEAVIEST:
        source += f"; implausible: {total / around:.2g} kg/m3 in the box around its colliders"
        status = DOUBTFUL if status == FILE else status
    table.add("mass", f"{total:.4g} kg", source, f"<mass> in {urdf}", status)
    return total


def _has_mass(inertial: Element) -> bool:
    values = [mass.attributes.get("value", "0") for mass in inertial.each("mass")]
    try:
        return any(float(value) > 0.0 for value in values)
    except ValueError:
        return True


def _inertial(mass: float, inertial: LinkInertia) -> Element:
    tensor = inertial.tensor * (mass / inertial.mass)
    names = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))
    return Element("inertial", {}, [
        Element("origin", {"xyz": " ".join(repr(float(value)) for value in inertial.center)}),
        Element("mass", {"value": repr(float(mass))}),
        Element("inertia", {key: repr(float(tensor[i, j])) for key, i, j in names}),
    ])  # fmt: skip


def add_shapes(table: GuessTable, root: Element, model: RobotModel, urdf: str) -> None:
    """Give every link with mass a box, for a robot without any shape."""
    for element in root.each("link"):
        link: Link = model.links[element.attributes.get("name", "")]
        if link.inertial is None:
            continue
        size, origin, what = replacement_shape(link.inertial)
        for tag in ("visual", "collision"):
            geometry = Element("geometry", {}, [Element("box", {"size": " ".join(map(format_number, size))})])
            place = {"xyz": " ".join(map(format_number, origin[:3, 3])), "rpy": _angles(origin[:3, :3])}
            element.children.append(Element(tag, {}, [Element("origin", place), geometry]))
        sides = " x ".join(f"{side:.3g}" for side in size)
        table.add(f"shape of {link.name}", f"{sides} m", f"the file has no shapes: {what}", f"<link> in {urdf}", GUESS)


def add_wheel_shapes(
    table: GuessTable, document: RobotDocument, model: RobotModel, radius: float | None, urdf: str, kind: str = ""
) -> RobotModel:
    """Give wheels whose shapes are missing a cylinder, and return the model with them.

    Such a wheel is a joint without limits about an axle across the robot, with "wheel" in its name or that of its link,
    or one of a pair of lowest joints. Its radius is, in this order, that of the drive plugin or controller, the height
    of its axle above the other wheels or a link named after the footprint, or that of a cylinder of its inertia.

    Args:
        table: lists the radii.
        document: the maker's file; <robot> gets the shapes, too.
        model: the robot.
        radius: radius [m] of the wheels that a plugin or controller gives.
        urdf: name of the URDF file of the folder.
        kind: kind of base if it is given; empty otherwise.

    Raises:
        RobotError: nothing gives the radius, and the kind of base does not say that no wheels are needed.
    """
    elements = {link.attributes.get("name", ""): link for link in document.root.each("link")}
    poses, links, lost = model.poses(), dict(model.links), list[str]()
    wheels = _named_or_paired(model, poses)
    bare = [joint for joint in wheels if not _has_shapes(elements[joint.child], model)]
    floors = _floors(model, poses, [joint for joint in wheels if joint not in bare])
    for joint in bare:
        link, what = links[joint.child], f"radius of {joint.child}"
        rows = [] if radius is None else [(radius, "radius of the drive plugin")]
        rows += [(float(poses[link.name][2, 3]) - floor, f"height of its axle above {of}") for floor, of in floors]
        rows += _radius_of_inertia(elements[link.name], link, joint)
        rows = [(value, source) for value, source in rows if SMALLEST_WHEEL < value < LARGEST_WHEEL]
        if not rows and what not in table.given:
            lost.append(link.name)
            continue
        guess, source = rows[0] if rows else (0.0, "")
        others = [f"; {value:.4g} m: {why}" for value, why in rows[1:] if abs(value - guess) > SAME * guess]
        source = f"it has no shape that can be read: {source}{''.join(others)}"
        size = table.number(what, guess, source, f"<cylinder> in {urdf}", GUESS, unit="m")
        turn = np.eye(4)
        turn[:3, :3] = across(joint.axis)
        shape = Cylinder(size, WHEEL_WIDTH * size)
        links[link.name] = dataclasses.replace(link, visuals=(), collisions=(LinkShape(shape, turn),))
        values = {"radius": format_number(size), "length": format_number(shape.length)}
        geometry = Element("geometry", {}, [Element("cylinder", values)])
        place = Element("origin", {"rpy": _angles(turn[:3, :3])})
        element = elements[link.name]
        element.children = [child for child in element.children if child.tag != "collision"]
        element.children.append(Element("collision", {}, [place, geometry]))
    if lost and kind not in ("planar", "legged"):
        raise RobotError(
            f"{document.place}: the meshes of the wheels {', '.join(lost[:8])} cannot be read, and no drive plugin,"
            " controller, other wheel, footprint or inertia gives their radius: give the meshes (--package"
            f" NAME=FOLDER), the radius (--set 'radius of {lost[0]}=0.1', in m), or --base planar to move the base"
            " directly"
        )
    return dataclasses.replace(model, links=links)


def _named_or_paired(model: RobotModel, poses: Mapping[str, Floats]) -> list[Joint]:
    """Return the joints without limits about axles across the robot that are wheels by their name or place.

    By its place it is one of two at both sides, with no lower joint of this kind, no joint below it and none but
    steering and springs above it.
    """
    above = {joint.child: joint for joint in model.joints.values()}
    bearing = {joint.parent for joint in model.movable}
    across_robot = [
        joint
        for joint in model.movable
        if joint.kind in ("continuous", "revolute")
        and joint.upper - joint.lower >= 2.0 * math.pi
        and abs((poses[joint.child][:3, :3] @ joint.axis)[1]) > 0.95
        and "cast" not in f"{joint.name} {joint.child}".lower()
    ]

    def is_free(joint: Joint) -> bool:
        name = joint.parent
        while name in above:
            upper = above[name]
            vertical = abs((poses[upper.child][:3, :3] @ upper.axis)[2]) > 0.8
            if upper in model.movable and not vertical:
                return False
            name = upper.parent
        return joint.child not in bearing

    places = {joint.name: poses[joint.child][:3, 3] for joint in across_robot if is_free(joint)}
    low = min((float(place[2]) for place in places.values()), default=0.0) + PAIR_TOLERANCE
    mirror = np.array([1.0, -1.0, 1.0])

    def is_paired(name: str) -> bool:
        if name not in places or places[name][2] > low or abs(places[name][1]) < PAIR_TOLERANCE:
            return False
        return any(np.abs(place * mirror - places[name]).max() < PAIR_TOLERANCE for place in places.values())

    return [joint for joint in across_robot if _is_named_wheel(joint) or is_paired(joint.name)]


def _floors(model: RobotModel, poses: Mapping[str, Floats], wheels: Sequence[Joint]) -> list[tuple[float, str]]:
    """Return heights [m] of the ground in the root frame, with what they are from."""
    floors = []
    for joint in wheels:
        link = model.links[joint.child]
        parts = [(poses[link.name] @ part.origin, part.shape.points()) for part in link.collisions or link.visuals]
        if parts:
            low = min(float((points @ matrix[2, :3] + matrix[2, 3]).min()) for matrix, points in parts)
            floors.append((low, f"the lowest point of {link.name}"))
    low_links = [(float(poses[name][2, 3]), name) for name in model.links if "footprint" in name.lower()]
    return [*floors[:1], *low_links[:1]]


def _radius_of_inertia(element: Element, link: Link, joint: Joint) -> list[tuple[float, str]]:
    """Return the radius [m] of the cylinder about the axle with the inertia in the file; empty for a placeholder."""
    if link.inertial is None or not any(inner.each("inertia") for inner in element.each("inertial")):
        return []
    mass, moments = link.inertial.mass, np.linalg.eigvalsh(link.inertial.tensor)
    along = float(joint.axis @ link.inertial.tensor @ joint.axis)
    radius = math.sqrt(2.0 * along / mass)
    width = math.sqrt(max(0.0, 6.0 * (float(moments.sum()) - along) / mass - 3.0 * radius**2))
    volume = math.pi * radius**2 * max(width, 0.01 * radius)
    if np.ptp(moments) < SAME * moments[2] or width > 2.0 * radius or not 0.1 <= mass / (DENSITY * volume) <= 10.0:
        return []
    return [(radius, "cylinder of its inertia")]


def _has_shapes(link: Element, model: RobotModel) -> bool:
    """Return whether a link has a shape that is no missing mesh."""
    shapes = [
        shape
        for tag in ("visual", "collision")
        for outer in link.each(tag)
        for geometry in outer.each("geometry")
        for shape in geometry.children
    ]
    return any(shape.tag != "mesh" or shape.attributes.get("filename", "").strip() in model.meshes for shape in shapes)


def _is_named_wheel(joint: Joint) -> bool:
    return any(word in f"{joint.name} {joint.child}".lower() for word in WHEEL_NAMES)


def _angles(rotation: Floats) -> str:
    """Return roll, pitch and yaw of a rotation ``[3, 3]``."""
    pitch = math.asin(min(1.0, max(-1.0, -float(rotation[2, 0]))))
    if abs(math.cos(pitch)) < 1e-9:
        roll, yaw = 0.0, math.atan2(-float(rotation[0, 1]), float(rotation[1, 1]))
    else:
        roll = math.atan2(float(rotation[2, 1]), float(rotation[2, 2]))
        yaw = math.atan2(float(rotation[1, 0]), float(rotation[0, 0]))
    return " ".join(map(format_number, (roll, pitch, yaw)))


def add_motors(
    table: GuessTable,
    root: Element,
    model: RobotModel,
    base: BaseKind,
    wheeled: bool,
    torque: float | None,
    speed: float,
    urdf: str,
) -> list[str]:
    """Add motors of wheels and other joints, and limits that the file does not give.

    Return a sentence for every wheel that its motor does not turn at the maximum speed.

    Args:
        table: lists the motors.
        root: <robot> of the folder.
        model: the robot.
        base: its base.
        wheeled: whether motors turn the wheels.
        torque: largest torque [N m] of the wheels, if a plugin gives it.
        speed: maximum speed [m/s] of the robot.
        urdf: name of the URDF file.
    """
    elements = {joint.attributes.get("name", ""): joint for joint in root.each("joint")}
    wheels = {wheel.joint: wheel for wheel in base.wheels}
    parents = {joint.child: joint.parent for joint in model.joints.values()}
    swivels = {parents.get(link, "") for link in base.castors} - {model.root}
    motors: dict[str, str] = {}
    weak: list[str] = []
    for joint in model.movable:
        if elements[joint.name].attributes.get("type") == "fixed":
            continue
        if joint.size != 1 or joint.child in base.castors or (joint.child in swivels and not joint.motor.kind):
            continue
        wheel = wheels.get(joint.name)
        if wheel is not None and not (wheeled and joint.name in base.driven):
            continue
        kind = "velocity" if wheel else "position"
        if joint.motor.kind != kind:
            source = "no transmission gives it" if not joint.motor.kind else f"instead of {joint.motor.kind}"
            change = f"<ros2_control> in {urdf}"
            status = GUESS if not joint.motor.kind else DERIVED
            words = ("position", "velocity", "effort", "none")
            kind = table.word(f"motor of {joint.name}", kind, source, change, status, words)
        if kind == "none":
            continue
        motors[joint.name] = kind
        if 0.0 < joint.motor.effort < math.inf:
            weak += [weak_motor(joint, joint.motor.effort, speed / wheel.radius)] if wheel else []
            continue
        effort, why = _effort(model, base, wheel, speed) if wheel else (max(10.0, model.mass), "mass of the robot")
        known = wheel is not None and torque is not None
        why = "the drive plugin" if known else why
        effort = table.number(
            f"effort of {joint.name}", torque if known and torque is not None else effort, why, f"<limit> in {urdf}",
            FILE if known else GUESS, unit="N" if joint.kind == "prismatic" else "N m",
        )  # fmt: skip
        weak += [weak_motor(joint, effort, speed / wheel.radius)] if wheel else []
        limit = next(iter(elements[joint.name].each("limit")), None)
        if limit is None:
            limit = Element("limit")
            elements[joint.name].children.append(limit)
        limit.attributes["effort"] = format_number(effort)
        if not 0.0 < joint.motor.velocity < math.inf:
            limit.attributes["velocity"] = format_number(3.0 / wheel.radius if wheel else 2.0)
    if motors:
        root.children.append(_control(motors))
    return [sentence for sentence in weak if sentence]


def _effort(model: RobotModel, base: BaseKind, wheel: FoundWheel, speed: float) -> tuple[float, str]:
    """Return the torque [N m] that a wheel needs at the maximum speed [m/s] of the robot, and where it is from."""
    share = (2.0 if base.kind == "skid-steer" else 1.0) / max(1, len(base.driven))
    effort = (
        share * model.mass * GRAVITY * wheel.radius
    )  # skid-steer wheels also push against the friction of the others
    dragged = sum(resistance(model.joints[wheel.joint], speed / wheel.radius) for wheel in base.wheels)
    own = resistance(model.joints[wheel.joint], speed / wheel.radius)
    against = max(own, dragged / max(1, len(base.driven)))  # also that of wheels without motors
    why = f"weight and radius, and {against:.4g} N m of <dynamics>" if against else "weight and radius"
    return effort + against, why


def _control(motors: Mapping[str, str]) -> Element:
    """Return <ros2_control> with the command types of joints."""
    rows = [
        Element("joint", {"name": name}, [Element("command_interface", {"name": kind})])
        for name, kind in motors.items()
    ]
    return Element("ros2_control", {"name": "motors", "type": "system"}, rows)
