"""Kernels of the genetic search: the pools of all people are sorted and crossed in one pass."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.typing import Floats


@kernel
def keep_fittest(
    children: Floats, pool: Floats, child_cost: Floats, cost: Floats, age: Floats, memory: float,
    genes: Floats, kept_cost: Floats, kept_age: Floats,
) -> None:  # fmt: skip
    """Write the parameters of each person with the lowest costs, best first; costs expire at the age ``memory``.

    Args:
        children, child_cost: ``[P, L, N, D]`` and ``[P, L, N]``, new parameters and their costs; preferred at equal
            costs.
        pool, cost, age: ``[M, L, N, D]`` and ``[M, L, N]``, earlier parameters, sorted by cost; the age is a number of
            generations.
        genes, kept_cost, kept_age: ``[K, L, N, D]`` and ``[K, L, N]``, output arrays.
    """
    P, (M, L, N, D) = len(children), pool.shape
    value, order = np.empty(P + M), np.empty(P + M, dtype=np.int64)
    for w in range(L):
        for n in range(N):
            for k in range(P + M):
                x = child_cost[k, w, n] if k < P else cost[k - P, w, n]
                if k >= P and not age[k - P, w, n] + 1.0 < memory:
                    x = math.inf
                at = k  # stable insertion: the pool is in order already
                while at > 0 and x < value[at - 1]:
                    value[at], order[at] = value[at - 1], order[at - 1]
                    at -= 1
                value[at], order[at] = x, k
            for i in range(len(genes)):
                k = order[i]
                kept_cost[i, w, n], kept_age[i, w, n] = value[i], 0.0 if k < P else age[k - P, w, n] + 1.0
                for d in range(D):
                    genes[i, w, n, d] = children[k, w, n, d] if k < P else pool[k - P, w, n, d]


@kernel
def breed(
    pool: Floats, rank: NDArray[np.int64], chance: Floats, place: Floats, mutation: Floats, change: Floats,
    incumbent: Floats, low: Floats, high: Floats, overshoot: float, width: float, bred: float, children: Floats,
) -> None:  # fmt: skip
    """Write children ``[P, L, N, D]``: two parents of each person are blended or exchanged, and mutated.

    Args:
        pool: ``[M, L, N, D]``, parameters of each person, best first.
        rank: ``[P, L, N, 2]``, places of the parents in the pool.
        chance: ``[P, L, N, 4]``, numbers from 0 to 1: the third chooses between blend and exchange, the fourth between
            a child and the incumbent.
        place, mutation: ``[P, L, N, D]``, numbers from 0 to 1: place between the parents, and whether to mutate.
        change: ``[P, L, N, D]``, normally distributed changes.
        incumbent: ``[1, L, N, D]``, parameters of people without a child.
        low, high: ``[D]``, bounds, at which children are reflected.
        overshoot: extension of the blend beyond the parents, relative to their distance.
        width: standard deviation of a mutation, relative to the bounds.
        bred: probability of a child.
        children: output array.
    """
    P, L, N, D = children.shape
    for k in range(P):
        for w in range(L):
            for n in range(N):
                taken, blends = chance[k, w, n, 3] < bred, chance[k, w, n, 2] < 0.5
                mother, father = rank[k, w, n, 0], rank[k, w, n, 1]
                for d in range(D):
                    if not taken:
                        children[k, w, n, d] = incumbent[0, w, n, d]
                        continue
                    share = place[k, w, n, d]
                    share = (1.0 + 2.0 * overshoot) * share - overshoot if blends else np.rint(share)
                    first = pool[mother, w, n, d]
                    value = first + share * (pool[father, w, n, d] - first)
                    if mutation[k, w, n, d] * D < 1.0:
                        value += width * (high[d] - low[d]) * change[k, w, n, d]
                    side = min(max(value, low[d]), high[d])
                    children[k, w, n, d] = min(max(2.0 * side - value, low[d]), high[d])
