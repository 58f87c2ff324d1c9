"""Navigators steer a robot. Contract: :class:`Navigator`; input: :class:`Observation`; output: :class:`Action`."""

from .action import Action
from .contract import check_navigator
from .decision_thread import HungNavigatorError, call_within
from .decisions import Decisions
from .dynamic_window import WindowCosts, dynamic_window_twist
from .external import ExternalNavigator
from .follower import FollowerNavigator
from .links.external_stack import Ros2Navigator, RosbridgeNavigator
from .links.real_robot import RealRobotNavigator
from .navigator import Navigator, copy_memory
from .observation import DISC, DriveLimits, Observation, VisiblePeople
from .observation_batch import AgentsInView, ObservationBatch
from .orca import ORCANavigator
from .path_planner import PathPlanner, Waypoints
from .planners.attention_policy import (
    ATTENTION_LAYERS,
    FACING_VALUES,
    MOST_ATTENDED,
    WALL_DIRECTIONS,
    AttentionInputs,
    AttentionPolicyNavigator,
    AttentionWeights,
    attention_inputs,
)
from .planners.driving_support import RDSNavigator
from .planners.elastic_band import TimeElasticBandNavigator
from .planners.learned_policy import PolicyInputs, PolicyNavigator, goal_frame_twists, policy_inputs
from .planners.model_predictive import MPCNavigator
from .planners.path_integral import MPPINavigator
from .planners.policy_kernels import OWN_VALUES, PERSON_VALUES
from .planners.policy_weights import LAYERS, PolicyWeights, policy_file
from .planners.potential_field import PotentialFieldNavigator
from .planners.predicted_occupancy import PredictedOccupancyNavigator
from .planners.recurrent_policy import (
    BODY_VALUES,
    WINDOW_STEPS,
    WINDOW_VALUES,
    RecurrentInputs,
    RecurrentPolicyNavigator,
    RecurrentWeights,
    empty_memory,
    recurrent_inputs,
    remember,
    with_memory,
)
from .planners.scan_policy import (
    SCAN_CHANNELS,
    SCAN_LAGS,
    SCAN_LAYERS,
    SCAN_SECTORS,
    SCAN_STRIDES,
    SCAN_VALUES,
    ScanInputs,
    ScanPolicyNavigator,
    ScanPolicyWeights,
    drive_twist,
    remember_scan,
    scan_inputs,
)
from .planners.social_force import SocialForceNavigator
from .planners.window_navigator import DynamicWindowNavigator
from .process.process_navigator import ProcessNavigator
from .sinusoid import SinusoidNavigator
from .straight import Straight
from .track_batch import TrackBatch
from .track_history import TrackHistory
from .wrappers.gesture_layer import GestureLayer
from .wrappers.safety_layer import SafetyLayer, SafetyState
from .wrappers.scan_map import ScanMapNavigator

__all__ = [
    "ATTENTION_LAYERS",
    "BODY_VALUES",
    "DISC",
    "FACING_VALUES",
    "LAYERS",
    "MOST_ATTENDED",
    "OWN_VALUES",
    "PERSON_VALUES",
    "SCAN_CHANNELS",
    "SCAN_LAGS",
    "SCAN_LAYERS",
    "SCAN_SECTORS",
    "SCAN_STRIDES",
    "SCAN_VALUES",
    "WALL_DIRECTIONS",
    "WINDOW_STEPS",
    "WINDOW_VALUES",
    "Action",
    "AgentsInView",
    "AttentionInputs",
    "AttentionPolicyNavigator",
    "AttentionWeights",
    "Decisions",
    "DriveLimits",
    "DynamicWindowNavigator",
    "ExternalNavigator",
    "FollowerNavigator",
    "GestureLayer",
    "HungNavigatorError",
    "MPCNavigator",
    "MPPINavigator",
    "Navigator",
    "ORCANavigator",
    "Observation",
    "ObservationBatch",
    "PathPlanner",
    "PolicyInputs",
    "PolicyNavigator",
    "PolicyWeights",
    "PotentialFieldNavigator",
    "PredictedOccupancyNavigator",
    "ProcessNavigator",
    "RDSNavigator",
    "RealRobotNavigator",
    "RecurrentInputs",
    "RecurrentPolicyNavigator",
    "RecurrentWeights",
    "Ros2Navigator",
    "RosbridgeNavigator",
    "SafetyLayer",
    "SafetyState",
    "ScanInputs",
    "ScanMapNavigator",
    "ScanPolicyNavigator",
    "ScanPolicyWeights",
    "SinusoidNavigator",
    "SocialForceNavigator",
    "Straight",
    "TimeElasticBandNavigator",
    "TrackBatch",
    "TrackHistory",
    "VisiblePeople",
    "Waypoints",
    "WindowCosts",
    "attention_inputs",
    "call_within",
    "check_navigator",
    "copy_memory",
    "drive_twist",
    "dynamic_window_twist",
    "empty_memory",
    "goal_frame_twists",
    "policy_file",
    "policy_inputs",
    "recurrent_inputs",
    "remember",
    "remember_scan",
    "scan_inputs",
    "with_memory",
]
