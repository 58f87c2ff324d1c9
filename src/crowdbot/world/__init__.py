"""Worlds: people and robots move together, one time step at a time.

Contracts: :class:`World`, :class:`Drive`, :class:`Stop`. Names are loaded on first use; MuJoCo is loaded when a world
or a renderer needs it.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .crowd.contact import BodyContact
    from .crowd.journey import Journey, Journeys
    from .crowd.limits import CrowdLimits
    from .crowd.portal import Portal
    from .crowd.replay import Script, Track
    from .crowd.routing import Router
    from .crowd.source import Source
    from .crowd.walk import Stepping, Walk, alone, together
    from .crowd.waypoint import Direction, Point, Stop, Zone
    from .physics.body_region_limits import TISSUES, Tissue, permitted_speed, region_of, two_body_force
    from .physics.colliders import bodies
    from .physics.contact_events import BodyForce, Collision
    from .physics.contacts import Party
    from .physics.people_motion import Limbs, Walkers
    from .physics.robot_body import Chassis
    from .physics.stage import Cube, Light, PhysicsStage, Prop, Table, Tree
    from .physics.world import PhysicsWorld
    from .planar import PlanarWorld
    from .rendering.camera import Camera, Images
    from .rendering.renderer import Studio
    from .robots.ackermann import AckermannDrive, SteeredTwists
    from .robots.drive import DifferentialDrive, Drive, Omnidirectional, Twists, moved
    from .robots.mount import SensorMount
    from .robots.robot import Robot, builtin_robots
    from .robots.servo import CommandDelay, Pending, VelocityServo
    from .robots.wheel import Wheel
    from .urdf import RobotModel, described, read_urdf
    from .urdf.transforms import frame, quaternion, roll_pitch_yaw
    from .world import Contact, World

_LAZY = {
    "AckermannDrive": "robots.ackermann",
    "BodyContact": "crowd.contact",
    "BodyForce": "physics.contact_events",
    "Camera": "rendering.camera",
    "Chassis": "physics.robot_body",
    "Collision": "physics.contact_events",
    "CommandDelay": "robots.servo",
    "Contact": "world",
    "CrowdLimits": "crowd.limits",
    "Cube": "physics.stage",
    "DifferentialDrive": "robots.drive",
    "Direction": "crowd.waypoint",
    "Drive": "robots.drive",
    "Images": "rendering.camera",
    "Journey": "crowd.journey",
    "Journeys": "crowd.journey",
    "Light": "physics.stage",
    "Limbs": "physics.people_motion",
    "Omnidirectional": "robots.drive",
    "Party": "physics.contacts",
    "Pending": "robots.servo",
    "PhysicsStage": "physics.stage",
    "PhysicsWorld": "physics.world",
    "PlanarWorld": "planar",
    "Point": "crowd.waypoint",
    "Portal": "crowd.portal",
    "Prop": "physics.stage",
    "Robot": "robots.robot",
    "RobotModel": "urdf",
    "Router": "crowd.routing",
    "Script": "crowd.replay",
    "SensorMount": "robots.mount",
    "Source": "crowd.source",
    "SteeredTwists": "robots.ackermann",
    "Stepping": "crowd.walk",
    "Stop": "crowd.waypoint",
    "Studio": "rendering.renderer",
    "TISSUES": "physics.body_region_limits",
    "Table": "physics.stage",
    "Tissue": "physics.body_region_limits",
    "Track": "crowd.replay",
    "Tree": "physics.stage",
    "Twists": "robots.drive",
    "VelocityServo": "robots.servo",
    "Walk": "crowd.walk",
    "Walkers": "physics.people_motion",
    "Wheel": "robots.wheel",
    "World": "world",
    "Zone": "crowd.waypoint",
    "alone": "crowd.walk",
    "bodies": "physics.colliders",
    "builtin_robots": "robots.robot",
    "described": "urdf",
    "frame": "urdf.transforms",
    "moved": "robots.drive",
    "permitted_speed": "physics.body_region_limits",
    "quaternion": "urdf.transforms",
    "read_urdf": "urdf",
    "region_of": "physics.body_region_limits",
    "roll_pitch_yaw": "urdf.transforms",
    "together": "crowd.walk",
    "two_body_force": "physics.body_region_limits",
}

__all__ = [
    "TISSUES",
    "AckermannDrive",
    "BodyContact",
    "BodyForce",
    "Camera",
    "Chassis",
    "Collision",
    "CommandDelay",
    "Contact",
    "CrowdLimits",
    "Cube",
    "DifferentialDrive",
    "Direction",
    "Drive",
    "Images",
    "Journey",
    "Journeys",
    "Light",
    "Limbs",
    "Omnidirectional",
    "Party",
    "Pending",
    "PhysicsStage",
    "PhysicsWorld",
    "PlanarWorld",
    "Point",
    "Portal",
    "Prop",
    "Robot",
    "RobotModel",
    "Router",
    "Script",
    "SensorMount",
    "Source",
    "SteeredTwists",
    "Stepping",
    "Stop",
    "Studio",
    "Table",
    "Tissue",
    "Track",
    "Tree",
    "Twists",
    "VelocityServo",
    "Walk",
    "Walkers",
    "Wheel",
    "World",
    "Zone",
    "alone",
    "bodies",
    "builtin_robots",
    "described",
    "frame",
    "moved",
    "permitted_speed",
    "quaternion",
    "read_urdf",
    "region_of",
    "roll_pitch_yaw",
    "together",
    "two_body_force",
]


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(importlib.import_module(f"{__name__}.{_LAZY[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *_LAZY])
