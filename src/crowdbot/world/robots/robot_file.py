"""Parser of ``robot.xml``: reports all errors, each with its line."""

from __future__ import annotations

import dataclasses
import importlib.resources
import math
import types
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import crowdbot.sensors
from crowdbot.core import (
    Element,
    InputError,
    RobotError,
    attribute_problems,
    builtin_classes,
    did_you_mean,
    find_class,
    from_attributes,
    nearest_name,
    parse_number,
    parse_xml,
    read_bytes,
)
from crowdbot.sensors import Sensor, preset
from crowdbot.world.robots.drives.drive import Drive
from crowdbot.world.urdf import RobotModel, read_urdf

from .link_dynamics import LinkDynamics, read_link
from .mount import SensorMount
from .wheel import Wheel

FILE = "robot.xml"
SHIPPED = Path(str(importlib.resources.files("crowdbot").joinpath("assets", "robots")))
"""Folder of the built-in robots."""

KNOWN: dict[str, tuple[str, ...]] = {
    "robot": ("name", "urdf", "about", "base", "extends", "default-sensors", "seat", "rider", "max-step", "max-slope"),
    "footprint": ("points", "radius"),
    "wheel": ("joint", "radius", "steering", "driven", "rollers"),
    "posture": ("joint", "position"),
}
PLACES = ("x", "y", "z", "roll", "pitch", "yaw")
CIRCLE = np.linspace(0.0, 2.0 * math.pi, 32, endpoint=False)
NAMED = {"sensor": "name", "wheel": "joint", "posture": "joint", "link": "name"}
"""Elements of which there may be several, with the attribute that tells them apart."""


def read_robot_file(folder: Path, *, trust: bool = False) -> dict[str, Any]:
    """Read ``robot.xml`` in a folder and the URDF file that it names; return the fields of a robot by name.

    Raises:
        RobotError: the file has errors; the exception lists all of them, one sentence each.
    """
    path = folder / FILE
    root = parse_xml(read_bytes(path, "robot", RobotError), str(path), what="robot", root="robot", refusal=RobotError)
    reader = _Reader(str(path), folder, trust)
    if root.tag != "robot":
        raise RobotError(f"{path}:{root.line}: the root element is <{root.tag[:40]}>, expected <robot>")
    if reader.words(root).get("extends"):
        root, reader.model_folder = extend_robot(root, folder, reader.shipped)
    values = reader.robot(root)
    reader.finish()
    return values


