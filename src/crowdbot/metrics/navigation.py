"""Navigation metrics of a logged episode: outcome, time, path, proximity, contacts, smoothness."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .agent_states import AgentStates
from .incremental import NavigationMetrics, NavigationOutcome

__all__ = ["NAVIGATION_METRICS", "navigation_metrics", "outcome"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

NAVIGATION_METRICS: dict[str, tuple[str, str]] = {
    "success": ("1", "the goal is reached in time and before any contact"),
    "collision": ("1", "a person or a wall is touched before the goal is reached (swept between samples)"),
    "timeout": ("1", "neither success nor collision"),
    "duration": ("s", "time from the first sample to the goal, or to the end of the log"),
    "time_to_goal": ("s", "duration if the outcome is success, otherwise NaN"),
    "goal_progress": ("1", "1 - final distance to the goal / initial distance to the goal"),
    "path_length": ("m", "sum of |p_k+1 - p_k|"),
    "path_efficiency": ("1", "distance from start to end / path length, in (0, 1]"),
    "min_clearance": ("m", "minimum of |p_i - p| - r_i - r over people and time (swept); negative if they overlap"),
    "min_clearance_time": ("s", "end of the time step with min_clearance"),
    "mean_nearest_distance": ("m", "mean clearance to the nearest person"),
    "min_wall_clearance": ("m", "minimum distance to a wall minus the radius of the robot (swept)"),
    "personal_space_compliance": ("1", "share of samples with a clearance of at least 0.5 m"),
    "intimate_share": ("1", "share of samples with a clearance to the nearest person below 0.45 m"),
    "personal_share": ("1", "share of samples with a clearance to the nearest person of 0.45 to 1.2 m"),
    "social_share": ("1", "share of samples with a clearance to the nearest person of 1.2 to 3.6 m"),
    "contacts": ("1", "number of contacts with people; a contact ends after 0.5 s at 0.05 m or more"),
    "robot_caused_contacts": ("1", "contacts in which the robot approaches faster, by more than 0.05 m/s"),
    "person_caused_contacts": ("1", "contacts in which the person approaches faster, or the robot stands"),
    "contact_time": ("s", "total duration of the contacts"),
    "max_penetration": ("m", "maximum overlap, 0 without contact"),
    "max_impact_speed": ("m/s", "maximum closing speed along the normal at first touch, 0 without contact"),
    "min_ttc": ("s", "minimum time to collision over samples and people, at constant velocities"),
    "ttc_below_1s": ("1", "share of samples with a time to collision below 1 s"),
    "ttc_below_3s": ("1", "share of samples with a time to collision below 3 s"),
    "stalled_time": ("s", "total time with a speed below 0.05 m/s"),
    "longest_stall": ("s", "longest uninterrupted time with a speed below 0.05 m/s"),
    "mean_jerk": ("m/s3", "mean norm of the second difference of the velocity over 0.1 s (or a longer time step)"),
    "max_jerk": ("m/s3", "maximum norm of the same difference"),
    "heading_change": ("rad", "sum of |wrap(h_k+1 - h_k)|"),
    "local_density": ("1/m2", "mean number of people within 2.5 m of the robot / (pi 2.5^2)"),
    "max_local_density": ("1/m2", "maximum number of people within 2.5 m of the robot / (pi 2.5^2)"),
}
"""Unit and definition of each key of :func:`navigation_metrics`, in order."""


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
) -> NavigationOutcome:
    """Return the outcome of an episode.

    A collision is a clearance below 0 to a person, or to a wall if ``walls [N, 4]`` are given, on the straight path
    between samples. A success is a sample with ``|p - goal| < tolerance`` [m] at most ``time_limit`` [s] after the
    first. The first of these events counts; a contact in the step that reaches the goal is a collision. Otherwise the
    outcome is a timeout, at the last sample within the limit.

    >>> p = np.array([[[0.0, 0.0], [5.0, 5.0]], [[1.0, 0.0], [5.0, 5.0]]])
    >>> outcome(np.arange(2.0), p, np.full(2, 0.3), np.ones((2, 2), bool), 0, np.array([1.1, 0.0]), tolerance=0.2)
    NavigationOutcome(name='success', sample=1)
    """
    still = np.zeros_like(position)
    return _metrics(times, position, still, radius, active, robot, goal, tolerance, None, walls, time_limit).outcome


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

    The log is evaluated up to the first sample at the goal, the time limit, or its end. Without people, clearances and
    times to collision are ``inf``; undefined values are NaN.

    Args:
        times: times ``[T]`` [s], increasing.
        position, velocity: ``[T, A, 2]`` [m], [m/s] of robot and people.
        radius: radii ``[A]`` [m].
        active: which agents are present ``[T, A]``.
        robot: index of the robot, which is always present.
        goal, tolerance: goal ``[2]`` [m] and the distance [m] below which it is reached.
        heading: heading of the robot ``[T]`` [rad] (default: direction of its velocity).
        walls: segments ``[N, 4]`` [m].
        time_limit: time limit after the first sample [s].

    Raises:
        InputError: shapes do not match, times do not increase, the robot is absent at some sample or a value is NaN.
    """
    _check(times, position, velocity, radius, active, robot, heading)
    return _metrics(
        times, position, velocity, radius, active, robot, goal, tolerance, heading, walls, time_limit
    ).result()


def _metrics(
    times: Floats,
    position: Floats,
    velocity: Floats,
    radius: Floats,
    active: Bools,
    robot: int,
    goal: Floats,
    tolerance: float,
    heading: Floats | None,
    walls: Floats | None,
    time_limit: float,
) -> NavigationMetrics:
    """Return the incremental metrics, updated with all samples of a log."""
    metrics = NavigationMetrics(robot, float(radius[robot]), goal, tolerance, walls=walls, time_limit=time_limit)
    for k in range(len(times)):
        here = np.flatnonzero(active[k])
        headings = np.full(len(here), np.nan)
        if heading is not None:
            headings[here == robot] = heading[k]
        metrics.update(AgentStates(float(times[k]), here, position[k, here], velocity[k, here], headings, radius[here]))
    return metrics


def _check(
    times: Floats,
    position: Floats,
    velocity: Floats,
    radius: Floats,
    active: Bools,
    robot: int,
    heading: Floats | None = None,
) -> None:
    count, agents = position.shape[:2]
    wanted = {
        "times": (times, (count,)),
        "position": (position, (count, agents, 2)),
        "velocity": (velocity, (count, agents, 2)),
        "radius": (radius, (agents,)),
        "active": (active, (count, agents)),
        "heading": (np.zeros(count) if heading is None else heading, (count,)),
    }
    for name, (value, shape) in wanted.items():
        if np.shape(value) != shape:
            raise InputError(f"navigation metrics: {name} has shape {list(np.shape(value))}, it must be {list(shape)}")
    if not 0 <= robot < agents:
        raise InputError(f"navigation metrics: robot = {robot} is not an index of {agents} agents")
    if count == 0 or np.any(np.diff(times) <= 0.0):
        raise InputError("navigation metrics: times must increase and contain at least one sample")
    if not np.all(active[:, robot]):
        raise InputError(f"navigation metrics: robot {robot} is absent at {times[np.argmin(active[:, robot])]} s")
    if not (np.all(np.isfinite(position[active])) and np.all(np.isfinite(velocity[active]))):
        raise InputError("navigation metrics: a position or velocity of an agent that is present is not finite")
