"""Springs of castors on uneven ground.

A robot with two wheels and castors at both ends of one rigid body would hang between its castors where a ramp begins,
and its wheels would spin in the air. Real robots have springs at wheels or castors. On stages with uneven ground the
contacts of castors are as soft as springs; on level stages they stay as they are, unless there are more balls and
swivel castors than driven wheels, at both ends: rigid ones would take most of the weight off the wheels, which then
slip in curves. Castor wheels that a file fixes to the base without any joint stay rigid on level stages.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from crowdbot.typing import Floats
from crowdbot.world.physics.engine import engine
from crowdbot.world.robots.robot import Robot

TRAVEL = 0.08
"""Deflection of the springs if the castors carried the whole weight, relative to the largest distance of a castor from
the middle of the robot (assumed)."""
FIRM_TRAVEL = 0.02
"""The same on level stages."""
DAMPING = 0.7
"""Damping ratio of the springs (assumed)."""
HALF = (0.5, 0.5, 0.001, 0.5, 2.0)
"""Impedance of one half: the force then is twice stiffness over inverse weight."""
GRAVITY = 9.81
NEAR = 0.05
"""Least distance [m] of a castor from the middle for this."""


def rests_on_castors(model: Any, prefix: str, robot: Robot) -> bool:
    """Return whether a robot has more castors than driven wheels, ahead of and behind their axle.

    All are balls, or turn about joints of their own, as swivel castors do.

    Args:
        model: model of the engine.
        prefix: prefix of the names of the robot.
        robot: the robot.
    """
    own = _castors(model, prefix)
    wheels = [robot.model.joints[wheel.joint] for wheel in robot.wheels if wheel.driven]
    root = int(model.body(prefix + robot.model.root).id)
    turning = model.geom_bodyid[own] != root
    usual = bool((turning | (model.geom_type[own] == engine().mjtGeom.mjGEOM_SPHERE)).all())
    count = len({-geom if body == root else int(body) for geom, body in zip(own, model.geom_bodyid[own], strict=True)})
    if robot.base != "wheels" or count <= len(wheels) or not usual:
        return False
    poses = robot.model.poses(robot.posture)
    axle = float(np.mean([(poses[joint.parent] @ joint.origin)[0, 3] for joint in wheels]))
    data = engine().MjData(model)
    engine().mj_kinematics(model, data)
    places = (data.geom_xpos[own] - data.xpos[root]) @ data.xmat[root].reshape(3, 3)[:, 0] - axle
    return bool(places.min() < -NEAR and places.max() > NEAR)


def _castors(model: Any, prefix: str) -> list[int]:
    """Return the frictionless geoms of a robot."""
    gliding = np.flatnonzero((model.geom_condim == 1) & (model.geom_priority == 1)).tolist()
    return [geom for geom in gliding if model.geom(geom).name.startswith(prefix)]


def soften_castors(model: Any, robots: Mapping[str, Robot], travel: float = TRAVEL) -> None:
    """Give the frictionless contacts of robots with wheels the stiffness of springs.

    Springs at the end at which the centre of mass lies are longer by what its weight compresses them, so that the robot
    is level on a level floor.

    Args:
        model: model of the engine, which is changed.
        robots: robots by the prefix of their names.
        travel: deflection if the castors carried the whole weight, see :data:`TRAVEL`.
    """
    data = engine().MjData(model)
    engine().mj_kinematics(model, data)
    engine().mj_comPos(model, data)
    for prefix, robot in robots.items():
        own = _castors(model, prefix)
        if robot.base != "wheels" or not own:
            continue
        mass = robot.model.mass / len(own)
        root = int(model.body(prefix + robot.model.root).id)
        places = _places(model, data, root, own)
        far = float(np.hypot(places[:, 0], places[:, 1]).max())
        stiffness = mass * GRAVITY / (travel * max(far, NEAR))
        damping = 2.0 * DAMPING * math.sqrt(stiffness * mass)
        for geom in own:
            light = float(model.body_invweight0[model.geom_bodyid[geom], 0])
            model.geom_solref[geom] = -0.5 * stiffness * light, -0.5 * damping * light
            model.geom_solimp[geom] = HALF
        _level(model, data, robot, root, own, places[:, 0], stiffness)


def _places(model: Any, data: Any, root: int, castors: Sequence[int]) -> Floats:
    """Return the places ``[C, 3]`` [m] of castors in the frame of the root link."""
    places = np.array(model.geom_pos[castors])
    turning = model.geom_bodyid[castors] != root
    away = data.geom_xpos[castors][turning] - data.xpos[root]
    places[turning] = away @ data.xmat[root].reshape(3, 3)
    return places


def _level(
    model: Any, data: Any, robot: Robot, root: int, castors: Sequence[int], places: Floats, stiffness: float
) -> None:
    """Lower the castors that carry weight by the deflection of their springs.

    Castors that turn keep their places: their contacts begin this distance above the floor.
    """
    poses = robot.model.poses(robot.posture)
    joints = [robot.model.joints[wheel.joint] for wheel in robot.wheels if wheel.driven]
    axle = float(np.mean([(poses[joint.parent] @ joint.origin)[0, 3] for joint in joints]))
    turn = data.xmat[root].reshape(3, 3)
    ahead = float((turn.T @ (data.subtree_com[root] - data.xpos[root]))[0]) - axle
    side = np.flatnonzero((places - axle) * ahead > 0.0)
    if not len(side):
        return
    lever = float(np.mean(np.abs(places[side] - axle)))
    load = robot.model.mass * GRAVITY * min(1.0, abs(ahead) / lever) / len(side)
    for geom in np.array(castors)[side].tolist():
        if model.geom_bodyid[geom] == root:
            model.geom_pos[geom, 2] -= load / stiffness
        else:
            model.geom_margin[geom] = load / stiffness
