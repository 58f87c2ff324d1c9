"""From head and hands to a body: hands are where they were, planted feet stay, and a turned input turns the output."""

import math

import numpy as np
import pytest
from headset_messages import message
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.humans import Gait, People, reach_poses, shapes
from crowdbot.vr import BodyEstimator, BodySize, HeadsetSample, RigidTransform
from crowdbot.web import StateFrame

PEOPLE = People.of(["man-20"])
SIZE = BodySize.of(PEOPLE)
HERE = RigidTransform.at(0.0, 0.0)
WRISTS = {"left": 9, "right": 16}
FEET = [shapes().bone(name) for name in ("foot_l", "foot_r")]


def turn(yaw, pitch=0.0):
    """Return the rotation of a head that faces a heading and looks down by a pitch [rad]."""
    c, s, u, d = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]) @ np.array([[u, 0, d], [0, 1.0, 0], [-d, 0, u]])


def sample(time, head=(0.0, 0.0, None), yaw=0.0, pitch=0.0, **hands):
    head = [SIZE.eye_height if item is None else item for item in head]
    return HeadsetSample.of_frame(StateFrame.decode(message(time, head, turn(yaw, pitch), **hands)))


def settled(estimator, count=30, room=HERE, **how):
    for k in range(count):
        pose = estimator.update(sample(k / 72, **how), room)
    return pose


def posture(pose):
    gait = Gait(PEOPLE)
    standing = gait.posture(gait.start([[pose.x, pose.y]], [pose.heading]))
    return reach_poses(standing, PEOPLE, {0: pose.row()})


@given(
    st.floats(-1.2, 1.2),
    st.floats(0.0, 1.3),
    st.floats(0.15, 0.95),
    st.floats(-3.0, 3.0),
    st.sampled_from(("left", "right")),
)
@settings(max_examples=25, deadline=None)
def test_a_hand_within_reach_is_reached_within_1_cm(aside, height, share, yaw, side):
    """Targets around the shoulder, within 15 to 95 % of the length of the arm."""
    rest = posture(settled(BodyEstimator(SIZE), yaw=yaw))
    shoulder = rest.position[0, WRISTS[side] - 2]
    arm = float(np.sum(PEOPLE.measures.arm[0]))
    if share * arm < 0.3 * arm:
        share = 0.3
    out = 1.0 if side == "left" else -1.0
    way = np.array([math.cos(aside + 0.4 * out), math.sin(aside + 0.4 * out), height - 0.6])
    way = turn(yaw) @ way / np.linalg.norm(way)
    target = shoulder + share * arm * way
    pose = settled(BodyEstimator(SIZE), yaw=yaw, **{side: target})
    found = posture(pose)
    assert np.linalg.norm(found.position[0, WRISTS[side]] - target) < 0.01
    other = "left" if side == "right" else "right"
    assert getattr(pose, f"{other}_hand") is None


@given(st.floats(-3.1, 3.1), st.floats(-20.0, 20.0), st.floats(-20.0, 20.0), st.integers(0, 50))
@settings(max_examples=10, deadline=None)
def test_turning_the_room_turns_the_pose(angle, x, y, seed):
    random = np.random.default_rng(seed)
    yaws, pitches = np.cumsum(random.normal(0, 0.1, 60)), random.uniform(-0.5, 1.2, 60)
    walk = np.cumsum(random.normal(0, 0.01, (60, 2)), axis=0)
    room = RigidTransform.at(x, y, angle)
    one, two = BodyEstimator(SIZE), BodyEstimator(SIZE)
    for k in range(60):
        head = (*walk[k], 1.5 + 0.1 * math.sin(0.1 * k))
        here = sample(k / 72, head, yaws[k], pitches[k], right=(walk[k, 0] + 0.3, walk[k, 1] - 0.2, 1.2))
        a, b = one.update(here, HERE), two.update(here, room)
        assert room.apply([a.x, a.y, 0.0])[:2] == pytest.approx([b.x, b.y], abs=3e-4)
        assert math.cos(a.heading + angle - b.heading) == pytest.approx(1.0, abs=1e-6)
        assert room.apply(a.right_hand[:3]) == pytest.approx(b.right_hand[:3], abs=1e-4)


def test_the_head_of_the_avatar_is_where_the_headset_is():
    from crowdbot.humans import eye_offsets

    for pitch, height in ((0.0, SIZE.eye_height), (0.6, SIZE.eye_height - 0.15), (0.0, SIZE.eye_height - 0.35)):
        pose = settled(BodyEstimator(SIZE), head=(0.5, -0.3, height), pitch=pitch)
        found = posture(pose)
        b = shapes().bone("head")
        eye = found.position[0, b] + found.rotation[0, b] @ eye_offsets(PEOPLE)[0]
        assert np.linalg.norm(eye - pose.head[:3]) < 0.02


