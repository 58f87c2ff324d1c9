"""Random streams in kernels draw the numbers of the generators, and generators are made at first use."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import RandomStreams, StateError, StateMark, draw_uniform, stream, stream_states, tree

PATHS = [("spawner", 3, "place"), ("crowd",), (), ("x" * 150, 9), ("é" * 40,), ("a" * 122,), ("a" * 300, -7)]


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(-(2**63), 2**63 - 1), min_size=1, max_size=4), st.text(max_size=6), st.integers())
def test_states_are_those_of_the_generators(seeds: list[int], name: str, number: int) -> None:
    paths = [*PATHS, (name, number)]
    states = stream_states(np.array(seeds), paths)
    for e, seed in enumerate(seeds):
        for k, path in enumerate(paths):
            rng = stream(seed, *path)
            known = rng.bit_generator.state["state"]
            assert (int(states[e, k, 0]) << 64) | int(states[e, k, 1]) == known["state"]
            assert (int(states[e, k, 2]) << 64) | int(states[e, k, 3]) == known["inc"]
            assert draw_uniform(states[e : e + 1, k], 5).tolist() == [rng.random(5).tolist()]


def test_the_states_advance() -> None:
    states = stream_states(np.array([4]), [("a",)])
    first = draw_uniform(states[:, 0], 3)
    second = draw_uniform(states[:, 0], 3)
    assert np.concatenate([first, second], axis=1)[0].tolist() == stream(4, "a").random(6).tolist()


def test_streams_continue_in_rows_and_not_in_copies() -> None:
    streams, known = RandomStreams([1, 2, 3], "s"), [stream(seed, "s") for seed in (1, 2, 3)]
    assert streams[1].random() == known[1].random()
    assert streams.rows(np.array([2, 1]))[1].random() == known[1].random()
    copies, later = tree.take(streams, np.array([1, 0, 1])), [known[1].random(), known[0].random()]
    assert [rng.random() for rng in copies] == [*later, later[0]]
    assert [streams[1].random(), streams[0].random()] == later


def test_streams_are_joined_and_put() -> None:
    streams = tree.join([RandomStreams([1], "s"), RandomStreams([2], "s"), RandomStreams([3], "s")])
    streams = tree.put(streams, np.array([0, 2]), RandomStreams([8, 9], "s"))
    assert [rng.random() for rng in streams] == [stream(seed, "s").random() for seed in (8, 2, 9)]
    with pytest.raises(IndexError):
        streams[3]


@given(drawn=st.lists(st.integers(0, 3), min_size=1, max_size=4))
@settings(max_examples=20, deadline=None)
def test_stored_streams_draw_the_same_later_numbers(drawn: list[int]) -> None:
    streams = RandomStreams(range(2**70, 2**70 + len(drawn)), "sensor", 3)
    for e, count in enumerate(drawn):
        _ = streams[e].random(count) if count else None
    leaves = tree.flatten(streams)
    assert [leaves[f"tree/_streams/{e}/made"] is None for e in range(len(drawn))] == [count == 0 for count in drawn]
    restored = tree.unflatten(leaves, RandomStreams(range(len(drawn)), "sensor", 3))
    assert [rng.random() for rng in restored] == [rng.random() for rng in streams]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"tree/_streams/0/made": StateMark("random", {"bit_generator": "PCG64"})}, "not the state of a random gen"),
        ({"tree/_streams/0/made": StateMark("random", 7)}, "not the state of a random generator"),
        ({"tree/_streams/0/seed": "one"}, "is a str, but the trial has a int"),
        ({"tree/_streams": StateMark("objects", 0)}, "has 0 parts, but the trial has 1"),
    ],
)
def test_wrong_states_of_streams_are_refused(change: dict[str, object], sentence: str) -> None:
    with pytest.raises(StateError, match=sentence):
        tree.unflatten(tree.flatten(RandomStreams([1], "a")) | change, RandomStreams([1], "a"))
