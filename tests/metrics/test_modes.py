"""Shares of modes: who belongs to which, batches, and shapes that do not fit."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.metrics import mode_count, mode_coverage, mode_shares

LEFT, RIGHT = [[0.0, 1.0], [0.0, 2.0]], [[0.0, -1.0], [0.0, -2.0]]


def test_a_path_belongs_to_the_nearest_mode_within_the_distance() -> None:
    drawn = np.array([LEFT, LEFT, RIGHT, [[0.0, 9.0], [0.0, 9.0]]])
    assert mode_shares(drawn, [LEFT, RIGHT]).tolist() == [0.75, 0.25]
    assert mode_shares(drawn, [LEFT, RIGHT], within=1.0).tolist() == [0.5, 0.25]
    assert mode_shares(drawn + [0.6, 0.8], [LEFT, RIGHT], within=1.0 + 1e-9).tolist() == [0.5, 0.25]
    assert mode_shares(drawn + [0.6, 0.8], [LEFT, RIGHT], within=1.0 - 1e-9).tolist() == [0.0, 0.0]


def test_a_mode_is_found_with_a_quarter_of_an_even_share() -> None:
    for count, expected in ((6, 2), (7, 2), (8, 1)):
        drawn = np.array([LEFT] * count + [RIGHT])
        assert mode_count(drawn, [LEFT, RIGHT]).item() == expected
        assert mode_coverage(drawn, [LEFT, RIGHT]).item() == pytest.approx(0.5 + 1.0 / (count + 1))


def test_a_batch_is_each_alone() -> None:
    rng = np.random.default_rng(0)
    drawn, modes = rng.normal(size=(3, 2, 5, 4, 2)), rng.normal(size=(3, 2, 6, 4, 2))
    shares = mode_shares(drawn, modes, within=2.0)
    assert shares.shape == (3, 2, 6)
    for place in np.ndindex(3, 2):
        np.testing.assert_array_equal(shares[place], mode_shares(drawn[place], modes[place], within=2.0))


@pytest.mark.parametrize(
    ("drawn", "modes"),
    [
        ((5, 4, 2), (4, 2)), ((4, 2), (4, 2)), ((5, 4, 2), (3, 5, 2)), ((5, 4, 3), (3, 4, 2)), ((0, 4, 2), (3, 4, 2)),
        ((5, 4, 2), (0, 4, 2)), ((5, 0, 2), (3, 0, 2)), ((2, 5, 4, 2), (3, 5, 4, 2)), ((1, 5, 4, 2), (3, 5, 4, 2)),
    ],
)  # fmt: skip
def test_shapes_that_do_not_fit_are_refused(drawn: tuple[int, ...], modes: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match="do not match"):
        mode_shares(np.zeros(drawn), np.zeros(modes))
