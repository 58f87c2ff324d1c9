"""Outlines: signed distances in random poses against shapely and the Minkowski difference."""

import math

import numpy as np
import pytest
import shapely

from crowdbot.core import InputError, kernel
from crowdbot.core.outlines import (
    Outlines,
    body_gap,
    convex_hull,
    inscribed_radius,
    outline_of,
    outline_to_outline,
    point_to_outline,
    segment_to_outline,
    swept_gap,
    swept_wall_gap,
    to_frame,
)

POSES = 100_000
SHAPES = [
    np.array([[-0.445, -0.29], [0.445, -0.29], [0.445, 0.29], [-0.445, 0.29]]),
    np.array([[-0.6, -0.2], [0.1, -0.3], [0.25, 0.0], [0.1, 0.3], [-0.6, 0.2]]),
    np.array([[0.0, -0.4], [0.5, 0.3], [-0.3, 0.2]]),
]


@kernel
def _segments(rows, corner, first, last, out):
    for k in range(len(rows)):
        out[k] = segment_to_outline(rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], corner, first, last)


@kernel
def _points(rows, corner, first, last, out):
    for k in range(len(rows)):
        out[k] = point_to_outline(rows[k, 0], rows[k, 1], corner, first, last)


@kernel
def _pairs(pose, corner, first, last, begin, end, out):
    for k in range(len(pose)):
        out[k] = outline_to_outline(pose[k, 0], pose[k, 1], pose[k, 2], corner, first, last, begin, end)


def _depth(difference):
    """Return the distance of the origin to the border of convex hulls that contain it."""
    hulls = shapely.convex_hull(shapely.multipoints(difference))
    return shapely.distance(shapely.boundary(hulls), shapely.Point(0.0, 0.0))


def _placed(shape, pose):
    cos, sin = np.cos(pose[:, 2])[:, None], np.sin(pose[:, 2])[:, None]
    return np.stack(
        [pose[:, :1] + cos * shape[:, 0] - sin * shape[:, 1], pose[:, 1:2] + sin * shape[:, 0] + cos * shape[:, 1]], -1
    )


