"""Tracks of several environments are equal to those that are updated one by one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, stream, tree
from crowdbot.navigation import DriveLimits, ObservationBatch, TrackBatch, TrackHistory


def same(one, other):
    """Return whether two histories are equal to the last bit."""
    return one.length == other.length and all(
        np.array_equal(getattr(one, name), getattr(other, name), equal_nan=name == "position")
        for name in ("times", "ids", "position")
    )


def grow(seed, environments=4, steps=9, length=4, people=6):
    """Return a batch and the histories that were updated alone, after random rows in random environments."""
    rng = stream(seed, "batch")
    batch, alone = TrackBatch.empty(environments, length), [TrackHistory.empty(length)] * environments
    for k in range(steps):
        ids = np.stack([rng.permutation(3 * people)[:people] - 4 for _ in range(environments)])
        position = rng.normal(0.0, 5.0, (environments, people, 2))
        seen = rng.random((environments, people)) < rng.random()
        position[~seen] = np.nan
        chosen = rng.random(environments) < 0.8
        batch = batch.update(np.full(environments, 0.1 * k), ids, position, seen, chosen)
        for e in np.flatnonzero(chosen):
            alone[e] = alone[e].update(0.1 * k, ids[e, seen[e]], position[e, seen[e]])
    return batch, alone


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(0, 7))
def test_each_history_has_the_bits_of_a_single_one(seed, length, people):
    batch, alone = grow(seed, length=length, people=people)
    assert all(same(batch[e], alone[e]) for e in range(4))
    assert all(same(item, other) for item, other in zip(batch, alone, strict=True))
    again = TrackBatch.of(alone)
    assert all(same(again[e], alone[e]) for e in range(4))
    assert batch.valid.sum() == sum(int((~np.isnan(item.position[..., 0])).sum()) for item in alone)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 1000), st.lists(st.integers(0, 3), min_size=1, max_size=5), st.permutations(range(4)))
def test_environments_are_selected_and_replaced(seed, rows, places):
    (batch, alone), (other, others) = grow(seed), grow(seed + 1)
    some = tree.take(batch, np.array(rows))
    assert all(same(some[k], alone[e]) for k, e in enumerate(rows))
    kept = batch.position.copy()
    mixed = batch.put(np.array(places[:2]), tree.take(other, np.array([0, 1])))
    expected = list(alone)
    expected[places[0]], expected[places[1]] = others[0], others[1]
    assert all(same(mixed[e], expected[e]) for e in range(4))
    np.testing.assert_array_equal(batch.position, kept)


def test_observations_have_tracks_as_arrays_and_one_by_one():
    batch, alone = grow(3)
    observations = ObservationBatch(
        pose=np.zeros((4, 3)), goal=np.ones((4, 2)), radius=np.full(4, 0.3), limits=DriveLimits(1.0, 1.0), dt=0.1,
        tracks=alone,
    )  # fmt: skip
    assert isinstance(observations.tracks, TrackBatch)
    assert observations.tracks.position.shape[:2] == batch.position.shape[:2]
    assert same(observations.environment(2).tracks, alone[2])


@pytest.mark.parametrize(
    ("time", "ids", "position", "sentence"),
    [
        (0.1, [1, 2], [[0.0, 0.0], [1.0, 1.0]], "and after the newest row at 0.2 s"),
        (np.nan, [1, 2], [[0.0, 0.0], [1.0, 1.0]], "time = nan s must be finite"),
        (0.3, [1, 1], [[0.0, 0.0], [1.0, 1.0]], "must be distinct"),
        (0.3, [1, 2], [[0.0, np.inf], [1.0, 1.0]], "the position of 1 is not finite"),
    ],
)
def test_wrong_rows_are_refused_as_in_a_single_history(time, ids, position, sentence):
    two = TrackBatch.empty(2).update(np.full(2, 0.2), np.array([[1], [1]]), np.zeros((2, 1, 2)), np.ones((2, 1), bool))
    rows = (np.array([[5, 6], ids]), np.array([np.ones((2, 2)), position]), np.ones((2, 2), bool))
    with pytest.raises(InputError, match=sentence):
        two.update(np.array([0.3, time]), *rows)


def test_lengths_must_be_equal_and_above_zero():
    with pytest.raises(InputError, match=r"different lengths: \[2, 3\] rows"):
        TrackBatch.of([TrackHistory.empty(2), TrackHistory.empty(3)])
    with pytest.raises(InputError, match="length = 0 rows must be at least 1"):
        TrackBatch.empty(2, 0)
