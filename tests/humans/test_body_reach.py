"""Head and hands of people are where they are given, bones keep their lengths, and nothing depends on the place."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from crowdbot.humans import BodyPose, Gait, People, Posture, reach_poses
from crowdbot.humans.asset import shapes
from crowdbot.humans.body_reach import eye_offsets

Floats = NDArray[np.float64]
PEOPLE = People.of(["man-20", "woman-36", "mannequin"], height=[1.85, 1.6, 1.72])
GAIT = Gait(PEOPLE)
PARENTS = shapes().parents
WRISTS, SHOULDERS = (9, 16), (7, 14)
HEAD, PELVIS, FEET = 5, 0, (22, 26)


def stand(x: float = 0.0, y: float = 0.0, heading: float = 0.0) -> Posture:
    return GAIT.posture(GAIT.start([[x, y]] * 3, [heading] * 3))


def turned(yaw: float, pitch: float = 0.0, roll: float = 0.0) -> tuple[float, ...]:
    """Return the quaternion of Rz(yaw) Ry(pitch) Rx(roll)."""
    (cy, sy), (cp, sp), (cr, sr) = ((math.cos(a / 2), math.sin(a / 2)) for a in (yaw, pitch, roll))
    return (
        cy * cp * cr + sy * sp * sr,
        cy * cp * sr - sy * sp * cr,
        cy * sp * cr + sy * cp * sr,
        sy * cp * cr - cy * sp * sr,
    )


def eyes(posture: Posture, k: int) -> Floats:
    offset = eye_offsets(PEOPLE)[k]
    return np.asarray(posture.position[k, HEAD] + posture.rotation[k, HEAD] @ offset)


def check_bones(posture: Posture) -> None:
    """Bones have the lengths of the body, and rotations are rotations."""
    assert np.all(np.isfinite(posture.position))
    head = PEOPLE.measures.head
    rest = np.linalg.norm(head[:, 1:] - head[:, PARENTS[1:]], axis=-1)
    now = np.linalg.norm(posture.position[:, 1:] - posture.position[:, PARENTS[1:]], axis=-1)
    assert now == pytest.approx(rest, abs=1e-9)
    unit = np.einsum("nbij,nbkj->nbik", posture.rotation, posture.rotation)
    assert np.abs(unit - np.eye(3)).max() < 1e-9
    assert np.linalg.det(posture.rotation) == pytest.approx(1.0)


@settings(max_examples=60, deadline=None)
@given(
    st.integers(0, 2), st.integers(0, 1), st.floats(0.2, 0.97), st.floats(-math.pi, math.pi), st.floats(-1.4, 1.5),
    st.floats(-3.1, 3.1), st.floats(-1.5, 1.5),
)  # fmt: skip
def test_a_hand_within_reach_is_where_it_is_given(
    k: int, side: int, share: float, azimuth: float, up: float, yaw: float, pitch: float
) -> None:
    standing = stand()
    arm = float(PEOPLE.measures.arm[k].sum())
    ray = np.array([math.cos(azimuth) * math.cos(up), math.sin(azimuth) * math.cos(up), math.sin(up)])
    far = max(share * arm, 0.31 * arm)  # nearer the elbow would have to bend more than 150 degrees
    goal = standing.position[k, SHOULDERS[side]] + far * ray
    hand = (*goal.tolist(), *turned(yaw, pitch))
    pose = BodyPose(0, 0, 0, **{("left_hand", "right_hand")[side]: hand})
    found = reach_poses(standing, PEOPLE, {k: pose.row()})
    check_bones(found)
    assert np.linalg.norm(found.position[k, WRISTS[side]] - goal) < 0.01
    other = WRISTS[1 - side]
    assert np.array_equal(found.position[k, other], standing.position[k, other])


@pytest.mark.parametrize("goal", [(2.5, -0.2, 1.5), (0.0, -0.2, 3.5), (0.3, -2.5, 0.4)])
def test_a_hand_out_of_reach_is_stretched_towards_the_goal(goal: tuple[float, float, float]) -> None:
    found = reach_poses(stand(), PEOPLE, {0: BodyPose(0, 0, 0, right_hand=(*goal, 1, 0, 0, 0)).row()})
    check_bones(found)
    arm = found.position[0, 16] - found.position[0, 14]
    wish = np.array(goal) - found.position[0, 14]
    assert np.linalg.norm(arm) == pytest.approx(PEOPLE.measures.arm[0].sum(), rel=0.01)
    assert arm @ wish / np.linalg.norm(arm) / np.linalg.norm(wish) > 0.9999


@settings(max_examples=40, deadline=None)
@given(st.floats(0.65, 1.0), st.floats(-0.15, 0.35), st.floats(-0.15, 0.15), st.floats(-1.0, 1.0), st.floats(-0.6, 0.9))
def test_the_eyes_are_where_they_are_given_and_the_feet_stay(
    share: float, x: float, y: float, yaw: float, pitch: float
) -> None:
    standing = stand()
    tall = float(eyes(standing, 0)[2])
    height = min(share * tall, math.sqrt(tall**2 - 0.5 * (x**2 + y**2)) - 0.12)
    found = reach_poses(standing, PEOPLE, {0: BodyPose(0, 0, 0, head=(x, y, height, *turned(yaw, pitch))).row()})
    check_bones(found)
    assert np.linalg.norm(eyes(found, 0) - (x, y, height)) < 0.01
    for foot in FEET:
        assert np.linalg.norm(found.position[0, foot] - standing.position[0, foot]) < 0.02


def test_who_crouches_bends_the_knees_forward() -> None:
    standing = stand()
    x, _, z = eyes(standing, 0)
    found = reach_poses(standing, PEOPLE, {0: BodyPose(0, 0, 0, head=(x, 0.0, z - 0.5, 1, 0, 0, 0)).row()})
    assert found.position[0, PELVIS, 2] < standing.position[0, PELVIS, 2] - 0.3
    assert np.all(found.position[0, [21, 25], 0] > standing.position[0, [21, 25], 0] + 0.15)
    assert np.linalg.norm(found.position[0, 22] - standing.position[0, 22]) < 1e-3


def test_the_head_looks_where_it_is_turned_up_to_the_limit_of_the_neck() -> None:
    x, _, z = eyes(stand(), 0)
    for yaw, most in ((0.6, 0.6), (3.0, 1.45)):
        pose = BodyPose(0, 0, 0, head=(x, 0.0, z - 0.05, *turned(yaw)))
        ahead = reach_poses(stand(), PEOPLE, {0: pose.row()}).rotation[0, HEAD][:, 0]
        assert abs(math.atan2(ahead[1], ahead[0])) == pytest.approx(most, abs=0.08)


@settings(max_examples=30, deadline=None)
@given(st.floats(-50, 50), st.floats(-50, 50), st.floats(-math.pi, math.pi))
def test_limbs_turn_and_shift_with_the_person(x: float, y: float, heading: float) -> None:
    c, s = math.cos(heading), math.sin(heading)

    def seven(px: float, py: float, pz: float, yaw: float, moved: bool) -> tuple[float, ...]:
        if not moved:
            return (px, py, pz, *turned(yaw, 0.3))
        return (x + c * px - s * py, y + s * px + c * py, pz, *turned(heading + yaw, 0.3))

    def posed(moved: bool) -> Floats:
        base = (x, y, heading) if moved else (0.0, 0.0, 0.0)
        parts = {
            "head": seven(0.2, 0.05, 1.3, 0.2, moved),
            "left_hand": seven(0.4, 0.2, 1.1, -0.4, moved),
            "right_hand": seven(0.3, -0.4, 1.6, 0.8, moved),
        }
        return reach_poses(stand(*base), PEOPLE, {1: BodyPose(*base, **parts).row()}).position[1]

    still, moved = posed(False), posed(True)
    back = np.stack([still[:, 0] * c - still[:, 1] * s + x, still[:, 0] * s + still[:, 1] * c + y, still[:, 2]], -1)
    assert moved == pytest.approx(back, abs=1e-6)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-1.0, 3.0), min_size=9, max_size=9), st.lists(st.floats(-1, 1), min_size=12, max_size=12))
def test_any_allowed_pose_gives_finite_limbs(places: list[float], turns: list[float]) -> None:
    def seven(k: int) -> tuple[float, ...]:
        px, py, pz = places[3 * k : 3 * k + 3]
        q = turns[4 * k : 4 * k + 4]
        q = q if math.hypot(*q) > 0.01 else [1.0, 0.0, 0.0, 0.0]
        return (0.6 * px, 0.6 * py, pz, *q)

    pose = BodyPose(0, 0, 0, head=seven(0), left_hand=seven(1), right_hand=seven(2))
    check_bones(reach_poses(stand(), PEOPLE, {0: pose.row(), 2: pose.row()}))


@pytest.mark.parametrize("part", ["head", "left_hand", "right_hand"])
def test_degenerate_goals_give_finite_limbs(part: str) -> None:
    standing = stand()
    for joint in (HEAD, *SHOULDERS, *WRISTS, PELVIS):
        for quaternion in ((1, 0, 0, 0), (0, 0, 0, 1), (0, 1, 0, 0), (500.0, 0, 0, 0)):
            goal = (*standing.position[0, joint].tolist(), *quaternion)
            check_bones(reach_poses(standing, PEOPLE, {0: BodyPose(0, 0, 0, **{part: goal}).row()}))


def test_a_whole_skeleton_has_the_rotations_that_are_given() -> None:
    bones = np.tile([1.0, 0.0, 0.0, 0.0], (28, 1))
    bones[14] = turned(0.0, 0.0, 0.5)
    pose = BodyPose(3.0, 1.0, 0.5, skeleton=(3.0, 1.0, 0.9, *bones.ravel().tolist()))
    found = reach_poses(stand(3.0, 1.0, 0.5), PEOPLE, {2: pose.row()})
    check_bones(found)
    assert found.position[2, PELVIS].tolist() == [3.0, 1.0, 0.9]
    base = np.array([[math.cos(0.5), -math.sin(0.5), 0.0], [math.sin(0.5), math.cos(0.5), 0.0], [0.0, 0.0, 1.0]])
    assert found.rotation[2, 5] == pytest.approx(base)
    assert found.rotation[2, 16] == pytest.approx(found.rotation[2, 14])
    assert not np.allclose(found.rotation[2, 14], base)


def test_without_parts_the_posture_is_that_of_the_gait() -> None:
    standing = stand()
    found = reach_poses(standing, PEOPLE, {0: BodyPose(0, 0).row()})
    assert np.array_equal(found.rotation, standing.rotation)
    assert np.array_equal(found.position, standing.position)
