"""Worlds: what turns commands into the next scene. Contracts :class:`World`, :class:`Drive` and :class:`Stop`."""

from .contact import BodyContact
from .drive import DifferentialDrive, Drive, Omnidirectional, Twists, moved
from .flow import Source
from .journey import Journey, Journeys
from .limits import CrowdLimits
from .planar import PlanarWorld
from .portal import Portal
from .routing import Router
from .script import Script, Track
from .stop import Direction, Point, Stop, Zone
from .world import Contact, World

__all__ = [
    "BodyContact",
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
    "Router",
    "Script",
    "Source",
    "Stop",
    "Track",
    "Twists",
    "World",
    "Zone",
    "moved",
]
