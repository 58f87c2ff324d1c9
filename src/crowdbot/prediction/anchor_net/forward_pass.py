"""The network of AnchorNet in NumPy and compiled kernels, without PyTorch.

Every sum has a fixed order that is independent of the number of people: a person gets the same bits alone and in a
batch. BLAS matrix products do not guarantee that.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.prediction.pretrained_weights import Numbers
from crowdbot.typing import Bools, Floats

BLOCK = 8
"""Number of people that share one pass over the weights of a layer."""


@kernel
def dense(x: Floats, weight: Floats, bias: Floats, rectify: bool) -> Floats:  # pragma: no cover - compiled
    """Return ``x [N, I] @ weight [I, O] + bias [O]``, clipped at 0 if ``rectify``."""
    N, outputs = len(x), len(bias)
    out = np.empty((N, outputs))
    whole = x.shape[1] // 4 * 4
    for first in range(0, N, BLOCK):
        last = min(N, first + BLOCK)
        for n in range(first, last):
            for o in range(outputs):
                out[n, o] = bias[o]
        for i in range(0, whole, 4):
            for n in range(first, last):
                a, b, c, d = x[n, i], x[n, i + 1], x[n, i + 2], x[n, i + 3]
                for o in range(outputs):
                    out[n, o] += (a * weight[i, o] + b * weight[i + 1, o]) + (
                        c * weight[i + 2, o] + d * weight[i + 3, o]
                    )
        for i in range(whole, x.shape[1]):
            for n in range(first, last):
                for o in range(outputs):
                    out[n, o] += x[n, i] * weight[i, o]
        if rectify:
            for n in range(first, last):
                for o in range(outputs):
                    out[n, o] = max(out[n, o], 0.0)
    return out


@kernel
def attend(
    query: Floats, company: Floats, there: Bools, nobody: Floats, alone: Floats
) -> Floats:  # pragma: no cover - compiled
    """Return attention ``[N, D]`` over neighbors, with the softmax of ``query . company / sqrt(D)`` as weights.

    Args:
        query: ``[N, D]``.
        company: ``[N, M, D]``, keys and values.
        there: ``[N, M]``, mask of the neighbors that exist.
        nobody, alone: ``[D]``, key and value of an additional neighbor that always exists.
    """
    N, M, D = company.shape
    out = np.empty((N, D))
    score = np.empty(M + 1)
    for n in range(N):
        largest = 0.0
        for m in range(M + 1):
            total = 0.0
            if m == M:
                for d in range(D):
                    total += query[n, d] * nobody[d]
            elif there[n, m]:
                for d in range(D):
                    total += query[n, d] * company[n, m, d]
            score[m] = total / math.sqrt(D)
            if m == M or there[n, m]:
                largest = max(largest, score[m])
        share = 0.0
        for m in range(M + 1):
            score[m] = math.exp(score[m] - largest) if m == M or there[n, m] else 0.0
            share += score[m]
        for d in range(D):
            out[n, d] = score[M] / share * alone[d]
        for m in range(M):
            if score[m] > 0.0:
                for d in range(D):
                    out[n, d] += score[m] / share * company[n, m, d]
    return out


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
