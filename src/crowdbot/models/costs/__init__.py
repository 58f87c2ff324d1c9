"""Cost terms over velocities, to compose crowd models."""

from .cost_terms import (
    CollisionDistance,
    Effort,
    FreeWay,
    GoalForce,
    HalfPlanes,
    Inertia,
    ModelForce,
    NoiseTerm,
    PowerLawEnergy,
    PowerLawForce,
    PreferredVelocity,
    ReciprocalObstacles,
)
from .neighbor_view import NeighborView
from .velocity_cost import Force, Sum, VelocityCost

__all__ = [
    "CollisionDistance",
    "Effort",
    "Force",
    "FreeWay",
    "GoalForce",
    "HalfPlanes",
    "Inertia",
    "ModelForce",
    "NeighborView",
    "NoiseTerm",
    "PowerLawEnergy",
    "PowerLawForce",
    "PreferredVelocity",
    "ReciprocalObstacles",
    "Sum",
    "VelocityCost",
]
