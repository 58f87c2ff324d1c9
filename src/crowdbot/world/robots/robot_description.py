"""The URDF text of a robot."""

from __future__ import annotations

import copy
import dataclasses
import math
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from crowdbot.core import Element, format_xml
from crowdbot.typing import Floats
from crowdbot.world.urdf import Box, Cylinder, Joint, Link, LinkShape, Mesh, RobotModel, Sphere
from crowdbot.world.urdf.shapes import Shape
from crowdbot.world.urdf.transforms import roll_pitch_yaw

if TYPE_CHECKING:
    from .robot import Robot


def robot_description(robot: Robot) -> str:
    """Return the URDF of a robot, as on the topic ``robot_description`` of ROS.

    It is the text of its file, with xacro and SDF converted; names of meshes are those of the file. URDF has no
    capsules: each becomes a cylinder with a sphere at each end, or RViz and others would leave it out. A robot that was
    made without a file is written from its links and joints.

    >>> from crowdbot.world import DifferentialDrive, Robot, read_urdf
    >>> puck = Robot.disc("puck", DifferentialDrive(), 0.3, mass=20.0)
    >>> read_urdf(robot_description(puck)).mass
    20.0
    """
    model = robot.model
    text = model.source or format_xml(_model(model))
    return _without_capsules(text) if "<capsule" in text else text


def _without_capsules(text: str) -> str:
    """Return the text of a robot whose capsules are cylinders with spheres at their ends."""
    root = ElementTree.fromstring(text)  # noqa: S314, a file that read_urdf has accepted has no entities
    for link in root.iter("link"):
        for part in [item for item in link if item.tag in ("visual", "collision")]:
            capsule = part.find("geometry/capsule")
            if capsule is None:
                continue
            capsule.tag, length = "cylinder", float(capsule.get("length", "nan"))
            place, turn = _origin_of(part)
            for number, end in enumerate((length / 2.0, -length / 2.0), list(link).index(part) + 1):
                ball = ElementTree.Element(part.tag)  # without the name of the part, which is unique
                ElementTree.SubElement(ball, "origin", {"xyz": _row(place + end * turn[:, 2]), "rpy": "0 0 0"})
                shape = ElementTree.SubElement(ball, "geometry")
                ElementTree.SubElement(shape, "sphere", {"radius": capsule.get("radius", "")})
                ball.extend(copy.deepcopy(item) for item in part if item.tag not in ("origin", "geometry"))
                link.insert(number, ball)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _origin_of(part: ElementTree.Element) -> tuple[Floats, Floats]:
    """Return position [m] and rotation matrix of a part in its link."""
    origin = part.find("origin")
    rows = {} if origin is None else {key: np.array(value.split(), dtype=np.float64) for key, value in origin.items()}
    return rows.get("xyz", np.zeros(3)), roll_pitch_yaw(*rows.get("rpy", np.zeros(3)))


def _model(model: RobotModel) -> Element:
    rows = [_link(link) for link in model.links.values()] + [_joint(joint) for joint in model.joints.values()]
    return Element("robot", {"name": model.name}, rows)


def _link(link: Link) -> Element:
    rows = []
    if link.inertial is not None:
        tensor = link.inertial.tensor
        names = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
        moments = {name: repr(float(tensor[place])) for name, place in names.items()}
        center = Element("origin", {"xyz": _row(link.inertial.center), "rpy": "0 0 0"})
        mass = Element("mass", {"value": repr(float(link.inertial.mass))})
        rows.append(Element("inertial", {}, [center, mass, Element("inertia", moments)]))
    rows += [_shape("visual", part) for part in link.visuals]
    rows += [_shape("collision", part) for part in link.collisions]
    return Element("link", {"name": link.name}, rows)


def _shape(tag: str, part: LinkShape) -> Element:
    rows = [_origin(part.origin), Element("geometry", {}, [_geometry(part.shape)])]
    if tag == "visual" and part.color is not None:
        rows.append(Element("material", {"name": ""}, [Element("color", {"rgba": _row(part.color)})]))
    return Element(tag, {"name": part.name} if part.name else {}, rows)


def _geometry(shape: Shape) -> Element:
    if isinstance(shape, Mesh):
        return Element("mesh", {"filename": shape.source})
    if isinstance(shape, Box):
        return Element("box", {"size": _row(shape.size)})
    if isinstance(shape, Sphere):
        return Element("sphere", {"radius": repr(float(shape.radius))})
    values = {"radius": repr(float(shape.radius)), "length": repr(float(shape.length))}
    return Element("cylinder" if isinstance(shape, Cylinder) else "capsule", values)


def _joint(joint: Joint) -> Element:
    rows = [_origin(joint.origin), Element("parent", {"link": joint.parent}), Element("child", {"link": joint.child})]
    rows.append(Element("axis", {"xyz": _row(joint.axis)}))
    limits = {
        "lower": joint.lower,
        "upper": joint.upper,
        "effort": joint.motor.effort,
        "velocity": joint.motor.velocity,
    }
    finite = {name: repr(float(value)) for name, value in limits.items() if math.isfinite(value)}
    if finite and joint.kind in ("revolute", "prismatic"):
        rows.append(Element("limit", {"effort": "1000.0", "velocity": "1000.0", **finite}))
    if joint.damping or joint.friction:
        rows.append(Element("dynamics", {"damping": repr(joint.damping), "friction": repr(joint.friction)}))
    if joint.mimic is not None:
        rows.append(Element("mimic", {name: str(value) for name, value in dataclasses.asdict(joint.mimic).items()}))
    return Element("joint", {"name": joint.name, "type": joint.kind}, rows)


def _origin(matrix: Floats) -> Element:
    pitch = math.atan2(-matrix[2, 0], math.hypot(matrix[0, 0], matrix[1, 0]))
    roll, yaw = math.atan2(matrix[2, 1], matrix[2, 2]), math.atan2(matrix[1, 0], matrix[0, 0])
    return Element("origin", {"xyz": _row(matrix[:3, 3]), "rpy": _row((roll, pitch, yaw))})


def _row(values: object) -> str:
    return " ".join(repr(float(value)) for value in np.asarray(values).tolist())