class _Reader:
    """Collects problems while parsing."""

    def __init__(self, place: str, folder: Path, trust: bool) -> None:
        self.place, self.folder, self.trust = place, folder, trust
        self.model_folder = folder
        self.found: list[tuple[float, str]] = []

    def say(self, element: Element, sentence: str) -> None:
        self.found.append((element.line, f"{self.place}:{element.line}: <{element.tag[:40]}> {sentence}"))

    def finish(self) -> None:
        if self.found:
            raise RobotError(*[sentence for _, sentence in sorted(self.found, key=lambda row: row[0])][:100])

    def robot(self, root: Element) -> dict[str, Any]:
        """Return the fields of the robot."""
        row = self.words(root)
        values: dict[str, Any] = {"name": row.get("name") or self.folder.resolve().name, "about": row.get("about", "")}
        values["base"] = row.get("base", "wheels")
        values |= {"seat": row.get("seat") == "true", "rider": row.get("rider", "")}
        values |= self.ground_limits(root)
        parts: dict[str, list[Any]] = {"sensor": [], "wheel": [], "posture": [], "link": []}
        once: set[str] = set()
        for inner in root.children:
            self.tag(inner, ("drive", "footprint", *parts))
            if inner.tag in ("drive", "footprint"):
                if inner.tag in once:
                    self.say(inner, "occurs more than once in <robot>; at most one is allowed")
                once.add(inner.tag)
                values |= self.drive(inner) if inner.tag == "drive" else self.footprint(inner)
            elif inner.tag in parts:
                made = getattr(self, inner.tag)(inner)
                parts[inner.tag] += [made] if made is not None else []
        if "drive" not in once:
            self.say(root, "needs the element <drive type=...>: how it moves")
        model = self.model(root, row.get("urdf", ""))
        if model is not None:
            self.check_names(root, model)
        posture = dict(parts["posture"])
        if len(posture) < len(parts["posture"]):
            self.say(root, "gives the posture of a joint twice")
        mounts = [mount(model.root) if callable(mount) else mount for mount in parts["sensor"]] if model else []
        return values | {
            "model": model,
            "mounts": tuple(mounts),
            "wheels": tuple(parts["wheel"]),
            "posture": posture,
            "links": tuple(parts["link"]),
        }

    def ground_limits(self, root: Element) -> dict[str, float]:
        """Return the largest step and slope that the robot passes, where the file gives them."""
        result = {}
        for key in ("max-step", "max-slope"):
            if key in root.attributes:
                value = self.number(root, key)
                result[key.replace("-", "_")] = max(0.0, value)
                if value < 0.0:
                    self.say(root, f'{key}="{root.attributes[key][:40]}" must be at least 0')
        return result

    def tag(self, element: Element, known: tuple[str, ...]) -> None:
        """Record an unknown element and return the tag that was probably meant."""
        if element.tag not in known:
            meant = did_you_mean(element.tag, known)
            self.say(element, f"is not an element of <robot>{meant}; it accepts {', '.join(known)}")
            element.tag = nearest_name(element.tag, known) or element.tag

    def check_names(self, root: Element, model: RobotModel) -> None:
        """Record unknown names of links and joints, and duplicate names of sensors."""
        turning = [joint.name for joint in model.movable if joint.size == 1]
        names = [inner.attributes.get("name", "") for inner in root.each("sensor")]
        base = root.attributes.get("base", "wheels")
        if base not in ("wheels", "planar"):
            self.say(root, f"base = {base[:40]!r} must be wheels or planar")
        for k, inner in enumerate(root.each("sensor")):
            link = inner.attributes.get("link", "")
            if link and link not in model.links:
                self.say(inner, f"link={link[:60]!r} is not a link of the robot{did_you_mean(link, model.links)}")
            if names[k] and names[k] in names[:k]:
                self.say(inner, f"name {names[k][:60]!r} is already used by another sensor; names must differ")
        for inner in root.each("wheel"):
            for key in ("joint", "steering"):
                name = inner.attributes.get(key, "")
                if name and name not in turning:
                    self.say(inner, f"{key}={name[:60]!r} is not a rotating joint{did_you_mean(name, model.joints)}")
        for inner in root.each("posture"):
            name = inner.attributes.get("joint", "")
            if name and name not in model.joints:
                self.say(inner, f"joint={name[:60]!r} is not a joint of the robot{did_you_mean(name, model.joints)}")

    def model(self, root: Element, name: str) -> Any:
        if not name:
            self.say(root, "needs the attribute 'urdf': the URDF file in the same folder")
            return None
        path = self.model_folder / name
        try:
            inside = path.resolve().is_relative_to(self.model_folder.resolve())
        except (OSError, RuntimeError, ValueError):
            inside = False
        if not inside:
            self.say(root, f"urdf={name[:80]!r} is outside the robot folder {self.folder}")
            return None
        try:
            return read_urdf(path, folder=self.model_folder)
        except RobotError as error:
            self.found += [(math.inf, sentence) for sentence in error.problems]
            return None

    def words(self, element: Element) -> dict[str, str]:
        """Return the attributes; unknown ones are recorded and replaced by those that were probably meant."""
        known = KNOWN[element.tag]
        for key in [key for key in element.attributes if key not in known]:
            meant = did_you_mean(key, known)
            self.say(element, f"has no attribute {key[:40]!r}{meant}; it accepts {', '.join(known)}")
            text = element.attributes.pop(key)
            if meant:
                element.attributes.setdefault(nearest_name(key, known), text)
        return element.attributes

    def number(self, element: Element, key: str) -> float:
        """Return a required number; 1 if it is invalid."""
        text = element.attributes.get(key)
        if text is None:
            self.say(element, f"needs the attribute {key!r}, a number")
            return 1.0
        try:
            return parse_number(text)
        except InputError as error:
            self.say(element, f'{key}="{text[:40]}" {error}')
            return 1.0

    def shipped(self, name: str) -> Path:
        """Return the file of a built-in robot."""
        known = sorted(entry.name for entry in SHIPPED.iterdir() if (entry / FILE).is_file())
        if name not in known:
            meant = f"{did_you_mean(name, known)}; built-in robots are {', '.join(known)}"
            raise RobotError(f"{self.place}: extends={name[:60]!r} is not a built-in robot{meant}")
        return SHIPPED / name / FILE

    def link(self, element: Element) -> LinkDynamics | None:
        """Return the dynamics of a link."""
        try:
            return read_link(element.attributes)
        except InputError as error:
            self.say(element, str(error))
            return None

    def wheel(self, element: Element) -> Wheel | None:
        """Return a wheel."""
        row = self.words(element)
        radius = self.number(element, "radius")
        driven = row.get("driven", "true")
        if driven not in ("true", "false"):
            self.say(element, f'driven="{driven[:40]}" must be true or false')
            return None
        if radius <= 0.0:
            self.say(element, f'radius="{element.attributes["radius"][:40]}" must be above 0')
            return None
        rollers = self.number(element, "rollers") if "rollers" in row else None
        try:
            return Wheel(row.get("joint", ""), radius, row.get("steering", ""), driven == "true", rollers)
        except InputError as error:
            self.say(element, str(error))
            return None

    def posture(self, element: Element) -> tuple[str, float]:
        """Return the name of a joint and its position."""
        return self.words(element).get("joint", ""), self.number(element, "position")

    def footprint(self, element: Element) -> dict[str, Any]:
        """Return the corners of the footprint."""
        row = self.words(element)
        if ("points" in row) == ("radius" in row):
            self.say(element, "needs either points or radius")
            return {}
        if "radius" in row:
            radius = self.number(element, "radius")
            if radius <= 0.0:
                self.say(element, f'radius="{row["radius"][:40]}" must be above 0')
            return {"footprint": radius * np.stack([np.cos(CIRCLE), np.sin(CIRCLE)], axis=1)}
        try:
            points = [[parse_number(part) for part in word.split(",")] for word in row["points"].split()]
        except InputError as error:
            self.say(element, f'points="{row["points"][:40]}" {error}')
            return {}
        if len(points) < 3 or any(len(point) != 2 for point in points):
            self.say(
                element, f'points="{row["points"][:40]}" must be at least 3 points x,y such as 0.3,0.2 -0.3,0.2 0,-0.4'
            )
            return {}
        return {"footprint": np.array(points)}

    def drive(self, element: Element) -> dict[str, Any]:
        """Return the drive and the latency of commands."""
        import crowdbot.world as room

        row = dict(element.attributes)
        values: dict[str, Any] = {}
        if "latency" in row:
            values["latency"] = self.number(element, "latency")
            del row["latency"]
            if values["latency"] < 0.0:
                self.say(element, f'latency="{element.attributes["latency"][:40]}" must be at least 0 s')
        made = self.plugged(element, row, room, Drive, ("latency",))
        return values | ({"drive": made} if made is not None else {})

    def sensor(self, element: Element) -> Any:
        """Return a mount, or a function that creates it once the root is known."""
        row = dict(element.attributes)
        name, link = row.pop("name", ""), row.pop("link", "")
        if not name:
            self.say(element, "needs the attribute 'name'")
        place = {key: self.number(element, key) for key in PLACES if key in row}
        rest = {key: text for key, text in row.items() if key not in PLACES}
        also = ("name", "link", *PLACES)
        if "preset" in rest:
            made = self.product(element, rest, also)
        else:
            made = self.plugged(element, rest, crowdbot.sensors, Sensor, also)
        if made is None:
            return None
        return lambda root: SensorMount(name, made, link or root, **place)

    def product(self, element: Element, row: Mapping[str, str], also: tuple[str, ...]) -> Sensor | None:
        """Return the sensor named by ``preset`` with the other attributes applied; None after an error."""
        rest = dict(row)
        name = rest.pop("preset")
        if "type" in rest:
            self.say(element, "has both preset and type; give one of them")
            return None
        try:
            made = preset(name)
        except InputError as error:
            self.say(element, str(error))
            return None
        problems = attribute_problems(type(made), rest, ("preset", *also))
        for problem in problems.values():
            self.say(element, problem)
        if problems:
            return None
        try:
            other = from_attributes(type(made), rest)
            names = [key.replace("-", "_") for key in rest]
            return dataclasses.replace(made, **{key: getattr(other, key) for key in names})
        except InputError as error:
            self.say(element, str(error))
            return None

    def plugged(
        self, element: Element, row: Mapping[str, str], room: types.ModuleType, contract: type, also: tuple[str, ...]
    ) -> Any:
        """Return the plug-in named by ``type``, created from the attributes; None after an error."""
        rest = dict(row)
        name = rest.pop("type", None)
        if name is None:
            self.say(element, f"needs the attribute 'type': {', '.join(builtin_classes(room, contract))} or an address")
            return None
        try:
            cls = find_class(name, room, contract, folder=self.folder, trust=self.trust)
        except InputError as error:
            self.say(element, str(error))
            return None
        problems = list(attribute_problems(cls, rest, also).values())
        if not problems:
            try:
                return from_attributes(cls, rest)
            except InputError as error:
                problems = [str(error)]
        for problem in problems:
            self.say(element, problem)
        return None


