"""Poses of actors on bodies with other proportions."""

from __future__ import annotations

import math

import motion_senders as senders
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.bridges.motion_capture import FootLock, Retargeting, SourceSkeleton
from crowdbot.bridges.motion_capture.retargeting import (
    align_vectors,
    body_axes,
    normalize,
    rotate_about,
    to_matrices,
    to_quaternions,
    yaw_of,
)
from crowdbot.bridges.motion_capture.xsens import xsens_skeleton
from crowdbot.core import InputError
from crowdbot.humans import Gait, People, RestSkeleton, reach_poses, rest_skeleton

ACTOR = xsens_skeleton(np.array(senders.T_POSE, dtype=np.float64))
PEOPLE = People.of(["man-20", "woman-36", "boy-08"])
Turns = dict[str, senders.Quaternion]


def shown(k: int, turns: Turns, where: senders.Vector = (0.0, 0.0, 0.0)) -> tuple[RestSkeleton, np.ndarray, np.ndarray]:
    """Return the bones of a person in the pose of the actor, as the world shows them: rotations and positions."""
    body = rest_skeleton(PEOPLE, k)
    pose = senders.posed(turns, where)
    turned = to_matrices(np.array([turn for _, turn in pose]))
    found = Retargeting(ACTOR, body).pose(np.array([place for place, _ in pose]), turned)
    gait = Gait(PEOPLE)
    standing = gait.posture(gait.start([[found.x, found.y]] * 3, [0.0] * 3))
    posture = reach_poses(standing, PEOPLE, {k: found.row()})
    return body, posture.rotation[k], posture.position[k]


@pytest.mark.parametrize("k", range(3))
def test_the_t_pose_has_straight_arms_palms_down_and_feet_on_the_floor(k: int) -> None:
    body, rotation, position = shown(k, {}, (2.0, -1.0, 0.0))

    def at(name: str) -> np.ndarray:
        return position[body.bone(name)]

    for side, out in (("l", 1.0), ("r", -1.0)):
        arm = at(f"hand_{side}") - at(f"upperarm_{side}")
        np.testing.assert_allclose(arm / np.linalg.norm(arm), [0.0, out, 0.0], atol=1e-3)
        hand = rotation[body.bone(f"hand_{side}")] @ body.hands[0 if side == "l" else 1]
        np.testing.assert_allclose(hand[:, 0], [0.0, out, 0.0], atol=1e-3)
        np.testing.assert_allclose(hand[:, 2], [0.0, 0.0, 1.0], atol=1e-3)
        leg = at(f"foot_{side}") - at(f"thigh_{side}")
        np.testing.assert_allclose(leg / np.linalg.norm(leg), [0.0, 0.0, -1.0], atol=1e-3)
        assert at(f"foot_{side}")[2] == pytest.approx(body.head[body.bone("foot_l"), 2], abs=0.02)
    hips = 0.5 * (at("thigh_l") + at("thigh_r"))
    np.testing.assert_allclose(hips[:2], [2.0, -1.0], atol=1e-3)


def test_limbs_point_where_those_of_the_actor_point() -> None:
    turns: Turns = {
        "Pelvis": senders.about("z", 0.7),
        "LeftUpperArm": senders.about("x", 1.4),
        "RightForeArm": senders.about("z", 1.2),
        "RightUpperLeg": senders.about("y", -0.9),
        "RightLowerLeg": senders.about("y", 1.1),
        "T8": senders.about("y", 0.3),
    }
    pose = dict(zip(senders.SEGMENTS, senders.posed(turns), strict=True))
    body, _, position = shown(1, turns)
    for ours, theirs in (
        (("upperarm_l", "lowerarm_l"), ("LeftUpperArm", "LeftForeArm")),
        (("lowerarm_l", "hand_l"), ("LeftForeArm", "LeftHand")),
        (("lowerarm_r", "hand_r"), ("RightForeArm", "RightHand")),
        (("thigh_r", "calf_r"), ("RightUpperLeg", "RightLowerLeg")),
        (("calf_r", "foot_r"), ("RightLowerLeg", "RightFoot")),
    ):
        a = position[body.bone(ours[1])] - position[body.bone(ours[0])]
        b = np.subtract(pose[theirs[1]][0], pose[theirs[0]][0])
        angle = math.acos(min(1.0, float(a @ b) / float(np.linalg.norm(a) * np.linalg.norm(b))))
        assert angle < math.radians(0.2)


