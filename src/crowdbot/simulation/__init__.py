"""Simulation of a trial with a seed; the result is an episode."""

from crowdbot.core import StateError, StateMark
from crowdbot.simulation.episode_digest import ResumableHash

from .decision_timer import decision_times
from .episode import Episode, ScanRow, log_of, scan_row, tracks_of
from .episode_digest import EpisodeDigest
from .episode_log import EpisodeLog
from .external_robots import OwnSource, UncommandedRobotWarning, open_own_sources
from .failure import RunEnd, RunFailure, RunFailureWarning
from .fault_state import FaultOrder
from .orders.avatar_order import AvatarOrder, RobotPoseOrder
from .orders.decision_orders import DecisionOrder, HungDecisionOrder, MissedDecisionOrder, RecordedDecisions
from .orders.element_orders import AddElementOrder, ParameterOrder, RemoveElementOrder, TrialOrder
from .orders.goal_order import GoalOrder
from .orders.joint_order import JointOrder
from .orders.order import Order, VelocityOrder, order_kinds, read_order, write_order
from .orders.order_schedule import OrderSchedule
from .orders.people_orders import AddPersonOrder, MoveOrder, RedirectOrder, RemoveOrder
from .orders.push_order import PushOrder
from .overrides import DoorOrder, apply_overrides
from .robot_control import RobotControl
from .runner import catch_interrupt, run_to_end, simulate, simulate_seeds, simulate_variants, warn_of_failure
from .simulation import Simulation
from .simulation_run import (
    KEYFRAMES,
    BatchSink,
    OrderSource,
    RunSnapshot,
    SimulationRun,
    Sink,
    StopRequest,
)
from .state.simulation_state import restore_state, state_of
from .state.state_codec import decode_state, encode_state
from .statistics import EpisodeStatistics, RunSummary, robot_metrics
from .step_batch import BatchReadings, StepBatch
from .step_record import WALL, RobotContact, StepRecord
from .variant_template import VariantTemplate

__all__ = [
    "KEYFRAMES",
    "WALL",
    "AddElementOrder",
    "AddPersonOrder",
    "AvatarOrder",
    "BatchReadings",
    "BatchSink",
    "DecisionOrder",
    "DoorOrder",
    "Episode",
    "EpisodeDigest",
    "EpisodeLog",
    "EpisodeStatistics",
    "FaultOrder",
    "GoalOrder",
    "HungDecisionOrder",
    "JointOrder",
    "MissedDecisionOrder",
    "MoveOrder",
    "Order",
    "OrderSchedule",
    "OrderSource",
    "OwnSource",
    "ParameterOrder",
    "PushOrder",
    "RecordedDecisions",
    "RedirectOrder",
    "RemoveElementOrder",
    "RemoveOrder",
    "ResumableHash",
    "RobotContact",
    "RobotControl",
    "RobotPoseOrder",
    "RunEnd",
    "RunFailure",
    "RunFailureWarning",
    "RunSnapshot",
    "RunSummary",
    "ScanRow",
    "Simulation",
    "SimulationRun",
    "Sink",
    "StateError",
    "StateMark",
    "StepBatch",
    "StepRecord",
    "StopRequest",
    "TrialOrder",
    "UncommandedRobotWarning",
    "VariantTemplate",
    "VelocityOrder",
    "apply_overrides",
    "catch_interrupt",
    "decision_times",
    "decode_state",
    "encode_state",
    "log_of",
    "open_own_sources",
    "order_kinds",
    "read_order",
    "restore_state",
    "robot_metrics",
    "run_to_end",
    "scan_row",
    "simulate",
    "simulate_seeds",
    "simulate_variants",
    "state_of",
    "tracks_of",
    "warn_of_failure",
    "write_order",
]
