"""Conversion of an SDF model (Gazebo) to the elements of URDF.

Supported are links, inertials, collisions, visuals, joints with one axis, frames, sensors, plugins and friction. In SDF
a link has its pose in the model and a joint its pose in the child; in URDF the frame of a link is that of its joint.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import Element, InputError, RobotError, did_you_mean, parse_number
from crowdbot.typing import Floats

from .transforms import frame, roll_pitch_yaw

JOINTS = ("revolute", "continuous", "prismatic", "fixed")
UNLIMITED = 1e10
"""Limits of a joint above this are no limits; SDF writes 1e16."""
MOST_FRAMES = 40


class SdfConversion(NamedTuple):
    """The elements of URDF, and sentences about what is left out."""

    root: Element
    ignored: tuple[str, ...]


def urdf_of_sdf(root: Element, place: str) -> SdfConversion:
    """Return the first model of an SDF file as elements of URDF.

    Args:
        root: root element ``<sdf>`` or ``<model>``.
        place: file name for messages.

    Raises:
        RobotError: there is no model, a number or name is wrong, or a joint type is not supported.

    >>> from crowdbot.core import parse_xml
    >>> text = b"<sdf><model name='m'><link name='a'><inertial><mass>2</mass></inertial></link></model></sdf>"
    >>> urdf_of_sdf(parse_xml(text, "m.sdf"), "m.sdf").root.children[0].attributes
    {'name': 'a'}
    """
    models = [root] if root.tag == "model" else [*root.each("model"), *_inside(root, "world", "model")]
    if not models:
        raise RobotError(f"{place}:{root.line}: <{root.tag[:40]}> contains no <model>")
    return _Converter(models[0], place).convert()


def _inside(element: Element, outer: str, inner: str) -> list[Element]:
    return [item for each in element.each(outer) for item in each.each(inner)]


def _one(element: Element | None, *path: str) -> Element | None:
    for tag in path:
        element = None if element is None else next(iter(element.each(tag)), None)
    return element


class _Converter:
    def __init__(self, model: Element, place: str) -> None:
        self.model, self.place = model, place
        self.ignored: list[str] = []
        self.links = {item.attributes.get("name", ""): item for item in model.each("link")}
        self.joints = {item.attributes.get("name", ""): item for item in model.each("joint")}
        self.frames = {item.attributes.get("name", ""): item for item in model.each("frame")}
        self.above = {self.text(joint, "child"): joint for joint in self.joints.values()}
        self._poses: dict[str, Floats] = {}
        self._active: list[str] = []

    def refuse(self, element: Element, sentence: str) -> None:
        raise RobotError(f"{self.place}:{element.line}: <{element.tag[:40]}> {sentence}")

    def text(self, element: Element | None, *path: str) -> str:
        """Return the text of an inner element, or ''."""
        found = _one(element, *path)
        return "" if found is None else found.stray

    def numbers(self, element: Element, text: str, count: int) -> list[float]:
        """Return ``count`` numbers of a text."""
        words = text.split()
        if len(words) != count:
            self.refuse(element, f"contains {text[:60]!r}, it must be {count} numbers")
        try:
            return [parse_number(word) for word in words]
        except InputError as error:
            self.refuse(element, f"contains {text[:60]!r}, which {error}")
            return []

    def number(self, element: Element | None, *path: str, default: float | None = None) -> float | None:
        """Return the number in an inner element, or the default if it is missing or infinite."""
        found = _one(element, *path)
        if found is None or found.stray.lstrip("+-").lower() in ("inf", "infinity"):
            return default
        return self.numbers(found, found.stray, 1)[0]

    def local_pose(self, element: Element) -> tuple[Floats, str]:
        """Return the pose in an element, and the frame that it is relative to ('' for the default one)."""
        pose = _one(element, "pose")
        if pose is None or not pose.stray:
            return np.eye(4), "" if pose is None else pose.attributes.get("relative_to", "")
        values = self.numbers(pose, pose.stray, 6)
        if pose.attributes.get("degrees") == "true":
            values[3:] = [math.radians(value) for value in values[3:]]
        matrix = frame(values[:3], roll_pitch_yaw(*values[3:]))
        return matrix, pose.attributes.get("relative_to", "") or pose.attributes.get("frame", "")

    def pose(self, name: str) -> Floats:
        """Return the frame of a link, joint or frame in the model."""
        if name in ("", "__model__", "world"):
            return np.eye(4)
        if name in self._poses:
            return self._poses[name]
        element = self.links.get(name) or self.joints.get(name) or self.frames.get(name)
        if element is None:
            known = [*self.links, *self.joints, *self.frames]
            self.refuse(self.model, f"has no frame {name[:60]!r}{did_you_mean(name, known)}")
            return np.eye(4)
        if name in self._active or len(self._active) > MOST_FRAMES:
            self.refuse(element, f"has a pose relative to itself: {' -> '.join([*self._active, name][-6:])}")
        self._active.append(name)
        matrix, base = self.local_pose(element)
        if not base and element.tag == "joint":
            base = self.text(element, "child")
        elif not base and element.tag == "frame":
            base = element.attributes.get("attached_to", "")
        self._poses[name] = self.pose(base) @ matrix
        self._active.pop()
        return self._poses[name]

    def link_frame(self, name: str) -> Floats:
        """Return the frame of a link in URDF: that of the joint above it."""
        joint = self.above.get(name)
        return self.pose(name) if joint is None else self.pose(joint.attributes.get("name", ""))

    def element(
        self, source: Element, tag: str, attributes: dict[str, str] | None = None, *children: Element
    ) -> Element:
        """Return a new element with the line of its source."""
        return Element(tag, attributes or {}, list(children), line=source.line, place=self.place)

    def origin(self, source: Element, matrix: Floats) -> Element:
        """Return <origin> of a frame."""
        sine = -float(np.clip(matrix[2, 0], -1.0, 1.0))
        if abs(sine) > 1.0 - 1e-12:  # yaw and roll turn about the same axis
            angles = (math.atan2(-matrix[1, 2], matrix[1, 1]), math.asin(sine), 0.0)
        else:
            roll, yaw = math.atan2(matrix[2, 1], matrix[2, 2]), math.atan2(matrix[1, 0], matrix[0, 0])
            angles = (roll, math.asin(sine), yaw)
        rows = {"xyz": " ".join(repr(float(v)) for v in matrix[:3, 3]), "rpy": " ".join(repr(v) for v in angles)}
        return self.element(source, "origin", rows)

    def convert(self) -> SdfConversion:
        """Return the model as URDF."""
        name = self.model.attributes.get("name", "") or "robot"
        root = self.element(self.model, "robot", {"name": name})
        for tag in ("include", "model"):
            for inner in self.model.each(tag):
                self.ignored.append(
                    f"{self.place}:{inner.line}: <{tag}> inside a model is not supported; it is left out"
                )
        for key, link in self.links.items():
            self.link(root, key, link)
        for joint in self.joints.values():
            self.joint(root, joint)
        plugins = self.model.each("plugin")
        if plugins:
            root.children.append(self.element(self.model, "gazebo", {}, *plugins))
        return SdfConversion(root, tuple(self.ignored))

    def link(self, root: Element, name: str, link: Element) -> None:
        """Add a link with its friction and sensors."""
        shift = np.linalg.inv(self.link_frame(name)) @ self.pose(name)
        made = self.element(link, "link", {"name": name})
        inertial = _one(link, "inertial")
        if inertial is not None:
            made.children.append(self.inertial(inertial, shift))
        for tag in ("visual", "collision"):
            for part in link.each(tag):
                geometry = self.geometry(part)
                if geometry is not None:
                    origin = self.origin(part, shift @ self.local_pose(part)[0])
                    row = {"name": part.attributes["name"]} if "name" in part.attributes else {}
                    made.children.append(self.element(part, tag, row, origin, geometry, *self.material(part, tag)))
        root.children.append(made)
        friction = next((_one(item, "surface", "friction", "ode", "mu") for item in link.each("collision")), None)
        if friction is not None and friction.stray:
            value = self.element(friction, "mu1", {"value": friction.stray})
            root.children.append(self.element(link, "gazebo", {"reference": name}, value))
        for sensor in link.each("sensor"):
            copied = self.element(sensor, "sensor", dict(sensor.attributes), *sensor.children)
            root.children.append(self.element(link, "gazebo", {"reference": name}, copied))
            if np.abs(shift - np.eye(4)).max() > 1e-9:
                place = self.origin(sensor, shift @ self.local_pose(sensor)[0]).attributes
                pose = self.element(sensor, "pose")
                pose.stray = f"{place['xyz']} {place['rpy']}"
                copied.children = [pose, *(child for child in copied.children if child.tag != "pose")]

    def inertial(self, source: Element, shift: Floats) -> Element:
        """Return <inertial>."""
        made = self.element(source, "inertial", {}, self.origin(source, shift @ self.local_pose(source)[0]))
        mass = self.number(source, "mass", default=0.0)
        made.children.append(self.element(source, "mass", {"value": repr(mass)}))
        moments = _one(source, "inertia")
        if moments is not None:
            keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
            row = {key: repr(self.number(moments, key, default=0.0)) for key in keys}
            made.children.append(self.element(moments, "inertia", row))
        return made

    def geometry(self, part: Element) -> Element | None:
        """Return <geometry>, or None if the shape is not supported."""
        outer = _one(part, "geometry")
        inner = None if outer is None else next(iter(outer.children), None)
        if outer is None or inner is None:
            self.refuse(part, "needs <geometry> with a shape")
            return None
        keys = {
            "box": ("size",),
            "cylinder": ("radius", "length"),
            "sphere": ("radius",),
            "capsule": ("radius", "length"),
        }
        if inner.tag in keys:
            row = {key: self.text(inner, key) for key in keys[inner.tag] if self.text(inner, key)}
            shape = self.element(inner, inner.tag, row)
        elif inner.tag == "mesh":
            row = {"filename": self.text(inner, "uri")}
            row |= {"scale": self.text(inner, "scale")} if self.text(inner, "scale") else {}
            row |= {"submesh": self.text(inner, "submesh", "name")} if _one(inner, "submesh") else {}
            row |= {"center": "true"} if self.text(inner, "submesh", "center") in ("true", "1") else {}
            shape = self.element(inner, "mesh", row)
        else:
            self.ignored.append(
                f"{self.place}:{inner.line}: the shape <{inner.tag[:40]}> is not supported; it is left out"
            )
            return None
        return self.element(outer, "geometry", {}, shape)

    def material(self, part: Element, tag: str) -> list[Element]:
        """Return <material> of a visual with a colour."""
        color = _one(part, "material", "diffuse") or _one(part, "material", "ambient")
        if tag != "visual" or color is None or len(color.stray.split()) not in (3, 4):
            return []
        text = color.stray if len(color.stray.split()) == 4 else f"{color.stray} 1"
        return [self.element(color, "material", {}, self.element(color, "color", {"rgba": text}))]

    def joint(self, root: Element, joint: Element) -> None:
        """Add a joint; a joint to the world is left out."""
        kind, name = joint.attributes.get("type", ""), joint.attributes.get("name", "")
        parent, child = self.text(joint, "parent"), self.text(joint, "child")
        if kind == "ball":
            kind = "fixed"
            self.ignored.append(
                f"{self.place}:{joint.line}: <joint> {name[:60]!r} is a ball joint, which is not supported; it is"
                " fixed, and a castor on it glides"
            )
        if kind not in JOINTS:
            self.refuse(
                joint, f"{name[:60]!r} type={kind[:40]!r} must be {', '.join(JOINTS)}{did_you_mean(kind, JOINTS)}"
            )
        if parent == "world":
            self.ignored.append(
                f"{self.place}:{joint.line}: <joint> {name[:60]!r} fixes the robot to the world; it is left out"
            )
            return
        place = self.pose(name)
        origin = self.origin(joint, np.linalg.inv(self.link_frame(parent)) @ place)
        ends = [self.element(joint, "parent", {"link": parent}), self.element(joint, "child", {"link": child})]
        axis = _one(joint, "axis")
        low = self.number(axis, "limit", "lower", default=-math.inf) or 0.0
        high = self.number(axis, "limit", "upper", default=math.inf) or 0.0
        if kind == "revolute" and (high > UNLIMITED or low < -UNLIMITED):
            kind = "continuous"
        made = self.element(joint, "joint", {"name": name, "type": kind}, *ends, origin)
        if axis is not None and kind != "fixed":
            made.children += self.axis(joint, axis, place)
            row = {"lower": repr(max(low, -1e6)), "upper": repr(min(high, 1e6))}
            for key in ("effort", "velocity"):
                value = self.number(axis, "limit", key, default=-1.0)
                row |= {key: repr(value)} if value is not None and 0.0 < value < UNLIMITED else {}
            made.children.append(self.element(axis, "limit", row))
        root.children.append(made)

    def axis(self, joint: Element, axis: Element, place: Floats) -> list[Element]:
        """Return <axis> in the frame of the joint, and <dynamics>."""
        inner = _one(axis, "xyz")
        vector = np.array([0.0, 0.0, 1.0] if inner is None else self.numbers(inner, inner.stray, 3))
        base = "" if inner is None else inner.attributes.get("expressed_in", "")
        if base or self.text(axis, "use_parent_model_frame") in ("1", "true"):
            vector = place[:3, :3].T @ self.pose(base)[:3, :3] @ vector
        made: list[Element] = [self.element(axis, "axis", {"xyz": " ".join(repr(float(v)) for v in vector)})]
        row = {key: self.text(axis, "dynamics", key) for key in ("damping", "friction")}
        row = {key: text for key, text in row.items() if text}
        return [*made, self.element(axis, "dynamics", row)] if row else made
