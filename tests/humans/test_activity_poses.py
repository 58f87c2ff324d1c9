"""Poses over the gait: hands where things are, flight in running, and heads turned to a robot."""

import numpy as np
import pytest

from crowdbot.humans import ACTIVITIES, Gait, People, keypoint_places, shapes

WHO = ["man-32", "woman-36", "boy-08"]


def standing(activity, **values):
    """Return gait and state of three people after two seconds of an activity."""
    gait = Gait(People.of(WHO), seed=2)
    state = gait.start(np.zeros((3, 2)) + np.arange(3)[:, None], [0.3] * 3)
    for _ in range(100):
        state = gait.step(state, state.position, np.zeros((3, 2)), [0.3] * 3, 0.02, activity=activity, **values)
    return gait, state


def place(posture, bone):
    return posture.position[:, shapes().bone(bone)]


@pytest.mark.parametrize("activity", ["carry", "read", "pram", "wheelchair"])
def test_both_hands_are_in_front_of_the_body_at_one_height(activity):
    gait, state = standing(activity)
    posture = gait.posture(state)
    left, right = place(posture, "hand_l"), place(posture, "hand_r")
    ahead = np.array([np.cos(0.3), np.sin(0.3), 0.0])
    assert np.abs(left[:, 2] - right[:, 2]).max() < 0.03
    for hand in (left, right):
        assert ((hand - place(posture, "pelvis")) @ ahead).min() > 0.12
    aside = np.linalg.norm(left - right, axis=1)
    assert aside.min() > 0.05
    assert aside.max() < 0.5


def test_a_waving_hand_is_above_the_shoulder_and_moves():
    gait, state = standing("wave")
    seen = []
    for _ in range(30):
        state = gait.step(state, state.position, np.zeros((3, 2)), [0.3] * 3, 0.02)
        posture = gait.posture(state)
        seen.append(place(posture, "hand_r"))
        assert (place(posture, "hand_r")[:, 2] > place(posture, "upperarm_r")[:, 2]).all()
    assert np.ptp(np.array(seen), axis=0)[:, :2].max() > 0.1


def test_who_tells_a_robot_to_wait_stretches_an_arm_ahead_with_the_palm_up():
    gait, state = standing("signal-wait")
    posture, ahead = gait.posture(state), np.array([np.cos(0.3), np.sin(0.3), 0.0])
    shoulder, hand, fingers = (place(posture, name) for name in ("upperarm_r", "hand_r", "fingers_02_r"))
    assert ((hand - shoulder) @ ahead).min() > 0.2
    assert np.abs(hand[:, 2] - shoulder[:, 2]).max() < 0.1
    assert (fingers - hand)[:, 2].min() > 0.04  # the fingers point up, so that the palm faces ahead
    assert np.abs((fingers - hand) @ ahead).max() < 0.04
    left = place(posture, "hand_l")
    assert (left[:, 2] < shoulder[:, 2] - 0.3).all()


def test_who_tells_a_robot_to_proceed_sweeps_an_arm_aside():
    gait, state = standing("signal-proceed")
    seen, aside = [], np.array([-np.sin(0.3), np.cos(0.3), 0.0])
    for _ in range(80):
        state = gait.step(state, state.position, np.zeros((3, 2)), [0.3] * 3, 0.02)
        seen.append(place(gait.posture(state), "hand_r") - place(gait.posture(state), "pelvis"))
    assert np.ptp(np.array(seen) @ aside, axis=0).min() > 0.2
    assert np.ptp(np.array(seen)[..., 2], axis=0).max() < 0.1


@pytest.mark.parametrize("other", ["signal-wait", "signal-proceed"])
def test_a_signal_begins_and_ends_without_a_jump(other):
    gait, state = standing("walk")
    before = gait.posture(state).position
    for activity in (other, "walk"):
        for _ in range(50):
            state = gait.step(state, state.position, np.zeros((3, 2)), [0.3] * 3, 0.02, activity=activity)
            now = gait.posture(state).position
            assert np.linalg.norm(now - before, axis=-1).max() < 0.02 * 3.0
            before = now


