"""Springs of castors on uneven ground.

A robot with two wheels and castors at both ends of one rigid body would hang between its castors where a ramp begins,
and its wheels would spin in the air. Real robots have springs at wheels or castors. On stages with uneven ground the
contacts of castors are as soft as springs; on level stages they stay as they are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from crowdbot.world.physics.engine import engine
from crowdbot.world.robots.robot import Robot

__all__ = ["soften_castors"]

TRAVEL = 0.08
"""Deflection of the springs if the castors carried the whole weight, relative to the largest distance of a castor from
the middle of the robot (assumed)."""
DAMPING = 0.7
"""Damping ratio of the springs (assumed)."""
HALF = (0.5, 0.5, 0.001, 0.5, 2.0)
"""Impedance of one half: the force then is twice stiffness over inverse weight."""
GRAVITY = 9.81
NEAR = 0.05
"""Least distance [m] of a castor from the middle for this."""


def soften_castors(model: Any, robots: Mapping[str, Robot]) -> None:
    """Give the frictionless contacts of robots with wheels the stiffness of springs.

    Springs at the end at which the centre of mass lies are longer by what its weight compresses them, so that the robot
    is level on a level floor.

    Args:
        model: model of the engine, which is changed.
        robots: robots by the prefix of their names.
    """
    data = engine().MjData(model)
    engine().mj_kinematics(model, data)
    engine().mj_comPos(model, data)
    names = [model.geom(g).name for g in range(model.ngeom)]
    gliding = (model.geom_condim == 1) & (model.geom_priority == 1)
    for prefix, robot in robots.items():
        own = [g for g in np.flatnonzero(gliding).tolist() if names[g].startswith(prefix)]
        if robot.base != "wheels" or not own:
            continue
        mass = robot.model.mass / len(own)
        far = float(np.hypot(model.geom_pos[own, 0], model.geom_pos[own, 1]).max())
        stiffness = mass * GRAVITY / (TRAVEL * max(far, NEAR))
        damping = 2.0 * DAMPING * math.sqrt(stiffness * mass)
        for geom in own:
            light = float(model.body_invweight0[model.geom_bodyid[geom], 0])
            model.geom_solref[geom] = -0.5 * stiffness * light, -0.5 * damping * light
            model.geom_solimp[geom] = HALF
        _level(model, data, robot, int(model.body(prefix + robot.model.root).id), own, stiffness)


def _level(model: Any, data: Any, robot: Robot, root: int, castors: Sequence[int], stiffness: float) -> None:
    """Lower the castors that carry weight by the deflection of their springs."""
    poses = robot.model.poses(robot.posture)
    joints = [robot.model.joints[wheel.joint] for wheel in robot.wheels if wheel.driven]
    axle = float(np.mean([(poses[joint.parent] @ joint.origin)[0, 3] for joint in joints]))
    turn = data.xmat[root].reshape(3, 3)
    ahead = float((turn.T @ (data.subtree_com[root] - data.xpos[root]))[0]) - axle
    side = [g for g in castors if model.geom_bodyid[g] == root and (model.geom_pos[g, 0] - axle) * ahead > 0.0]
    if not side:
        return
    lever = float(np.mean(np.abs(model.geom_pos[side, 0] - axle)))
    load = robot.model.mass * GRAVITY * min(1.0, abs(ahead) / lever) / len(side)
    model.geom_pos[side, 2] -= load / stiffness
