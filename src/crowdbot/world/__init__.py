"""Worlds: people and robots move together, one time step at a time.

Contracts: :class:`World`, :class:`Drive`, :class:`Waypoint`. Names are loaded on first use. MuJoCo is loaded when a
world or a renderer needs it.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .crowd.contact import ContactModel
    from .crowd.journey import JourneyAssignment, WaypointSequence
    from .crowd.limits import CrowdLimits
    from .crowd.portal import PortalTransfer
    from .crowd.replay import ReplayedPeople, ReplayedTrack
    from .crowd.routing import Router
    from .crowd.source import PeopleSource
    from .crowd.walk import CrowdStepRequest, StepGenerator, compute_together, run_step
    from .crowd.waypoint import HeadingWaypoint, PointWaypoint, PolygonZone, Waypoint
    from .physics.body_region_limits import (
        BODY_REGION_LIMITS,
        BodyRegionLimits,
        permitted_speed,
        region_of,
        two_body_force,
    )
    from .physics.colliders import scene_bodies
    from .physics.contact_events import BodyContactEvent, ContactForce
    from .physics.contacts import ContactBody
    from .physics.people_motion import LimbCapsules, PeopleMotion
    from .physics.robot_body import RobotBody
    from .physics.stage import CubeBody, LightSource, PhysicsStage, PropBody, TableBody, TreeBody
    from .physics.world import PhysicsWorld
    from .planar import PlanarWorld
    from .rendering.camera import CameraImages, SceneCamera
    from .rendering.renderer import Renderer
    from .robot_contract import check_robot
    from .robots.ackermann import AckermannDrive, SteeredTwists
    from .robots.drive import DifferentialDrive, Drive, Omnidirectional, Twists, integrate_twist
    from .robots.mount import MountPlacement, SensorMount
    from .robots.robot import Robot, builtin_robots
    from .robots.servo import CommandDelay, Pending, VelocityServo
    from .robots.wheel import Wheel
    from .urdf import RobotModel, describe, read_urdf
    from .urdf.transforms import frame, quaternion, roll_pitch_yaw
    from .world import Contact, World

_LAZY = {
    "AckermannDrive": "robots.ackermann",
    "BODY_REGION_LIMITS": "physics.body_region_limits",
    "BodyContactEvent": "physics.contact_events",
    "BodyRegionLimits": "physics.body_region_limits",
    "CameraImages": "rendering.camera",
    "CommandDelay": "robots.servo",
    "Contact": "world",
    "ContactBody": "physics.contacts",
    "ContactForce": "physics.contact_events",
    "ContactModel": "crowd.contact",
    "CrowdLimits": "crowd.limits",
    "CrowdStepRequest": "crowd.walk",
    "CubeBody": "physics.stage",
    "DifferentialDrive": "robots.drive",
    "Drive": "robots.drive",
    "HeadingWaypoint": "crowd.waypoint",
    "JourneyAssignment": "crowd.journey",
    "LightSource": "physics.stage",
    "LimbCapsules": "physics.people_motion",
    "MountPlacement": "robots.mount",
    "Omnidirectional": "robots.drive",
    "Pending": "robots.servo",
    "PeopleMotion": "physics.people_motion",
    "PeopleSource": "crowd.source",
    "PhysicsStage": "physics.stage",
    "PhysicsWorld": "physics.world",
    "PlanarWorld": "planar",
    "PointWaypoint": "crowd.waypoint",
    "PolygonZone": "crowd.waypoint",
    "PortalTransfer": "crowd.portal",
    "PropBody": "physics.stage",
    "Renderer": "rendering.renderer",
    "ReplayedPeople": "crowd.replay",
    "ReplayedTrack": "crowd.replay",
    "Robot": "robots.robot",
    "RobotBody": "physics.robot_body",
    "RobotModel": "urdf",
    "Router": "crowd.routing",
    "SceneCamera": "rendering.camera",
    "SensorMount": "robots.mount",
    "SteeredTwists": "robots.ackermann",
    "StepGenerator": "crowd.walk",
    "TableBody": "physics.stage",
    "TreeBody": "physics.stage",
    "Twists": "robots.drive",
    "VelocityServo": "robots.servo",
    "Waypoint": "crowd.waypoint",
    "WaypointSequence": "crowd.journey",
    "Wheel": "robots.wheel",
    "World": "world",
    "builtin_robots": "robots.robot",
    "check_robot": "robot_contract",
    "compute_together": "crowd.walk",
    "describe": "urdf",
    "frame": "urdf.transforms",
    "integrate_twist": "robots.drive",
    "permitted_speed": "physics.body_region_limits",
    "quaternion": "urdf.transforms",
    "read_urdf": "urdf",
    "region_of": "physics.body_region_limits",
    "roll_pitch_yaw": "urdf.transforms",
    "run_step": "crowd.walk",
    "scene_bodies": "physics.colliders",
    "two_body_force": "physics.body_region_limits",
}

__all__ = [
    "BODY_REGION_LIMITS",
    "AckermannDrive",
    "BodyContactEvent",
    "BodyRegionLimits",
    "CameraImages",
    "CommandDelay",
    "Contact",
    "ContactBody",
    "ContactForce",
    "ContactModel",
    "CrowdLimits",
    "CrowdStepRequest",
    "CubeBody",
    "DifferentialDrive",
    "Drive",
    "HeadingWaypoint",
    "JourneyAssignment",
    "LightSource",
    "LimbCapsules",
    "MountPlacement",
    "Omnidirectional",
    "Pending",
    "PeopleMotion",
    "PeopleSource",
    "PhysicsStage",
    "PhysicsWorld",
    "PlanarWorld",
    "PointWaypoint",
    "PolygonZone",
    "PortalTransfer",
    "PropBody",
    "Renderer",
    "ReplayedPeople",
    "ReplayedTrack",
    "Robot",
    "RobotBody",
    "RobotModel",
    "Router",
    "SceneCamera",
    "SensorMount",
    "SteeredTwists",
    "StepGenerator",
    "TableBody",
    "TreeBody",
    "Twists",
    "VelocityServo",
    "Waypoint",
    "WaypointSequence",
    "Wheel",
    "World",
    "builtin_robots",
    "check_robot",
    "compute_together",
    "describe",
    "frame",
    "integrate_twist",
    "permitted_speed",
    "quaternion",
    "read_urdf",
    "region_of",
    "roll_pitch_yaw",
    "run_step",
    "scene_bodies",
    "two_body_force",
]


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(importlib.import_module(f"{__name__}.{_LAZY[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *_LAZY])
