"""Poses in space: rotations about fixed axes, parts that are mounted on other parts, and the view from above."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.core import MOUNT_HEIGHT, Pose, SpatialPose, product

ANGLE = st.floats(-3.0, 3.0)
TILT = st.floats(-1.5, 1.5)


def rotation(roll, pitch, yaw):
    """Return the matrix of turns about x, then y, then z of the world, written out."""
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


@given(ANGLE, TILT, ANGLE)
def test_angles_turn_about_the_axes_of_the_world(roll, pitch, yaw):
    pose = SpatialPose.of([[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]], roll, pitch, yaw)
    np.testing.assert_allclose(pose.matrix, [rotation(roll, pitch, yaw)] * 2, atol=1e-12)
    np.testing.assert_allclose(pose.heading, yaw, atol=1e-9)
    np.testing.assert_array_equal(pose.planar.position, [[1.0, 2.0], [0.0, 0.0]])
    np.testing.assert_array_equal(pose.planar.heading, pose.heading)
    longer = SpatialPose(pose.position, 3.0 * pose.rotation)
    np.testing.assert_allclose(longer.matrix, pose.matrix, atol=1e-12)


@given(ANGLE, TILT, ANGLE, ANGLE, TILT, ANGLE)
def test_a_product_turns_by_the_second_then_by_the_first(a, b, c, d, e, f):
    first, second = SpatialPose.of((0, 0, 0), a, b, c), SpatialPose.of((0, 0, 0), d, e, f)
    both = SpatialPose(first.position, product(first.rotation, second.rotation))
    np.testing.assert_allclose(both.matrix[0], rotation(a, b, c) @ rotation(d, e, f), atol=1e-12)


@given(ANGLE, TILT, ANGLE, ANGLE, TILT, ANGLE)
def test_a_mounted_part_moves_and_turns_with_what_carries_it(a, b, c, d, e, f):
    carrier = SpatialPose.of((1.0, -2.0, 0.5), a, b, c)
    part = carrier.offset(0.3, -0.2, 0.1, d, e, f)
    np.testing.assert_allclose(part.position[0], [1.0, -2.0, 0.5] + rotation(a, b, c) @ [0.3, -0.2, 0.1], atol=1e-12)
    np.testing.assert_allclose(part.matrix[0], rotation(a, b, c) @ rotation(d, e, f), atol=1e-12)
    plain = carrier.offset(0.3, -0.2)
    np.testing.assert_allclose(plain.position[0], [1.0, -2.0, 0.5] + rotation(a, b, c) @ [0.3, -0.2, 0.0], atol=1e-12)
    np.testing.assert_allclose(plain.matrix, carrier.matrix, atol=1e-12)


@given(ANGLE)
def test_planar_and_spatial_poses_agree(heading):
    planar = Pose.of([[1.0, 2.0], [3.0, 4.0]], heading)
    space = planar.to_spatial()
    np.testing.assert_array_equal(space.position[:, 2], MOUNT_HEIGHT)
    np.testing.assert_allclose(space.matrix, [rotation(0.0, 0.0, heading)] * 2, atol=1e-12)
    np.testing.assert_allclose(
        planar.offset(0.5, -0.25, 0.1).position, space.offset(0.5, -0.25).position[:, :2], atol=1e-12
    )
    assert planar.offset(0.5, -0.25, 0.1).heading == pytest.approx(planar.heading + 0.1)
    assert MOUNT_HEIGHT == 0.4
