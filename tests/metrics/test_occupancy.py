"""Scores of predicted scans against definitions written out cell by cell."""

import math

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.metrics import (
    OccupancyGrid,
    occupancy_iou,
    range_error,
    structural_similarity,
    weighted_squared_error,
)


def test_cells_grow_in_all_directions_and_points_outside_are_left_out():
    grid = OccupancyGrid(cells=8, size=0.5)
    points = [[1.1, 0.1], [math.nan, 0.0], [4.2, 0.0], [-0.1, 0.0], [1.0, 2.1], [math.inf, 0.0]]
    cells = grid.occupied(points)
    expected = np.zeros((8, 8), dtype=bool)
    expected[1:4, 3:6] = True
    assert np.array_equal(cells, expected)


def test_batches_are_independent():
    points = stream(0).uniform(-1.0, 7.0, (3, 2, 40, 2))
    whole = OccupancyGrid().occupied(points)
    assert np.array_equal(whole[2, 1], OccupancyGrid().occupied(points[2, 1]))
    assert whole.shape == (3, 2, 64, 64)


def test_intersection_over_union():
    truth = np.zeros((3, 4, 4), dtype=bool)
    truth[:2, :2] = True
    predicted = np.zeros((3, 4, 4))
    predicted[0, 1:3] = 0.5
    predicted[1] = 0.49
    assert occupancy_iou(truth, predicted)[:2].tolist() == [pytest.approx(4 / 12), 0.0]
    assert math.isnan(occupancy_iou(truth, predicted)[2])


def test_both_classes_weigh_the_same():
    truth = np.zeros((4, 4))
    truth[0, 0] = 1.0
    predicted = np.full((4, 4), 0.2)
    assert weighted_squared_error(truth, predicted) == pytest.approx(0.5 * (0.8**2 + 0.2**2))
    assert math.isnan(weighted_squared_error(np.zeros((2, 2)), np.zeros((2, 2))))


def test_structural_similarity_equals_sums_over_windows():
    rng = stream(1)
    one, other = rng.random((24, 24)), rng.random((24, 24))
    weight = np.exp(-0.5 * (np.arange(-5, 6) / 1.5) ** 2)
    window = np.outer(weight, weight) / weight.sum() ** 2
    found = np.empty((24, 24))
    a, b = np.pad(one, 5, mode="symmetric"), np.pad(other, 5, mode="symmetric")
    for i in range(24):
        for j in range(24):
            x, y = a[i : i + 11, j : j + 11], b[i : i + 11, j : j + 11]
            mx, my = (window * x).sum(), (window * y).sum()
            vx, vy = (window * (x - mx) ** 2).sum(), (window * (y - my) ** 2).sum()
            cov = (window * (x - mx) * (y - my)).sum()
            found[i, j] = (2 * mx * my + 1e-4) * (2 * cov + 9e-4) / ((mx**2 + my**2 + 1e-4) * (vx + vy + 9e-4))
    assert structural_similarity(one, other) == pytest.approx(found.mean(), rel=1e-9)


def test_missing_returns_count_as_the_largest_range():
    assert range_error([[1.0, -np.inf, np.inf]], [[3.0, 0.0, np.inf]], 10.0).tolist() == [pytest.approx(2.0 / 3.0)]


def test_wrong_values_are_rejected():
    with pytest.raises(InputError, match="size"):
        OccupancyGrid(size=0.0)
    with pytest.raises(InputError, match="cannot be compared"):
        structural_similarity(np.zeros((4, 4)), np.zeros((5, 5)))
