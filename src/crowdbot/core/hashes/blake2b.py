"""BLAKE2b in kernels (RFC 7693): the compression of blocks into a state that callers hold.

The hashes of :mod:`hashlib` can neither be called in kernels nor be stored.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.core.kernels import kernel
from crowdbot.typing import Words

HASH_BLOCK = 128
"""Length of a block [bytes]."""
IV = np.array(
    [
        0x6A09E667F3BCC908, 0xBB67AE8584CAA73B, 0x3C6EF372FE94F82B, 0xA54FF53A5F1D36F1,
        0x510E527FADE682D1, 0x9B05688C2B3E6C1F, 0x1F83D9ABFB41BD6B, 0x5BE0CD19137E2179,
    ],
    dtype=np.uint64,
)  # fmt: skip
"""Initial words (section 2.6)."""
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
"""Message schedule of the 12 rounds (section 2.7)."""


def hash_start(size: int) -> Words:
    """Return the state ``[8]`` of a hash without a key before the first block.

    Args:
        size: length of the digest [bytes], 1 to 64.

    >>> import hashlib
    >>> state, text = hash_start(16), b"crowd"
    >>> words = np.frombuffer(text.ljust(HASH_BLOCK, bytes(1)), dtype=np.uint64)
    >>> hash_blocks(state, words, np.array([len(text)], dtype=np.uint64), True)
    >>> state.tobytes()[:16] == hashlib.blake2b(text, digest_size=16).digest()
    True
    """
    state = IV.copy()
    state[0] ^= np.uint64(0x01010000 ^ size)
    return state


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
def _add_blocks(state: Words, words: Words, lengths: Words, last: bool, iv: Words, sigma: Any) -> None:
    """Add blocks; constants that are arguments are read faster than global ones."""
    for b in range(len(lengths)):
        m = words[16 * b : 16 * b + 16]
        v0, v1, v2, v3, v4, v5, v6, v7 = state[0], state[1], state[2], state[3], state[4], state[5], state[6], state[7]
        v8, v9, v10, v11, v12, v13, v14, v15 = iv[0], iv[1], iv[2], iv[3], iv[4] ^ lengths[b], iv[5], iv[6], iv[7]
        if last and b == len(lengths) - 1:
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
        state[0] ^= v0 ^ v8
        state[1] ^= v1 ^ v9
        state[2] ^= v2 ^ v10
        state[3] ^= v3 ^ v11
        state[4] ^= v4 ^ v12
        state[5] ^= v5 ^ v13
        state[6] ^= v6 ^ v14
        state[7] ^= v7 ^ v15


@kernel
def hash_blocks(state: Words, words: Words, lengths: Words, last: bool) -> None:
    """Add blocks to the state ``[8]`` (function F of RFC 7693); see :func:`hash_start`.

    Args:
        state: modified in place.
        words: the blocks, ``[16 * n]``, little-endian, padded with zeros.
        lengths: ``[n]`` number of bytes up to the end of each block.
        last: whether the last of the blocks ends the message.
    """
    _add_blocks(state, words, lengths, last, IV, SIGMA)
