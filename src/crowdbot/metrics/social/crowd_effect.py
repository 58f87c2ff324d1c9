"""Effects measured with paired runs: people with and without the robot, and the robot with and without people."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from crowdbot.metrics.agent_states import AgentLog
from crowdbot.metrics.motion import jerk, path_length
from crowdbot.typing import Floats

from .robot_log import RobotLog

Measure = Callable[[Floats, Floats, Floats], float]
NEIGHBOR = 5.0
"""People who come closer to the robot than this [m], between centres, are its neighbours."""
SAME_ENTRY = 1.0
"""Distance [m] of the entries of the same person in two runs at most."""
MOVED = 0.5
"""Mean displacement [m] above which a person is displaced."""


def crowd_effect(run: AgentLog, ghost: AgentLog, robot: int, shifted: AgentLog | None = None) -> dict[str, float]:
    """Return the metrics of the family ``crowd-effect``.

    Args:
        run: the run.
        ghost: the same run with a robot that nobody sees or feels.
        robot: id of the robot in the run.
        shifted: the same run with the robot 1 mm aside, for the chaos floor.

    People are the same if their ids are, and they enter within 1 m of the same place; ids of people who enter later
    depend on their order. Displacements are means over the time in which a person is present in both runs.
    """
    displacement, near = _displacements(run, ghost, robot)
    moved = displacement[near]
    pairs = [(run, ghost, k) for k in np.flatnonzero(near).tolist()]
    floor = math.nan
    if shifted is not None:
        noise, neighbors = _displacements(run, shifted, robot)
        floor = float(np.mean(noise[neighbors])) if neighbors.any() else math.nan
    mean = float(np.mean(moved)) if len(moved) else math.nan
    worst = np.sort(moved)[::-1][: max(1, math.ceil(len(moved) / 10))]
    return {
        "crowd_disturbance": mean,
        "chaos_floor": floor,
        "disturbance_ratio": mean / floor if floor > 0.0 else math.inf if mean > 0.0 else math.nan,
        "worst_person_disturbance": float(np.max(moved)) if len(moved) else math.nan,
        "worst_decile_disturbance": float(np.mean(worst)) if len(moved) else math.nan,
        "displaced_share": float(np.mean(moved > MOVED)) if len(moved) else math.nan,
        "neighbors": float(near.sum()),
        "neighbor_time_ratio": _mean_ratio([_ratio(_stay(a, k), _stay(b, k)) for a, b, k in pairs]),
        "neighbor_length_ratio": _mean_ratio([_ratio(*_common(a, b, k, _length)) for a, b, k in pairs]),
        "neighbor_jerk_ratio": _mean_ratio([_ratio(*_common(a, b, k, _jerk)) for a, b, k in pairs]),
        "neighbor_speed_ratio": _mean_ratio([_ratio(*_common(a, b, k, _speed)) for a, b, k in pairs]),
        "people_time_lost": float(np.nansum([_stay(a, k) - _stay(b, k) for a, b, k in pairs])) if pairs else 0.0,
    }


def empty_scene_ratios(log: RobotLog, empty: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``empty-scene``: time, length and jerk relative to the run without people.

    Time and length need success in both runs.
    """
    both = log.success and empty.success
    mine, alone = (float(np.mean(values)) if len(values) else math.nan for values in (_jerks(log), _jerks(empty)))
    return {
        "relative_time": _ratio(log.duration, empty.duration) if both else math.nan,
        "relative_length": _ratio(path_length(log.position), path_length(empty.position)) if both else math.nan,
        "relative_jerk": _ratio(mine, alone),
    }


def _jerks(log: RobotLog) -> Floats:
    return jerk(log.times, log.velocity)


def _displacements(run: AgentLog, other: AgentLog, robot: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the mean displacement of each person ``[A]`` [m], 0 without common time, and who is a neighbour."""
    samples, agents = (min(len(run.times), len(other.times)), min(run.active.shape[1], other.active.shape[1]))
    same = np.hypot(*(_entry(run)[:agents] - _entry(other)[:agents]).T) < SAME_ENTRY
    both = run.active[:samples, :agents] & other.active[:samples, :agents] & same
    gap = np.hypot(*np.moveaxis(run.position[:samples, :agents] - other.position[:samples, :agents], -1, 0))
    count = both.sum(axis=0)
    mean = np.where(both, gap, 0.0).sum(axis=0) / np.maximum(1, count)
    away = np.hypot(*np.moveaxis(run.position[:, :agents] - run.position[:, robot : robot + 1], -1, 0))
    close = run.active[:, :agents] & run.active[:, robot : robot + 1] & (away < NEIGHBOR)
    near = close.any(axis=0) & (count > 0)
    near[robot] = False
    return mean, near


def _entry(log: AgentLog) -> Floats:
    """Return the position ``[A, 2]`` [m] at which each agent enters; meaningless for those who never do."""
    first = np.argmax(log.active, axis=0)
    return np.asarray(log.position[first, np.arange(log.active.shape[1])])


def _stay(log: AgentLog, person: int) -> float:
    """Return the time until a person leaves [s]; NaN if present at the end."""
    there = np.flatnonzero(log.active[:, person])
    return (
        float(log.times[there[-1]] - log.times[there[0]]) if len(there) and there[-1] < len(log.times) - 1 else math.nan
    )


def _common(run: AgentLog, ghost: AgentLog, person: int, measure: Measure) -> tuple[float, float]:
    """Return a value of a person in both runs, over the samples at which the person is present in both."""
    count = min(len(run.times), len(ghost.times))
    both = run.active[:count, person] & ghost.active[:count, person]
    first, second = (
        measure(item.times[:count][both], item.position[:count, person][both], item.velocity[:count, person][both])
        for item in (run, ghost)
    )
    return first, second


def _length(times: Floats, position: Floats, velocity: Floats) -> float:
    return path_length(position)


def _jerk(times: Floats, position: Floats, velocity: Floats) -> float:
    found = jerk(times, velocity)
    return float(np.mean(found)) if len(found) else math.nan


def _speed(times: Floats, position: Floats, velocity: Floats) -> float:
    return float(np.mean(np.hypot(velocity[:, 0], velocity[:, 1]))) if len(times) else math.nan


def _ratio(one: float, other: float) -> float:
    return one / other if other > 1e-9 else math.nan


def _mean_ratio(values: list[float]) -> float:
    known = [value for value in values if math.isfinite(value)]
    return float(np.mean(known)) if known else math.nan
