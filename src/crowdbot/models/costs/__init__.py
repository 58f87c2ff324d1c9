"""Cost terms over velocities, to compose crowd models."""

from .cost_terms import (
    AdmissibleRange,
    CollisionDistance,
    Effort,
    FocusOfExpansion,
    FreeWay,
    GoalForce,
    HalfPlanes,
    Inertia,
    ModelForce,
    NoiseTerm,
    PassingTimes,
    PowerLawEnergy,
    PowerLawForce,
    PreferredVelocity,
    ReciprocalObstacles,
)
from .neighbor_view import NeighborView
from .velocity_cost import Force, Sum, VelocityCost

__all__ = [
    "AdmissibleRange",
    "CollisionDistance",
    "Effort",
    "FocusOfExpansion",
    "Force",
    "FreeWay",
    "GoalForce",
    "HalfPlanes",
    "Inertia",
    "ModelForce",
    "NeighborView",
    "NoiseTerm",
    "PassingTimes",
    "PowerLawEnergy",
    "PowerLawForce",
    "PreferredVelocity",
    "ReciprocalObstacles",
    "Sum",
    "VelocityCost",
]
