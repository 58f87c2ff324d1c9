"""Calibration: fit the parameters of crowd models to recorded people; a scheme is model x cost x search x goal."""

from .calibrator import (
    CalibrationChunk,
    Calibrator,
    RecordingCalibration,
    goal_class,
    goal_for,
    resolve_cost,
    resolve_goal,
    resolve_model,
    resolve_search,
)
from .cost import Absolute, Cost, InterPedestrian, Progressive, WeightedSum, check_cost
from .fit import Fit, futures
from .identifiability import ParameterProfile, plot_profiles, profile_parameters
from .parameter_space import ParameterSpace
from .population_prior import PopulationPrior
from .rollout import ResimulatedTracks, Resimulation, Rollout
from .search import Search, SearchResult, TimeLimit
from .searches import CMAES, Annealing, Cooling, Genetic, Geometric, Greedy, RandomSearch

__all__ = [
    "CMAES",
    "Absolute",
    "Annealing",
    "CalibrationChunk",
    "Calibrator",
    "Cooling",
    "Cost",
    "Fit",
    "Genetic",
    "Geometric",
    "Greedy",
    "InterPedestrian",
    "ParameterProfile",
    "ParameterSpace",
    "PopulationPrior",
    "Progressive",
    "RandomSearch",
    "RecordingCalibration",
    "ResimulatedTracks",
    "Resimulation",
    "Rollout",
    "Search",
    "SearchResult",
    "TimeLimit",
    "WeightedSum",
    "check_cost",
    "futures",
    "goal_class",
    "goal_for",
    "plot_profiles",
    "profile_parameters",
    "resolve_cost",
    "resolve_goal",
    "resolve_model",
    "resolve_search",
]
