"""The walk: planted feet stay, knees and pelvis move as people's do, on straights, starts, stops and turns."""

import numpy as np
import pytest
from walks import WALKERS, bone, knees, slip, walk

from crowdbot.humans import Gait, People, names

DT = 0.02


def _straight(speed):
    return lambda t: (speed * t, 0.0, 0.0)


def _start_and_stop(t):
    knots, speeds = [0.0, 0.5, 1.2, 3.0, 3.6], [0.0, 0.0, 1.4, 1.4, 0.0]
    times = np.linspace(0.0, t, 500)
    return np.trapezoid(np.interp(times, knots, speeds), times), 0.0, 0.0


def _circle(speed, turn):
    return lambda t: (speed / turn * np.sin(turn * t), speed / turn * (1 - np.cos(turn * t)), turn * t)


PATHS = {
    "slow": (_straight(0.4), True),
    "usual": (_straight(1.4), True),
    "fast": (_straight(2.0), True),
    "start and stop": (_start_and_stop, False),
    "jump to speed and back": (lambda t: (1.4 * np.clip(t - 0.5, 0.0, 2.5), 0.0, 0.0), False),
    "wide turn": (_circle(1.2, 0.3), True),
    "turn": (_circle(1.0, 0.8), True),
    "narrow turn": (_circle(0.6, 1.5), True),
    "on the spot": (lambda t: (0.0, 0.0, np.clip(t - 0.5, 0.0, 3.0)), False),
    "fast on the spot": (lambda t: (0.0, 0.0, np.clip(3.0 * (t - 0.5), 0.0, np.pi)), False),
    "aside": (lambda t: (0.0, 0.5 * t, 0.0), True),
    "backward": (lambda t: (-0.6 * t, 0.0, 0.0), True),
}


@pytest.mark.parametrize("name", PATHS)
def test_planted_feet_stay_where_they_are(name):
    path, moving = PATHS[name]
    _, states, _, points, under = walk(path, 4.5, DT, moving=moving, level=1)
    speed = slip(states, points, DT)
    assert np.nanmax(speed) < 0.02
    assert np.nanmean(speed) < 0.001
    assert points[..., 2].min() > -1e-9
    assert under.min() > -0.005  # of the skin: heels are round, ours turn about one line


@pytest.mark.parametrize("name", PATHS)
def test_one_foot_always_stands_and_legs_reach(name):
    path, moving = PATHS[name]
    gait, states, postures, points, _ = walk(path, 4.5, DT, moving=moving)
    assert np.array([s.planted for s in states]).max(axis=-1).min() == 1.0
    hips = np.array([p.position[:, 0, 2] for p in postures]) / gait.size[:, 5]
    assert hips.min() > (0.80 if name == "fast" else 0.87)
    assert hips.max() < 1.04
    planted = np.array([s.planted for s in states])[..., None] > 0
    assert np.abs(np.where(planted, points[..., 2], 0.0).min(axis=-1)).max() < 0.002  # planted soles touch the floor


def test_knee_and_pelvis_move_as_people_s_at_the_usual_speed():
    adults = [n for n in names() if n.startswith(("man-", "woman-", "mannequin"))]
    _, states, postures, _, _ = walk(_straight(1.4), 4.0, DT, people=adults, moving=True)
    bend = np.degrees(knees(postures[50:]))
    swinging = np.array([s.planted[:, 0] for s in states[50:]]) == 0
    peak = np.where(swinging, bend, 0.0).max(axis=0)
    height = np.array([p.position[:, 0, 2] for p in postures[50:]])
    bob = height.max(axis=0) - height.min(axis=0)
    assert peak.min() > 55
    assert peak.max() < 65
    assert bob.min() > 0.040
    assert bob.max() < 0.050


def test_stride_follows_the_relations_of_boulic():
    for speed in (0.6, 1.0, 1.4, 1.8):
        gait, states, _, _, _ = walk(_straight(speed), 6.0, DT, moving=True)
        phase = np.unwrap(2 * np.pi * np.array([s.phase for s in states]), axis=0) / (2 * np.pi)
        stride = speed * 6.0 / (phase[-1] - phase[0])
        relation = 1.346 * np.sqrt(speed / gait.size[:, 5]) * gait.size[:, 5] * gait.style[:, 1]
        longest = speed / gait.size[:, 5] < 1.9
        assert np.abs(stride / relation - 1.0)[longest].max() < 0.05


def test_knees_bend_forward_and_the_body_is_where_it_is_said_to_be():
    gait, states, postures, _, _ = walk(_circle(1.0, 0.8), 4.0, DT, moving=True)
    for state, posture in zip(states, postures, strict=True):
        middle = 0.5 * (posture.position[:, bone("thigh_l")] + posture.position[:, bone("foot_l")])
        bulge = posture.position[:, bone("calf_l")] - middle
        ahead = np.stack([np.cos(state.yaw), np.sin(state.yaw)], axis=1)
        assert (bulge[:, :2] * ahead).sum(axis=1).min() > 0.0
        away = posture.position[:, 0, :2] - state.position
        assert np.linalg.norm(away, axis=1).max() < 0.03
    assert np.isfinite(gait.skin(states[-1])).all()


def test_bones_keep_their_lengths():
    gait, _, postures, _, _ = walk(_start_and_stop, 2.0, 0.05)
    head = gait.people.measures.head
    for name, end in (("thigh_l", "calf_l"), ("calf_r", "foot_r"), ("upperarm_r", "lowerarm_r"), ("neck_01", "head")):
        rest = np.linalg.norm(head[:, bone(end)] - head[:, bone(name)], axis=1)
        for posture in postures:
            now = np.linalg.norm(posture.position[:, bone(end)] - posture.position[:, bone(name)], axis=1)
            np.testing.assert_allclose(now, rest, atol=1e-9)
            turn = posture.rotation[:, bone(name)]
            np.testing.assert_allclose(
                turn @ turn.transpose(0, 2, 1), np.broadcast_to(np.eye(3), turn.shape), atol=1e-9
            )


def test_standing_people_stand_still_and_feet_come_together_after_a_stop():
    gait, states, _, _, _ = walk(_start_and_stop, 6.0, DT)
    last = states[-1]
    assert not last.moving.any()
    apart = np.linalg.norm(last.foot[:, 0, :2] - last.foot[:, 1, :2], axis=1) / gait.size[:, 5]
    assert apart.max() < 0.35
    again = gait.step(last, last.position, np.zeros_like(last.position), last.yaw, 0.1)
    np.testing.assert_array_equal(again.foot, last.foot)


def test_styles_differ_by_person_and_by_seed():
    people = People.of(list(WALKERS))
    first, second = Gait(people, seed=1), Gait(people, seed=2)
    assert len(np.unique(first.style[:, 0])) == len(WALKERS)
    assert not np.array_equal(first.style, second.style)
    phases = first.start(np.zeros((6, 2)), np.zeros(6), np.tile([1.2, 0.0], (6, 1))).phase
    assert len(np.unique(phases)) == 6
