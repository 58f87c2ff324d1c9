"""How shapes look from the origin, against the rectangle of their heights and distances and against sampled points."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from crowdbot.core.geometry import nearest_on_segment
from crowdbot.core.windows import (
    ball_in_view,
    hull_gap,
    hull_in_view,
    hull_levels,
    hull_width,
    rod_gap,
    rod_levels,
    rod_width,
)

number = st.floats(-4.0, 4.0).map(lambda value: round(value, 3))
point = st.tuples(number, number, number)
radius = st.floats(0.05, 1.0).map(lambda value: round(value, 3))
quick = settings(max_examples=60, deadline=None)
EDGE = 1e-9


def nearest(a, b):
    """Return the distance of the origin to the line from a to b, seen from above."""
    return math.hypot(*nearest_on_segment(0.0, 0.0, *a[:2], *b[:2]))


def nearest_side(corner):
    """Return the distance of the origin to the nearest line between two corners of a hull, seen from above."""
    return min(nearest(a, b) for k, a in enumerate(corner) for b in corner[:k])


def corner_levels(low, high, near, far):
    """Return the extreme elevations of a rectangle of heights and distances."""
    angles = [math.atan2(z, d) for z in (low, high) for d in (near, far)]
    return min(angles), max(angles)


def widest_gap(azimuth):
    """Return the widest free angle between azimuths and the azimuth at its end."""
    ordered = np.sort(np.asarray(azimuth) % (2.0 * math.pi))
    gaps = np.diff(ordered, append=ordered[0] + 2.0 * math.pi)
    k = int(np.argmax(gaps))
    return gaps[k], ordered[(k + 1) % len(ordered)]


def assert_window(left, width, azimuth, spare):
    """The window covers the azimuths and is at most ``spare`` wider; ``azimuth`` fill their range densely."""
    gap, start = widest_gap(azimuth)
    if width >= 2.0 * math.pi:
        assert gap < math.pi + 0.02 + spare
        return
    behind = (np.asarray(azimuth) - left + EDGE) % (2.0 * math.pi)
    assert behind.max() <= width + 2 * EDGE
    assert width <= 2.0 * math.pi - gap + spare
    assert abs(math.remainder(left - start, 2.0 * math.pi)) <= spare + EDGE


@quick
@given(st.lists(point, min_size=3, max_size=8))
def test_a_hull_is_as_wide_as_its_corners_are_apart(points):
    corner = np.array(points)
    assume(np.hypot(corner[:, 0], corner[:, 1]).min() > 0.01)
    azimuth = np.arctan2(corner[:, 1], corner[:, 0])
    gap, _ = widest_gap(azimuth)
    assume(abs(gap - math.pi) > 1e-3)
    left, width = hull_width(corner, len(corner))
    if gap < math.pi:
        assert (left, width) == (-math.pi, 2.0 * math.pi)
    else:
        assert_window(left, width, azimuth, 1e-9)


def test_only_the_counted_corners_of_a_hull_are_seen():
    corner = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [1.0, 1.0, 2.0], [-1.0, -1.0, -9.0], [-1.0, 1.0, 9.0]])
    left, width = hull_width(corner, 3)
    assert (left, width) == pytest.approx((0.0, math.pi / 2))
    assert hull_gap(corner, 3) == pytest.approx(math.sqrt(0.5))
    assert hull_levels(corner, 3, True) == pytest.approx((0.0, math.pi / 2))
    assert hull_in_view(corner, 3, 1.0, 0.0, 0.0)


@pytest.mark.parametrize("place", range(3))
def test_a_hull_with_a_corner_above_the_origin_is_all_around(place):
    corner = np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 1.0, 0.0]])
    corner[place, :2] = 0.0
    assert hull_width(corner, 3) == (-math.pi, 2.0 * math.pi)


@quick
@given(st.lists(point, min_size=2, max_size=8))
def test_the_gap_to_a_hull_is_the_nearest_point_between_corners(points):
    corner = np.array(points)
    assert hull_gap(corner, len(corner)) == pytest.approx(nearest_side(corner), abs=1e-12)


def test_the_gap_to_a_hull_of_equal_corners_is_their_distance():
    assert hull_gap(np.full((4, 3), 3.0), 4) == pytest.approx(math.sqrt(18.0))


@quick
@given(st.lists(point, min_size=3, max_size=8), st.booleans())
def test_levels_of_a_hull_are_those_of_its_heights_and_distances(points, around):
    corner = np.array(points)
    near = 0.0 if around else nearest_side(corner)
    far, low, high = np.hypot(corner[:, 0], corner[:, 1]).max(), corner[:, 2].min(), corner[:, 2].max()
    assume(far > 0.01)
    assert hull_levels(corner, len(corner), around) == pytest.approx(corner_levels(low, high, near, far), abs=1e-9)


CUBE = np.array([[x, y, z] for x in (2.0, 3.0) for y in (-1.0, 1.0) for z in (-0.5, 0.5)])
FAR = math.hypot(3.0, 1.0)


@pytest.mark.parametrize(
    ("lift", "limit", "down", "up", "is_seen"),
    [
        (0.0, 2.0 + EDGE, -0.1, 0.1, True),
        (0.0, 2.0 - EDGE, -0.1, 0.1, False),
        (1.0, 9.0, -0.1, 0.5 / FAR + EDGE, True),
        (1.0, 9.0, -0.1, 0.5 / FAR - EDGE, False),
        (-1.0, 9.0, -0.5 / FAR - EDGE, 0.1, True),
        (-1.0, 9.0, -0.5 / FAR + EDGE, 0.1, False),
    ],
)
def test_a_hull_is_in_view_up_to_the_reach_and_the_outer_beams(lift, limit, down, up, is_seen):
    assert hull_in_view(CUBE + [0.0, 0.0, lift], 8, limit, down, up) == is_seen


def discs(a, b, radius):
    """Return points on the border of two discs, ``[P, 2]``."""
    angle = np.linspace(0.0, 2.0 * math.pi, 181)
    ring = radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return np.concatenate([a + ring, b + ring])


@quick
@given(number, number, number, number, radius)
@example(2.0, 0.0, 1.0, 0.25, 1.0)
@example(2.0, 0.0, 1.0, -0.25, 1.0)
def test_a_rod_is_as_wide_as_its_two_discs_or_a_little_more(ax, ay, bx, by, size):
    a, b = np.array([ax, ay]), np.array([bx, by])
    assume(min(math.hypot(ax, ay), math.hypot(bx, by)) > size + 0.01)
    gap = nearest(a, b)
    assume(abs(gap - size) > 0.02)
    border = discs(a, b, size)
    left, width = rod_width(ax, ay, bx, by, size)
    if gap < size:
        assert width > math.pi - 0.2
    else:
        assert_window(left, width, np.arctan2(border[:, 1], border[:, 0]), 0.14)


@pytest.mark.parametrize("other", [(2.0, 0.0), (2.0, 0.001), (2.0, 0.4), (-1.0, 2.0), (0.0, -2.0)])
@pytest.mark.parametrize("size", [0.05, 0.9, 1.4])
def test_a_rod_of_one_place_is_as_wide_as_a_disc(other, size):
    left, width = rod_width(*other, *other, size)
    exact = math.asin(size / math.hypot(*other))
    assert exact <= 0.5 * width + EDGE <= 1.11 * exact
    assert math.remainder(left + 0.5 * width - math.atan2(other[1], other[0]), 2.0 * math.pi) == pytest.approx(0.0)


def test_a_rod_over_the_origin_is_all_around():
    around = (-math.pi, 2.0 * math.pi)
    assert rod_width(0.5, 0.0, 3.0, 0.0, 0.5) == around  # the origin lies on the first disc
    assert rod_width(3.0, 0.0, 0.0, 0.3, 0.5) == around
    assert rod_width(0.0, 0.0, 3.0, 0.0, 0.0) == around
    assert rod_width(3.0, 0.0, 0.0, 0.0, 0.0) == around
    assert rod_width(-3.0, 0.1, 3.0, 0.1, 0.5) == around  # between the discs
    assert rod_width(0.5 + EDGE, 0.0, 3.0, 0.0, 0.5)[1] == pytest.approx(math.pi, abs=1e-3)


@quick
@given(point, point, radius, st.booleans())
def test_levels_of_a_rod_are_those_of_its_heights_and_distances(a, b, size, around):
    near = 0.0 if around else max(0.0, nearest(a, b) - size)
    far = max(math.hypot(*a[:2]), math.hypot(*b[:2])) + size
    expected = corner_levels(min(a[2], b[2]) - size, max(a[2], b[2]) + size, near, far)
    assert rod_levels(*a, *b, size, around) == pytest.approx(expected, abs=1e-9)


def test_levels_of_an_upright_rod():
    assert rod_levels(3.0, 4.0, 0.0, 3.0, 4.0, 1.0, 1.0, False) == pytest.approx((-math.atan2(1, 4), math.atan2(2, 4)))


@quick
@given(point, point, radius)
def test_the_gap_to_a_rod_is_the_distance_to_its_middle_line_less_its_radius(a, b, size):
    a, b = np.array(a), np.array(b)
    length = float(np.linalg.norm(b - a))
    assume(length > 0.01)
    sampled = np.linalg.norm(a + np.linspace(0.0, 1.0, 2001)[:, None] * (b - a), axis=1).min()
    expected = max(0.0, sampled - size)
    assert rod_gap(*a, *((b - a) / length), length, size) == pytest.approx(expected, abs=2e-3)


@quick
@given(point, point, radius, st.floats(0.5, 5.0), st.floats(-1.0, 0.0), st.floats(0.0, 1.0))
def test_a_rod_with_a_visible_point_is_in_view(a, b, size, limit, down, up):
    a, b = np.array(a), np.array(b)
    length = float(np.linalg.norm(b - a))
    assume(length > 0.01)
    axis, middle = (b - a) / length, 0.5 * (a + b)
    line = a + np.linspace(0.0, 1.0, 41)[:, None] * (b - a)
    ball = np.array([[0, 0, 1], [0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]) * size
    points = (line[:, None] + ball).reshape(-1, 3)
    away, flat = np.linalg.norm(points, axis=1), np.hypot(points[:, 0], points[:, 1])
    visible = (away <= limit) & (points[:, 2] <= up * flat) & (points[:, 2] >= down * flat)
    if visible.any():
        assert ball_in_view(*middle, axis[2], middle[2], 0.5 * length, size, limit, down, up)


@pytest.mark.parametrize(
    ("limit", "down", "up", "is_seen"),
    [
        (3.3 + EDGE, -1.0, 1.0, True),
        (3.3 - EDGE, -1.0, 1.0, False),
        (99.0, -1.0, 2.7 / 6.7 + EDGE, True),
        (99.0, -1.0, 2.7 / 6.7 - EDGE, False),
    ],
)
def test_a_rod_is_in_view_up_to_the_reach_and_the_outer_beams(limit, down, up, is_seen):
    # the middle is 5 m away, 4 m high; half a length 1.5 m at a slope of -2/3 and the radius 0.2 m leave 2.8 m
    assert ball_in_view(3.0, 0.0, 4.0, -2.0 / 3.0, 4.0, 1.5, 0.2, limit, down, up + 0.1 / 6.7) == is_seen
    assert ball_in_view(3.0, 0.0, -4.0, 2.0 / 3.0, -4.0, 1.5, 0.2, limit, -up - 0.1 / 6.7, -down) == is_seen