def test_a_body_with_the_proportions_of_the_actor_repeats_the_pose_to_a_millimetre() -> None:
    body = rest_skeleton(PEOPLE, 0)
    legs = {"UpperLeg": "thigh", "LowerLeg": "calf", "Foot": "foot", "Toe": "ball"}
    arms = {"UpperArm": "upperarm", "ForeArm": "lowerarm", "Hand": "hand"}
    rest = ACTOR.rest.copy()
    for side, end, out in (("Left", "l", 1.0), ("Right", "r", -1.0)):
        for kind, chain, way in ((legs, "thigh", (0.0, 0.0, -1.0)), (arms, "upperarm", (0.0, out, 0.0))):
            heads = [body.head[body.bone(f"{name}_{end}")] for name in kind.values()]
            place = body.head[body.bone(f"{chain}_{end}")].copy()
            for k, name in enumerate(kind):
                rest[senders.SEGMENTS.index(f"{side}{name}")] = place
                if k + 1 < len(heads):
                    place = place + np.linalg.norm(heads[k + 1] - heads[k]) * np.array(way)
    rest[:, 2] += body.head[body.bone("foot_l"), 2] - rest[senders.SEGMENTS.index("LeftFoot"), 2]
    actor = SourceSkeleton(ACTOR.names, ACTOR.parents, rest)
    fit = Retargeting(actor, body)
    assert fit.scale == pytest.approx(1.0)
    found = fit.pose(rest, np.tile(np.eye(3), (23, 1, 1)))
    assert found.skeleton is not None
    gait = Gait(PEOPLE)
    standing = gait.posture(gait.start([[found.x, found.y]] * 3, [0.0] * 3))
    position = reach_poses(standing, PEOPLE, {0: found.row()}).position[0]
    for name, ours in (("LeftFoot", "foot_l"), ("RightFoot", "foot_r"), ("LeftLowerLeg", "calf_l")):
        np.testing.assert_allclose(position[body.bone(ours)], rest[senders.SEGMENTS.index(name)], atol=1e-3)


@given(st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.05))
def test_quaternions_and_matrices_are_inverse(values: list[float]) -> None:
    q = np.array(values) / np.linalg.norm(values)
    again = to_quaternions(to_matrices(q))
    assert abs(float(q @ again)) == pytest.approx(1.0, abs=1e-9)
    assert again[0] >= 0.0


@given(st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6))
def test_align_vectors_turns_one_direction_into_the_other(values: list[float]) -> None:
    a, b = np.array(values[:3]) + 0.01, np.array(values[3:]) - 0.01
    if min(np.linalg.norm(a), np.linalg.norm(b)) < 1e-3:
        a, b = np.array([1.0, 0, 0]), np.array([-1.0, 0, 0])
    turn = align_vectors(a, b)
    np.testing.assert_allclose(turn @ a / np.linalg.norm(a), b / np.linalg.norm(b), atol=1e-4)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-9)


def test_headings_of_upright_and_lying_bodies() -> None:
    assert yaw_of(rotate_about([0.0, 0.0, 1.0], 2.5)) == pytest.approx(2.5)
    lying = rotate_about([0.0, 0.0, 1.0], 1.0) @ rotate_about([0.0, 1.0, 0.0], math.pi / 2)
    assert yaw_of(lying) == pytest.approx(1.0)
    assert normalize(np.array([np.nan, 0.0, 0.0, 1.0])) is None


