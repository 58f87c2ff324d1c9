"""The map of a stage as ``nav_msgs/OccupancyGrid``, as map_server sends it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.messages import Messages
from crowdbot.trials import Stage

RESOLUTION, MOST_CELLS = 0.05, 1_000_000
"""Size of a cell [m], and the largest number of cells; a larger stage gets larger cells."""
MARGIN = 1.0
"""Free space [m] around walls, people and robots."""
OCCUPIED = 100


def map_message(make: Messages, stage: Stage, scene: Scene) -> Any:
    """Return ``nav_msgs/OccupancyGrid``: 100 in and on solids and outside the walkable area, 0 elsewhere.

    A cell is occupied if a solid is nearer to its centre than half of its diagonal.

    Args:
        make: creates the message.
        stage: the stage, with walls, obstacles and props.
        scene: people and robots at the start, which lie on the map.

    >>> from crowdbot.simulation import Simulation
    >>> from crowdbot.trials import load_trial
    >>> simulation = Simulation(load_trial("bottleneck"), 0)
    >>> grid = map_message(Messages(), simulation.trial.stage, simulation.world.scene)
    >>> grid.info.resolution, int(grid.data.max()), grid.data.size == grid.info.width * grid.info.height
    (0.05, 100, True)
    """
    low, high = _bounds(stage, scene)
    cell = RESOLUTION
    while math.prod(np.ceil((high - low) / cell)) > MOST_CELLS:
        cell *= 2.0
    width, height = (int(count) for count in np.ceil((high - low) / cell))
    x, y = (low[axis] + cell * (np.arange(count) + 0.5) for axis, count in ((0, width), (1, height)))
    centres = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    occupied = stage.clearance(centres) <= cell * math.sqrt(0.5)
    info = make.make(
        "nav_msgs/msg/MapMetaData",
        map_load_time=make.stamp(0),
        resolution=cell,
        width=width,
        height=height,
        origin=make.pose(float(low[0]), float(low[1]), 0.0),
    )
    data = np.where(occupied, OCCUPIED, 0).astype(np.int8)
    return make.make("nav_msgs/msg/OccupancyGrid", header=make.header(0), info=info, data=data)


def _bounds(stage: Stage, scene: Scene) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the corners [m] of the map, on whole cells."""
    places = [np.asarray(ring, dtype=np.float64) for ring in stage.rings]
    there = scene.active[0]
    places += [scene.position[0, there], scene.goal[0, there], np.zeros((1, 2))]
    points = np.concatenate([rows[np.isfinite(rows).all(axis=1)] for rows in places])
    low = np.floor((points.min(axis=0) - MARGIN) / RESOLUTION) * RESOLUTION
    return low, points.max(axis=0) + MARGIN
