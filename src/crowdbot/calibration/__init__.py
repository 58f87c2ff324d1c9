"""Floor 3: which parameters make a crowd model walk like recorded people; a scheme is model x cost x search x goal."""

from .calibrator import Calibrator, Fit, named_goal, named_model
from .costs import AbsoluteDifference, Cost
from .rollout import Rollout
from .search import Found, RandomSearch, Search

__all__ = [
    "AbsoluteDifference",
    "Calibrator",
    "Cost",
    "Fit",
    "Found",
    "RandomSearch",
    "Rollout",
    "Search",
    "named_goal",
    "named_model",
]
