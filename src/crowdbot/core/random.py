"""Random streams: each consumer has its own generator, identified by a seed and a path."""

from __future__ import annotations

import hashlib

import numpy as np

__all__ = ["stream"]


def stream(seed: int, *path: str | int) -> np.random.Generator:
    """Return the random generator of ``seed`` and ``path``.

    Streams with different paths are independent: for example, adding a sensor does not change the crowd.

    Args:
        seed: any integer.
        path: names or numbers that identify the consumer, from general to specific.

    >>> a = stream(7, "spawner", 3).random()
    >>> a == stream(7, "spawner", 3).random(), a == stream(7, "spawner", 4).random()
    (True, False)
    """
    text = "\x1f".join([repr(int(seed)), *(f"{type(p).__name__}:{p}" for p in path)])
    digest = hashlib.blake2b(text.encode(), digest_size=16).digest()
    return np.random.Generator(np.random.PCG64(int.from_bytes(digest, "little")))
