"""Worlds: people and robots move together, one time step at a time.

Contracts: :class:`World`, :class:`Drive`, :class:`Waypoint`. Names are loaded on first use. MuJoCo is loaded when a
world or a renderer needs it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from crowdbot.world.physics.robots.robot_body import RobotBody
    from crowdbot.world.robots.drives.ackermann import AckermannDrive, SteeredTwists, TricycleDrive
    from crowdbot.world.robots.drives.drive import DifferentialDrive, Drive, Omnidirectional, Twists, integrate_twist
    from crowdbot.world.robots.drives.legged import LeggedDrive
    from crowdbot.world.robots.drives.servo import CommandDelay, Pending, VelocityServo
    from crowdbot.world.robots.drives.skid_steer import SkidSteerDrive
    from crowdbot.world.robots.drives.wheeled import MecanumDrive, OmniWheelDrive, WheeledDrive

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

__getattr__, __dir__, __all__ = lazy_exports(__name__)
