"""Calibration: fit the parameters of crowd models to recorded people; a scheme is model x cost x search x goal."""

from .annealing import Annealing
from .calibrator import Calibrator
from .cma_es import CMAES
from .contract import check_cost
from .cooling import Cooling, Geometric
from .cost import Absolute, Cost, InterPedestrian, Progressive, WeightedSum
from .fit import Fit
from .fit_prediction import futures
from .genetic import Genetic
from .greedy import Greedy
from .identifiability import ParameterProfile, plot_profiles, profile_parameters
from .parameter_space import ParameterSpace
from .population_prior import PopulationPrior
from .random_search import RandomSearch
from .recording_calibration import CalibrationChunk, RecordingCalibration
from .resimulation import ResimulatedTracks, Resimulation
from .rollout import Rollout
from .scheme_parts import goal_class, goal_for, resolve_cost, resolve_goal, resolve_model, resolve_search
from .search import Search, SearchResult
from .time_limit import TimeLimit

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
