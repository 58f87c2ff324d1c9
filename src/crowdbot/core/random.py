"""Random streams: each consumer has its own generator, identified by a seed and a path."""

from __future__ import annotations

import hashlib

import numpy as np


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
    text = repr(int(seed)) + stream_text(*path)
    digest = hashlib.blake2b(text.encode(), digest_size=16).digest()
    return np.random.Generator(np.random.PCG64(int.from_bytes(digest, "little")))


def stream_text(*path: str | int) -> str:
    """Return the text that follows the seed in the hashed text of a stream.

    >>> stream_text("spawner", 3)
    '\\x1fstr:spawner\\x1fint:3'
    """
    return "".join(f"\x1f{type(p).__name__}:{p}" for p in path)
