"""The gait as a step: same bytes alone or among others, wrong input is named, extremes stay bounded."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from walks import WALKERS, soles, walk

from crowdbot.core import InputError, UnknownName
from crowdbot.humans import ACTIVITIES, Gait, People
from crowdbot.humans import feet as feet_kernels
from crowdbot.humans import posture as posture_kernels

COUNT = len(WALKERS)


def _wander(t):
    return np.stack([1.1 * t + 0.3 * np.sin(2 * t + np.arange(COUNT)), np.arange(COUNT) + 0.4 * np.cos(t)], axis=1)


def _run(gait, rows, steps=60, dt=0.05, activity="walk"):
    state = gait.start(_wander(0.0)[rows], np.zeros(len(rows)), activity=activity)
    for k in range(1, steps + 1):
        before, now = _wander((k - 1) * dt)[rows], _wander(k * dt)[rows]
        velocity = (now - before) / dt
        state = gait.step(state, now, velocity, np.arctan2(velocity[:, 1], velocity[:, 0]), dt)
    return state


def test_the_same_steps_give_the_same_bytes():
    one, other = (_run(Gait(People.of(WALKERS), seed=5), np.arange(COUNT)) for _ in range(2))
    for a, b in zip(one, other, strict=True):
        assert a.tobytes() == b.tobytes()


@pytest.mark.parametrize("activity", ["walk", "phone"])
def test_alone_or_among_others_is_the_same(activity):
    rows = np.arange(COUNT)
    everyone = Gait(People.of(WALKERS), seed=5)
    state = _run(everyone, rows, activity=activity)
    skin, limbs = everyone.skin(state, 2), everyone.limbs(state)
    for i in rows:
        alone = Gait(People.of([WALKERS[i]]), seed=5, ids=[i])
        own = _run(alone, rows[i : i + 1], activity=activity)
        for a, b in zip(own, state, strict=True):
            assert a[0].tobytes() == b[i].tobytes()
        assert alone.skin(own, 2)[0].tobytes() == skin[i].tobytes()
        np.testing.assert_array_equal(alone.limbs(own).start[0], limbs.start[i])


def test_a_step_leaves_the_state_as_it_was_and_a_branch_goes_on_alike():
    gait = Gait(People.of(WALKERS))
    state = _run(gait, np.arange(COUNT), steps=20)
    copy = [part.copy() for part in state]
    after = gait.step(state, state.position + 0.05, np.ones((COUNT, 2)), state.yaw, 0.05)
    again = gait.step(type(state)(*copy), state.position + 0.05, np.ones((COUNT, 2)), state.yaw, 0.05)
    for a, b, c, d in zip(state, copy, after, again, strict=True):
        assert a.tobytes() == b.tobytes()
        assert c.tobytes() == d.tobytes()


def test_kernels_do_what_their_python_says():
    gait = Gait(People.of(WALKERS))
    state = _run(gait, np.arange(COUNT), steps=10)
    fast = gait.step(state, state.position + 0.06, np.ones((COUNT, 2)), state.yaw + 0.1, 0.05)
    slow = type(state)(*(part.copy() for part in state))
    feet_kernels.advance.py_func(
        slow, np.ones((COUNT, 2)), state.position + 0.06, state.yaw + 0.1, np.zeros(COUNT), 0.05, gait.style, gait.size
    )
    for a, b in zip(fast, slow, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-12)
    m, out = gait.people.measures, gait.posture(fast)
    lengths = np.stack([m.thigh, m.shank, m.arm[:, 0], m.arm[:, 1], m.height], axis=1)
    R, P = np.empty_like(out.rotation), np.empty_like(out.position)
    parents = posture_kernels.shapes().parents
    posture_kernels._pose.py_func(fast, lengths, m.head, m.frame, gait.style, gait.size, gait.seats, parents, R, P)
    np.testing.assert_allclose(P, out.position, atol=1e-12)


def test_a_moved_world_moves_the_people_with_it():
    gait = Gait(People.of(WALKERS))
    rows, angle, offset = np.arange(COUNT), 0.7, np.array([30.0, -12.0])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    here = gait.start(_wander(0.0)[rows], np.zeros(COUNT))
    there = gait.start(_wander(0.0) @ turn.T + offset, np.full(COUNT, angle))
    for k in range(1, 40):
        now = _wander(0.05 * k)
        velocity = (now - _wander(0.05 * (k - 1))) / 0.05
        heading = np.arctan2(velocity[:, 1], velocity[:, 0])
        here = gait.step(here, now, velocity, heading, 0.05)
        there = gait.step(there, now @ turn.T + offset, velocity @ turn.T, heading + angle, 0.05)
    expected = gait.skin(here) @ np.block([[turn, np.zeros((2, 1))], [np.zeros((1, 2)), np.ones((1, 1))]]).T
    np.testing.assert_allclose(gait.skin(there), expected + np.append(offset, 0.0), atol=1e-6)


@pytest.mark.parametrize("activity", ACTIVITIES)
def test_every_activity_blends_in_and_keeps_the_feet_on_the_floor(activity):
    gait, states, _, points, under = walk(lambda t: (0.0, 0.0, 0.3), 0.4, 0.05)
    state = states[-1]
    before = gait.posture(state).position
    for _ in range(60):
        state = gait.step(state, state.position, np.zeros((COUNT, 2)), np.full(COUNT, 0.3), 0.05, activity=activity)
        now = gait.posture(state).position
        assert np.abs(now - before).max() < 0.14  # nothing jumps
        before = now
    assert state.blend[:, ACTIVITIES.index(activity)].min() > 0.99
    assert gait.skin(state, 0)[..., 2].min() > -0.005
    assert points[..., 2].min() > -1e-9
    assert under.min() > -0.005


def test_the_phone_is_at_the_ear_and_who_sits_sits():
    from walks import bone

    gait = Gait(People.of(WALKERS))
    call = gait.posture(gait.start(np.zeros((COUNT, 2)), np.zeros(COUNT), activity="phone"))
    finger, head = call.position[:, bone("fingers_01_r")], call.position[:, bone("head")]
    tall = gait.people.height[:, None]
    assert np.abs((finger - head) / tall - [0.02, -0.05, 0.01]).max() < 0.05
    rest = gait.start(np.zeros((COUNT, 2)), np.zeros(COUNT), activity="sit")
    sat = gait.posture(rest)
    hips = sat.position[:, bone("thigh_l"), 2]
    assert hips.min() > 0.5
    assert hips.max() < 0.6
    flat = sat.position[:, bone("calf_l"), 2] - hips
    assert np.abs(flat).max() < 0.12
    np.testing.assert_allclose(sat.position[:, 0, :2], 0.0, atol=1e-9)
    carried = gait.step(rest, np.full((COUNT, 2), 0.04), np.full((COUNT, 2), 0.8), np.zeros(COUNT), 0.05)
    moved = (gait.posture(carried).position - sat.position)[:, [0, 1, 20, 21, 22, 23, 24, 25, 26, 27]]
    np.testing.assert_allclose(moved[..., :2], 0.04, atol=1e-6)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"velocity": [[np.nan, 0.0]]}, "velocity of person 0 is not finite"),
        ({"position": [[np.inf, 0.0]]}, "position of person 0 is not finite"),
        ({"heading": [np.nan]}, "heading of person 0 is not finite"),
        ({"velocity": [[1.0, 0.0, 0.0]]}, r"velocity has shape \[1, 3\], it must be \[1, 2\]"),
        ({"velocity": [[50.0, 0.0]]}, "50.0 m/s is not allowed, it must be at most 12 m/s"),
        ({"dt": np.nan}, "dt = nan s"),
        ({"dt": 0.0}, "dt = 0.0 s"),
        ({"dt": -1.0}, "dt = -1.0 s"),
    ],
)
def test_wrong_input_is_named(change, message):
    gait = Gait(People.of(["man-20"]))
    state = gait.start([[0.0, 0.0]], [0.0])
    given_ = {"position": [[0.0, 0.0]], "velocity": [[0.0, 0.0]], "heading": [0.0], "dt": 0.1, **change}
    with pytest.raises(InputError, match=message):
        gait.step(state, **given_)


def test_wrong_activities_and_counts_are_named():
    gait = Gait(People.of(["man-20"]))
    with pytest.raises(UnknownName, match="unknown activity 'fone', did you mean 'phone'"):
        gait.start([[0.0, 0.0]], [0.0], activity="fone")
    with pytest.raises(InputError, match="2 activities are given for 1 people"):
        gait.start([[0.0, 0.0]], [0.0], activity=["walk", "sit"])
    with pytest.raises(InputError, match="activity index 99 must be from 0 to 15"):
        gait.start([[0.0, 0.0]], [0.0], activity=np.array([99]))
    with pytest.raises(InputError, match="2 ids are given for 1 people"):
        Gait(People.of(["man-20"]), ids=[1, 2])


@settings(max_examples=25)
@given(
    st.lists(
        st.tuples(
            st.floats(-12, 12), st.floats(-4, 4), st.floats(-50, 50), st.sampled_from([0.001, 0.05, 0.4, 0.9, 1e6])
        ),
        min_size=1,
        max_size=12,
    ),
    st.sampled_from(ACTIVITIES),
)
def test_any_motion_keeps_the_body_whole(moves, activity):
    gait = Gait(People.of(["woman-20", "boy-08"]))
    state = gait.start(np.zeros((2, 2)), np.zeros(2))
    place = np.zeros((2, 2))
    for speed, jump, heading, dt in moves:
        place = place + [speed * min(dt, 1.0) + jump, jump]
        velocity = np.array([[speed, 0.0], [0.0, -speed]])
        state = gait.step(state, place, velocity, np.full(2, heading), dt, activity=activity)
        skin = gait.skin(state)
        assert np.isfinite(skin).all()
        assert np.abs(skin[..., :2] - place[:, None]).max() < 3.0
        assert skin[..., 2].max() < 2.2
        assert skin[..., 2].min() > -0.4
        assert soles(gait, gait.posture(state))[..., 2].max() < 1.5
