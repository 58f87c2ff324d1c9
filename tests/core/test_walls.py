"""Walls: rings become edges with the right neighbours, corners and sides."""

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