def test_a_skeleton_without_limbs_is_refused_with_its_names() -> None:
    with pytest.raises(InputError, match="no joint such as LeftHand; it has Root, Arm"):
        SourceSkeleton(("Root", "Arm"), (-1, 0), np.zeros((2, 3)))
    with pytest.raises(InputError, match=r"a leg of a skeleton is 86 m long; check the unit"):
        SourceSkeleton(ACTOR.names, ACTOR.parents, xsens_skeleton().rest * 100.0)
    lying = ACTOR.rest.copy()
    lying[15:] = 0.5 * (lying[15:] + lying[15:] * [1.0, -1.0, 1.0])
    with pytest.raises(InputError, match="does not stand in the rest pose"):
        body_axes(ACTOR.names, ACTOR.parents, lying)


def walking_actor(time: float) -> tuple[np.ndarray, np.ndarray, list[bool]]:
    """Return positions and rotations of an actor who walks at 1 m/s, and which foot is on the floor, left and right."""
    names = {name: k for k, name in enumerate(senders.SEGMENTS)}
    shift = np.array([time, 0.0, -0.1])  # bent knees
    position, rotation, down = ACTOR.rest + shift, np.tile(np.eye(3), (23, 1, 1)), []
    for phase, side in ((0.0, "Left"), (0.5, "Right")):
        k, share = divmod(time + phase, 1.0)  # a foot stands for 0.6 s and swings for 0.4 s, 1 m further
        down.append(share < 0.6)
        swing = max(0.0, share - 0.6) / 0.4
        hip, knee, foot = (names[f"{side}{name}"] for name in ("UpperLeg", "LowerLeg", "Foot"))
        place = ACTOR.rest[foot].copy()
        place[0] = k - phase + 0.3 + 0.5 * (1.0 - math.cos(math.pi * swing))
        place[2] += 0.08 * math.sin(math.pi * swing)
        long, short = (float(np.linalg.norm(ACTOR.rest[b] - ACTOR.rest[a])) for a, b in ((hip, knee), (knee, foot)))
        away = place - position[hip]
        distance = float(np.linalg.norm(away))
        pitch = math.atan2(away[0], -away[2])
        bend = math.acos((long**2 + distance**2 - short**2) / (2.0 * long * distance))
        position[knee] = position[hip] + long * np.array([math.sin(pitch + bend), 0.0, -math.cos(pitch + bend)])
        lower = place - position[knee]
        position[foot] = place
        rotation[hip] = rotate_about([0.0, 1.0, 0.0], -(pitch + bend))
        rotation[knee] = rotate_about([0.0, 1.0, 0.0], -math.atan2(lower[0], -lower[2]))
    return position, rotation, down


@pytest.mark.parametrize("k", range(3))
def test_feet_on_the_floor_do_not_slide_on_a_body_with_other_proportions(k: int) -> None:
    """Without the lock the feet of the boy slide by 15 cm in each step of the grown-up actor."""
    body = rest_skeleton(PEOPLE, k)
    plain, lock = Retargeting(ACTOR, body), FootLock(Retargeting(ACTOR, body))
    slides: dict[bool, list[float]] = {False: [], True: []}
    places: dict[tuple[bool, int], list[np.ndarray]] = {}
    gait = Gait(PEOPLE)
    for number, time in enumerate(np.arange(0.0, 3.0, 1 / 60)):
        position, rotation, down = walking_actor(float(time))
        for held in (False, True):
            found = lock.pose(number, float(time), position, rotation) if held else plain.pose(position, rotation)
            standing = gait.posture(gait.start([[found.x, found.y]] * 3, [0.0] * 3))
            shown = reach_poses(standing, PEOPLE, {k: found.row()}).position[k]
            for side, name in enumerate(("foot_l", "foot_r")):
                row = places.setdefault((held, side), [])
                if down[side]:
                    row.append(shown[body.bone(name)][:2])
                elif row:
                    slides[held].append(float(np.linalg.norm(row[-1] - row[3])))
                    row.clear()
            assert found is lock.pose(number, float(time), position, rotation) or not held
    print(f"{PEOPLE.persons[k].name}: planted feet slide {max(slides[False]):.3f} m, held {max(slides[True]):.4f} m")
    assert len(slides[True]) >= 5
    assert max(slides[True]) < 0.005
    assert max(slides[True]) < 0.2 * max(slides[False]) + 0.002
