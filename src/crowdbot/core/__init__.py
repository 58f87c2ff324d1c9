"""Floor 0: what every other floor stands on. Needs numpy and the standard library; kernels need numba."""

from .bodies import STAGE, Bodies, Skins
from .clock import Clock, ExternalClock, FreeClock, PacedClock
from .errors import (
    CrowdbotError,
    DataError,
    EpisodeError,
    InputError,
    MissingExtra,
    RobotError,
    TrialError,
    UnknownName,
)
from .paper import Paper
from .parameter import Parameter, PerAgent, check_parameters, parameter, parameters, per_agent
from .pose import Pose, SpatialPose, Twist, wrap
from .random import stream
from .scene import Scene
from .walls import Walls

__all__ = [
    "STAGE",
    "Bodies",
    "Clock",
    "CrowdbotError",
    "DataError",
    "EpisodeError",
    "ExternalClock",
    "FreeClock",
    "InputError",
    "MissingExtra",
    "PacedClock",
    "Paper",
    "Parameter",
    "PerAgent",
    "Pose",
    "RobotError",
    "Scene",
    "Skins",
    "SpatialPose",
    "TrialError",
    "Twist",
    "UnknownName",
    "Walls",
    "check_parameters",
    "parameter",
    "parameters",
    "per_agent",
    "stream",
    "wrap",
]
