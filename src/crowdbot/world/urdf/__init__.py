"""Robots from URDF: what is read, cured and refused before anything else sees it."""

from .folders import robot_folder
from .meshes import with_pieces
from .mjcf import BaseServo, Mjcf, mjcf
from .model import JOINT_KINDS, Inertial, Joint, Link, Mimic, Motor, Part, Remark, RobotModel
from .reading import read_urdf
from .report import described
from .shapes import Box, Capsule, Cylinder, Mesh, Piece, Sphere

__all__ = [
    "JOINT_KINDS",
    "BaseServo",
    "Box",
    "Capsule",
    "Cylinder",
    "Inertial",
    "Joint",
    "Link",
    "Mesh",
    "Mimic",
    "Mjcf",
    "Motor",
    "Part",
    "Piece",
    "Remark",
    "RobotModel",
    "Sphere",
    "described",
    "mjcf",
    "read_urdf",
    "robot_folder",
    "with_pieces",
]
