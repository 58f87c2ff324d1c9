"""Trials: simulations as data. Dataclasses, XML, checks, built-in scenarios, placement of people, importers.

Names are loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from .agent import Agent, AgentParameter, Avatar
    from .builtin import load_builtin_trial, load_trial
    from .builtin_names import FLOWS, SIZES, builtin_trials, trial_titles
    from .cameras.camera import OVERVIEW, Camera, overview
    from .cameras.camera_remarks import camera_remarks
    from .crowd import ContactSpec, Crowd, Crowds, Limits, Routing, crowd_names
    from .distribution import Distribution
    from .faults.builtin_faults import (
        BlindSensor,
        FrozenSensor,
        LateSensor,
        LocalizationJump,
        LocalizationOffset,
        LostCommands,
        SlippingWheel,
    )
    from .faults.fault import Fault, FaultSpec, SensorFault, have_same_kinds
    from .fields import UNWRITABLE, attribute, check, children, element_word, outline, quote_value
    from .files.code_references import code_digest, code_references, is_code
    from .files.layout_file import builtin_stages, load_layout
    from .files.stage_maps import MOST_CELLS, is_area_file, map_files
    from .files.trial_files import recording_files, resolve_file
    from .ground.door import Door
    from .ground.elements import UNEVEN, Platform, Ramp, Stairs, Threshold
    from .ground.plan import floor_plan
    from .ground.text_plan import floor_plan_of_xml
    from .importers.dxf import import_dxf
    from .importers.foreign import import_trial
    from .importers.hunavsim import import_hunavsim
    from .importers.original import ImportedTrial, import_original, plan_of, trials_of
    from .importers.original_order import Plan
    from .importers.pedsim import import_pedsim
    from .importers.recording import recorded_trial
    from .importers.umans import import_umans
    from .importers.vadere import import_vadere
    from .journey import Direction, Exit, Journey, Point, Portal, Zone
    from .notation import Points, plain
    from .parser import check_trial, parse_trial
    from .people import Group, SourceSpec, Spawner
    from .placement.appearance import PeopleAppearance, people_appearance, trial_bodies, trial_clips
    from .placement.expansion import expand_spawners
    from .placement.placement_plan import PeopleBatch, PlacementPlan
    from .placement.population import place
    from .placement.spawn_placement import GAP, InitialPeople
    from .props import Cube, Light, Table, Tree
    from .randomized_model import RandomizedModel, own
    from .recorded_people import RecordedPeople
    from .robot import Mount, Planner, RobotGoal, RobotSpec
    from .robots.joint_target import JointTarget, joint_positions
    from .robots.passage import blind_remarks, narrow_passage, passage_remarks
    from .robots.predictor import RobotPredictor
    from .robots.reaction import ReactionSpec, robot_reactions
    from .robots.robot_parts import describe_robot, override_remarks, remarks_at_end, replace_robot, robot_lines
    from .robots.robot_pose import RobotPose
    from .scenarios import PRESETS
    from .scenarios.crowds import DENSITIES
    from .stage import Obstacle, Stage, Wall, area
    from .stage_contract import check_stage
    from .sweep import Sweep
    from .trial import End, EndCondition, RecordingSpec, Trial
    from .validation.model_ranges import MODEL_RANGES, ModelRange, model_range
    from .validation.rates import trial_remarks
    from .validation.trial_checks import robot_place_problem
    from .variants import apply_values, expand_sweeps
    from .xml.element_edit import add_element, needs_trust, remove_element
    from .xml.reader import XmlReader
    from .xml.trial_text import parse_trial_xml, read_trial_bytes
    from .xml.writer import element_from, trial_xml
    from .xml.xsd import schema

__getattr__, __dir__, __all__ = lazy_exports(__name__)
