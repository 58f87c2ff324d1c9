"""Worlds: people and robots move together, one time step at a time.

Contracts: :class:`World`, :class:`Drive`, :class:`Waypoint`. Names are loaded on first use. MuJoCo is loaded when a
world or a renderer needs it.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from crowdbot.world.physics.robots.robot_body import RobotBody
    from crowdbot.world.robots.drives.ackermann import AckermannDrive, SteeredTwists
    from crowdbot.world.robots.drives.drive import DifferentialDrive, Drive, Omnidirectional, Twists, integrate_twist
    from crowdbot.world.robots.drives.legged import LeggedDrive
    from crowdbot.world.robots.drives.mecanum import MecanumDrive
    from crowdbot.world.robots.drives.omni_wheels import OmniWheelDrive
    from crowdbot.world.robots.drives.servo import CommandDelay, Pending, VelocityServo
    from crowdbot.world.robots.drives.skid_steer import SkidSteerDrive
    from crowdbot.world.robots.drives.tricycle import TricycleDrive
    from crowdbot.world.robots.drives.wheeled import WheeledDrive

    from .buildings.building import Building, BuildingDoor, BuildingPart, read_building
    from .crowd.arrivals import arrival_counts
    from .crowd.avatars import Avatars, give_pose
    from .crowd.contact import ContactModel
    from .crowd.journey import JourneyAssignment, WaypointSequence
    from .crowd.limits import CrowdLimits
    from .crowd.people_flow import environment_seeds
    from .crowd.portal import PortalTransfer
    from .crowd.replay import ReplayedPeople, ReplayedTrack
    from .crowd.routing import Router
    from .crowd.source import PeopleSource
    from .crowd.waypoint import HeadingWaypoint, PointWaypoint, PolygonZone, Waypoint
    from .doors.doors import Doors
    from .doors.leaf import DoorLeaf
    from .doors.motion import show_doors
    from .ground.ground import Ground
    from .ground.part import GroundPart
    from .live_changes import (
        add_person,
        check_goal,
        check_place,
        check_room,
        move_agent,
        next_person,
        push_person,
        redirect_person,
        remove_person,
        slot_of,
    )
    from .physics.balance.ability import BalanceAbility, balance_ability, maximum_lean
    from .physics.balance.balance import Balance
    from .physics.balance.fall import Fall
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
    from .physics.scenery import add_rings
    from .physics.stage import CubeBody, LightSource, PhysicsStage, PropBody, TableBody, TreeBody
    from .physics.world import PhysicsWorld
    from .planar import PlanarWorld
    from .planar_environments import planar_world
    from .planar_live_changes import widen
    from .reactions.reaction import REACTIONS, RobotReaction
    from .reactions.robot_reactions import RobotReactions, people_by_reaction, reaction_codes
    from .rendering.camera import CameraImages, SceneCamera
    from .rendering.gl_context import graphics_library
    from .rendering.renderer import Renderer
    from .robot_contract import DriveTest, check_robot, drive_tests
    from .robots.guess_table import Guess
    from .robots.joint_motion import check_joint, free_joints, move_joint
    from .robots.mount import MountPlacement, SensorMount
    from .robots.robot import Robot, builtin_robots
    from .robots.robot_description import robot_description
    from .robots.robot_import import RobotFolder, import_robot
    from .robots.wheel import Wheel
    from .robots.wheel_encoders import joint_states, simulated_body, wheel_geometry, wheel_rotation
    from .stage_appearance import FLOORS, RANDOM, SKIES, WALL_SURFACES, StageAppearance
    from .urdf import RobotModel, describe, read_mesh, read_urdf
    from .urdf.link_surface import LinkSurface, link_surface
    from .urdf.transforms import frame, quaternion, roll_pitch_yaw
    from .world import Contact, World
    from .world_batch import join_worlds, put_environments, select_environments, step_environments, worlds_of

_LAZY = {
    "AckermannDrive": "robots.drives.ackermann",
    "Avatars": "crowd.avatars",
    "BODY_REGION_LIMITS": "physics.body_region_limits",
    "Balance": "physics.balance.balance",
    "BalanceAbility": "physics.balance.ability",
    "BodyContactEvent": "physics.contact_events",
    "BodyRegionLimits": "physics.body_region_limits",
    "CameraImages": "rendering.camera",
    "CommandDelay": "robots.drives.servo",
    "Contact": "world",
    "ContactBody": "physics.contacts",
    "ContactForce": "physics.contact_events",
    "ContactModel": "crowd.contact",
    "CrowdLimits": "crowd.limits",
    "CubeBody": "physics.stage",
    "DifferentialDrive": "robots.drives.drive",
    "DoorLeaf": "doors.leaf",
    "Doors": "doors.doors",
    "Drive": "robots.drives.drive",
    "Ground": "ground.ground",
    "GroundPart": "ground.part",
    "Guess": "robots.guess_table",
    "HeadingWaypoint": "crowd.waypoint",
    "JourneyAssignment": "crowd.journey",
    "LeggedDrive": "robots.drives.legged",
    "Building": "buildings.building",
    "BuildingDoor": "buildings.building",
    "BuildingPart": "buildings.building",
    "read_building": "buildings.building",
    "FLOORS": "stage_appearance",
    "RANDOM": "stage_appearance",
    "SKIES": "stage_appearance",
    "StageAppearance": "stage_appearance",
    "WALL_SURFACES": "stage_appearance",
    "LightSource": "physics.stage",
    "LimbCapsules": "physics.people_motion",
    "LinkSurface": "urdf.link_surface",
    "MecanumDrive": "robots.drives.mecanum",
    "MountPlacement": "robots.mount",
    "OmniWheelDrive": "robots.drives.omni_wheels",
    "Omnidirectional": "robots.drives.drive",
    "Pending": "robots.drives.servo",
    "PeopleMotion": "physics.people_motion",
    "PeopleSource": "crowd.source",
    "PhysicsStage": "physics.stage",
    "PhysicsWorld": "physics.world",
    "PlanarWorld": "planar",
    "PointWaypoint": "crowd.waypoint",
    "PolygonZone": "crowd.waypoint",
    "PortalTransfer": "crowd.portal",
    "PropBody": "physics.stage",
    "REACTIONS": "reactions.reaction",
    "Renderer": "rendering.renderer",
    "graphics_library": "rendering.gl_context",
    "ReplayedPeople": "crowd.replay",
    "ReplayedTrack": "crowd.replay",
    "Robot": "robots.robot",
    "RobotBody": "physics.robots.robot_body",
    "RobotFolder": "robots.robot_import",
    "RobotModel": "urdf",
    "RobotReaction": "reactions.reaction",
    "RobotReactions": "reactions.robot_reactions",
    "Router": "crowd.routing",
    "SceneCamera": "rendering.camera",
    "SensorMount": "robots.mount",
    "SkidSteerDrive": "robots.drives.skid_steer",
    "SteeredTwists": "robots.drives.ackermann",
    "TableBody": "physics.stage",
    "TreeBody": "physics.stage",
    "TricycleDrive": "robots.drives.tricycle",
    "Twists": "robots.drives.drive",
    "VelocityServo": "robots.drives.servo",
    "Waypoint": "crowd.waypoint",
    "WaypointSequence": "crowd.journey",
    "Wheel": "robots.wheel",
    "WheeledDrive": "robots.drives.wheeled",
    "World": "world",
    "add_person": "live_changes",
    "add_rings": "physics.scenery",
    "arrival_counts": "crowd.arrivals",
    "balance_ability": "physics.balance.ability",
    "builtin_robots": "robots.robot",
    "check_goal": "live_changes",
    "check_joint": "robots.joint_motion",
    "check_place": "live_changes",
    "check_room": "live_changes",
    "check_robot": "robot_contract",
    "describe": "urdf",
    "drive_tests": "robot_contract",
    "DriveTest": "robot_contract",
    "environment_seeds": "crowd.people_flow",
    "frame": "urdf.transforms",
    "Fall": "physics.balance.fall",
    "free_joints": "robots.joint_motion",
    "give_pose": "crowd.avatars",
    "import_robot": "robots.robot_import",
    "integrate_twist": "robots.drives.drive",
    "join_worlds": "world_batch",
    "joint_states": "robots.wheel_encoders",
    "link_surface": "urdf.link_surface",
    "maximum_lean": "physics.balance.ability",
    "move_agent": "live_changes",
    "next_person": "live_changes",
    "move_joint": "robots.joint_motion",
    "people_by_reaction": "reactions.robot_reactions",
    "permitted_speed": "physics.body_region_limits",
    "planar_world": "planar_environments",
    "put_environments": "world_batch",
    "quaternion": "urdf.transforms",
    "reaction_codes": "reactions.robot_reactions",
    "read_mesh": "urdf",
    "read_urdf": "urdf",
    "push_person": "live_changes",
    "redirect_person": "live_changes",
    "region_of": "physics.body_region_limits",
    "remove_person": "live_changes",
    "robot_description": "robots.robot_description",
    "roll_pitch_yaw": "urdf.transforms",
    "scene_bodies": "physics.colliders",
    "select_environments": "world_batch",
    "show_doors": "doors.motion",
    "simulated_body": "robots.wheel_encoders",
    "slot_of": "live_changes",
    "step_environments": "world_batch",
    "two_body_force": "physics.body_region_limits",
    "wheel_geometry": "robots.wheel_encoders",
    "wheel_rotation": "robots.wheel_encoders",
    "widen": "planar_live_changes",
    "worlds_of": "world_batch",
}

__all__ = [
    "BODY_REGION_LIMITS",
    "FLOORS",
    "RANDOM",
    "REACTIONS",
    "SKIES",
    "WALL_SURFACES",
    "AckermannDrive",
    "Avatars",
    "Balance",
    "BalanceAbility",
    "BodyContactEvent",
    "BodyRegionLimits",
    "Building",
    "BuildingDoor",
    "BuildingPart",
    "CameraImages",
    "CommandDelay",
    "Contact",
    "ContactBody",
    "ContactForce",
    "ContactModel",
    "CrowdLimits",
    "CubeBody",
    "DifferentialDrive",
    "DoorLeaf",
    "Doors",
    "Drive",
    "DriveTest",
    "Fall",
    "Ground",
    "GroundPart",
    "Guess",
    "HeadingWaypoint",
    "JourneyAssignment",
    "LeggedDrive",
    "LightSource",
    "LimbCapsules",
    "LinkSurface",
    "MecanumDrive",
    "MountPlacement",
    "OmniWheelDrive",
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
    "RobotFolder",
    "RobotModel",
    "RobotReaction",
    "RobotReactions",
    "Router",
    "SceneCamera",
    "SensorMount",
    "SkidSteerDrive",
    "StageAppearance",
    "SteeredTwists",
    "TableBody",
    "TreeBody",
    "TricycleDrive",
    "Twists",
    "VelocityServo",
    "Waypoint",
    "WaypointSequence",
    "Wheel",
    "WheeledDrive",
    "World",
    "add_person",
    "add_rings",
    "arrival_counts",
    "balance_ability",
    "builtin_robots",
    "check_goal",
    "check_joint",
    "check_place",
    "check_robot",
    "check_room",
    "describe",
    "drive_tests",
    "environment_seeds",
    "frame",
    "free_joints",
    "give_pose",
    "graphics_library",
    "import_robot",
    "integrate_twist",
    "join_worlds",
    "joint_states",
    "link_surface",
    "maximum_lean",
    "move_agent",
    "move_joint",
    "next_person",
    "people_by_reaction",
    "permitted_speed",
    "planar_world",
    "push_person",
    "put_environments",
    "quaternion",
    "reaction_codes",
    "read_building",
    "read_mesh",
    "read_urdf",
    "redirect_person",
    "region_of",
    "remove_person",
    "robot_description",
    "roll_pitch_yaw",
    "scene_bodies",
    "select_environments",
    "show_doors",
    "simulated_body",
    "slot_of",
    "step_environments",
    "two_body_force",
    "wheel_geometry",
    "wheel_rotation",
    "widen",
    "worlds_of",
]


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(importlib.import_module(f"{__name__}.{_LAZY[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *_LAZY])
