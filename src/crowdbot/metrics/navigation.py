"""Navigation metrics of a logged episode: outcome, time, path, proximity, contacts, smoothness."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Bools, Floats

from .agent_states import AgentStates
from .incremental import NavigationMetrics, NavigationOutcome
from .social.metric import metric_families

NAVIGATION_METRICS: dict[str, tuple[str, str]] = {
    row.name: (row.unit, row.formula) for row in metric_families()["navigation"]
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