def test_the_trunk_follows_a_look_aside_slowly_and_a_large_one_at_once():
    estimator = BodyEstimator(SIZE)
    assert settled(estimator, 5).heading == pytest.approx(0.0)
    pose = estimator.update(sample(6 / 72, yaw=math.radians(40)), HERE)
    assert abs(pose.heading) < 0.06
    pose = estimator.update(sample(7 / 72, yaw=math.radians(90)), HERE)
    assert pose.heading == pytest.approx(math.radians(40), abs=0.06)  # 50 degrees of neck
    for k in range(8, 8 + 72 * 10):
        pose = estimator.update(sample(k / 72, yaw=math.radians(90)), HERE)
    assert pose.heading == pytest.approx(math.radians(90), abs=0.02)


def test_a_look_at_the_own_feet_keeps_the_heading():
    pose = settled(BodyEstimator(SIZE), yaw=1.0, pitch=math.pi / 2 - 0.01)
    assert pose.heading == pytest.approx(1.0, abs=1e-3)
    assert settled(BodyEstimator(SIZE), yaw=1.0, pitch=-math.pi / 2 + 0.01).heading == pytest.approx(1.0, abs=1e-3)


def test_a_bow_leaves_the_pelvis_behind_and_a_crouch_does_not():
    upright = settled(BodyEstimator(SIZE))
    crouch = settled(BodyEstimator(SIZE), head=(0.0, 0.0, SIZE.eye_height - 0.3))
    bow = settled(BodyEstimator(SIZE), head=(0.4, 0.0, SIZE.eye_height - 0.3), pitch=1.0)
    assert crouch.x == pytest.approx(upright.x, abs=1e-6)
    assert bow.x < upright.x + 0.15
    assert settled(BodyEstimator(SIZE), 3, head=(0.0, 0.0, 1.6)).left_hand is None
    assert BodyEstimator(SIZE).update(no_head(), HERE) is None


def no_head():
    return HeadsetSample.of_frame(StateFrame.decode(message(0.0, None)))


def test_a_controller_that_lies_far_away_is_no_hand():
    pose = settled(BodyEstimator(SIZE), right=(3.0, 0.0, 0.7), left=(0.3, 0.2, 1.2))
    assert pose.right_hand is None
    assert pose.left_hand is not None


def soles(gait, found):
    """Return heel, ball and toes of both feet ``[2, 3, 3]``."""
    m, feet = gait.people.measures, []
    for side in "lr":
        foot, ball = shapes().bone(f"foot_{side}"), shapes().bone(f"ball_{side}")
        points = (
            (foot, [m.heel[0], 0.0, -m.ankle[0]]),
            (ball, [0.0, 0.0, -m.ball[0, 1]]),
            (ball, [m.toe[0] - m.ball[0, 0], 0.0, -m.ball[0, 1]]),
        )
        feet.append([found.position[0, b] + found.rotation[0, b] @ np.array(p) for b, p in points])
    return np.array(feet)


def test_planted_feet_do_not_slip():
    """Walk 3 m, look around, reach, and lean: ankles of planted feet that are flat stay to 0.1 mm."""
    gait, estimator = Gait(PEOPLE), BodyEstimator(SIZE)
    state, worst, steps = None, 0.0, 0
    last, before, planted, foot = np.zeros((1, 2)), None, np.zeros(2), np.zeros((2, 3))
    for k in range(360):
        time = k / 72
        x = 0.9 * max(0.0, min(time - 0.5, 3.0))
        lean = 0.06 * math.sin(5.0 * time) if time > 3.8 else 0.0
        pose = estimator.update(
            sample(time, (x + lean, 0.1 * math.sin(time), None), 0.5 * math.sin(2 * time), right=(x + 0.4, -0.2, 1.3)),
            HERE,
        )
        place, heading = np.array([[pose.x, pose.y]]), np.array([pose.heading])
        if state is None:
            state = gait.start(place, heading)
        else:
            state = gait.step(state, place, (place - last) * 72, heading, 1 / 72)
        last = place
        now = soles(gait, reach_poses(gait.posture(state), PEOPLE, {0: pose.row()}))
        if before is not None:
            both = (state.planted[0] > 0) & (planted > 0) & (np.abs(state.foot[0] - foot).max(axis=1) == 0.0)
            steps += int(((state.planted[0] > 0) & (planted == 0)).sum())
            for f in np.flatnonzero(both):
                flat = (now[f, :, 2] < 1e-3) & (before[f, :, 2] < 1e-3)
                if flat.all():
                    worst = max(worst, float(np.abs(now[f, :, :2] - before[f, :, :2]).max()))
        before, planted, foot = now, state.planted[0].copy(), state.foot[0].copy()
    assert steps >= 4
    assert worst < 1e-4
