"""Worlds: what turns commands into the next scene. Contracts :class:`World`, :class:`Drive` and :class:`Stop`."""

from .ackermann import AckermannDrive, SteeredTwists
from .contact import BodyContact
from .drive import DifferentialDrive, Drive, Omnidirectional, Twists, moved
from .flow import Source
from .journey import Journey, Journeys
from .limits import CrowdLimits
from .planar import PlanarWorld
from .portal import Portal
from .robot import Robot, SensorMount, builtin_robots
from .routing import Router
from .script import Script, Track
from .servo import CommandDelay, VelocityServo
from .stop import Direction, Point, Stop, Zone
from .wheel import Wheel
from .world import Contact, World

__all__ = [
    "AckermannDrive",
    "BodyContact",
    "CommandDelay",
    "Contact",
    "CrowdLimits",
    "DifferentialDrive",
    "Direction",
    "Drive",
    "Journey",
    "Journeys",
    "Omnidirectional",
    "PlanarWorld",
    "Point",
    "Portal",
    "Robot",
    "Router",
    "Script",
    "SensorMount",
    "Source",
    "SteeredTwists",
    "Stop",
    "Track",
    "Twists",
    "VelocityServo",
    "Wheel",
    "World",
    "Zone",
    "builtin_robots",
    "moved",
]
