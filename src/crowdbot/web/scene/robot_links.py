"""Poses of the links of robots."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from crowdbot.core import SpatialPose
from crowdbot.simulation import RobotControl, Simulation
from crowdbot.typing import Floats
from crowdbot.world import Robot, frame, free_joints, simulated_body

from .meshes import shown_links
from .quaternions import quaternions


def link_poses(simulation: Simulation, scene: Any, control: RobotControl) -> Floats:
    """Return position [m] and quaternion w, x, y, z ``[L, 7]`` of the links with shapes of a robot in the world.

    In the physics world they are those of the engine. In the plane, joints are at the targets of orders or at rest.
    """
    robot, names = control.robot.body, shown_links(control.robot.body)
    body = simulated_body(simulation.world, control.agent, 0)
    if body is not None:
        frames = body.frames()
        found = np.array([frames[name] for name in names]).reshape(-1, 4, 4)
        return np.concatenate([found[:, :3, 3], quaternions(found[:, :3, :3])], axis=1)
    targets = tuple(None if math.isnan(at) else at for at in control.joints[0].tolist())  # NaN is never cached
    return standing_links(scene, control.agent, _resting(robot, targets))


def standing_links(scene: Any, agent: int, links: Floats) -> Floats:
    """Return position [m] and quaternion ``[L, 7]`` in the world of links ``[L, 4, 4]`` of an upright robot."""
    x, y = scene.position[0, agent].tolist()
    heading = float(scene.heading[0, agent])
    base = np.eye(4)
    base[:2, :2] = [[math.cos(heading), -math.sin(heading)], [math.sin(heading), math.cos(heading)]]
    base[:2, 3] = x, y
    found = base @ links
    return np.concatenate([found[:, :3, 3], quaternions(found[:, :3, :3])], axis=1)


@functools.lru_cache(maxsize=64)
def _resting(robot: Robot, targets: tuple[float | None, ...]) -> Floats:
    """Return the frames ``[L, 4, 4]`` of the links with shapes in the base frame; None for joints without a target."""
    joints = {name: at for name, at in zip(free_joints(robot), targets, strict=True) if at is not None}
    return link_frames(robot, joints)


def link_frames(
    robot: Robot, joints: Mapping[str, float], tilt: tuple[float, float, float] | None = None
) -> Floats:  # fmt: skip
    """Return the frames ``[L, 4, 4]`` of the links with shapes for positions of joints; others are at rest.

    Args:
        robot: the robot.
        joints: positions of joints by name.
        tilt: height [m], roll and pitch [rad] of the root link; None: upright on a level floor.
    """
    poses = robot.model.poses({**robot.posture, **joints})
    result = np.array([poses[name] for name in shown_links(robot)]).reshape(-1, 4, 4)
    if tilt is not None:
        height, roll, pitch = tilt
        turn = SpatialPose.of((0.0, 0.0, 0.0), roll=roll, pitch=pitch).matrix[0]
        return np.asarray(frame((0.0, 0.0, height), turn) @ result)
    result[:, 2, 3] += robot.lift
    return result
