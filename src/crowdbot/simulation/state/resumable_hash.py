"""ResumableHash: BLAKE2b whose state between two updates can be stored and continued.

The hashes of :mod:`hashlib` cannot be stored. A run that continues from a keyframe needs the hash of everything before.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from crowdbot.core import HASH_BLOCK, InputError, hash_blocks, hash_start

WAITING = 1 << 16
"""Bytes that wait for the next call of the kernel at most."""
SIZE = 16
"""Length of the digest [bytes]."""


class ResumableHash:
    """BLAKE2b with a digest of 16 bytes, as ``hashlib.blake2b(digest_size=16)``, that can be stored.

    >>> whole, half = ResumableHash(), ResumableHash()
    >>> whole.update(b"crowd and robot")
    >>> half.update(b"crowd and")
    >>> half = ResumableHash.of(half.state)
    >>> half.update(b" robot")
    >>> half.hexdigest() == whole.hexdigest()
    True
    """

    def __init__(self) -> None:
        self._words, self._length, self._rest = hash_start(SIZE), 0, bytearray()

    @classmethod
    def of(cls, state: Mapping[str, Any]) -> ResumableHash:
        """Continue from a stored state.

        Raises:
            InputError: the state is not that of a hash.
        """
        words, length, rest = (state.get(name) for name in ("words", "length", "rest"))
        fits = isinstance(words, np.ndarray) and words.dtype == np.uint64 and words.shape == (8,)
        fits = fits and isinstance(rest, np.ndarray) and rest.dtype == np.uint8 and rest.ndim == 1
        if not fits or not isinstance(length, int) or not 0 <= length < 2**62 or length % HASH_BLOCK:
            raise InputError("the state of a hash needs words [8], a length in whole blocks and the rest")
        resumable_hash = cls()
        assert words is not None
        assert rest is not None
        resumable_hash._words, resumable_hash._length, resumable_hash._rest = (
            words.copy(),
            length,
            bytearray(rest.tobytes()),
        )
        return resumable_hash

    @property
    def state(self) -> dict[str, Any]:
        """The state as arrays and numbers."""
        self._absorb()
        return {
            "words": self._words.copy(),
            "length": self._length,
            "rest": np.frombuffer(bytes(self._rest), dtype=np.uint8),
        }

    def update(self, data: bytes) -> None:
        """Add bytes."""
        self._rest += data
        if len(self._rest) > WAITING:
            self._absorb()

    def copy(self) -> ResumableHash:
        """Return an independent hash in the same state."""
        self._absorb()
        other = ResumableHash()
        other._words, other._length, other._rest = self._words.copy(), self._length, bytearray(self._rest)
        return other

    def hexdigest(self) -> str:
        """Return the hash of all bytes so far."""
        self._absorb()
        state, size = self._words.copy(), len(self._rest)
        block = np.frombuffer(bytes(self._rest).ljust(HASH_BLOCK, b"\0"), dtype="<u8").astype(np.uint64)
        hash_blocks(state, block, np.array([self._length + size], dtype=np.uint64), True)
        return state.astype("<u8").tobytes()[:SIZE].hex()

    def _absorb(self) -> None:
        """Add whole blocks to the state, without the last one, which may end the message."""
        count = max(0, (len(self._rest) - 1) // HASH_BLOCK)
        if count:
            words = np.frombuffer(bytes(self._rest[: count * HASH_BLOCK]), dtype="<u8").astype(np.uint64)
            length = self._length + HASH_BLOCK * np.arange(1, count + 1)
            hash_blocks(self._words, words, length.astype(np.uint64), False)
            del self._rest[: count * HASH_BLOCK]
            self._length += count * HASH_BLOCK
