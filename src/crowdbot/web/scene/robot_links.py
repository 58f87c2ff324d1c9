"""Poses of the links of robots."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.simulation import RobotControl, Simulation
from crowdbot.world import Robot, free_joints, simulated_body

from .meshes import shown_links
from .quaternions import quaternions

__all__ = ["link_poses"]

Floats = NDArray[np.float64]


def link_poses(simulation: Simulation, scene: Any, control: RobotControl) -> Floats:
    """Return position [m] and quaternion w, x, y, z ``[L, 7]`` of the links with shapes of a robot in the world.

    In the physics world they are those of the engine. In the plane, joints are at the targets of orders or at rest.
    """
    robot, names = control.robot.body, shown_links(control.robot.body)
    body = simulated_body(simulation.world, control.agent, 0)
    if body is not None:
        frames = body.frames()
        found = np.array([frames[name] for name in names]).reshape(-1, 4, 4)
    else:
        x, y = scene.position[0, control.agent].tolist()
        heading = float(scene.heading[0, control.agent])
        base = np.eye(4)
        base[:2, :2] = [[math.cos(heading), -math.sin(heading)], [math.sin(heading), math.cos(heading)]]
        base[:3, 3] = x, y, robot.lift
        found = base @ _resting(robot, tuple(control.joints[0].tolist()))
    return np.concatenate([found[:, :3, 3], quaternions(found[:, :3, :3])], axis=1)


@functools.lru_cache(maxsize=64)
def _resting(robot: Robot, targets: tuple[float, ...]) -> Floats:
    """Return the frames ``[L, 4, 4]`` of the links with shapes in the root frame; NaN for joints without a target."""
    joints = {name: at for name, at in zip(free_joints(robot), targets, strict=True) if not math.isnan(at)}
    poses = robot.model.poses({**robot.posture, **joints})
    return np.array([poses[name] for name in shown_links(robot)]).reshape(-1, 4, 4)
