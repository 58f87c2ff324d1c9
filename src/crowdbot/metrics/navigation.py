"""How a robot got through a crowd: outcome, time, path, proximity, contacts, smoothness. Functions of logs only."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .contacts import contact_events
from .motion import heading_change, jerk, longest_stall, path_efficiency, path_length, stalled_time
from .proximity import (
    clearance,
    local_density,
    personal_space_compliance,
    proxemic_shares,
    swept_clearance,
    time_to_collision,
    wall_clearance,
)

__all__ = ["NAVIGATION_METRICS", "Outcome", "navigation_metrics", "outcome"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

NAVIGATION_METRICS: dict[str, tuple[str, str]] = {
    "success": ("1", "the goal was reached in time and before any contact"),
    "collision": ("1", "someone or a wall was touched before the goal was reached, swept between samples"),
    "timeout": ("1", "neither; success + collision + timeout = 1"),
    "duration": ("s", "from the first sample to the goal, or to the end of the log"),
    "time_to_goal": ("s", "duration of a success, otherwise NaN"),
    "goal_progress": ("1", "1 - distance to the goal at the end / at the beginning"),
    "path_length": ("m", "sum |p_k+1 - p_k|"),
    "path_efficiency": ("1", "straight distance between both ends / path length, in (0, 1]"),
    "min_clearance": ("m", "smallest |p_i - p| - r_i - r over time and people, swept; negative = overlap"),
    "min_clearance_time": ("s", "end of the time step of min_clearance"),
    "mean_nearest_distance": ("m", "mean over samples of the clearance to the nearest person"),
    "min_wall_clearance": ("m", "smallest distance to a wall less the robot's radius, swept"),
    "personal_space_compliance": ("1", "share of samples with a clearance of at least 0.5 m"),
    "intimate_share": ("1", "share of samples with the nearest person below 0.45 m, surface to surface"),
    "personal_share": ("1", "the same from 0.45 to 1.2 m"),
    "social_share": ("1", "the same from 1.2 to 3.6 m"),
    "contacts": ("1", "number of contact events with people (over when 0.05 m apart for 0.5 s)"),
    "robot_caused_contacts": ("1", "events in which the robot closed in faster, by more than 0.05 m/s"),
    "person_caused_contacts": ("1", "events in which the person closed in faster, or the robot stood"),
    "contact_time": ("s", "sum of the durations of the events"),
    "max_penetration": ("m", "deepest overlap, 0 without contact"),
    "max_impact_speed": ("m/s", "largest closing speed along the normal at first touch, 0 without contact"),
    "min_ttc": ("s", "smallest time to collision over samples and people, at constant velocities"),
    "ttc_below_1s": ("1", "share of samples with a time to collision below 1 s"),
    "ttc_below_3s": ("1", "share of samples with a time to collision below 3 s"),
    "stalled_time": ("s", "time slower than 0.05 m/s"),
    "longest_stall": ("s", "longest time without a break slower than 0.05 m/s"),
    "mean_jerk": ("m/s3", "mean size of the second difference of the velocity over 0.1 s (or the log's longer step)"),
    "max_jerk": ("m/s3", "its maximum"),
    "heading_change": ("rad", "sum |wrap(h_k+1 - h_k)|"),
    "local_density": ("1/m2", "mean number of people within 2.5 m of the robot's centre / (pi 2.5^2)"),
    "max_local_density": ("1/m2", "its maximum"),
}
"""Unit and definition of every key of :func:`navigation_metrics`, in order."""


class Outcome(NamedTuple):
    """How an episode ended: ``success``, ``collision`` or ``timeout``, and at which sample that was decided."""

    name: str
    sample: int


def outcome(
    times: Floats,
    position: Floats,
    radius: Floats,
    active: Bools,
    robot: int,
    goal: Floats,
    tolerance: float,
    *,
    walls: Floats | None = None,
    time_limit: float = math.inf,
) -> Outcome:
    """Return how an episode ended.

    A collision is a clearance below 0 to a person or (when ``walls [N, 4]`` are given) to a wall, on the straight way
    between samples; a success is a sample with ``|p - goal| < tolerance`` [m] not later than ``time_limit`` [s] after
    the first; what comes first counts, and a contact in the time step that reaches the goal comes first. Otherwise it
    is a timeout, at the last sample within the limit.

    >>> p = np.array([[[0.0, 0.0], [5.0, 5.0]], [[1.0, 0.0], [5.0, 5.0]]])
    >>> outcome(np.arange(2.0), p, np.full(2, 0.3), np.ones((2, 2), bool), 0, np.array([1.1, 0.0]), tolerance=0.2)
    Outcome(name='success', sample=1)
    """
    near = np.min(swept_clearance(times, position, radius, active, robot), axis=1)
    if walls is not None:
        near = np.minimum(near, wall_clearance(position[:, robot], float(radius[robot]), walls))
    away = position[:, robot] - goal
    arrived = np.hypot(away[:, 0], away[:, 1]) < tolerance
    for k in np.flatnonzero(((near < 0.0) | arrived) & (times - times[0] <= time_limit)):
        return Outcome("collision" if near[k] < 0.0 else "success", int(k))
    return Outcome("timeout", int(np.flatnonzero(times - times[0] <= time_limit)[-1]))


def navigation_metrics(
    times: Floats,
    position: Floats,
    velocity: Floats,
    radius: Floats,
    active: Bools,
    robot: int,
    goal: Floats,
    tolerance: float,
    *,
    heading: Floats | None = None,
    walls: Floats | None = None,
    time_limit: float = math.inf,
) -> dict[str, float]:
    """Return every metric of :data:`NAVIGATION_METRICS` for one robot in one episode.

    The log counts up to the first sample at the goal, to the time limit, or to its end. Without people, clearances
    and times to collision are ``inf``; what is not defined is NaN.

    Args:
        times: ``[T]`` [s], increasing.
        position, velocity: ``[T, A, 2]`` [m], [m/s] of robot and people.
        radius: ``[A]`` [m].
        active: ``[T, A]`` who is there.
        robot: index of the robot, there all the time.
        goal, tolerance: ``[2]`` [m] and the distance [m] below which it is reached.
        heading: ``[T]`` [rad] of the robot; by default the direction of its velocity while it moves.
        walls: segments ``[N, 4]`` [m].
        time_limit: [s] after the first sample.

    Raises:
        InputError: shapes do not fit, times do not increase, the robot is absent at some sample or a value is NaN.
    """
    _check(times, position, velocity, radius, active, robot)
    goal = np.asarray(goal, dtype=np.float64)
    ended = outcome(times, position, radius, active, robot, goal, tolerance, walls=walls, time_limit=time_limit)
    end = _end(times, position[:, robot], goal, tolerance, time_limit)
    times, position, velocity, active = times[:end], position[:end], velocity[:end], active[:end]
    turned = _directions(velocity[:, robot]) if heading is None else heading[:end]
    duration = float(times[-1] - times[0])
    first, last = (math.dist(position[k, robot], goal) for k in (0, -1))
    jerks = jerk(times, velocity[:, robot])
    return {
        **{name: float(ended.name == name) for name in ("success", "collision", "timeout")},
        "duration": duration,
        "time_to_goal": duration if ended.name == "success" else math.nan,
        "goal_progress": 1.0 - last / first if first > 0.0 else 1.0,
        "path_length": path_length(position[:, robot]),
        "path_efficiency": path_efficiency(position[:, robot]),
        **_nearness(times, position, radius, active, robot),
        "min_wall_clearance": _wall_gap(position[:, robot], float(radius[robot]), walls),
        **_contacts(times, position, velocity, radius, active, robot),
        **_foresight(position, velocity, radius, active, robot),
        "stalled_time": stalled_time(times, velocity[:, robot]),
        "longest_stall": longest_stall(times, velocity[:, robot]),
        "mean_jerk": float(np.mean(jerks)) if len(jerks) else math.nan,
        "max_jerk": float(np.max(jerks)) if len(jerks) else math.nan,
        "heading_change": heading_change(turned),
    }


def _nearness(times: Floats, position: Floats, radius: Floats, active: Bools, robot: int) -> dict[str, float]:
    swept = np.min(swept_clearance(times, position, radius, active, robot), axis=1)
    nearest = np.min(clearance(position, radius, active, robot), axis=1)
    someone = np.isfinite(nearest)
    density = local_density(position, active, robot)
    return {
        "min_clearance": float(np.min(swept)),
        "min_clearance_time": float(times[np.argmin(swept)]) if np.any(np.isfinite(swept)) else math.nan,
        "mean_nearest_distance": float(np.mean(nearest[someone])) if np.any(someone) else math.inf,
        "personal_space_compliance": personal_space_compliance(nearest),
        **{f"{zone}_share": share for zone, share in proxemic_shares(nearest).items()},
        "local_density": float(np.mean(density)),
        "max_local_density": float(np.max(density)),
    }


def _contacts(
    times: Floats, position: Floats, velocity: Floats, radius: Floats, active: Bools, robot: int
) -> dict[str, float]:
    events = contact_events(times, position, velocity, radius, active, robot)
    return {
        "contacts": float(len(events)),
        "robot_caused_contacts": float(sum(event.cause == "robot" for event in events)),
        "person_caused_contacts": float(sum(event.cause == "person" for event in events)),
        "contact_time": sum((event.end - event.begin for event in events), 0.0),
        "max_penetration": max((event.depth for event in events), default=0.0),
        "max_impact_speed": max((event.impact_speed for event in events), default=0.0),
    }


def _foresight(position: Floats, velocity: Floats, radius: Floats, active: Bools, robot: int) -> dict[str, float]:
    soonest = np.min(time_to_collision(position, velocity, radius, active, robot), axis=1)
    return {
        "min_ttc": float(np.min(soonest)),
        "ttc_below_1s": float(np.mean(soonest < 1.0)),
        "ttc_below_3s": float(np.mean(soonest < 3.0)),
    }


def _wall_gap(position: Floats, radius: float, walls: Floats | None) -> float:
    return math.inf if walls is None else float(np.min(wall_clearance(position, radius, walls)))


def _end(times: Floats, position: Floats, goal: Floats, tolerance: float, time_limit: float) -> int:
    arrived = np.flatnonzero(np.hypot(position[:, 0] - goal[0], position[:, 1] - goal[1]) < tolerance)
    within = int(np.count_nonzero(times - times[0] <= time_limit))
    return min(within, int(arrived[0]) + 1) if len(arrived) else within


def _directions(velocity: Floats) -> Floats:
    moving = np.hypot(velocity[:, 0], velocity[:, 1]) > 0.05
    return np.asarray(np.arctan2(velocity[moving, 1], velocity[moving, 0]))


def _check(times: Floats, position: Floats, velocity: Floats, radius: Floats, active: Bools, robot: int) -> None:
    count, agents = position.shape[:2]
    wanted = {
        "times": (times, (count,)),
        "position": (position, (count, agents, 2)),
        "velocity": (velocity, (count, agents, 2)),
        "radius": (radius, (agents,)),
        "active": (active, (count, agents)),
    }
    for name, (value, shape) in wanted.items():
        if np.shape(value) != shape:
            raise InputError(f"navigation metrics: {name} has shape {list(np.shape(value))}, it must be {list(shape)}")
    if not 0 <= robot < agents:
        raise InputError(f"navigation metrics: robot = {robot} is not an index of {agents} agents")
    if count == 0 or np.any(np.diff(times) <= 0.0):
        raise InputError("navigation metrics: times must increase and hold at least one sample")
    if not np.all(active[:, robot]):
        raise InputError(f"navigation metrics: robot {robot} is absent at {times[np.argmin(active[:, robot])]} s")
    if not (np.all(np.isfinite(position[active])) and np.all(np.isfinite(velocity[active]))):
        raise InputError("navigation metrics: a position or velocity of someone who is there is not finite")
