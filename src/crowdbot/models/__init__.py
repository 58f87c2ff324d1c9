"""Models of walking people: how each agent of a scene chooses its next velocity, and where it wants to go."""

from .anticipation_velocity import AnticipationVelocity
from .collision_free_speed import CollisionFreeSpeed
from .cost_model import CostModel
from .goals import CurrentDirection, Goal, GroundTruth
from .heuristics import Heuristics
from .model import CrowdModel
from .orca import ORCA
from .pledestrians import PLEdestrians
from .social_force import SocialForce

__all__ = [
    "ORCA",
    "AnticipationVelocity",
    "CollisionFreeSpeed",
    "CostModel",
    "CrowdModel",
    "CurrentDirection",
    "Goal",
    "GroundTruth",
    "Heuristics",
    "PLEdestrians",
    "SocialForce",
]
