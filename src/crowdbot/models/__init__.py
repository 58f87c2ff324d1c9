"""Crowd models and goal estimators."""

from . import costs
from .contract import check_goal, check_model
from .costs.cost_model import CostModel
from .forces.boids import Boids
from .forces.escape_panic import EscapePanic
from .forces.generalized_centrifugal_force import GeneralizedCentrifugalForce
from .forces.group_force import GroupForce
from .forces.headed_social_force import HeadedSocialForce
from .forces.power_law import PowerLaw
from .forces.social_force import SocialForce
from .goals import CurrentDirection, Goal, GroundTruth
from .headway import HeadwayLayer, find_layered, with_headway
from .mixture import Mixture
from .model import CrowdModel
from .presets import CrowdPreset, People, crowd_presets
from .speed_models.anticipation_velocity import AnticipationVelocity
from .speed_models.collision_free_speed import CollisionFreeSpeed
from .speed_models.collision_free_speed_v3 import CollisionFreeSpeedV3
from .speed_models.optimal_steps import OptimalSteps
from .valid_range import ModelRange
from .velocity_obstacles.orca import ORCA
from .velocity_obstacles.pledestrians import PLEdestrians
from .velocity_obstacles.vog import VOG
from .vision.heuristics import Heuristics
from .vision.tangent import Tangent
from .vision.vbm import VBM
from .vision.warp_driver import WarpDriver

__all__ = [
    "ORCA",
    "VBM",
    "VOG",
    "AnticipationVelocity",
    "Boids",
    "CollisionFreeSpeed",
    "CollisionFreeSpeedV3",
    "CostModel",
    "CrowdModel",
    "CrowdPreset",
    "CurrentDirection",
    "EscapePanic",
    "GeneralizedCentrifugalForce",
    "Goal",
    "GroundTruth",
    "GroupForce",
    "HeadedSocialForce",
    "HeadwayLayer",
    "Heuristics",
    "Mixture",
    "ModelRange",
    "OptimalSteps",
    "PLEdestrians",
    "People",
    "PowerLaw",
    "SocialForce",
    "Tangent",
    "WarpDriver",
    "check_goal",
    "check_model",
    "costs",
    "crowd_presets",
    "find_layered",
    "with_headway",
]
