"""Random streams in kernels.

The hashes of :mod:`hashlib` can neither be called in kernels nor be stored.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.typing import Bytes, Floats, Ints, Words

from .kernels import kernel
from .random import stream, stream_text
from .tree import Storage, objects

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
def _mix_words(a: Any, b: Any, c: Any, d: Any, x: Any, y: Any) -> Any:
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
            v0, v4, v8, v12 = _mix_words(v0, v4, v8, v12, m[s[0]], m[s[1]])
            v1, v5, v9, v13 = _mix_words(v1, v5, v9, v13, m[s[2]], m[s[3]])
            v2, v6, v10, v14 = _mix_words(v2, v6, v10, v14, m[s[4]], m[s[5]])
            v3, v7, v11, v15 = _mix_words(v3, v7, v11, v15, m[s[6]], m[s[7]])
            v0, v5, v10, v15 = _mix_words(v0, v5, v10, v15, m[s[8]], m[s[9]])
            v1, v6, v11, v12 = _mix_words(v1, v6, v11, v12, m[s[10]], m[s[11]])
            v2, v7, v8, v13 = _mix_words(v2, v7, v8, v13, m[s[12]], m[s[13]])
            v3, v4, v9, v14 = _mix_words(v3, v4, v9, v14, m[s[14]], m[s[15]])
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


PLACES = 24
"""Bytes reserved for the seed at the beginning of a text."""
DIGEST = 16
"""Bytes of a hash of which a generator is seeded."""
LOW32 = np.uint64(0xFFFFFFFF)
S1, S11, S16, S32, S58, S63, S64 = (np.uint64(k) for k in (1, 11, 16, 32, 58, 63, 64))
ZERO = np.uint64(0)
INIT_A, MULT_A = np.uint64(0x43B0D7E5), np.uint64(0x931E8875)
INIT_B, MULT_B = np.uint64(0x8B51F9DD), np.uint64(0x58F38DED)
MIX_L, MIX_R = np.uint64(0xCA01F9DD), np.uint64(0x4973F715)
"""Constants of ``numpy.random.SeedSequence``."""
MULTIPLIER = (np.uint64(2549297995355413924), np.uint64(4865540595714422341))
"""High and low word of the multiplier of PCG64."""
UNIT = 1.0 / 9007199254740992.0


@dataclass
class _Stream:
    """A generator that is made at first use."""

    seed: int
    path: tuple[str | int, ...]
    made: np.random.Generator | None = None
    storage = Storage(constants=("path",))

    def __deepcopy__(self, memo: Any) -> _Stream:
        return _Stream(self.seed, self.path, copy.deepcopy(self.made))


class RandomStreams(Sequence[np.random.Generator]):
    """The generators of E environments, each made when it is first used; a tree, see :mod:`crowdbot.core.tree`.

    Args:
        seeds: seed of each environment.
        path: names or numbers that identify the consumer; see :func:`stream`.

    >>> streams = RandomStreams([4, 5], "sensor", "scan")
    >>> streams[1].random() == stream(5, "sensor", "scan").random()
    True
    """

    storage = Storage()

    def __init__(self, seeds: Iterable[int], *path: str | int) -> None:
        self._streams = objects(_Stream(int(seed), path) for seed in seeds)

    def __len__(self) -> int:
        """Return E."""
        return len(self._streams)

    def __getitem__(self, environment: Any) -> Any:
        """Return the generator of an environment."""
        chosen: _Stream = self._streams[environment]
        if chosen.made is None:
            chosen.made = stream(chosen.seed, *chosen.path)
        return chosen.made

    def rows(self, environments: Ints) -> RandomStreams:
        """Return the streams of some environments, which continue in this object too."""
        some = RandomStreams(())
        some._streams = self._streams[environments]
        return some


def stream_states(seeds: Ints, paths: Sequence[Sequence[str | int]]) -> Words:
    """Return ``[E, K, 4]`` the states of the generators ``stream(seed, *path)`` of E seeds and K paths, for kernels.

    Args:
        seeds: ``[E]``.
        paths: K paths.

    >>> states = stream_states(np.array([7, 8]), [("spawner", 3), ("crowd",)])
    >>> bool(draw_uniform(states[:, 0], 2)[1, 1] == stream(8, "spawner", 3).random(2)[1])
    True
    """
    texts = [stream_text(*path).encode() for path in paths]
    width = HASH_BLOCK * -(-(PLACES + max(map(len, texts), default=0)) // HASH_BLOCK)
    letters = np.zeros((len(texts), width), dtype=np.uint8)
    for row, text in zip(letters, texts, strict=True):
        row[: len(text)] = np.frombuffer(text, dtype=np.uint8)
    states = np.empty((len(seeds), len(texts), 4), dtype=np.uint64)
    lengths = np.array([*map(len, texts)], dtype=np.int64)
    _seed_all(np.ascontiguousarray(seeds, dtype=np.int64), letters, lengths, hash_start(DIGEST), states)
    return states


def draw_uniform(states: Words, count: int) -> Floats:
    """Return ``[N, count]`` the next numbers in [0, 1) of generators with states ``[N, 4]``, which are advanced."""
    out = np.empty((len(states), count))
    rows = np.ascontiguousarray(states)
    _draw(rows, out)
    states[:] = rows
    return out


@kernel
def next_uniform(state: Words) -> float:
    """Return the next number in [0, 1) of the generator with a state ``[4]``, as ``Generator.random``."""
    _advance(state)
    word, turn = state[0] ^ state[1], state[0] >> S58
    word = (word >> turn) | (word << ((S64 - turn) & S63))
    return float(word >> S11) * UNIT


@kernel
def _draw(states: Words, out: Floats) -> None:
    for n in range(len(out)):
        for k in range(out.shape[1]):
            out[n, k] = next_uniform(states[n])


@kernel
def _advance(state: Words) -> None:
    """Advance a PCG64 by one step: ``state * multiplier + increment`` in 128 bits, as two words each."""
    high, low = MULTIPLIER
    a0, a1, b0, b1 = state[1] & LOW32, state[1] >> S32, low & LOW32, low >> S32
    middle = a1 * b0 + ((a0 * b0) >> S32)
    other = a0 * b1 + (middle & LOW32)
    top = a1 * b1 + (middle >> S32) + (other >> S32)
    top += state[0] * low + state[1] * high + state[2]
    bottom = state[1] * low
    total = bottom + state[3]
    if total < bottom:
        top += S1
    state[0], state[1] = top, total


@kernel
def _seed_all(seeds: Ints, letters: Bytes, lengths: Ints, start: Words, states: Words) -> None:
    width = letters.shape[1]
    text, digits = np.empty(width, dtype=np.uint8), np.empty(PLACES, dtype=np.uint8)
    words, ends = np.empty(width // 8, dtype=np.uint64), np.empty(width // HASH_BLOCK, dtype=np.uint64)
    digest, pool = np.empty(8, dtype=np.uint64), np.empty(4, dtype=np.uint64)
    for e in range(len(seeds)):
        size = _write_number(seeds[e], digits)
        for k in range(len(lengths)):
            text[:] = 0
            for i in range(size):
                text[i] = digits[i]
            for i in range(lengths[k]):
                text[size + i] = letters[k, i]
            _hash(text, size + lengths[k], start, words, ends, digest)
            _seed(digest, pool, states[e, k])


@kernel
def _write_number(number: int, digits: Bytes) -> int:
    """Write the decimal digits of a number as text, and return their number."""
    rest, size = np.uint64(number), 0
    if number < 0:
        rest, digits[0], size = ZERO - np.uint64(number), 45, 1
    first, ten = size, np.uint64(10)
    while True:
        digits[size] = np.uint8(48 + int(rest % ten))
        rest //= ten
        size += 1
        if rest == ZERO:
            break
    for i in range((size - first) // 2):
        digits[first + i], digits[size - 1 - i] = digits[size - 1 - i], digits[first + i]
    return size


@kernel
def _hash(text: Bytes, size: int, start: Words, words: Words, lengths: Words, state: Words) -> None:
    """Write the BLAKE2b hash of a text padded with zeros to ``state``; words and lengths are work space."""
    blocks = max(1, -(-size // HASH_BLOCK))
    for i in range(16 * blocks):
        word = ZERO
        for k in range(8):
            word |= np.uint64(text[8 * i + k]) << np.uint64(8 * k)
        words[i] = word
    for block in range(blocks):
        lengths[block] = (block + 1) * HASH_BLOCK
    lengths[blocks - 1] = size
    state[:] = start
    hash_blocks(state, words, lengths[:blocks], True)


@kernel
def _seed(digest: Words, pool: Words, state: Words) -> None:
    """Write the state of ``PCG64(SeedSequence(number))`` of the first 128 bits of a hash."""
    constant = INIT_A
    for i in range(4):
        word = (digest[i // 2] >> (S32 * np.uint64(i % 2))) & LOW32
        pool[i], constant = _mix(word, constant, MULT_A)
    for source in range(4):
        for target in range(4):
            if source != target:
                word, constant = _mix(pool[source], constant, MULT_A)
                mixed = (MIX_L * pool[target] - MIX_R * word) & LOW32
                pool[target] = mixed ^ (mixed >> S16)
    constant, start = INIT_B, np.empty(4, dtype=np.uint64)
    for i in range(4):
        low, constant = _mix(pool[2 * i % 4], constant, MULT_B)
        high, constant = _mix(pool[(2 * i + 1) % 4], constant, MULT_B)
        start[i] = low | (high << S32)
    state[0], state[1] = ZERO, ZERO
    state[2], state[3] = (start[2] << S1) | (start[3] >> S63), (start[3] << S1) | S1
    _advance(state)
    total = state[1] + start[1]
    state[0] += start[0] + (S1 if total < start[1] else ZERO)
    state[1] = total
    _advance(state)


@kernel
def _mix(word: Any, constant: Any, factor: Any) -> Any:
    """Return a mixed word of 32 bits and the next constant of ``numpy.random.SeedSequence``."""
    word = word ^ constant
    constant = (constant * factor) & LOW32
    word = (word * constant) & LOW32
    return word ^ (word >> S16), constant
