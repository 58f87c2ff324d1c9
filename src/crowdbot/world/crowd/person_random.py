"""Random numbers that depend only on seed, identity and purpose, not on the position in an array or batch."""

from __future__ import annotations

import hashlib

import numpy as np
from numpy.typing import ArrayLike, NDArray

STEP = np.uint64(0x9E3779B97F4A7C15)
MIX1 = np.uint64(0xBF58476D1CE4E5B9)
MIX2 = np.uint64(0x94D049BB133111EB)


def uniform(seed: ArrayLike, person: ArrayLike, *path: str | int) -> NDArray[np.float64]:
    """Return a uniform random number in [0, 1) for each person (SplitMix64 hash of the arguments).

    Args:
        seed: seed of each environment, ``[E, 1]`` or a number.
        person: identities ``[E, A]``.
        path: purpose of the number.

    >>> bool(uniform(7, [[3, 4]], "side")[0, 0] == uniform([[7]], [[5, 3]], "side")[0, 1])
    True
    """
    text = "\x1f".join(f"{type(p).__name__}:{p}" for p in path)
    state: NDArray[np.uint64] = np.array(
        int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "little"), dtype=np.uint64
    )
    with np.errstate(over="ignore"):
        for word in (seed, person):
            state = _mixed(state + STEP + np.asarray(word, dtype=np.int64).astype(np.uint64))
    return np.asarray((state >> np.uint64(11)).astype(np.float64) * 2.0**-53)


def _mixed(state: NDArray[np.uint64]) -> NDArray[np.uint64]:
    state = (state ^ (state >> np.uint64(30))) * MIX1
    state = (state ^ (state >> np.uint64(27))) * MIX2
    return state ^ (state >> np.uint64(31))
