"""Rays in space against signed distances, sampled along the ray, and against linear equations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from crowdbot.core import stream
from crowdbot.core.rays import (
    BOX,
    CAPSULE,
    CYLINDER,
    TRIANGLE,
    WALL,
    WIDTH,
    meet,
    normal_at,
    ray_to_triangle,
    ray_to_wall,
    within,
)

some = settings(max_examples=60, deadline=None)
seeds = st.integers(0, 10_000)
FAR = 14.0


def unit(vector):
    return vector / np.linalg.norm(vector)


def turned(rng):
    """Return three perpendicular unit vectors ``[3, 3]``."""
    return np.linalg.qr(rng.normal(size=(3, 3)))[0].T


def shape(kind, rng, near=2.5):
    """Return the row of a capsule, cylinder or box at about ``near`` from the origin."""
    row = np.zeros(WIDTH)
    row[:3] = near * unit(rng.normal(size=3)) * rng.uniform(0.2, 2.0)
    if kind == BOX:
        row[3:12], row[12:15] = turned(rng).ravel(), rng.uniform(0.2, 1.5, 3)
    else:
        row[3:6], row[6], row[7] = unit(rng.normal(size=3)), rng.uniform(0.1, 3.0), rng.uniform(0.1, 1.2)
    return row


def signed_distance(kind, row, points):
    """Return a distance that is negative inside, 0 on the surface and 1-Lipschitz: ``[P]`` of points ``[P, 3]``."""
    away = points - row[:3]
    if kind == BOX:
        off = np.abs(away @ row[3:12].reshape(3, 3).T) - row[12:15]
        return np.linalg.norm(np.maximum(off, 0.0), axis=1) + np.minimum(off.max(axis=1), 0.0)
    height = away @ row[3:6]
    side = np.linalg.norm(away - height[:, None] * row[3:6], axis=1)
    over = np.maximum(height - row[6], -height)
    if kind == CAPSULE:
        return np.hypot(side, np.maximum(over, 0.0)) - row[7]
    off = np.stack([side - row[7], over], axis=1)
    return np.linalg.norm(np.maximum(off, 0.0), axis=1) + np.minimum(off.max(axis=1), 0.0)


@pytest.mark.parametrize("kind", [CAPSULE, CYLINDER, BOX])
@some
@given(seed=seeds)
def test_a_ray_meets_a_solid_where_its_distance_is_first_zero(kind, seed):
    rng = stream(seed, "rays")
    row = shape(kind, rng)
    here = signed_distance(kind, row, np.zeros((1, 3)))[0]
    assume(abs(here) > 0.02)
    assert within(kind, row) == (here < 0.0)
    assume(here > 0.0)
    d = unit(row[:3] + rng.normal(0.0, 1.2, 3))
    along = np.linspace(0.0, FAR, 4001)
    distance = signed_distance(kind, row, along[:, None] * d)
    assume(abs(distance.min()) > 0.01)
    found = meet(kind, *d, row)
    if distance.min() > 0.0:
        assert found == math.inf
        return
    first = along[np.argmax(distance <= 0.0)]
    assert first - FAR / 4000 - 1e-9 <= found <= first + 1e-9
    point = found * d
    assert signed_distance(kind, row, point[None])[0] == pytest.approx(0.0, abs=1e-9)
    around = point + 1e-5 * np.concatenate([np.eye(3), -np.eye(3)])
    slope = signed_distance(kind, row, around)
    gradient = (slope[:3] - slope[3:]) / 2e-5
    if abs(np.linalg.norm(gradient) - 1.0) < 1e-4:  # not at an edge
        np.testing.assert_allclose(normal_at(kind, *point, row), gradient, atol=1e-3)


@pytest.mark.parametrize("kind", [CAPSULE, CYLINDER, BOX])
@some
@given(seed=seeds)
def test_the_origin_is_within_a_solid_or_not(kind, seed):
    row = shape(kind, stream(seed, "within"), near=0.8)
    here = signed_distance(kind, row, np.zeros((1, 3)))[0]
    assume(abs(here) > 1e-9)
    assert within(kind, row) == (here < 0.0)


def corners(kind, rng):
    """Return corner and two edges of a flat shape, and its row."""
    corner, edge = rng.normal(0.0, 2.0, 3), rng.normal(0.0, 2.0, 3)
    row = np.zeros(WIDTH)
    if kind == TRIANGLE:
        other = rng.normal(0.0, 2.0, 3)
        row[:9] = np.concatenate([corner, corner + edge, corner + other])
        return corner, edge, other, row
    up, tall = unit(np.cross(edge, rng.normal(size=3))), rng.uniform(0.5, 3.0)
    row[:10] = np.concatenate([corner, edge, up, [tall]])
    return corner, edge, tall * up, row


@pytest.mark.parametrize("kind", [WALL, TRIANGLE])
@some
@given(seed=seeds)
def test_a_ray_meets_a_flat_shape_where_three_equations_say(kind, seed):
    rng = stream(seed, "flat")
    corner, one, two, row = corners(kind, rng)
    inside = corner + rng.uniform(-0.3, 1.0) * one + rng.uniform(-0.3, 1.0) * two
    d = unit(inside if rng.random() < 0.9 else -inside)
    matrix = np.stack([d, -one, -two], axis=1)
    assume(abs(np.linalg.det(matrix)) > 1e-3)
    t, a, b = np.linalg.solve(matrix, corner)
    rest = 1.0 - a - b if kind == TRIANGLE else min(1.0 - a, 1.0 - b)
    assume(min(abs(t), abs(a), abs(b), abs(rest)) > 1e-3)
    expected = t if t > 0.0 and a > 0.0 and b > 0.0 and rest > 0.0 else math.inf
    assert meet(kind, *d, row) == pytest.approx(expected, rel=1e-9)
    normal = np.array(normal_at(kind, *(t * d), row))
    assert np.linalg.norm(normal) == pytest.approx(1.0)
    np.testing.assert_allclose([normal @ unit(one), normal @ unit(two)], 0.0, atol=1e-9)
    assert not within(kind, row)


def test_a_ray_along_an_axis_meets_the_end_of_a_rod():
    row = np.array([2.0, 0.1, 0.0, 1.0, 0.0, 0.0, 3.0, 0.5, *[0.0] * 8])
    assert meet(CYLINDER, 1.0, 0.0, 0.0, row) == pytest.approx(2.0)
    assert meet(CAPSULE, 1.0, 0.0, 0.0, row) == pytest.approx(2.0 - math.sqrt(0.25 - 0.01))
    row[1] = 0.6
    assert meet(CYLINDER, 1.0, 0.0, 0.0, row) == meet(CAPSULE, 1.0, 0.0, 0.0, row) == math.inf
    row[:3] = (5.0, 0.1, 0.0)
    row[3] = -1.0
    assert meet(CYLINDER, 1.0, 0.0, 0.0, row) == pytest.approx(2.0)
    assert meet(CYLINDER, -1.0, 0.0, 0.0, row) == math.inf
    assert meet(CAPSULE, -1.0, 0.0, 0.0, row) == math.inf


def test_a_ray_along_a_side_of_a_box_or_in_a_plane_misses():
    box = np.array([3.0, 0.0, 0.0, *np.eye(3).ravel(), 1.0, 0.5, 0.5, 0.0])
    assert meet(BOX, 1.0, 0.0, 0.0, box) == 2.0
    assert meet(BOX, -1.0, 0.0, 0.0, box) == math.inf
    box[1] = 0.6
    assert meet(BOX, 1.0, 0.0, 0.0, box) == math.inf
    box[1] = 0.5
    assert meet(BOX, 1.0, 0.0, 0.0, box) == 2.0  # the side belongs to it
    assert ray_to_wall(1.0, 0.0, 0.0, 2.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0) == math.inf
    assert ray_to_triangle(1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0, 0.0, 0.0, 2.0, 1.0, 0.0) == math.inf


@some
@given(seed=seeds)
def test_no_ray_slips_between_two_triangles(seed):
    rng = stream(seed, "edge")
    a, b = rng.normal(0.0, 2.0, 3), rng.normal(0.0, 2.0, 3)
    d = unit(a + rng.uniform(0.05, 0.95) * (b - a))
    middle = np.cross(d, b - a)
    left, right = (a + b) / 2.0 + middle, (a + b) / 2.0 - middle
    met = [ray_to_triangle(*d, *a, *b, *left), ray_to_triangle(*d, *b, *a, *right)]
    assert math.isfinite(min(met))
