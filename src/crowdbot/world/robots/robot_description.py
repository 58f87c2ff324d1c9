"""The URDF text of a robot."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import Element, format_xml
from crowdbot.typing import Floats
from crowdbot.world.urdf import Box, Cylinder, Joint, Link, LinkShape, Mesh, RobotModel, Sphere
from crowdbot.world.urdf.shapes import Shape

if TYPE_CHECKING:
    from .robot import Robot


def robot_description(robot: Robot) -> str:
    """Return the URDF of a robot, as on the topic ``robot_description`` of ROS.

    It is the text of its file, with xacro and SDF converted; names of meshes are those of the file. A robot that was
    made without a file is written from its links and joints.

    >>> from crowdbot.world import DifferentialDrive, Robot, read_urdf
    >>> puck = Robot.disc("puck", DifferentialDrive(), 0.3, mass=20.0)
    >>> read_urdf(robot_description(puck)).mass
    20.0
    """
    model = robot.model
    return model.source or format_xml(_model(model))


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
