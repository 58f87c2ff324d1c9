"""Rotations, inertias and the bodies of props against formulas and slow twins."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, stream
from crowdbot.world import Cube, Table, Tree, quaternion, roll_pitch_yaw
from crowdbot.world.urdf.inertia import _round_tensor, _sides, unphysical
from crowdbot.world.urdf.shapes import Box, Capsule, ConvexPiece, Cylinder, Sphere, together
from crowdbot.world.urdf.transforms import across, axis_rotation, frame, from_quaternion, transform_points

angle = st.floats(-math.pi, math.pi)
some = settings(max_examples=40, deadline=None)


@some
@given(roll=angle, pitch=angle, yaw=angle)
def test_rotations_and_quaternions_are_each_other_s_inverse(roll: float, pitch: float, yaw: float) -> None:
    rotation = roll_pitch_yaw(roll, pitch, yaw)
    x, y, z = np.eye(3)
    np.testing.assert_allclose(
        rotation, axis_rotation(z, yaw) @ axis_rotation(y, pitch) @ axis_rotation(x, roll), atol=1e-12
    )
    wxyz = quaternion(rotation)
    assert wxyz[0] >= 0.0
    assert np.linalg.norm(wxyz) == pytest.approx(1.0)
    np.testing.assert_allclose(from_quaternion(wxyz), rotation, atol=1e-9)
    np.testing.assert_allclose(from_quaternion(-3.0 * wxyz), rotation, atol=1e-9)


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.6, 0.8, 0.0), (0.0, -0.6, 0.8)])
@pytest.mark.parametrize("turn", [0.3, 2.0, math.pi - 1e-3, math.pi])
def test_a_quaternion_has_half_the_angle_and_the_axis(axis: tuple[float, float, float], turn: float) -> None:
    wxyz = quaternion(axis_rotation(axis, turn))
    expected = np.array([math.cos(0.5 * turn), *(math.sin(0.5 * turn) * np.array(axis))])
    np.testing.assert_allclose(wxyz * np.sign(wxyz @ expected), expected, atol=1e-9)


@some
@given(seed=st.integers(0, 999))
def test_the_shortest_way_brings_z_to_an_axis(seed: int) -> None:
    axis = stream(seed, "axis").normal(size=3)
    axis /= np.linalg.norm(axis)
    turn = across(axis)
    np.testing.assert_allclose(turn[:, 2], axis, atol=1e-9)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-9)
    assert np.trace(turn) == pytest.approx(1.0 + 2.0 * axis[2])  # the angle between z and the axis, no more
    np.testing.assert_array_equal(across((0.0, 0.0, -1.0)), np.diag([1.0, -1.0, -1.0]))


def test_points_of_a_frame_in_its_parent() -> None:
    place = frame((1.0, 2.0, 3.0), roll_pitch_yaw(0.0, 0.0, math.pi / 2))
    np.testing.assert_allclose(transform_points(place, np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 5.0]])),
                               [[1.0, 3.0, 3.0], [0.0, 2.0, 8.0]], atol=1e-12)  # fmt: skip


@pytest.mark.parametrize(
    ("shape", "volume", "moments"),
    [
        (Box((1.0, 2.0, 3.0)), 6.0, np.array([13.0, 10.0, 5.0]) / 12.0),
        (Sphere(2.0), 32.0 * math.pi / 3.0, np.full(3, 0.4 * 4.0)),
    ],
)
def test_moments_of_one_kilogram(shape: Box | Sphere, volume: float, moments: np.ndarray) -> None:
    solid = shape.solid()
    assert solid.volume == pytest.approx(volume)
    np.testing.assert_allclose(solid.inertia(1.0), np.diag(moments), atol=1e-12)


def test_moments_of_a_cylinder_are_those_of_textbooks() -> None:
    # about its centre: m r^2 / 2 along the axis, m (3 r^2 + l^2) / 12 across
    inertia = Cylinder(0.5, 2.0).solid().inertia(3.0)
    np.testing.assert_allclose(
        np.diag(inertia), [3.0 * (0.75 + 4.0) / 12.0, 3.0 * (0.75 + 4.0) / 12.0, 0.375], rtol=1e-12
    )


def test_solids_together_have_their_common_centre_and_the_inertia_of_steiner() -> None:
    box = Box((1.0, 1.0, 1.0)).solid()
    pair = together([(box, frame((-1.0, 0.0, 0.0))), (box, frame((1.0, 0.0, 0.0)))])
    assert pair is not None
    assert pair.volume == 2.0
    np.testing.assert_allclose(pair.center, np.zeros(3), atol=1e-12)
    np.testing.assert_allclose(pair.inertia(2.0), np.diag([1.0 / 3.0, 1.0 / 3.0 + 2.0, 1.0 / 3.0 + 2.0]), atol=1e-12)
    turned = together([(Box((1.0, 2.0, 3.0)).solid(), frame((5.0, 0.0, 0.0), axis_rotation((0, 0, 1), math.pi / 2)))])
    assert turned is not None
    np.testing.assert_allclose(np.diag(turned.inertia(12.0)), [10.0, 13.0, 5.0], atol=1e-9)
    assert together([]) is None


def test_a_capsule_lies_between_cylinders() -> None:
    low, solid, high = (Cylinder(0.5, 2.0).solid(), Capsule(0.5, 2.0).solid(), Cylinder(0.5, 3.0).solid())
    assert low.volume < solid.volume < high.volume
    assert solid.volume == pytest.approx(low.volume + Sphere(0.5).solid().volume)


def test_a_flat_convex_piece_has_no_volume_and_its_centre_is_the_mean_of_its_vertices() -> None:
    triangle = np.array([[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, 6.0, 1.0]])
    solid = ConvexPiece(triangle, np.array([[0, 1, 2], [0, 2, 1]])).solid()
    assert solid.volume == 0.0
    np.testing.assert_allclose(solid.center, [1.0, 2.0, 1.0])


@pytest.mark.parametrize(
    ("moments", "words"),
    [
        ((1.0, 1.0, 2.0), ""),
        ((1.0, 1.0, 2.0 + 1e-6), ""),
        ((1.0, 1.0, 2.0 + 1e-5), "violate the triangle inequality"),
        ((1e-9, 1.0, 1.0), ""),
        ((0.0, 1.0, 1.0), "must all be above 0"),
        ((-0.5, 1.0, 1.0), "must all be above 0"),
    ],
)
def test_an_inertia_is_physical_up_to_rounding(moments: tuple[float, ...], words: str) -> None:
    found = unphysical(np.diag(moments))
    assert found.endswith(words)
    assert bool(found) == bool(words)


def test_rounding_errors_of_an_inertia_are_lifted_and_nothing_else_is() -> None:
    turn = roll_pitch_yaw(0.3, -0.7, 1.1)
    rounded = turn @ np.diag([1.0, 1.0, 2.0 + 1e-7]) @ turn.T
    moments = np.linalg.eigvalsh(_round_tensor(rounded))
    assert moments[0] + moments[1] >= moments[2]
    np.testing.assert_allclose(moments, [1.0, 1.0, 2.0], atol=1e-6)
    fine = turn @ np.diag([1.0, 1.5, 2.0]) @ turn.T
    np.testing.assert_array_equal(_round_tensor(fine), fine)


def test_the_box_of_an_inertia_has_its_sides() -> None:
    solid = Box((0.3, 0.6, 1.2)).solid()
    np.testing.assert_allclose(_sides(7.0, np.diag(solid.inertia(7.0))), [0.3, 0.6, 1.2])


def geoms(element: object) -> dict[str, dict[str, str]]:
    return {child.attributes["name"]: child.attributes for child in element.children if child.tag == "geom"}  # type: ignore[attr-defined]


def numbers(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def test_a_tree_is_a_trunk_that_stops_people_and_a_crown_that_does_not() -> None:
    tree = Tree(1.0, 2.0, height=5.0, trunk=0.2, crown=1.5)
    parts = geoms(tree.body("oak"))
    assert set(parts) == {"oak/0", "oak/1"}
    radius, half = numbers(parts["oak/0"]["size"])
    assert (radius, half) == pytest.approx((0.2, 1.3))  # up to 5.0 - 1.6 * 1.5 = 2.6 m
    assert numbers(parts["oak/0"]["pos"]) == pytest.approx([0.0, 0.0, 1.3])
    wide, deep, tall = numbers(parts["oak/1"]["size"])
    assert (wide, deep, tall) == pytest.approx((1.5, 1.5, 1.5))
    assert numbers(parts["oak/1"]["pos"])[2] + tall == pytest.approx(5.0)
    assert (parts["oak/1"]["contype"], parts["oak/1"]["conaffinity"]) == ("0", "0")
    ring = tree.outline()
    assert ring is not None
    np.testing.assert_allclose([ring.min(axis=0), ring.max(axis=0)], [[0.8, 1.8], [1.2, 2.2]])


def test_a_default_tree_has_a_trunk_of_0_15_m() -> None:
    ring = Tree(0.0, 0.0).outline()
    assert ring is not None
    np.testing.assert_allclose(np.ptp(ring, axis=0), [0.3, 0.3])


@pytest.mark.parametrize("prop", [Cube(1.0, 2.0), Table(1.0, 2.0), Tree(1.0, 2.0)])
def test_props_stand_where_they_are_put(prop: Cube | Table | Tree) -> None:
    element = prop.body("it")
    assert numbers(element.attributes["pos"])[:2] == [1.0, 2.0]
    assert geoms(element)
    ring = prop.outline()
    if ring is not None:
        np.testing.assert_allclose(0.5 * (ring.min(axis=0) + ring.max(axis=0)), [1.0, 2.0])


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"x": math.nan}, 'Tree: x="nan" is not finite'),
        ({"height": 0.0}, 'Tree: height="0.0" must be at least 0.001 m'),
        ({"crown": -1.0}, 'Tree: crown="-1.0" must be at least 0.001 m'),
        ({"trunk": math.inf}, 'Tree: trunk="inf" is not finite'),
    ],
)
def test_props_without_a_size_are_refused(values: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Tree(**{"x": 0.0, "y": 0.0, **values})