def extend_robot(root: Element, folder: Path, shipped: Callable[[str], Path]) -> tuple[Element, Path]:
    """Return the element of a robot file with what it takes from the built-in robot that it extends.

    Attributes, drive and footprint of the file replace those of the built-in robot; so do sensors of the same name,
    wheels and postures of the same joint, and links of the same name. ``default-sensors="false"`` takes no sensors.

    Args:
        root: element of the file, with the attribute ``extends``.
        folder: its folder.
        shipped: returns the robot file of a built-in robot, or raises an error.

    Returns:
        The element, and the folder of its URDF file.
    """
    name = root.attributes.pop("extends", "")
    own_sensors = root.attributes.pop("default-sensors", "true") == "false"
    if not name:
        return root, folder
    path = shipped(name)
    base = parse_xml(read_bytes(path, "robot"), str(path), what="robot", root="robot")
    base, place = extend_robot(base, path.parent, shipped)
    given, model = {_key(child) for child in root.children}, root.attributes.get("urdf")
    taken = [
        child for child in base.children if _key(child) not in given and not (own_sensors and child.tag == "sensor")
    ]
    root.attributes = {**base.attributes, "name": folder.resolve().name, **root.attributes}
    root.children = [*taken, *root.children]
    return root, folder if model else place


def _key(element: Element) -> tuple[str, str]:
    return element.tag, element.attributes.get(NAMED.get(element.tag, ""), "")