@pytest.mark.parametrize("other", ["walk", "phone", "carry", "stick", "pram", "run"])
def test_a_waving_hand_rises_and_falls_without_a_jump(other):
    gait, state = standing(other)
    before = gait.posture(state).position
    for activity in ("wave", other):
        for _ in range(50):
            state = gait.step(state, state.position, np.zeros((3, 2)), [0.3] * 3, 0.02, activity=activity)
            now = gait.posture(state).position
            assert np.linalg.norm(now - before, axis=-1).max() < 0.02 * 3.0  # [m/s], the tips of the fingers
            before = now


@pytest.mark.parametrize("activity", ["look", "stick", "wave"])
def test_an_arm_without_a_task_swings_as_in_walking(activity):
    gait = Gait(People.of(WHO), seed=2)
    way, hands = np.tile([1.3, 0.0], (3, 1)), []
    for name in (activity, "walk"):
        state = gait.start(np.zeros((3, 2)), [0.0] * 3, way, name)
        seen = []
        for k in range(60):
            state = gait.step(state, way * 0.02 * (k + 1), way, [0.0] * 3, 0.02)
            seen.append(place(gait.posture(state), "hand_l"))
        hands.append(seen)
    np.testing.assert_allclose(hands[0], hands[1], atol=1e-9)


def test_running_has_flight_and_no_foot_in_the_floor():
    gait = Gait(People.of(WHO), seed=2)
    way = np.tile([3.0, 0.0], (3, 1))
    state = gait.start(np.zeros((3, 2)), [0.0] * 3, way, "run")
    low = []
    for k in range(120):
        state = gait.step(state, way * 0.02 * (k + 1), way, [0.0] * 3, 0.02)
        low.append(gait.skin(state, 0)[..., 2].min(axis=1))
    low = np.array(low)
    assert low.min() > -0.002
    assert (np.mean(low > 0.03, axis=0) > 0.08).all()  # both feet are in the air
    assert (np.mean(low < 0.02, axis=0) > 0.4).all()


def test_a_head_turns_to_its_target_up_to_a_limit():
    gait, state = standing("look")
    for angle, expected in ((0.8, 0.8), (-1.1, -1.1), (3.0, np.radians(75.0))):
        point = np.append(state.position[0] + 4.0 * np.array([np.cos(0.3 + angle), np.sin(0.3 + angle)]), 1.0)
        posture = gait.posture(state, {0: point})
        ahead = posture.rotation[0, shapes().bone("head"), :, 0]
        turned = np.arctan2(ahead[1], ahead[0]) - 0.3
        assert turned == pytest.approx(expected, abs=0.12)


def test_other_activities_are_as_without_poses():
    """The first six activities give the posture of the gait alone."""
    gait, state = standing("talk")
    from crowdbot.humans.posture import posture

    plain = posture(state, gait.people.measures, gait.style, gait.size, gait.seats)
    np.testing.assert_array_equal(plain.rotation, gait.posture(state).rotation)
    assert ACTIVITIES[:6] == ("walk", "talk", "phone", "bottle", "text", "sit")


def test_keypoints_are_where_body_parts_are():
    gait, state = standing("walk")
    points = keypoint_places(gait.people, gait.posture(state))
    assert points.shape == (3, 17, 3)
    skin = gait.skin(state, 0)
    for person in range(3):
        nose, left, right = points[person, 0], points[person, 1], points[person, 2]
        ahead, aside = np.array([np.cos(0.3), np.sin(0.3)]), np.array([-np.sin(0.3), np.cos(0.3)])
        assert (nose - 0.5 * (left + right))[:2] @ ahead > 0.01
        assert (left - right)[:2] @ aside == pytest.approx(0.06, abs=0.015)
        assert np.linalg.norm(skin[person] - nose, axis=1).min() < 0.01  # on the skin
        assert (points[person, 3] - points[person, 4])[:2] @ aside > 0.12  # ears
        assert points[person, 15:, 2].max() < 0.12  # ankles


def test_who_runs_stands_at_rest_and_walks_slowly():
    people = People.of(["man-32", "man-32"])
    for speed in (0.0, 0.4):
        way = np.array([[speed, 0.0]] * 2)
        gait = Gait(people, seed=1, ids=[0, 0])
        state = gait.start(np.zeros((2, 2)), [0.0, 0.0], way, ["run", "walk"])
        for k in range(100):
            state = gait.step(state, way * 0.02 * (k + 1), way, [0.0, 0.0], 0.02)
        one, other = gait.posture(state).position
        np.testing.assert_allclose(one, other, atol=1e-9)
