"""BLAKE2b in kernels has the digests of hashlib, for all lengths of texts and digests."""

from __future__ import annotations

import hashlib

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import HASH_BLOCK, hash_blocks, hash_start


def digest(text: bytes, size: int, first: int) -> bytes:
    """Return the digest of a text; ``first`` blocks are added in an earlier call than the others."""
    count = max(1, -(-len(text) // HASH_BLOCK))
    words = np.frombuffer(text.ljust(count * HASH_BLOCK, b"\0"), dtype="<u8").astype(np.uint64)
    lengths = HASH_BLOCK * np.arange(1, count + 1, dtype=np.uint64)
    lengths[-1] = len(text)
    state, early = hash_start(size), min(first, count - 1)
    hash_blocks(state, words[: 16 * early], lengths[:early], False)
    hash_blocks(state, words[16 * early :], lengths[early:], True)
    return state.astype("<u8").tobytes()[:size]


@given(text=st.binary(max_size=700), size=st.integers(1, 64), first=st.integers(0, 6))
@settings(max_examples=80, deadline=None)
def test_digests_are_those_of_hashlib(text: bytes, size: int, first: int) -> None:
    assert digest(text, size, first) == hashlib.blake2b(text, digest_size=size).digest()


def test_texts_that_end_with_a_block() -> None:
    for length in (0, 1, 127, 128, 129, 256, 257):
        assert digest(b"a" * length, 16, 1) == hashlib.blake2b(b"a" * length, digest_size=16).digest()


def test_a_start_is_independent_of_later_hashes() -> None:
    before = hash_start(16).tolist()
    digest(b"crowd", 16, 0)
    assert hash_start(16).tolist() == before
