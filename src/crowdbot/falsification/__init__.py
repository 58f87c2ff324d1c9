"""Falsification: search a trial for failures of its navigator, and estimate how likely they are."""

from .cluster import FailureCluster, find_clusters
from .cross_entropy import CrossEntropy
from .directed import AIMS, DirectedSearch
from .estimate import mixture_estimate, replicate_estimate
from .event import describe_event
from .factor import Factor, parse_factor
from .failure import FAILURES, FailureCriterion, parse_failure
from .falsifier import falsify, parse_sampling
from .found_trial import FoundTrial, write_failures
from .plain_sampling import PlainSampling
from .proposal import Proposal, fit_proposal, mixture_weights
from .report import describe_rarity, factor_ranges, write_report
from .result import FalsificationResult, FoundFailure
from .runner import SampleRunner
from .sample import Sample, SampleJob, run_samples
from .sampling import Sampling, SamplingResult
from .search_space import SearchSpace
from .splitting import Splitting
from .urgency import collision_urgency

__all__ = [
    "AIMS",
    "FAILURES",
    "CrossEntropy",
    "DirectedSearch",
    "Factor",
    "FailureCluster",
    "FailureCriterion",
    "FalsificationResult",
    "FoundFailure",
    "FoundTrial",
    "PlainSampling",
    "Proposal",
    "Sample",
    "SampleJob",
    "SampleRunner",
    "Sampling",
    "SamplingResult",
    "SearchSpace",
    "Splitting",
    "collision_urgency",
    "describe_event",
    "describe_rarity",
    "factor_ranges",
    "falsify",
    "find_clusters",
    "fit_proposal",
    "mixture_estimate",
    "mixture_weights",
    "parse_factor",
    "parse_failure",
    "parse_sampling",
    "replicate_estimate",
    "run_samples",
    "write_failures",
    "write_report",
]