@pytest.mark.parametrize("shape", SHAPES)
def test_points_and_discs_in_random_places(shape):
    places = np.random.default_rng(1).uniform(-1.0, 1.0, (POSES, 2))
    out = np.empty((POSES, 3))
    _points(places, shape, 0, len(shape), out)
    polygon, points = shapely.Polygon(shape), shapely.points(places)
    border = shapely.distance(polygon.exterior, points)
    np.testing.assert_allclose(out[:, 0], np.where(shapely.contains(polygon, points), -border, border), atol=1e-12)
    np.testing.assert_allclose(np.hypot(*(out[:, 1:] - places).T), border, atol=1e-12)
    np.testing.assert_allclose(shapely.distance(polygon.exterior, shapely.points(out[:, 1:])), 0.0, atol=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_segments_in_random_places(shape):
    rng = np.random.default_rng(2)
    rows = np.concatenate([rng.uniform(-1.0, 1.0, (POSES, 2)), np.zeros((POSES, 2))], axis=1)
    rows[:, 2:] = rows[:, :2] + rng.normal(0.0, 0.5, (POSES, 2))
    out = np.empty((POSES, 5))
    _segments(rows, shape, 0, len(shape), out)
    polygon, lines = shapely.Polygon(shape), shapely.linestrings(rows.reshape(-1, 2, 2))
    apart = shapely.distance(polygon, lines)
    meets = apart == 0.0
    assert 0.1 < meets.mean() < 0.9
    np.testing.assert_allclose(out[~meets, 0], apart[~meets], atol=1e-12)
    np.testing.assert_allclose(shapely.distance(polygon, shapely.points(out[~meets, 1:3])), 0.0, atol=1e-12)
    np.testing.assert_allclose(shapely.distance(lines[~meets], shapely.points(out[~meets, 3:])), 0.0, atol=1e-12)
    ends = rows[meets].reshape(-1, 2, 2)
    depth = _depth((shape[None, :, None] - ends[:, None]).reshape(len(ends), -1, 2))
    np.testing.assert_allclose(-out[meets, 0], depth, atol=1e-12)
    np.testing.assert_allclose(np.hypot(*(out[:, 1:3] - out[:, 3:]).T), np.abs(out[:, 0]), atol=1e-12)


@pytest.mark.parametrize("pair", [(0, 0), (0, 1), (1, 2)])
def test_two_outlines_in_random_poses(pair):
    one, two = SHAPES[pair[0]], SHAPES[pair[1]]
    pose = np.random.default_rng(3).uniform([-1.2, -1.2, -9.0], [1.2, 1.2, 9.0], (POSES, 3))
    out, corner = np.empty(POSES), np.concatenate([one, two])
    _pairs(pose, corner, 0, len(one), len(one), len(corner), out)
    placed = _placed(two, pose)
    apart = shapely.distance(shapely.Polygon(one), shapely.polygons(placed))
    meets = apart == 0.0
    assert 0.2 < meets.mean() < 0.8
    np.testing.assert_allclose(out[~meets], apart[~meets], atol=1e-12)
    difference = (one[None, :, None] - placed[meets][:, None]).reshape(meets.sum(), -1, 2)
    np.testing.assert_allclose(-out[meets], _depth(difference), atol=1e-12)


def test_bodies_are_discs_or_outlines():
    box = SHAPES[0]
    table = Outlines.of({1: box, 3: box}, agents=4)
    assert table.first.tolist() == [0, 0, 4, 4, 8]
    disc, outline = (0.3, 0, 0), (0.54, 0, 4)
    right = 0.5 * math.pi

    def gap(one, a, two, b):
        return body_gap(*a, one[0], *one[1:], *b, two[0], *two[1:], table.corner)

    assert gap(disc, (0.0, 0.0, 0.0), disc, (2.0, 0.0, 0.0)) == pytest.approx(1.4)
    assert gap(outline, (0.0, 0.0, 0.0), disc, (2.0, 0.0, 0.0)) == pytest.approx(2.0 - 0.445 - 0.3)
    assert gap(disc, (2.0, 0.0, 0.0), outline, (0.0, 0.0, right)) == pytest.approx(2.0 - 0.29 - 0.3)
    assert gap(outline, (1.0, 1.0, 0.0), outline, (1.0, 2.0, right)) == pytest.approx(1.0 - 0.29 - 0.445)


def test_a_sweep_finds_what_ends_miss():
    """A box drives past a disc; a bar turns over a wall that it touches at neither end."""
    box = Outlines.of({0: SHAPES[0]}, 1).corner
    still = (0.0, 0.35, 0.0) * 2
    past = swept_gap(-1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.54, 0, 4, *still, 0.1, 0, 0, box, math.inf)
    assert past == pytest.approx(0.35 - 0.29 - 0.1, abs=0.01)
    walls = np.array([[0.0, 0.43, 0.1, 0.43]])
    turning = swept_wall_gap(0.0, 0.0, 0.0, 0.0, 0.0, math.pi, 0.54, box, 0, 4, walls)
    ends = swept_wall_gap(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.54, box, 0, 4, walls)
    assert ends == pytest.approx(0.14)
    assert turning < 0.0
    far = swept_gap(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.54, 0, 4, 9.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.1, 0, 0, box, 0.0)
    assert far == pytest.approx(8.0 - 0.64)


def test_outline_of_footprints():
    turn = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    assert outline_of(0.4 * circle) is None
    beside = outline_of(0.4 * circle + [0.1, 0.0])
    assert beside is not None
    assert 16 <= len(beside) <= 64
    assert inscribed_radius(beside) == pytest.approx(0.3, abs=0.002)
    hull = convex_hull(0.4 * circle + [0.1, 0.0])
    assert shapely.Polygon(beside).hausdorff_distance(shapely.Polygon(hull)) < 0.002
    with pytest.raises(InputError, match="no area"):
        outline_of([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    x, y = to_frame(1.0, 2.0, 1.0, 1.0, math.cos(0.5 * math.pi), math.sin(0.5 * math.pi))
    assert (x, y) == pytest.approx((1.0, 0.0))
