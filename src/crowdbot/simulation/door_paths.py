"""Paths of robots at the current doors."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.navigation import PathPlanner
from crowdbot.world import Doors, World, add_rings, worlds_of

__all__ = ["next_waypoints"]

Floats = NDArray[np.float64]


def next_waypoints(
    planner: PathPlanner, world: World, environments: NDArray[np.int64], place: Floats, goal: Floats, path: Floats
) -> tuple[Any, Floats]:
    """Return the next points of the paths of a robot, around doors that are closed now, and its goals.

    With doors, paths are planned anew, since a door may have opened or closed. A robot whose goal is behind a closed
    door has its own place as the goal until the door opens.

    Args:
        planner: planner among walls without doors.
        world: the world.
        environments: ``[N]`` indices of the environments; with doors, N = 1.
        place, goal: ``[N, 2]`` [m].
        path: ``[N, 9]`` states of the paths.
    """
    worlds = worlds_of(world)
    doors: Doors | None = worlds[int(environments[0]) if len(worlds) > 1 else 0].doors
    if doors is None:
        return planner.next_waypoints(place, goal, path), goal
    lines = doors.path_lines()
    walls = add_rings(planner.walls, lines) if lines else planner.walls
    found = PathPlanner.for_stage(walls, planner.radius, planner.margin).next_waypoints(place, goal)
    if not any(doors.blocked) or not found.failures:
        return found, goal
    point, own = found.point.copy(), goal.copy()
    for k in found.failures:
        point[k], own[k] = place[k], place[k]
    return found._replace(point=point, failures={}), own
