"""The network of AnchorNet in NumPy and compiled kernels, without PyTorch."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.prediction.pretrained_weights import Numbers
from crowdbot.typing import Floats

from .layers import attend, dense


def network_output(numbers: Numbers, own: Floats, company: Floats, there: NDArray[np.bool_]) -> Floats:
    """Return the network output ``[N, O]``: residuals of all futures, scores, single residual, spreads."""

    def layer(x: Floats, name: str, rectify: bool = True) -> Floats:
        return np.asarray(dense(np.ascontiguousarray(x), numbers[f"{name}_weight"], numbers[f"{name}_bias"], rectify))

    N, M, _ = company.shape
    hidden = layer(layer(own, "own_1"), "own_2")
    near = layer(layer(company.reshape(N * M, -1), "near_1"), "near_2").reshape(N, M, -1)
    query = layer(hidden, "query", rectify=False)
    seen = attend(query, near, np.ascontiguousarray(there), numbers["nobody"], numbers["alone"])
    both = layer(np.concatenate([hidden, seen], axis=1), "both_1")
    return layer(layer(both, "both_2"), "out", rectify=False)


def reach_of(numbers: Numbers) -> float:
    """Return the largest distance of a neighbor that is read [m]; infinite for weights without the array ``reach``."""
    return float(numbers["reach"]) if "reach" in numbers else math.inf


def feature_limit(numbers: Numbers) -> float:
    """Return the bound of the features [m]; infinite for weights that learned from unbounded ones."""
    return math.inf if "unbounded" in numbers else reach_of(numbers)
