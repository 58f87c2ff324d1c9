"""Worlds: people and robots move together, one time step at a time.

Contracts: :class:`World`, :class:`Drive`, :class:`Waypoint`. Names are loaded on first use. MuJoCo is loaded when a
world or a renderer needs it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from crowdbot.world.physics.robots.robot_body import RobotBody as RobotBody
    from crowdbot.world.robots.drives.ackermann import AckermannDrive as AckermannDrive
    from crowdbot.world.robots.drives.ackermann import SteeredTwists as SteeredTwists
    from crowdbot.world.robots.drives.ackermann import TricycleDrive as TricycleDrive
    from crowdbot.world.robots.drives.drive import DifferentialDrive as DifferentialDrive
    from crowdbot.world.robots.drives.drive import Drive as Drive
    from crowdbot.world.robots.drives.drive import Omnidirectional as Omnidirectional
    from crowdbot.world.robots.drives.drive import Twists as Twists
    from crowdbot.world.robots.drives.drive import integrate_twist as integrate_twist
    from crowdbot.world.robots.drives.legged import LeggedDrive as LeggedDrive
    from crowdbot.world.robots.drives.servo import CommandDelay as CommandDelay
    from crowdbot.world.robots.drives.servo import Pending as Pending
    from crowdbot.world.robots.drives.servo import VelocityServo as VelocityServo
    from crowdbot.world.robots.drives.skid_steer import SkidSteerDrive as SkidSteerDrive
    from crowdbot.world.robots.drives.wheeled import MecanumDrive as MecanumDrive
    from crowdbot.world.robots.drives.wheeled import OmniWheelDrive as OmniWheelDrive
    from crowdbot.world.robots.drives.wheeled import WheeledDrive as WheeledDrive

    from .behaviors.behavior_tree import BehaviorTree as BehaviorTree
    from .behaviors.behavior_xml import parse_behavior_tree as parse_behavior_tree
    from .building import Building as Building
    from .building import BuildingDoor as BuildingDoor
    from .building import BuildingPart as BuildingPart
    from .building import read_building as read_building
    from .crowd.arrivals import arrival_counts as arrival_counts
    from .crowd.avatars import Avatars as Avatars
    from .crowd.avatars import give_pose as give_pose
    from .crowd.contact import ContactModel as ContactModel
    from .crowd.journey import JourneyAssignment as JourneyAssignment
    from .crowd.journey import WaypointSequence as WaypointSequence
    from .crowd.limits import CrowdLimits as CrowdLimits
    from .crowd.people_flow import environment_seeds as environment_seeds
    from .crowd.portal import Exit as Exit
    from .crowd.portal import Portal as Portal
    from .crowd.replay import ReplayedPeople as ReplayedPeople
    from .crowd.replay import ReplayedTrack as ReplayedTrack
    from .crowd.routing import Router as Router
    from .crowd.source import PeopleSource as PeopleSource
    from .crowd.waypoint import Direction as Direction
    from .crowd.waypoint import Point as Point
    from .crowd.waypoint import Waypoint as Waypoint
    from .crowd.waypoint import Zone as Zone
    from .doors.door import Door as Door
    from .doors.doors import Doors as Doors
    from .ground.ground import Ground as Ground
    from .ground.part import GroundPart as GroundPart
    from .live_changes import add_person as add_person
    from .live_changes import check_goal as check_goal
    from .live_changes import check_place as check_place
    from .live_changes import check_room as check_room
    from .live_changes import move_agent as move_agent
    from .live_changes import next_person as next_person
    from .live_changes import push_person as push_person
    from .live_changes import redirect_person as redirect_person
    from .live_changes import remove_person as remove_person
    from .live_changes import slot_of as slot_of
    from .physics.balance.ability import BalanceAbility as BalanceAbility
    from .physics.balance.ability import balance_ability as balance_ability
    from .physics.balance.ability import maximum_lean as maximum_lean
    from .physics.balance.balance import Balance as Balance
    from .physics.balance.fall import Fall as Fall
    from .physics.body_region_limits import BODY_REGION_LIMITS as BODY_REGION_LIMITS
    from .physics.body_region_limits import BodyRegionLimits as BodyRegionLimits
    from .physics.body_region_limits import permitted_speed as permitted_speed
    from .physics.body_region_limits import region_of as region_of
    from .physics.body_region_limits import two_body_force as two_body_force
    from .physics.colliders import scene_bodies as scene_bodies
    from .physics.contact_events import BodyContactEvent as BodyContactEvent
    from .physics.contact_events import ContactForce as ContactForce
    from .physics.contacts import ContactBody as ContactBody
    from .physics.people_motion import LimbCapsules as LimbCapsules
    from .physics.people_motion import PeopleMotion as PeopleMotion
    from .physics.scenery import add_rings as add_rings
    from .physics.stage import Chair as Chair
    from .physics.stage import Cube as Cube
    from .physics.stage import Light as Light
    from .physics.stage import PhysicsStage as PhysicsStage
    from .physics.stage import PropBody as PropBody
    from .physics.stage import Table as Table
    from .physics.stage import Tree as Tree
    from .physics.world import PhysicsWorld as PhysicsWorld
    from .planar import PlanarWorld as PlanarWorld
    from .reactions.reaction import ALWAYS_IN_FORCE as ALWAYS_IN_FORCE
    from .reactions.reaction import REACTIONS as REACTIONS
    from .reactions.reaction import RobotReaction as RobotReaction
    from .reactions.robot_reactions import GESTURE as GESTURE
    from .reactions.robot_reactions import RobotReactions as RobotReactions
    from .reactions.robot_reactions import gesture_codes as gesture_codes
    from .reactions.robot_reactions import people_by_gesture as people_by_gesture
    from .reactions.robot_reactions import people_by_reaction as people_by_reaction
    from .reactions.robot_reactions import reaction_codes as reaction_codes
    from .rendering.camera import CameraImages as CameraImages
    from .rendering.camera import SceneCamera as SceneCamera
    from .rendering.gl_context import graphics_library as graphics_library
    from .rendering.renderer import Renderer as Renderer
    from .robot_contract import DriveTest as DriveTest
    from .robot_contract import check_robot as check_robot
    from .robot_contract import drive_tests as drive_tests
    from .robots.guess_table import Guess as Guess
    from .robots.joint_motion import check_joint as check_joint
    from .robots.joint_motion import free_joints as free_joints
    from .robots.mount import MountPlacement as MountPlacement
    from .robots.mount import SensorMount as SensorMount
    from .robots.robot import Robot as Robot
    from .robots.robot import builtin_robots as builtin_robots
    from .robots.robot_description import robot_description as robot_description
    from .robots.robot_import import RobotFolder as RobotFolder
    from .robots.robot_import import import_robot as import_robot
    from .robots.wheel import Wheel as Wheel
    from .robots.wheel_encoders import joint_states as joint_states
    from .robots.wheel_encoders import simulated_body as simulated_body
    from .robots.wheel_encoders import wheel_geometry as wheel_geometry
    from .robots.wheel_encoders import wheel_rotation as wheel_rotation
    from .stage_appearance import FLOORS as FLOORS
    from .stage_appearance import RANDOM as RANDOM
    from .stage_appearance import SKIES as SKIES
    from .stage_appearance import WALL_SURFACES as WALL_SURFACES
    from .stage_appearance import Appearance as Appearance
    from .urdf import RobotModel as RobotModel
    from .urdf import Submesh as Submesh
    from .urdf import describe as describe
    from .urdf import read_mesh as read_mesh
    from .urdf import read_urdf as read_urdf
    from .urdf.link_surface import LinkSurface as LinkSurface
    from .urdf.link_surface import link_surface as link_surface
    from .urdf.transforms import frame as frame
    from .urdf.transforms import quaternion as quaternion
    from .urdf.transforms import roll_pitch_yaw as roll_pitch_yaw
    from .world import Contact as Contact
    from .world import World as World
    from .world_batch import join_worlds as join_worlds
    from .world_batch import put_environments as put_environments
    from .world_batch import select_environments as select_environments
    from .world_batch import step_environments as step_environments
    from .world_batch import worlds_of as worlds_of

__getattr__, __dir__, __all__ = lazy_exports(__name__)
