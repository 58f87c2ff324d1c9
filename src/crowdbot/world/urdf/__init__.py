"""URDF robots: parsing, repair, checks and conversion to MJCF."""

from .folders import robot_folder
from .inertia import replacement_shape
from .meshes import Submesh, read_mesh, with_pieces
from .mjcf import BaseServo, Mjcf, mjcf
from .model import JOINT_KINDS, Joint, Link, LinkInertia, LinkShape, Mimic, Motor, Remark, RobotModel
from .reading import read_urdf
from .report import describe
from .robot_document import RobotDocument, parse_robot_file
from .shapes import Box, Capsule, ConvexPiece, Cylinder, Mesh, Sphere

__all__ = [
    "JOINT_KINDS",
    "BaseServo",
    "Box",
    "Capsule",
    "ConvexPiece",
    "Cylinder",
    "Joint",
    "Link",
    "LinkInertia",
    "LinkShape",
    "Mesh",
    "Mimic",
    "Mjcf",
    "Motor",
    "Remark",
    "RobotDocument",
    "RobotModel",
    "Sphere",
    "Submesh",
    "describe",
    "mjcf",
    "parse_robot_file",
    "read_mesh",
    "read_urdf",
    "replacement_shape",
    "robot_folder",
    "with_pieces",
]
