"""Friction of wheels on the floor with a direction: sliding tyres of skid-steer bases, and wheels with rollers."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.world.physics.engine import engine
from crowdbot.world.robots.robot import Robot
from crowdbot.world.robots.skid_steer import SkidSteerDrive

__all__ = ["WheelFriction", "orient_friction"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CREEP = 0.02
"""Slip speed [m/s] from which a tyre slides."""
ACROSS = 0.2
"""Friction of a sliding tyre across its slip, as a share of the friction along it."""
FREE = 0.01
"""Friction across the axes of rollers, as a share of the friction along them: the resistance of their bearings."""
FLAT = 0.7
"""Smallest vertical part of a contact normal of a wheel on the ground."""


@kernel
def _orient(
    geom: NDArray[np.int32], place: Floats, frame: Floats, friction: Floats, wheel_of: Ints, rollers: Floats,
    joint: Ints, axle: Floats, body: Ints, root: Ints, speed: Floats, center: Floats,
) -> int:  # fmt: skip
    """Turn the tangents of contacts of wheels, set their friction, and return their number."""
    found = 0
    for c in range(len(geom)):
        w = max(wheel_of[geom[c, 0]], wheel_of[geom[c, 1]])
        nx, ny, nz = frame[c, 0], frame[c, 1], frame[c, 2]
        if w < 0 or abs(nz) < FLAT:
            continue
        if np.isnan(rollers[w]):
            b, r = body[w], root[w]
            px, py, pz = place[c, 0] - center[r, 0], place[c, 1] - center[r, 1], place[c, 2] - center[r, 2]
            tx = speed[b, 3] + speed[b, 1] * pz - speed[b, 2] * py
            ty = speed[b, 4] + speed[b, 2] * px - speed[b, 0] * pz
            tz = speed[b, 5] + speed[b, 0] * py - speed[b, 1] * px
        else:
            up = 1.0 if nz > 0.0 else -1.0
            ax, ay, az = axle[joint[w], 0], axle[joint[w], 1], axle[joint[w], 2]
            cos, sin = math.cos(rollers[w]), math.sin(rollers[w])
            tx = cos * up * (ay * nz - az * ny) + sin * ax
            ty = cos * up * (az * nx - ax * nz) + sin * ay
            tz = cos * up * (ax * ny - ay * nx) + sin * az
        along = tx * nx + ty * ny + tz * nz
        tx, ty, tz = tx - along * nx, ty - along * ny, tz - along * nz
        size = math.sqrt(tx * tx + ty * ty + tz * tz)
        if size < 1e-9:
            continue
        tx, ty, tz = tx / size, ty / size, tz / size
        frame[c, 3], frame[c, 4], frame[c, 5] = tx, ty, tz
        frame[c, 6], frame[c, 7], frame[c, 8] = ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
        share = min(1.0, max(ACROSS, CREEP / size)) if np.isnan(rollers[w]) else FREE
        friction[c, 1] = share * friction[c, 0]
        found += 1
    return found


class WheelFriction:
    """Wheels of a robot whose friction has a direction.

    * **Sliding tyres.** The engine chooses the direction of a friction force by all forces of a step, so that the
      friction of a light driven wheel acts sideways and hardly along. A tyre of a :class:`SkidSteerDrive` that slides
      faster than ``CREEP`` gets its full friction against the slip and the share ``ACROSS`` across it: Coulomb's law.
    * **Rollers.** A wheel with rollers has its full friction along their axes, and the share ``FREE`` across them.
      Single rollers are not simulated, so there is no vibration.

    Args:
        model: model of the engine.
        robot: description of the robot.
        prefix: prefix of its names in the engine.
    """

    def __init__(self, model: Any, robot: Robot, prefix: str) -> None:
        skids = isinstance(robot.drive, SkidSteerDrive) and robot.base == "wheels"
        wheels = [wheel for wheel in robot.wheels if robot.base == "wheels" and (skids or wheel.rollers is not None)]
        self.joint = np.array([model.joint(prefix + wheel.joint).id for wheel in wheels], dtype=np.int64)
        self.rollers = np.array([math.nan if wheel.rollers is None else wheel.rollers for wheel in wheels])
        self.body = np.asarray(model.jnt_bodyid[self.joint], dtype=np.int64)
        self.root = np.asarray(model.body_rootid[self.body], dtype=np.int64)
        self.wheel_of = np.full(model.ngeom, -1, dtype=np.int64)
        for number, body in enumerate(self.body.tolist()):
            self.wheel_of[model.geom_bodyid == body] = number

    def __len__(self) -> int:
        """Return the number of wheels whose friction has a direction."""
        return len(self.joint)

    def orient(self, data: Any) -> int:
        """Set the friction of the contacts of a step, and return their number."""
        contact = data.contact
        return int(
            _orient(
                contact.geom, contact.pos, contact.frame, contact.friction, self.wheel_of, self.rollers, self.joint,
                data.xaxis, self.body, self.root, data.cvel, data.subtree_com,
            )
        )  # fmt: skip


def orient_friction(frictions: Iterable[WheelFriction], model: Any, data: Any) -> None:
    """Set the friction of wheels between the two halves of an engine step, and compute the constraints anew."""
    wheels = [friction for friction in frictions if len(friction)]
    if wheels and data.ncon and sum([friction.orient(data) for friction in wheels]):
        mj = engine()
        mj.mj_makeConstraint(model, data)
        mj.mj_projectConstraint(model, data)
        mj.mj_referenceConstraint(model, data)
