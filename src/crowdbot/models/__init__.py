"""Models of walking people: how each agent of a scene chooses its next velocity, and where it wants to go."""

from . import costs
from .anticipation_velocity import AnticipationVelocity
from .boids import Boids
from .collision_free_speed import CollisionFreeSpeed
from .cost_model import CostModel
from .escape_panic import EscapePanic
from .goals import CurrentDirection, Goal, GroundTruth
from .group_force import GroupForce
from .heuristics import Heuristics
from .mixture import Mixture
from .model import CrowdModel
from .orca import ORCA
from .pledestrians import PLEdestrians
from .power_law import PowerLaw
from .social_force import SocialForce
from .tangent import Tangent
from .vbm import VBM
from .vog import VOG

__all__ = [
    "ORCA",
    "VBM",
    "VOG",
    "AnticipationVelocity",
    "Boids",
    "CollisionFreeSpeed",
    "CostModel",
    "CrowdModel",
    "CurrentDirection",
    "EscapePanic",
    "Goal",
    "GroundTruth",
    "GroupForce",
    "Heuristics",
    "Mixture",
    "PLEdestrians",
    "PowerLaw",
    "SocialForce",
    "Tangent",
    "costs",
]
