"""Rollout: the motion of a drive under a fixed lattice of plans, for model-predictive control."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import wrap_angle
from crowdbot.navigation.goal_motion import SLOWING_TIME, TURN_GAIN
from crowdbot.navigation.observation import Observation
from crowdbot.typing import Floats

EAGER = 100.0
"""Value for unknown accelerations [m/s2], [rad/s2]."""
SPEEDS = (1.0, 0.75, 0.5, 0.25, 0.0)
"""Shares of the largest speed in a plan."""
TURNS = (0.0, 0.08, -0.08, 0.2, -0.2, 0.4, -0.4, 0.7, -0.7, 1.0, -1.0)
"""Shares of the largest turn rate, or of a half turn away from the waypoint for a holonomic drive."""
FASTEST_TURN = 2.0
"""Largest turn rate of a plan [rad/s]."""
HOLDS = (0.6, 1.5)
"""Times for which the first part of a plan lasts [s]."""
PASSED = 0.3
"""Distance [m] at which a plan leaves the waypoint for the goal."""


class PlanMotions(NamedTuple):
    """The motion under C plans in T steps."""

    first: Floats
    """``[C, 3]`` forward, turn, left that the plan begins with."""
    position: Floats
    """``[C, T, 2]`` [m]."""
    heading: Floats
    """``[C, T]`` [rad]."""
    remaining: Floats
    """``[C, T]`` length of the path to the goal that is left [m]."""
    change: Floats
    """``[C]`` change of the velocity in the first step [m/s] as a share of the largest, and the same of the turn."""


def _plans() -> Floats:
    """Return the plans ``[C, 3]``: share of the speed, share of the turn, time of the first part [s].

    After the first part a plan goes on to the waypoint with the full speed. A plan of 0 s goes there at once, with its
    share of the speed.
    """
    rows = [(speed, 0.0, 0.0) for speed in SPEEDS]
    rows += [(speed, turn, hold) for hold in HOLDS for speed in SPEEDS for turn in TURNS]
    return np.array(rows)


PLANS = _plans()


def roll_out(observation: Observation, speed: float, steps: int, step: float) -> PlanMotions:
    """Return the motion of the drive within its limits under each plan.

    Args:
        observation: what the robot knows.
        speed: largest speed [m/s].
        steps: number T of steps.
        step: length of a step [s].
    """
    C, top = len(PLANS), min(speed, observation.limits.max_speed)
    share, hold = PLANS[:, 0], PLANS[:, 2]
    move = _move_holonomic if observation.limits.holonomic else _move_ahead
    heading = np.full(C, observation.heading)
    motion = np.tile(_motion(observation), (C, 1))
    place = np.tile(observation.position, (C, 1))
    way, goal = np.array(observation.waypoint), np.array(observation.goal)
    passed = np.full(C, math.dist(observation.waypoint, observation.goal) == 0.0)
    beyond = math.dist(observation.waypoint, observation.goal)
    headings = np.empty((C, steps))
    position, remaining, first, change = np.empty((C, steps, 2)), np.empty((C, steps)), np.empty((C, 3)), np.zeros(C)
    for k in range(steps):
        towards = np.where(passed[:, None], goal, way) - place
        distance = np.hypot(*towards.T)
        left = distance + np.where(passed, 0.0, beyond)
        held = k * step < hold - 1e-9
        most = np.where(held | (hold == 0.0), share, 1.0) * top
        slow = np.minimum(most, np.minimum(left / SLOWING_TIME, _braking(left, observation.limits.max_acceleration)))
        target, place, heading = move(observation, held, most, slow, towards, motion, place, heading, step)
        if k == 0:
            first[:] = target
            step_of = motion - _motion(observation)
            turned = 0.0 if observation.limits.holonomic else np.abs(step_of[:, 2]) / observation.limits.max_turn_rate
            change = np.hypot(step_of[:, 0], step_of[:, 1]) / top + turned
        ahead = np.where(passed[:, None], goal, way) - place
        distance = np.hypot(*ahead.T)
        remaining[:, k] = distance + np.where(passed, 0.0, beyond)
        passed = passed | (distance < PASSED)
        position[:, k], headings[:, k] = place, heading
    return PlanMotions(first, position, headings, remaining, change)


def _motion(observation: Observation) -> Floats:
    """Return the state of the drive: forward and turn, or the velocity x, y of the world and the turn."""
    if observation.limits.holonomic:
        return np.array([*observation.velocity.tolist(), observation.twist.turn])
    return np.array([observation.twist.forward, 0.0, observation.twist.turn])


def _braking(remaining: Floats, acceleration: float) -> Floats:
    return np.sqrt(1.6 * min(acceleration, EAGER) * remaining)


def _turn_to(angle: Floats, observation: Observation) -> Floats:
    """Return the turn rates [rad/s] that turn the robot by angles without overshoot, as ``Observation.turn_by``."""
    limits = observation.limits
    push = np.sqrt(1.6 * min(limits.max_turn_acceleration, EAGER) * np.abs(angle))
    size = np.minimum(np.minimum(TURN_GAIN * np.abs(angle), limits.max_turn_rate), push)
    return np.asarray(np.copysign(size, angle))


def _bearing(towards: Floats, heading: Floats) -> Floats:
    angle = np.where((towards == 0.0).all(axis=1), 0.0, np.arctan2(towards[:, 1], towards[:, 0]) - heading)
    return wrap_angle(angle)


def _move_ahead(
    observation: Observation, held: NDArray[np.bool_], most: Floats, slow: Floats, towards: Floats,
    motion: Floats, place: Floats, heading: Floats, step: float,
) -> tuple[Floats, Floats, Floats]:  # fmt: skip
    """Move a drive that goes only ahead by a step; write ``motion``, return target twist, place and heading."""
    limits = observation.limits
    bearing = _bearing(towards, heading)
    steer = _turn_to(bearing, observation)
    aside = PLANS[:, 1] * min(limits.max_turn_rate, FASTEST_TURN)
    turn = np.where(held, aside, steer)
    forward = np.where(held, most, slow * np.maximum(0.0, 2.0 * np.cos(bearing) - 1.0))
    push, spin = min(limits.max_acceleration, EAGER) * step, min(limits.max_turn_acceleration, EAGER) * step
    motion[:, 0] += np.clip(forward - motion[:, 0], -push, push)
    motion[:, 2] += np.clip(turn - motion[:, 2], -spin, spin)
    middle = heading + 0.5 * step * motion[:, 2]
    moved = place + (step * motion[:, 0])[:, None] * np.stack([np.cos(middle), np.sin(middle)], axis=1)
    return np.stack([forward, turn, np.zeros_like(turn)], axis=1), moved, heading + step * motion[:, 2]


def _move_holonomic(
    observation: Observation, held: NDArray[np.bool_], most: Floats, slow: Floats, towards: Floats,
    motion: Floats, place: Floats, heading: Floats, step: float,
) -> tuple[Floats, Floats, Floats]:  # fmt: skip
    """Move a holonomic drive by a step; write ``motion``, return target twist, place and heading."""
    limits = observation.limits
    distance = np.maximum(np.hypot(*towards.T), 1e-9)
    size = np.where(held, most, np.minimum(slow, distance / step))
    aside = np.where(held, PLANS[:, 1] * math.pi, 0.0)
    cos, sin, unit = np.cos(aside), np.sin(aside), towards / distance[:, None]
    velocity = np.stack([cos * unit[:, 0] - sin * unit[:, 1], sin * unit[:, 0] + cos * unit[:, 1]], axis=1)
    velocity *= size[:, None]
    turn = np.where(size > 0.05, _turn_to(_bearing(velocity, heading), observation), 0.0)
    change = velocity - motion[:, :2]
    need, push = np.hypot(*change.T), min(limits.max_acceleration, EAGER) * step
    motion[:, :2] += change * np.minimum(1.0, push / np.maximum(need, 1e-9))[:, None]
    middle = heading + 0.5 * observation.dt * turn
    cos, sin = np.cos(middle), np.sin(middle)
    target = np.stack(
        [cos * velocity[:, 0] + sin * velocity[:, 1], turn, cos * velocity[:, 1] - sin * velocity[:, 0]], axis=1
    )
    return target, place + step * motion[:, :2], heading + step * turn
