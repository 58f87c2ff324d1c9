"""Surfaces: every side of a wall once, every corner once, against the plain distance to a union of segments."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from model_crowds import PILLAR, ROOM

from crowdbot.core import Walls
from crowdbot.models.forces.wall_surfaces import surface_distance, wall_surfaces


def felt(walls, x, y, reach=100.0):
    """Return distance and normal of every surface that is felt at x, y, nearest first."""
    surfaces = wall_surfaces(Walls.of(walls))
    all_ = [surface_distance(*surfaces, k, x, y, reach) for k in range(len(surfaces.face) + len(surfaces.corner))]
    return sorted(item for item in all_ if item[0] < math.inf)


def test_a_joint_is_felt_once():
    wall = [[(float(k), 0.0), (k + 1.0, 0.0)] for k in range(-5, 5)]
    for x in (0.0, 0.5, 1.0 - 1e-16, 1.0, 1.0 + 1e-15, -2.0):
        assert felt(wall, x, 0.7) == [(pytest.approx(0.7), 0.0, 1.0)]
        assert felt(wall, x, -0.7) == [(pytest.approx(0.7), 0.0, -1.0)]


def test_both_walls_of_a_room_corner_are_felt():
    near = felt([ROOM], 5.0, 5.5)[:2]
    assert near == [(0.5, 0.0, -1.0), (1.0, -1.0, 0.0)]
    assert len(felt([ROOM], 5.0, 5.5)) == 4


def test_an_outer_corner_is_felt_once_from_its_cone():
    box = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    assert felt([box], 1.3, 1.4) == [(pytest.approx(0.5), pytest.approx(0.6), pytest.approx(0.8))]
    assert felt([box], 0.5, 1.4) == [(pytest.approx(0.4), 0.0, 1.0)]  # and not the far side


def test_nothing_is_felt_inside_of_a_solid_or_on_a_corner():
    box = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    assert felt([box], 0.5, 0.6) == []
    assert felt([box], 1.0, 1.0) == []
    assert felt([], 0.0, 0.0) == []


@settings(max_examples=200, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_the_nearest_surface_is_the_nearest_point_of_all_walls(seed):
    rng = np.random.default_rng(seed)
    corners = np.cumsum(rng.normal(0.0, 1.0, (6, 2)), axis=0)
    walls = [corners[k : k + 2] for k in range(5)] + [np.array(PILLAR)]
    x, y = rng.normal(0.0, 3.0, 2)
    segments = Walls.of(walls).segments()
    best = math.inf
    for ax, ay, bx, by in segments:
        t = np.clip(((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2), 0.0, 1.0)
        best = min(best, math.hypot(x - ax - t * (bx - ax), y - ay - t * (by - ay)))
    ring = np.array(PILLAR)
    edge, there = np.roll(ring, -1, axis=0) - ring, (x, y) - ring
    inside = np.all(edge[:, 0] * there[:, 1] - edge[:, 1] * there[:, 0] >= 0.0)
    if not inside:  # who stands in the pillar does not feel it
        assert felt(walls, x, y)[0][0] == pytest.approx(best)
    assert felt(walls, x, y, reach=best * 0.999) == []
