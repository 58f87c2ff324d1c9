"""Metrics of distributions against slow, obvious twins, and against what is known of them."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, stream
from crowdbot.metrics import earth_mover_distance, mode_count, mode_coverage, mode_shares, nearest_neighbor_accuracy


def far(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.mean([math.dist(a, b) for a, b in zip(one, other, strict=True)]))


def slow_accuracy(real: np.ndarray, drawn: np.ndarray) -> float:
    both = [(path, True) for path in real] + [(path, False) for path in drawn]
    right = 0.0
    for index, (path, kind) in enumerate(both):
        rest = [(far(path, other), own) for n, (other, own) in enumerate(both) if n != index]
        least = min(away for away, _ in rest)
        nearest = [own for away, own in rest if away <= least * (1.0 + 1e-12)]
        right += sum(own == kind for own in nearest) / len(nearest)
    return right / len(both)


def slow_mover(real: np.ndarray, drawn: np.ndarray) -> float:
    pairings = itertools.permutations(range(len(drawn)))
    return min(float(np.mean([far(real[n], drawn[m]) for n, m in enumerate(order)])) for order in pairings)


@settings(max_examples=25)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 5), steps=st.integers(1, 3), grid=st.booleans())
def test_they_equal_their_slow_twins(seed: int, count: int, steps: int, grid: bool) -> None:
    rng = stream(seed, "paths")
    paths = (
        rng.integers(0, 2, (2, 3, count, steps, 2)).astype(float) if grid else rng.normal(size=(2, 3, count, steps, 2))
    )
    near, moved = nearest_neighbor_accuracy(*paths), earth_mover_distance(*paths)
    for group in range(3):
        assert near[group] == pytest.approx(slow_accuracy(paths[0, group], paths[1, group]))
        assert moved[group] == pytest.approx(slow_mover(paths[0, group], paths[1, group]))


def test_what_is_known_of_equal_copied_and_far_samples() -> None:
    rng = stream(1, "known")
    real, drawn = rng.normal(size=(2, 400, 20, 2, 2))
    assert nearest_neighbor_accuracy(real, drawn).mean() == pytest.approx(0.48, abs=0.02)  # leaving out bends it down
    assert nearest_neighbor_accuracy(real, real).max() == 0.0
    assert nearest_neighbor_accuracy(real, drawn + 50.0).min() == 1.0
    assert earth_mover_distance(real, real[:, ::-1]).max() == 0.0
    far_away = earth_mover_distance(real, real + np.array([30.0, 40.0]))
    assert far_away == pytest.approx(np.full(400, 50.0))


def test_copies_that_tie_are_shared() -> None:
    same = np.zeros((4, 1, 2))
    assert nearest_neighbor_accuracy(same, same).item() == pytest.approx(3 / 7)


def test_a_cost_is_not_taken_from_both_sides() -> None:
    """The cost of real n with drawn m differs from that of real m with drawn n."""
    real = np.array([0.0, 1.0, 5.0])[:, None, None] * np.ones(2)
    drawn = np.array([0.0, 0.0, 0.0])[:, None, None] * np.ones(2)
    assert earth_mover_distance(real, drawn).item() == pytest.approx(2.0 * math.sqrt(2.0))


def test_modes_are_counted_and_covered() -> None:
    modes = np.array([[[0.0, 0.0]], [[1.0, 0.0]], [[2.0, 0.0]]])
    drawn = np.concatenate([np.repeat(modes[:1], 11, 0), np.repeat(modes[1:2], 1, 0)]) + 0.01
    assert mode_shares(drawn, modes).tolist() == pytest.approx([11 / 12, 1 / 12, 0.0])
    assert mode_count(drawn, modes).item() == 2
    assert mode_count(drawn, modes, within=0.001).item() == 0
    assert mode_coverage(drawn, modes).item() == pytest.approx(1 / 3 + 1 / 12)
    assert mode_coverage(modes, modes).item() == pytest.approx(1.0)


def test_wrong_shapes_are_said() -> None:
    with pytest.raises(InputError, match=r"shapes \[2, 1, 2\] and \[3, 1, 2\]; both must be"):
        earth_mover_distance(np.zeros((2, 1, 2)), np.zeros((3, 1, 2)))
    with pytest.raises(InputError, match="at least one"):
        nearest_neighbor_accuracy(np.zeros((0, 1, 2)), np.zeros((0, 1, 2)))
    with pytest.raises(InputError, match="do not match"):
        mode_shares(np.zeros((2, 1, 2)), np.zeros((2, 2, 2)))
