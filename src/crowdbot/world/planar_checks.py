"""Checks of the arguments of a planar world."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from crowdbot.core import InputError, Scene
from crowdbot.world.robots.drives.drive import Drive

__all__ = ["check_arguments"]


def check_arguments(
    scene: Scene,
    drives: Mapping[int, Drive],
    robot_margin: float,
    leave_radius: float | None,
    heading_jitter: float,
    substeps: int,
) -> None:
    """Raise :class:`InputError` if an argument of a planar world is not allowed."""
    agents = scene.shape[1]
    for robot in drives:
        if not 0 <= robot < agents:
            raise InputError(f"a drive is given for agent {robot}, but the scene has agents 0 to {agents - 1}")
        if not np.all(scene.external[:, robot]):
            raise InputError(f"agent {robot} has a drive but is not external: set external=True for robots")
    if not 0.0 <= robot_margin < math.inf:
        raise InputError(f"robot_margin {robot_margin} m must be finite and at least 0")
    if leave_radius is not None and not 0.0 < leave_radius < math.inf:
        raise InputError(f"leave_radius {leave_radius} m must be finite and above 0, or None")
    if not 0.0 <= heading_jitter <= math.pi:
        raise InputError(f"heading_jitter {heading_jitter} rad must be from 0 to pi")
    if isinstance(substeps, bool) or not isinstance(substeps, int) or not 1 <= substeps <= 10_000:
        raise InputError(f"substeps = {substeps!r} must be a whole number from 1 to 10000")
