"""The navigators of the leader-follower experiment."""

from __future__ import annotations

import math

import numpy as np
import pytest

from crowdbot.core import InputError, Twist
from crowdbot.navigation import (
    DriveLimits,
    FollowerNavigator,
    Observation,
    SinusoidNavigator,
    VisiblePeople,
)

LIMITS = DriveLimits(1.0, 1.5, 2.0, 3.0)


def seen(pose=(0.0, 0.0, 0.0), time=0.0, people=(), dt=0.05):
    """Return what a robot knows; people are x, y, vx, vy."""
    rows = np.array(people, dtype=float).reshape(-1, 4)
    there = VisiblePeople(rows[:, :2], rows[:, 2:], np.full(len(rows), 0.25))
    return Observation(pose=pose, goal=(9.0, 0.0), radius=0.3, limits=LIMITS, dt=dt, people=there, time=time)


def drive(navigator, steps, heading=0.4, push=0.0):
    """Return the displacements of a robot that follows its commands exactly, pushed aside once."""
    x, y, angle, ways = 1.0, 2.0, heading, []
    memory = navigator.begin(seen((x, y, angle)))
    for k in range(steps):
        action, memory = navigator.decide(seen((x, y, angle), 0.05 * k), memory)
        ways.append((x - 1.0) * math.cos(heading) + (y - 2.0) * math.sin(heading))
        angle += 0.05 * action.twist.turn + (push if k == 20 else 0.0)
        x += 0.05 * action.twist.forward * math.cos(angle)
        y += 0.05 * action.twist.forward * math.sin(angle)
    return np.array(ways), angle


def test_the_leader_moves_as_a_sinusoid_from_rest_and_stands_at_the_end():
    leader = SinusoidNavigator(amplitude=0.4, period=4.0, cycles=2, wait=1.0)
    ways, _ = drive(leader, 220)
    times = np.clip(0.05 * np.arange(220) - 1.0, 0.0, 8.0)
    np.testing.assert_allclose(ways, 0.4 * (1.0 - np.cos(0.5 * math.pi * times)), atol=1e-9)


def test_the_leader_turns_back_when_it_is_pushed_aside():
    ways, angle = drive(SinusoidNavigator(amplitude=0.4, period=4.0, cycles=4), 200, push=0.3)
    assert abs(angle - 0.4) < 1e-3
    assert ways.max() < 0.85


def test_a_motion_that_is_too_fast_for_the_drive_is_refused():
    with pytest.raises(InputError, match=r"amplitude of 0\.5 m and a period of 2\.0 s need 1\.57 m/s.*reaches 1 m/s"):
        SinusoidNavigator(amplitude=0.5, period=2.0).begin(seen())
    with pytest.raises(InputError, match="period"):
        SinusoidNavigator(period=0.0)


def test_the_follower_keeps_the_first_distance_in_any_frame():
    robot = FollowerNavigator(gain=1.0)
    for turn in (0.0, 1.0, -2.0):
        c, s = math.cos(turn), math.sin(turn)
        person = lambda gap, speed, c=c, s=s: (gap * c, gap * s, speed * c, speed * s)  # noqa: E731
        start = seen((0.0, 0.0, turn), people=[person(1.5, 0.0)])
        action, memory = robot.decide(start, robot.begin(start))
        assert memory.distance == pytest.approx(1.5)
        assert action.twist.forward == pytest.approx(0.0, abs=1e-12)
        action, _ = robot.decide(seen((0.0, 0.0, turn), people=[person(1.2, -0.3)]), memory)
        assert action.twist.forward == pytest.approx(-0.6)


def test_the_follower_stands_without_a_person_ahead_and_keeps_the_limits():
    robot = FollowerNavigator(distance=1.0)
    behind = seen(people=[(-1.0, 0.0, 0.5, 0.0)])
    assert robot.decide(behind, robot.begin(behind))[0].twist == Twist()
    far = seen(people=[(9.0, 0.0, 0.0, 0.0), (9.0, 1.0, 0.0, 0.0)])
    assert robot.decide(far, robot.begin(far))[0].twist.forward == LIMITS.max_speed
    with pytest.raises(InputError, match="sight"):
        FollowerNavigator(sight=200.0)
