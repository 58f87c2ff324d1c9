"""Falsification: search a trial for failures of its navigator, and estimate how likely they are."""

from .estimate import mixture_estimate, replicate_estimate
from .failure import FAILURES, FailureCriterion, collision_urgency, describe_event, parse_failure
from .falsifier import falsify, parse_sampling
from .report import describe_rarity, factor_ranges, write_report
from .result import FailureCluster, FalsificationResult, FoundFailure, FoundTrial, find_clusters, write_failures
from .sample import Sample, SampleJob, SampleRunner, run_samples
from .search_space import Factor, SearchSpace, parse_factor
from .searches import (
    AIMS,
    CrossEntropy,
    DirectedSearch,
    PlainSampling,
    Proposal,
    Sampling,
    SamplingResult,
    Splitting,
    fit_proposal,
    mixture_weights,
)

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
