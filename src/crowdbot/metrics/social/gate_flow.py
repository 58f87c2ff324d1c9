"""Flow of people through the gate on the way of a robot, with and without the robot."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.metrics.agent_states import AgentLog
from crowdbot.typing import Floats

from .robot_log import RobotLog

REACH = 5.0
"""Largest distance [m] of an end of the gate from the place on the path."""
STEP = 0.25
"""Largest distance [m] between the places on the path."""


def gate_metrics(log: RobotLog, run: AgentLog, ghost: AgentLog, robot: int) -> dict[str, float]:
    """Return the metrics of the gate of the family ``crowd-disturbance``; NaN where a log has no goal.

    Args:
        log: log of the robot.
        run: the run.
        ghost: the same run with a robot that nobody sees or feels.
        robot: id of the robot in the run.
    """
    gate = find_gate(log)
    time = min(float(log.times[-1]), float(ghost.times[-1])) - float(run.times[0])
    if gate is None or time <= 0.0:
        return dict.fromkeys(("gate_flow", "gate_flow_without_robot", "gate_flow_loss"), math.nan)
    width = float(np.hypot(*(gate[1] - gate[0])))
    with_robot, without = (count_crossings(item, gate, robot, run.times[0] + time) for item in (run, ghost))
    return {
        "gate_flow": with_robot / (width * time),
        "gate_flow_without_robot": without / (width * time),
        "gate_flow_loss": 1.0 - with_robot / without if without else math.nan,
    }


def find_gate(log: RobotLog) -> Floats | None:
    """Return the ends ``[2, 2]`` [m] of the gate: the narrowest place on the shortest path of a robot.

    At each place on the path, the gate goes from the nearest point of the walls on the right to that on the left, where
    no wall is nearer than 5 m to the point 5 m aside. The shortest gate is taken, of equal ones that nearest to the
    middle of the path. None without a goal, or if the path has no length.

    >>> from crowdbot.metrics.agent_states import AgentLog
    >>> place = np.array([[[0.0, 0.0]], [[1.0, 0.0]]])
    >>> agents = AgentLog(np.arange(2.0), place, place, np.zeros((2, 1)), np.ones((2, 1)), np.ones((2, 1), bool))
    >>> door = np.array([[3.0, 1.0, 3.0, 9.0], [3.0, -1.0, 3.0, -9.0]])
    >>> find_gate(RobotLog.of(agents, 0, (8.0, 0.0), walls=door)).round(6).tolist()
    [[3.0, -1.0], [3.0, 1.0]]
    """
    if log.goal is None:
        return None
    path = np.stack([log.position[0], log.goal]) if log.path is None else log.path
    lengths = np.hypot(*np.diff(path, axis=0).T)
    total = float(lengths.sum())
    if total <= 0.0:
        return None
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    steps = max(1, math.ceil(total / (2.0 * STEP)))
    found = []
    for k in sorted(range(-steps, steps + 1), key=abs):
        at = total / 2.0 + k * total / (2.0 * steps)
        leg = min(int(np.searchsorted(ends, at, side="right")) - 1, len(lengths) - 1)
        ahead = (path[leg + 1] - path[leg]) / lengths[leg]
        place, left = path[leg] + (at - ends[leg]) * ahead, np.array([-ahead[1], ahead[0]])
        found.append(np.stack([_end_of_gate(place, side * left, log.walls) for side in (-1.0, 1.0)]))
    widths = np.round([np.hypot(*(gate[1] - gate[0])) for gate in found], 6)
    return np.asarray(found[int(np.argmin(widths))])


def _end_of_gate(place: Floats, left: Floats, walls: Floats) -> Floats:
    """Return the nearest point [m] of the walls on one side of a place, or the point 5 m to this side."""
    far = place + REACH * left
    start, along = walls[:, :2] - place, walls[:, 2:] - walls[:, :2]
    height, slope = start @ left, along @ left
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = -height / slope
        nearest = np.nan_to_num(-np.sum(start * along, axis=1) / np.sum(along**2, axis=1))
    # the part of each wall on this side, as shares of its length
    first = np.where((slope > 0.0) & (height < 0.0), zero, 0.0)
    last = np.where((slope < 0.0) & (height + slope < 0.0), zero, 1.0)
    there = (np.maximum(height, height + slope) > 0.0) & (first <= last)
    points = start + np.clip(nearest, first, last)[:, None] * along
    away = np.where(there, np.hypot(*points.T), np.inf)
    k = int(np.argmin(away)) if len(walls) else 0
    return np.asarray(place + points[k] if len(walls) and away[k] < REACH else far)


def count_crossings(log: AgentLog, gate: Floats, robot: int, end: float) -> int:
    """Return how often people cross a gate until a time, in either direction.

    A person crosses when two samples in succession are on different sides and the line between them meets the gate.

    Args:
        log: the run.
        gate: ends ``[2, 2]`` [m].
        robot: id of the robot, which does not count.
        end: time [s].
    """
    across = gate[1] - gate[0]
    rows = log.times <= end
    place, active = log.position[rows], log.active[rows]
    before, after = place[:-1] - gate[0], place[1:] - gate[0]
    sides = [_cross(across, item) >= 0.0 for item in (before, after)]
    move = after - before
    turn = _cross(across, move)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = _cross(before, move) / turn
    crosses = (sides[0] != sides[1]) & (share >= 0.0) & (share <= 1.0) & active[:-1] & active[1:]
    crosses[:, robot] = False
    return int(crosses.sum())


def _cross(one: Floats, two: Floats) -> Floats:
    return np.asarray(one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0])
