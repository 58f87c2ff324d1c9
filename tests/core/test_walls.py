"""Walls: rings become edges with the right neighbours, corners and sides."""

import copy
import dataclasses
import gc
import pickle
import weakref

import numpy as np
import pytest
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box

from crowdbot.core import InputError, Walls


def _area(walls):
    (ax, ay), (bx, by) = walls.start.T, walls.end.T
    return 0.5 * float(np.sum(ax * by - bx * ay))


def test_a_ring_closes_and_links():
    walls = Walls.of([[(0, 0), (2, 0), (2, 1), (0, 1), (0, 0)]])
    assert len(walls) == 4
    np.testing.assert_array_equal(walls.end[walls.previous], walls.start)
    np.testing.assert_array_equal(walls.start[walls.next], walls.end)
    assert walls.convex.all()


def test_clockwise_corners_are_concave():
    assert not Walls.of([[(0, 0), (0, 1), (2, 1), (2, 0)]]).convex.any()


def test_a_thin_wall_has_two_edges_and_is_one_segment():
    walls = Walls.of([[(0, 0), (3, 0)], [(0, 0), (2, 0), (2, 1)]])
    assert len(walls) == 5
    assert walls.convex[:2].all()
    assert walls.segments().shape == (4, 4)


def test_shapely_polygons_are_solid_whatever_their_direction():
    for ring in ([(0, 0), (2, 0), (2, 1)], [(2, 1), (2, 0), (0, 0)]):
        assert _area(Walls.of([Polygon(ring)])) == pytest.approx(1.0)


def test_a_hole_of_a_solid_is_a_room():
    solid = box(0, 0, 4, 4).difference(box(1, 1, 2, 2))
    assert _area(Walls.of([solid])) == pytest.approx(16.0 - 1.0)


def test_multipolygons_and_lines():
    assert len(Walls.of([MultiPolygon([box(0, 0, 1, 1), box(3, 3, 4, 4)])])) == 8
    assert len(Walls.of([LineString([(0, 0), (1, 0), (1, 1)])])) == 4


def test_around_a_walkable_area():
    area = box(0, 0, 10, 5).difference(Point(5, 2.5).buffer(0.5))
    assert _area(Walls.around(area)) == pytest.approx(-area.area)
    assert _area(Walls.around([(0, 0), (10, 0), (10, 5), (0, 5)])) == pytest.approx(-50.0)


def test_edges_are_linked_ring_by_ring():
    walls = Walls.of([[(0, 0), (2, 0), (2, 1)], [(5, 5), (6, 5)]])
    assert walls.start.tolist() == [[0, 0], [2, 0], [2, 1], [5, 5], [6, 5]]
    assert walls.end.tolist() == [[2, 0], [2, 1], [0, 0], [6, 5], [5, 5]]
    assert walls.previous.tolist() == [2, 0, 1, 4, 3]
    assert walls.next.tolist() == [1, 2, 0, 4, 3]
    assert walls.segments().tolist() == [[0, 0, 2, 0], [2, 0, 2, 1], [2, 1, 0, 0], [5, 5, 6, 5]]
    assert Walls.of(walls) is walls


def test_only_corners_to_the_right_are_concave():
    step = [(0, 0), (4, 0), (4, 4), (2, 4), (2, 2), (0, 2)]  # an L with one concave corner, at (2, 2)
    assert Walls.of([step]).convex.tolist() == [True, True, True, True, False, True]
    assert Walls.of([[(0, 0), (1, 0), (2, 0), (2, 2)]]).convex.all()  # a straight corner is convex


def test_repeated_points_are_dropped():
    assert Walls.of([[(0, 0), (0, 0), (2, 0), (2, 1), (2, 1)]]).start.tolist() == [[0, 0], [2, 0], [2, 1]]


def test_a_walkable_ring_is_clockwise_whatever_its_direction():
    ring = [(0, 0), (2, 0), (2, 1)]
    assert _area(Walls.around(ring)) == _area(Walls.around(ring[::-1])) == -1.0
    holes = Polygon(box(0, 0, 9, 9).exterior, [list(box(1, 1, 2, 2).exterior.coords)[::-1]])
    assert _area(Walls.around(holes)) == pytest.approx(1.0 - 81.0)


def test_the_number_of_a_wrong_ring_is_named():
    with pytest.raises(InputError, match="wall 1 has a coordinate"):
        Walls.of([[(0, 0), (1, 0)], [(0, 0), (np.nan, 1)]])


@pytest.mark.parametrize(
    ("ring", "words"),
    [
        ([(0, 0)], "wall 0 has no length"),
        ([(1, 1), (1, 1)], "wall 0 has no length"),
        ([(0, 0), (np.inf, 1)], "not finite"),
        ([(0, 0, 0), (1, 1, 1)], r"shape \[2, 3\]"),
    ],
)
def test_wrong_rings_are_named(ring, words):
    with pytest.raises(InputError, match=words):
        Walls.of([ring])


def test_no_walls_are_empty_arrays():
    walls = Walls.of()
    assert len(walls) == 0
    assert walls.segments().shape == (0, 4)


def test_derived_values_are_computed_once_for_each_walls():
    calls = []

    def count(walls):
        calls.append(walls)
        return len(walls)

    one, other = (Walls.of([[(0, 0), (2, 0), (2, k)]]) for k in (1, 2))
    assert [one.derive(count), one.derive(count), other.derive(count)] == [3, 3, 3]
    assert [id(call) for call in calls] == [id(one), id(other)]
    assert one.segments() is one.segments()
    assert one.segments() is not other.segments()


def test_copies_of_walls_derive_their_own_values():
    walls = Walls.of([[(0, 0), (2, 0)]])
    plain = pickle.dumps(walls)
    segments = walls.segments()
    assert pickle.dumps(walls) == plain
    moved = dataclasses.replace(walls, start=walls.start + 1.0, end=walls.end + 1.0)
    assert moved.segments().tolist() == [[1.0, 1.0, 3.0, 1.0]]
    for same in (copy.deepcopy(walls), pickle.loads(plain), copy.copy(walls)):
        assert same.segments() is not segments
        np.testing.assert_array_equal(same.segments(), segments)


def test_derived_values_do_not_keep_walls_alive():
    walls = Walls.of([[(0, 0), (2, 0)]])
    walls.segments()
    reference = weakref.ref(walls)
    del walls
    gc.collect()
    assert reference() is None
