"""Models of walking people: how each agent of a scene chooses its next velocity, and where it wants to go."""

from .goals import CurrentDirection, Goal, GroundTruth
from .model import CrowdModel
from .orca import ORCA
from .social_force import SocialForce

__all__ = ["ORCA", "CrowdModel", "CurrentDirection", "Goal", "GroundTruth", "SocialForce"]
