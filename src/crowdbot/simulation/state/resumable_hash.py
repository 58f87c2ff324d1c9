"""ResumableHash: BLAKE2b whose state between two updates can be stored and continued.

The hashes of :mod:`hashlib` cannot be stored. A run that continues from a keyframe needs the hash of everything before.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, kernel

__all__ = ["ResumableHash"]

Words = NDArray[np.uint64]

BLOCK = 128
"""Length of a block [bytes]."""
WAITING = 1 << 16
"""Bytes that wait for the next call of the kernel at most."""
SIZE = 16
"""Length of the digest [bytes]."""
START = np.array(
    [
        0x6A09E667F3BCC908 ^ 0x01010000 ^ SIZE, 0xBB67AE8584CAA73B, 0x3C6EF372FE94F82B, 0xA54FF53A5F1D36F1,
        0x510E527FADE682D1, 0x9B05688C2B3E6C1F, 0x1F83D9ABFB41BD6B, 0x5BE0CD19137E2179,
    ],
    dtype=np.uint64,
)  # fmt: skip
PLAIN = START.copy()
PLAIN[0] ^= np.uint64(0x01010000 ^ SIZE)
SIGMA = np.array(
    [
        [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15],
        [14, 10, 4, 8, 9, 15, 13, 6, 1, 12, 0, 2, 11, 7, 5, 3],
        [11, 8, 12, 0, 5, 2, 15, 13, 10, 14, 3, 6, 7, 1, 9, 4],
        [7, 9, 3, 1, 13, 12, 11, 14, 2, 6, 5, 10, 4, 0, 15, 8],
        [9, 0, 5, 7, 2, 4, 10, 15, 14, 1, 11, 12, 6, 8, 3, 13],
        [2, 12, 6, 10, 0, 11, 8, 3, 4, 13, 7, 5, 15, 14, 1, 9],
        [12, 5, 1, 15, 14, 13, 4, 10, 0, 7, 6, 3, 9, 2, 8, 11],
        [13, 11, 7, 14, 12, 1, 3, 9, 5, 0, 15, 4, 8, 6, 2, 10],
        [6, 15, 14, 9, 11, 3, 0, 8, 12, 2, 13, 7, 1, 4, 10, 5],
        [10, 2, 8, 4, 7, 6, 1, 5, 15, 11, 9, 14, 3, 12, 13, 0],
        [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15],
        [14, 10, 4, 8, 9, 15, 13, 6, 1, 12, 0, 2, 11, 7, 5, 3],
    ],
    dtype=np.uint64,
)


@kernel(inline=True)
def _mix(a: Any, b: Any, c: Any, d: Any, x: Any, y: Any) -> Any:
    """Return four words of the block after mixing in two words of the message (function G of RFC 7693)."""
    a = a + b + x
    d = d ^ a
    d = (d >> np.uint64(32)) | (d << np.uint64(32))
    c = c + d
    b = b ^ c
    b = (b >> np.uint64(24)) | (b << np.uint64(40))
    a = a + b + y
    d = d ^ a
    d = (d >> np.uint64(16)) | (d << np.uint64(48))
    c = c + d
    b = b ^ c
    return a, (b >> np.uint64(63)) | (b << np.uint64(1)), c, d


@kernel
def _compress(h: Words, words: Words, length: Words, last: bool, p: Words, sigma: Any) -> None:
    """Add blocks to the state ``[8]`` (function F of RFC 7693).

    Args:
        h: state, modified in place.
        words: the blocks, ``[16 * n]``.
        length: ``[n]`` number of bytes up to the end of each block.
        last: whether the last of the blocks ends the message.
        p, sigma: constants of the hash.
    """
    for b in range(len(length)):
        m = words[16 * b : 16 * b + 16]
        v0, v1, v2, v3, v4, v5, v6, v7 = h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7]
        v8, v9, v10, v11, v12, v13, v14, v15 = p[0], p[1], p[2], p[3], p[4] ^ length[b], p[5], p[6], p[7]
        if last and b == len(length) - 1:
            v14 = ~v14
        for r in range(12):
            s = sigma[r]
            v0, v4, v8, v12 = _mix(v0, v4, v8, v12, m[s[0]], m[s[1]])
            v1, v5, v9, v13 = _mix(v1, v5, v9, v13, m[s[2]], m[s[3]])
            v2, v6, v10, v14 = _mix(v2, v6, v10, v14, m[s[4]], m[s[5]])
            v3, v7, v11, v15 = _mix(v3, v7, v11, v15, m[s[6]], m[s[7]])
            v0, v5, v10, v15 = _mix(v0, v5, v10, v15, m[s[8]], m[s[9]])
            v1, v6, v11, v12 = _mix(v1, v6, v11, v12, m[s[10]], m[s[11]])
            v2, v7, v8, v13 = _mix(v2, v7, v8, v13, m[s[12]], m[s[13]])
            v3, v4, v9, v14 = _mix(v3, v4, v9, v14, m[s[14]], m[s[15]])
        h[0] ^= v0 ^ v8
        h[1] ^= v1 ^ v9
        h[2] ^= v2 ^ v10
        h[3] ^= v3 ^ v11
        h[4] ^= v4 ^ v12
        h[5] ^= v5 ^ v13
        h[6] ^= v6 ^ v14
        h[7] ^= v7 ^ v15


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
        self._words, self._length, self._rest = START.copy(), 0, bytearray()

    @classmethod
    def of(cls, state: Mapping[str, Any]) -> ResumableHash:
        """Continue from a stored state.

        Raises:
            InputError: the state is not that of a hash.
        """
        words, length, rest = (state.get(name) for name in ("words", "length", "rest"))
        fits = isinstance(words, np.ndarray) and words.dtype == np.uint64 and words.shape == (8,)
        fits = fits and isinstance(rest, np.ndarray) and rest.dtype == np.uint8 and rest.ndim == 1
        if not fits or not isinstance(length, int) or not 0 <= length < 2**62 or length % BLOCK:
            raise InputError("the state of a hash needs words [8], a length in whole blocks and the rest")
        found = cls()
        assert words is not None
        assert rest is not None
        found._words, found._length, found._rest = words.copy(), length, bytearray(rest.tobytes())
        return found

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
        block = np.frombuffer(bytes(self._rest).ljust(BLOCK, b"\0"), dtype="<u8").astype(np.uint64)
        _compress(state, block, np.array([self._length + size], dtype=np.uint64), True, PLAIN, SIGMA)
        return state.astype("<u8").tobytes()[:SIZE].hex()

    def _absorb(self) -> None:
        """Add whole blocks to the state, without the last one, which may end the message."""
        count = max(0, (len(self._rest) - 1) // BLOCK)
        if count:
            words = np.frombuffer(bytes(self._rest[: count * BLOCK]), dtype="<u8").astype(np.uint64)
            length = self._length + BLOCK * np.arange(1, count + 1)
            _compress(self._words, words, length.astype(np.uint64), False, PLAIN, SIGMA)
            del self._rest[: count * BLOCK]
            self._length += count * BLOCK
