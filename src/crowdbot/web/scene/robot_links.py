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
        return poses_of(found)
    targets = tuple(None if math.isnan(at) else at for at in control.joints[0].tolist())  # NaN is never cached
    return standing_links(scene, control.agent, _resting(robot, targets))


def standing_links(scene: Any, agent: int, links: Floats) -> Floats:
    """Return position [m] and quaternion ``[L, 7]`` in the world of links ``[L, 7]`` in the frame of an upright robot.

    >>> from crowdbot.core import Scene
    >>> scene = Scene.of([[1.0, 0.0]], [[0.0, 0.0]], heading=[math.pi / 2])
    >>> standing_links(scene, 0, np.array([[0.5, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0]])).round(3).tolist()
    [[1.0, 0.5, 0.1, 0.707, 0.0, 0.0, 0.707]]
    """
    place, heading = scene.position[0, agent], float(scene.heading[0, agent])
    cos, sin = math.cos(heading), math.sin(heading)
    c, s = math.cos(0.5 * heading), math.sin(0.5 * heading)
    turn = np.zeros((7, 7))  # both parts of a pose are linear in those of the link: one product for all links
    turn[:3, :3] = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]
    turn[3:, 3:] = [[c, 0.0, 0.0, -s], [0.0, c, -s, 0.0], [0.0, s, c, 0.0], [s, 0.0, 0.0, c]]
    found = links @ turn.T
    found[:, :2] += place
    return np.asarray(found)


def poses_of(frames: Floats) -> Floats:
    """Return position and quaternion ``[L, 7]`` of frames ``[L, 4, 4]``."""
    return np.concatenate([frames[:, :3, 3], quaternions(frames[:, :3, :3])], axis=1)


@functools.lru_cache(maxsize=64)
def _resting(robot: Robot, targets: tuple[float | None, ...]) -> Floats:
    """Return the poses ``[L, 7]`` of the links with shapes in the base frame; None for joints without a target."""
    joints = {name: at for name, at in zip(free_joints(robot), targets, strict=True) if at is not None}
    return poses_of(link_frames(robot, joints))


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
