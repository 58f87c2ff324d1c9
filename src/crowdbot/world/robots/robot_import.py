"""Conversion of a maker's robot file to a robot folder with ``robot.xml``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import Element, RobotError, format_xml
from crowdbot.world.robots.drives.base_drive import (
    RUBBER,
    SMOOTH,
    curve_limit,
    drive_type,
    inner_angle,
    mass_attributes,
    middle_angle,
    rollers_of,
    tire_friction,
    turns_wheels,
    wheel_attributes,
)
from crowdbot.world.robots.drives.skid_slide import GRAVITY
from crowdbot.world.urdf import RobotDocument, RobotModel, parse_robot_file, read_urdf

from .base_kind import BaseKind, is_locked, joints_above, recognize_base, wheel_springs
from .controllers import JointLimits, find_controller_files, read_controllers, read_joint_limits
from .gazebo_tags import SAME, DriveParameters, find_sensors, guess_sensors, read_drive_parameters
from .guess_table import DERIVED, DOUBTFUL, FILE, GIVEN, GUESS, Guess, GuessTable
from .robot_urdf import (
    add_masses,
    add_motors,
    add_shapes,
    add_wheel_shapes,
    copy_elements,
    copy_meshes,
    format_number,
)

__all__ = ["Guess", "RobotFolder", "import_robot"]

GROUND_LINK = "drive_center"
TEMPLATE = 1.0
"""Limit of commands in the templates of ``<ros2_control>``, which many files keep."""
PLAUSIBLE = {
    "max_speed": (0.2, 5.0), "max_acceleration": (0.1, 5.0), "max_turn_rate": (0.2, 10.0),
    "max_turn_acceleration": (0.2, 20.0), "center_x": (-0.5, 0.5), "center_y": (-0.2, 0.2), "wheels_x": (-1.0, 1.0),
}  # fmt: skip
"""Usual values of bases, in SI units; a file with others may have been written for another purpose."""
SIDEWAYS = (
    "the wheels roll along y, but the front of a robot is along x (REP 103), so it would drive sideways; turn the base"
    " of the robot file by 90 degrees"
)


@dataclass
class RobotFolder:
    """The files of a robot folder.

    Fields:
        name: name of the robot.
        texts: text files by path in the folder.
        copies: mesh files to copy, by path in the folder.
        guesses: table of everything that is read, derived or guessed.
        remarks: sentences about repairs and parts that are left out.
        kind: kind of base.
        mass: total mass [kg].
    """

    name: str
    texts: dict[str, str] = field(default_factory=dict)
    copies: dict[str, Path] = field(default_factory=dict)
    guesses: list[Guess] = field(default_factory=list)
    remarks: tuple[str, ...] = ()
    kind: str = ""
    mass: float = 0.0


@dataclass
class _Conversion:
    """State shared by the functions below."""

    name: str
    table: GuessTable
    model: RobotModel
    base: BaseKind
    parameters: DriveParameters
    joints: Mapping[str, JointLimits]
    wheeled: bool
    mass: float = 0.0

    @property
    def urdf(self) -> str:
        return f"{self.name}.urdf"


def import_robot(
    source: Path,
    name: str,
    *,
    packages: Mapping[str, Path] | None = None,
    arguments: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
    kind: str = "",
    controllers: Sequence[Path] = (),
    values: Mapping[str, str] | None = None,
) -> RobotFolder:
    """Return the robot folder of a URDF, xacro or SDF file.

    Args:
        source: the file.
        name: name of the robot.
        packages, arguments, environment: as in :func:`read_urdf`.
        kind: kind of base, see :data:`BASE_KINDS` (default: recognized).
        controllers: YAML files with parameters of ROS controllers (default: those that the robot file names, or that
            are in its package).
        values: values instead of those of the table, by their name there, such as ``{"max-speed": "0.5"}``.

    Raises:
        RobotError: the file has errors, or has no mass.
        InputError: ``kind`` is unknown, a controller file cannot be read, or a value is invalid.
    """
    document = parse_robot_file(source, packages=packages, arguments=arguments, environment=environment)
    model = read_urdf(source, packages=packages, arguments=arguments, environment=environment, colliders="hull")
    if model.mass <= 0.0:
        raise RobotError(f"{source}: the robot has no mass and no shapes to compute it from")
    table = GuessTable(values)
    if not any(link.collisions or link.visuals for link in model.links.values()):
        add_shapes(table, document.root, model, f"{name}.urdf")
        model = read_urdf(format_xml(copy_elements(document.root, model.name)), colliders="hull")
    parameters, remarks = _parameters(source, document, model, controllers)
    model = add_wheel_shapes(table, document, model, parameters.values.get("radius"), f"{name}.urdf", kind)
    base = recognize_base(model, parameters.plugins, kind)
    if not kind:
        _check_steering(document.place, model, base)
    status = GIVEN if kind else (FILE if base.why.startswith("the plugin") else DERIVED)
    wrong = (
        "; the robot lies on its side" if base.turned else "; it would drive sideways" if base.rolls_sideways else ""
    )
    status, why = DOUBTFUL if wrong else status, f"{base.why}{wrong}"
    table.rows.insert(0, Guess("kind of base", base.kind, why, "--base KIND", status))
    done = _Conversion(
        name, table, model, base, parameters, read_joint_limits(document.root), turns_wheels(model, base)
    )
    root = _robot_element(done)
    _sensor_elements(done, root, document.root)
    drive = root.each("drive")[0].attributes
    urdf, copies = _urdf_element(done, document.root, float(drive.get("max-steering", 0.0)))
    speed = float(drive["max-speed"])
    remarks += add_motors(table, urdf, model, base, done.wheeled, parameters.values.get("effort"), speed, done.urdf)
    table.check_names()
    made = RobotFolder(name, {done.urdf: format_xml(urdf), "robot.xml": format_xml(root)}, copies, table.rows)
    first = [SIDEWAYS] if base.rolls_sideways else [f"{document.place}: {base.turned}"] if base.turned else []
    made.remarks, made.kind, made.mass = (*first, *model.warnings, *remarks), base.kind, done.mass
    made.texts["import.json"] = _record(made, source)
    return made


def _check_steering(place: str, model: RobotModel, base: BaseKind) -> None:
    """Raise an error if wheels that do not steer are on locked joints named after steering, with an axis not vertical.

    SolidWorks exports a joint whose limits were left empty in this way; the wheels of a car would be dragged sideways.
    """
    for wheel in base.wheels:
        for joint in joints_above(model, model.joints[wheel.joint]):
            if not wheel.steering and is_locked(joint) and "steer" in f"{joint.name} {joint.child}".lower():
                axis = " ".join(format_number(value) for value in model.poses()[joint.child][:3, :3] @ joint.axis)
                raise RobotError(
                    f"{place}: the joint {joint.name!r} above the wheel {wheel.link!r} cannot steer: its limits are"
                    f" {joint.lower:g} to {joint.upper:g} rad, and its axis is {axis} in the robot, not 0 0 1; correct"
                    " its <axis> and <limit> in the file, or give --base skid-steer for a robot without steering"
                )


def _record(made: RobotFolder, source: Path) -> str:
    """Return the table as JSON."""
    rows = [guess._asdict() for guess in made.guesses]
    return json.dumps({"source": source.name, "table": rows, "remarks": list(made.remarks)}, indent=1) + "\n"


def _parameters(
    source: Path, document: RobotDocument, model: RobotModel, controllers: Sequence[Path]
) -> tuple[DriveParameters, list[str]]:
    """Return the parameters of plugins and controller files; a controller file comes first."""
    parameters, remarks = read_drive_parameters(document.root), []
    if controllers:
        found = [controller for path in controllers for controller in read_controllers(path)]
        if not found:
            remarks.append(f"no controller in {', '.join(str(path) for path in controllers)} moves the base")
    else:
        found, remarks = find_controller_files(source, document.root, tuple(model.joints), document.folders.find)
    for one in found[1:]:
        remarks.append(f"the controller {one.name!r} in {one.place} is not used; {found[0].name!r} is")
    for one in found[:1]:
        missing = [joint for joint in one.joints if joint not in model.joints]
        if missing:
            remarks.append(f"the controller {one.name!r} in {one.place} names {missing[0]!r}, which is not a joint")
        label = f"{one.name} in {Path(one.place).name}"
        parameters = parameters.extend((one.kind,), one.values, label)
    return parameters, remarks


def _robot_element(done: _Conversion) -> Element:
    """Return <robot> with its drive and wheels."""
    model, base, table = done.model, done.base, done.table
    root = Element("robot", {"name": done.name, "urdf": done.urdf, "base": "wheels" if done.wheeled else "planar"})
    root.attributes["about"] = f"{base.kind} base, from {model.name}"
    how = "its wheels are turned by motors" if done.wheeled else "the base is moved directly"
    table.add("physics world", root.attributes["base"], f"{base.kind} base: {how}", "base= in robot.xml", DERIVED)
    root.children.append(Element("drive", _drive(done)))
    if not len(model.points()):
        table.add("footprint", "outline of the visuals", "the file has no colliders", "<footprint> in robot.xml", GUESS)
        root.children.append(Element("footprint", {"radius": format_number(_reach(model))}))
    for wheel in base.wheels:
        guessed = any(row.what == f"radius of {wheel.link}" and row.status == GUESS for row in table.rows)
        why = "radius of its shape" + (", a guess" if guessed else "") + _other(done, "radius", wheel.radius)
        radius = table.number(f"wheel {wheel.joint}", wheel.radius, why, "<wheel> in robot.xml", DERIVED, unit="m")
        row = {"joint": wheel.joint, "radius": format_number(radius)}
        row |= {"steering": wheel.steering} if wheel.steering else {}
        row |= {} if wheel.joint in base.driven else {"driven": "false"}
        rollers = rollers_of(base, wheel) if done.wheeled else None
        if rollers is not None:
            source = "usual arrangement" if rollers else "across the axle"
            change = "rollers= of <wheel> in robot.xml"
            table.add(f"rollers {wheel.joint}", f"{rollers:.4g} rad", source, change, GUESS)
            row["rollers"] = format_number(rollers)
        if done.wheeled:  # the tyres of wheels without motors also hold the base
            root.children.append(Element("wheel", row))
    for link in base.castors:
        why = "it touches the ground without a motor"
        table.add(f"castor {link}", "glides", why, f"<mu1> in {done.urdf}", DERIVED)
    return root


def _reach(model: RobotModel) -> float:
    poses = model.poses()
    rows = [
        (poses[name] @ part.origin, part.shape.points()) for name, link in model.links.items() for part in link.visuals
    ]
    return max(math.hypot(*(matrix[:2, :3] @ row + matrix[:2, 3])) for matrix, points in rows for row in points)


def _drive(done: _Conversion) -> dict[str, str]:
    """Return the attributes of <drive>, and list each with its source."""
    base, given = done.base, done.parameters.values
    kind = drive_type(base, done.wheeled)
    done.table.add("drive", kind, f"{base.kind} base", "type= of <drive> in robot.xml", DERIVED)
    row = {"type": kind}

    def choose(key: str, guess: float, why: str, status: str, unit: str) -> float:
        guess, why, status = _plausible(done, key, *(_given(done, key) if key in given else (guess, why, status)))
        name = key.replace("_", "-")
        value = done.table.number(name, guess, why, f"{name}= of <drive> in robot.xml", status, unit=unit)
        row[name] = repr(value) if key == "max_steering" else format_number(value)  # rounded up, it may exceed pi / 2
        return value

    speed = choose("max_speed", *_top_speed(done), "m/s")
    grip = 0.3 * GRAVITY * tire_friction(done.model, base) if done.wheeled else 1.0
    why = "common value" if grip >= 1.0 else "0.3 of the friction of its wheels"
    choose("max_acceleration", min(1.0, grip), why, GUESS if grip >= 1.0 else DERIVED, "m/s2")
    if kind in ("ackermann-drive", "tricycle-drive"):
        angle, why, status = _steering(done)
        if status == FILE and given.get("max_steering", 0.0) > angle:  # the inner wheel would reach its joint limit
            why, status = why + _other(done, "max_steering", angle), DOUBTFUL
            given = {key: value for key, value in given.items() if key != "max_steering"}
        choose("max_steering", angle, why, status, "rad")
        choose("max_steering_rate", 1.0, "common value", GUESS, "rad/s")
        if base.wheelbase:
            given = {key: value for key, value in given.items() if key != "wheelbase"}
        why = "places of the wheels" + _other(done, "wheelbase", base.wheelbase) if base.wheelbase else "common value"
        choose("wheelbase", base.wheelbase or 0.6, why, DERIVED if base.wheelbase else GUESS, "m")
    else:
        track = base.track or given.get("track", 0.5)
        wheels, reach, most = wheel_attributes(base, track, done.wheeled)
        turning = min(speed / reach, most) if reach > 0.025 else 1.5
        why = f"speed and places of the wheels, at most {most:g} rad/s" if base.track else "common value"
        turn = choose("max_turn_rate", turning, why, DERIVED if base.track else GUESS, "rad/s")
        choose("max_turn_acceleration", 3.0, "common value", GUESS, "rad/s2")
        if kind == "legged-drive":
            choose("max_side_speed", 0.5 * speed, "half of the maximum speed", GUESS, "m/s")
        given = {}
        for key, value, unit in wheels:
            if key == "first_angle":
                row["first-angle"] = _first_angle(done, value)
            else:
                choose(key, value, "places of the wheels" + _other(done, key, value), DERIVED, unit)
        if kind == "differential-drive":
            most, why = curve_limit(done.model, base, done.wheeled)
            choose("max_lateral_acceleration", most, why, DERIVED, "m/s2")
        if kind == "skid-steer-drive":
            for key, value in mass_attributes(done.model, base):
                choose(key, value, "masses of the links", DERIVED, "m")
            choose("friction", tire_friction(done.model, base), "<mu1> of the wheels, at most 1", DERIVED, "")
        if wheels:
            fastest = _wheel_speed(done)
            need = (speed + turn * reach) * (math.sqrt(2.0) if kind == "mecanum-drive" else 1.0) / base.wheels[0].radius
            why, status = (fastest.source, fastest.status) if fastest.value else ("speed and turn rate", DERIVED)
            choose("max_wheel_speed", fastest.value or need, why, status, "rad/s")
    return row


def _first_angle(done: _Conversion, angle: float) -> str:
    done.table.add("first-angle", f"{angle:.4g} rad", "places of the wheels", "first-angle=", DERIVED)
    return format_number(angle)


def _given(done: _Conversion, key: str) -> tuple[float, str, str]:
    """Return what a plugin or controller gives, with source and status."""
    parameters = done.parameters
    value, why = parameters.values[key], parameters.sources.get(key, "the drive plugin")
    others = [parameters.others[key]] if key in parameters.others else []
    others += _exceeded(done, value) if key == "max_speed" else []
    return value, "; ".join([why, *others]), DOUBTFUL if others else FILE


def _other(done: _Conversion, key: str, value: float) -> str:
    """Return what a plugin or controller gives instead of a value that counts, as an end of a sentence."""
    other = done.parameters.values.get(key, value)
    if math.isclose(other, value, rel_tol=SAME):
        return ""
    return f"; {done.parameters.sources.get(key, 'the drive plugin')} has {other:.4g}"


def _plausible(done: _Conversion, key: str, value: float, why: str, status: str) -> tuple[float, str, str]:
    """Return a value with source and status, which say whether it is implausible."""
    low, high = PLAUSIBLE.get(key, (0.0, math.inf))
    if low <= value <= (high if done.base.wheels else math.inf):
        return value, why, status
    reason = f"below {low:g}" if value < low else f"above {high:g}"
    return value, f"{why}; implausible: {reason}", DOUBTFUL if status == FILE else status


class _WheelSpeed(NamedTuple):
    """The limit of the driven wheels that counts [rad/s] (0 without one), its source and status, and what does not."""

    value: float
    source: str
    status: str
    ignored: str = ""


def _wheel_speed(done: _Conversion) -> _WheelSpeed:
    """Return the limit of the driven wheels in ``<ros2_control>`` or ``<limit>``.

    The lower one counts. But commands of up to 1, or for a base that creeps, are often left from a template: then the
    joint decides.
    """
    radius = done.base.wheels[0].radius if done.base.wheels else 0.0
    commands = [done.joints[name].velocity for name in done.base.driven if name in done.joints]
    limits = [done.model.joints[name].motor.velocity for name in done.base.driven]
    rows = [[value for value in row if 0.0 < value < math.inf] for row in (commands, limits)]
    command, limit = (min(row, default=0.0) for row in rows)
    places = ((command, "<ros2_control> of the wheels"), (limit, "<limit> of the wheels"))
    usable = [(value, place) for value, place in places if 0.05 <= value * radius <= 5.0]
    ignored = "; ".join(f"{place} has {value:.4g} rad/s" for value, place in places if value > 0.0)
    if not usable:
        return _WheelSpeed(0.0, "", GUESS, ignored)
    creeps = command == TEMPLATE or command * radius < PLAUSIBLE["max_speed"][0]
    if len(usable) == 2 and not math.isclose(command, limit, rel_tol=SAME):
        value, place = usable[1] if creeps else min(usable)
        other, elsewhere = usable[0] if place == usable[1][1] else usable[1]
        template = ", perhaps of a template" if creeps else ""
        return _WheelSpeed(value, f"{value:.4g} rad/s in {place}; {elsewhere} has {other:.4g}{template}", DOUBTFUL)
    value, place = usable[0]
    others = [f"{elsewhere} has {other:.4g} rad/s" for other, elsewhere in places if other > 0.0 and elsewhere != place]
    if len(usable) == 1 and others:
        return _WheelSpeed(value, f"{value:.4g} rad/s in {place}; {others[0]}", DOUBTFUL)
    if place == places[0][1] and command == TEMPLATE:
        return _WheelSpeed(value, f"{place}: {value:g} rad/s, perhaps of a template", DOUBTFUL)
    most = max(max(row, default=0.0) for row in rows)
    if not math.isclose(value, most, rel_tol=SAME):
        return _WheelSpeed(value, f"{value:.4g} rad/s in {place}; another wheel has {most:.4g}", DOUBTFUL)
    return _WheelSpeed(value, place, FILE)


def _top_speed(done: _Conversion) -> tuple[float, str, str]:
    """Return the maximum speed [m/s] of a base that no plugin or controller gives, with source and status."""
    radius = done.base.wheels[0].radius if done.base.wheels else 0.0
    found = _wheel_speed(done)
    if found.value:
        return found.value * radius, found.source, found.status
    guess, why = (min(1.0, 10.0 * radius), "10 rad/s of the wheels") if radius else (1.0, "common value")
    return guess, f"{why}; {found.ignored}, not used" if found.ignored else why, GUESS


def _exceeded(done: _Conversion, speed: float) -> list[str]:
    """Return the limit of the wheels that a speed [m/s] of a plugin or controller exceeds."""
    found = _wheel_speed(done)
    most = found.value * done.base.wheels[0].radius if found.value else math.inf
    return [f"the wheels allow {most:.4g} m/s: {found.source}"] if speed > (1.0 + SAME) * most else []


def _steering(done: _Conversion) -> tuple[float, str, str]:
    """Return the largest steering angle [rad], with source and status."""
    names = [wheel.steering for wheel in done.base.wheels if wheel.steering]
    angles = [done.joints[name].position for name in names if name in done.joints]
    angles += [done.model.joints[name].upper for name in names if not is_locked(done.model.joints[name])]
    usable = [value for value in angles if value > 0.05]
    middle = middle_angle(done.base, min(usable)) if usable else 0.0
    if middle:
        return middle, "<limit> of the steering joints", FILE
    locked = any(is_locked(done.model.joints[name]) for name in names)
    return 0.6, "common value" + ("; <limit> of the steering joints allows no motion" if locked else ""), GUESS


MOST_SENSORS = 50
"""Largest number of sensors of a robot in a trial."""
BODY_SENSORS = ("imu", "bumper", "joint-states", "wheel-odometry")
"""Sensors of the robot itself, which are left out first."""


def _sensor_elements(done: _Conversion, root: Element, source: Element) -> None:
    """Add the sensors of Gazebo tags, and those that links are named after."""
    change, model = "<sensor> in robot.xml", done.model
    sensors = find_sensors(source)
    usable = [item for item in sensors if item.attributes and (item.link or model.root) in model.links]
    kept = sorted(usable, key=lambda item: item.attributes["type"] in BODY_SENSORS)[:MOST_SENSORS]
    for item in sensors:
        link = item.link or model.root
        if item in usable and not any(item is other for other in kept):
            why = f"{len(usable)} sensors, a robot has at most {MOST_SENSORS}"
            done.table.add(f"sensor {item.name}", "left out", f"{item.source}; {why}", change, DERIVED)
            continue
        if not item.attributes or link not in model.links:
            why = "there is no such link" if item.attributes else "its type is not supported"
            done.table.add(f"sensor {item.name}", "left out", f"{item.source}; {why}", change, DERIVED)
            continue
        root.children.append(Element("sensor", {"name": item.name, "link": link} | item.attributes))
        done.table.add(f"sensor {item.name}", item.attributes["type"], item.source, change)
    for sensor in guess_sensors(tuple(model.links), sensors)[: MOST_SENSORS - len(kept)]:
        root.children.append(Element("sensor", {"name": sensor.name, "link": sensor.link} | sensor.attributes))
        done.table.add(f"sensor {sensor.name}", sensor.attributes["type"], sensor.source, change, GUESS)
    if not root.each("sensor"):
        done.table.add("sensors", "none", "no <sensor> in <gazebo> tags", change, DERIVED)


def _urdf_element(done: _Conversion, source: Element, steering: float) -> tuple[Element, dict[str, Path]]:
    """Return <robot> with links, joints, materials and friction, and the mesh files to copy.

    ``steering`` is the maximum steering angle [rad], 0 without steering.
    """
    model, base = done.model, done.base
    root = copy_elements(source, done.name)
    copies = copy_meshes(root, model)
    _lock_springs(done, root)
    _free_steering(done, root, steering)
    done.mass = add_masses(done.table, root, model, done.urdf)
    if abs(base.rear) > 0.005 and base.wheels and base.kind != "planar":
        root.children.append(Element("link", {"name": GROUND_LINK}))
        joint = Element("joint", {"name": f"{GROUND_LINK}_joint", "type": "fixed"})
        joint.children = [Element("parent", {"link": GROUND_LINK}), Element("child", {"link": model.root})]
        joint.children.append(Element("origin", {"xyz": f"{format_number(-base.rear)} 0 0"}))
        root.children.append(joint)
        change = f"{GROUND_LINK} in {done.urdf}"
        done.table.add("centre of turning", f"x = {base.rear:.4g} m", "axle of the wheels", change, DERIVED)
    gliding = [*base.castors, *([] if done.wheeled else [wheel.link for wheel in base.wheels])]
    turned = {wheel.link for wheel in base.wheels if wheel.joint in base.driven}
    for name, link in model.links.items():
        friction = 0.0 if name in gliding or (not done.wheeled and name in _feet(model, base)) else link.friction
        if done.wheeled and name in turned and friction is not None:
            friction = _tire(done.table, name, friction, done.urdf)
        if friction is not None:
            mu = Element("mu1", {"value": format_number(friction)})
            root.children.append(Element("gazebo", {"reference": name}, [mu]))
    return root, copies


def _lock_springs(done: _Conversion, root: Element) -> None:
    """Fix the springs of wheels: URDF has no stiffness and no preload, which decide how much weight the wheels bear."""
    names = wheel_springs(done.model, done.base) if done.wheeled else ()
    for joint in root.each("joint"):
        name = joint.attributes.get("name", "")
        if name in names:
            joint.attributes["type"] = "fixed"
            source = "a spring of a wheel: URDF has no stiffness and no preload"
            done.table.add(f"joint {name}", "fixed", source, f"type= of <joint> in {done.urdf}", DERIVED)


def _free_steering(done: _Conversion, root: Element, angle: float) -> None:
    """Remove <mimic> from steering joints, as two front wheels steer by different angles, and limits without motion."""
    names = {wheel.steering for wheel in done.base.wheels}
    for joint in root.each("joint"):
        name = joint.attributes.get("name", "")
        if name in names and joint.each("mimic"):
            joint.children = [inner for inner in joint.children if inner.tag != "mimic"]
            why = "both front wheels turn about one centre"
            done.table.add(f"steering {name}", "on its own", why, f"<mimic> in {done.urdf}", DERIVED)
        if name in names and angle and is_locked(done.model.joints[name]):
            most, (limit,) = inner_angle(done.base, angle), joint.each("limit")
            why = f"max-steering; the file has {done.model.joints[name].lower:g} to {done.model.joints[name].upper:g}"
            limit.attributes |= {"lower": repr(-most), "upper": repr(most)}
            done.table.add(f"limit of {name}", f"{most:.4g} rad", why, f"<limit> in {done.urdf}", GUESS)


def _tire(table: GuessTable, link: str, friction: float, urdf: str) -> float:
    """Return the friction coefficient of a driven wheel: not more than rubber has, and not 0."""
    usable = RUBBER if friction < SMOOTH else min(friction, RUBBER)
    if usable != friction:
        source = f"rubber; the file has {friction:.4g}"
        table.add(f"friction of {link}", f"{usable:g}", source, f"<mu1> in {urdf}", GUESS)
    return usable


def _feet(model: RobotModel, base: BaseKind) -> set[str]:
    return {model.joints[name].child for name in base.legs}
