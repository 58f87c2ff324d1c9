"""Floor 3: which parameters make a crowd model walk like recorded people; a scheme is model x cost x search x goal."""

from .annealing import Annealing
from .calibrator import Calibrator, Fit, named_goal, named_model
from .cma_es import CMAES
from .cooling import Cooling, Geometric
from .costs import AbsoluteDifference, Cost
from .genetic import Genetic
from .greedy import Greedy
from .random_search import RandomSearch
from .rollout import Rollout
from .search import Found, Search

__all__ = [
    "CMAES",
    "AbsoluteDifference",
    "Annealing",
    "Calibrator",
    "Cooling",
    "Cost",
    "Fit",
    "Found",
    "Genetic",
    "Geometric",
    "Greedy",
    "RandomSearch",
    "Rollout",
    "Search",
    "named_goal",
    "named_model",
]
