"""Cameras that show a wall instead of the stage."""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import NDArray

from crowdbot.trials.stage import Stage
from crowdbot.trials.trial import Trial

from .camera import Camera, floor_points, hidden_floor

IN_WALL = 0.02
"""A camera nearer to a wall [m] is in it; walls without an area are as thick."""
MARGIN = 10.0
"""Floor around the walls and the camera [m] that counts, too."""
HIDDEN = 0.98
"""Share of the floor in an image that walls hide before the camera is told to be behind a wall."""


def camera_remarks(trial: Trial, name: str = "") -> list[str]:
    """Return a sentence for every fixed camera that is in a wall, or whose view of the floor is hidden by walls.

    Args:
        trial: the trial.
        name: only the camera with this name (default: all cameras).

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Camera, Stage, Trial, Wall
    >>> stage = Stage(walls=[Wall([(0, -9), (0, 9)])])
    >>> behind = Camera(name="c", x=-0.2, z=1.6)
    >>> camera_remarks(Trial(name="t", duration=1, crowd=ORCA(), stage=stage, cameras=[behind]))
    ["camera 'c' looks at a wall: walls hide 100 % of the floor in its image"]
    """
    fixed = [camera for camera in trial.cameras if not camera.robot and name in ("", camera.name)]
    return [remark for camera in fixed if (remark := _remark(trial.stage, camera))]


def _remark(stage: Stage, camera: Camera) -> str:
    walls = stage.as_walls(props=False).segments().reshape(-1, 2, 2)
    if not len(walls):
        return ""
    place = np.array([camera.x, camera.y])
    if 0.0 <= camera.z <= stage.wall_height and _in_wall(stage, walls, place):
        return f"camera {camera.name!r} is in a wall at {camera.x:g},{camera.y:g}; it shows the inside of the wall"
    low, high = walls.min(axis=(0, 1)), walls.max(axis=(0, 1))
    floor = floor_points(stage, np.minimum(low, place - MARGIN), np.maximum(high, place + MARGIN))
    floor = floor[_in_frame(camera, floor)]
    if not len(floor):
        return ""
    hidden = float(hidden_floor(stage, floor, np.array([[camera.x, camera.y, camera.z]])).mean())
    if hidden < HIDDEN:
        return ""
    return f"camera {camera.name!r} looks at a wall: walls hide {100.0 * hidden:.0f} % of the floor in its image"


def _in_wall(stage: Stage, walls: NDArray[np.float64], place: NDArray[np.float64]) -> bool:
    point = shapely.points(place)
    near = shapely.distance(shapely.linestrings(walls), point).min() < IN_WALL
    return bool(near) or bool(stage.block_around(point))


def _in_frame(camera: Camera, floor: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return ``[N]`` whether floor points ``[N, 2]`` [m] are in the image, walls left aside."""
    flat, fall = math.cos(camera.pitch), math.sin(camera.pitch)
    cos, sin = math.cos(camera.heading), math.sin(camera.heading)
    off = np.column_stack([floor - (camera.x, camera.y), np.full(len(floor), -camera.z)])
    ahead = off @ (flat * cos, flat * sin, -fall)
    right, up = off @ (sin, -cos, 0.0), off @ (fall * cos, fall * sin, flat)
    edge = math.tan(0.5 * camera.field_of_view)
    inside = (np.abs(right) <= edge * ahead) & (np.abs(up) <= edge * camera.height / camera.width * ahead)
    return np.asarray(inside & (ahead > 0.0))
