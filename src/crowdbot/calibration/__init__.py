"""Floor 3: which parameters make a crowd model walk like recorded people; a scheme is model x cost x search x goal."""

from .absolute import Absolute
from .annealing import Annealing
from .calibrator import Calibrator
from .cma_es import CMAES
from .cooling import Cooling, Geometric
from .cost import Cost
from .fit import Fit
from .futures import futures
from .genetic import Genetic
from .greedy import Greedy
from .inter_pedestrian import InterPedestrian
from .parameter_space import Space
from .population_prior import PopulationPrior
from .progressive import Progressive
from .random_search import RandomSearch
from .recording_calibration import Campaign, FittedPiece
from .resimulation import Rehearsal, Walked
from .rollout import Rollout
from .scheme_parts import goal_for, kind_of_goal, named_cost, named_goal, named_model, named_search
from .search import Found, Search
from .weighted_sum import WeightedSum

__all__ = [
    "CMAES",
    "Absolute",
    "Annealing",
    "Calibrator",
    "Campaign",
    "Cooling",
    "Cost",
    "Fit",
    "FittedPiece",
    "Found",
    "Genetic",
    "Geometric",
    "Greedy",
    "InterPedestrian",
    "PopulationPrior",
    "Progressive",
    "RandomSearch",
    "Rehearsal",
    "Rollout",
    "Search",
    "Space",
    "Walked",
    "WeightedSum",
    "futures",
    "goal_for",
    "kind_of_goal",
    "named_cost",
    "named_goal",
    "named_model",
    "named_search",
]
