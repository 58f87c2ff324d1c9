"""Friction of wheels on the floor with a direction: sliding tyres of skid-steer bases, and wheels with rollers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.world.physics.engine import engine
from crowdbot.world.robots.drives.skid_steer import SkidSteerDrive
from crowdbot.world.robots.robot import Robot

__all__ = ["WheelFriction"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STICKS, SLIDES = 0.01, 0.06
"""Slip speeds [m/s]: below the first, the engine holds a tyre; above the second, it slides."""
FREE = 0.01
"""Friction across the axes of rollers, as a share of the friction along them: the resistance of their bearings."""
LEAST = 0.001
"""Smallest share of the friction of the engine; it needs one above 0."""
SETTLE = 0.1
"""Time constant [s] of the loads of sliding tyres: pneumatic tyres and a yielding frame level out hops."""
FLAT = 0.7
"""Smallest vertical part of a contact normal of a wheel on the ground."""


@kernel
def _roll(
    geom: NDArray[np.int32], frame: Floats, friction: Floats, wheel_of: Ints, rollers: Floats, joint: Ints,
    axle: Floats,
) -> int:  # fmt: skip
    """Turn the tangents of contacts of wheels with rollers to the axes of the rollers; return their number."""
    found = 0
    for c in range(len(geom)):
        w = max(wheel_of[geom[c, 0]], wheel_of[geom[c, 1]])
        nx, ny, nz = frame[c, 0], frame[c, 1], frame[c, 2]
        if w < 0 or abs(nz) < FLAT or np.isnan(rollers[w]):
            continue
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
        friction[c, 1] = FREE * friction[c, 0]
        found += 1
    return found


@kernel
def _slide(
    geom: NDArray[np.int32], place: Floats, frame: Floats, friction: Floats, wheel_of: Ints, body: Ints, root: Ints,
    speed: Floats, center: Floats, loads: Floats, force: Floats, point: Floats,
) -> int:  # fmt: skip
    """Write force and point of application ``[W, 3]`` of the friction of sliding tyres; return their contacts."""
    found, count = 0, np.zeros(len(body))
    force[:], point[:] = 0.0, 0.0
    for c in range(len(geom)):
        w = max(wheel_of[geom[c, 0]], wheel_of[geom[c, 1]])
        if w >= 0 and abs(frame[c, 2]) >= FLAT:
            count[w] += 1.0
    for c in range(len(geom)):
        w = max(wheel_of[geom[c, 0]], wheel_of[geom[c, 1]])
        nx, ny, nz = frame[c, 0], frame[c, 1], frame[c, 2]
        if w < 0 or abs(nz) < FLAT:
            continue
        b, r = body[w], root[w]
        px, py, pz = place[c, 0] - center[r, 0], place[c, 1] - center[r, 1], place[c, 2] - center[r, 2]
        tx = speed[b, 3] + speed[b, 1] * pz - speed[b, 2] * py
        ty = speed[b, 4] + speed[b, 2] * px - speed[b, 0] * pz
        tz = speed[b, 5] + speed[b, 0] * py - speed[b, 1] * px
        along = tx * nx + ty * ny + tz * nz
        tx, ty, tz = tx - along * nx, ty - along * ny, tz - along * nz
        size = math.sqrt(tx * tx + ty * ty + tz * tz)
        share = min(1.0, max(0.0, (size - STICKS) / (SLIDES - STICKS)))
        for k in range(3):
            point[w, k] += place[c, k] / count[w]
        if share > 0.0:
            push = share * friction[c, 0] * loads[w] / (count[w] * size)
            force[w, 0] -= push * tx
            force[w, 1] -= push * ty
            force[w, 2] -= push * tz
            rest = max(LEAST, 1.0 - share)
            friction[c, 0], friction[c, 1] = rest * friction[c, 0], rest * friction[c, 1]
            found += 1
    return found


@kernel
def _weigh(geom: NDArray[np.int32], address: NDArray[np.int32], force: Floats, wheel_of: Ints, loads: Floats) -> None:
    """Write the normal forces of wheels ``[W]`` [N]."""
    loads[:] = 0.0
    for c in range(len(geom)):
        w = max(wheel_of[geom[c, 0]], wheel_of[geom[c, 1]])
        if w >= 0 and address[c] >= 0:
            loads[w] += force[address[c]]


class WheelFriction:
    """Wheels of a robot whose friction has a direction.

    * **Sliding tyres** of a :class:`SkidSteerDrive`. The friction of the engine lifts a sliding wheel, and chooses its
      direction by all forces of a step, so that a light driven wheel is held sideways and hardly along. A tyre that
      slides faster than ``SLIDES`` instead gets the force of Coulomb's law: friction coefficient times the load of the
      step before, against the slip. Below ``STICKS`` the engine holds it; between them, both take a share.
    * **Rollers.** A wheel with rollers has its full friction along their axes, and the share ``FREE`` across them.
      Single rollers are not simulated, so there is no vibration.

    Args:
        model: model of the engine.
        robot: description of the robot.
        prefix: prefix of its names in the engine.
    """

    def __init__(self, model: Any, robot: Robot, prefix: str) -> None:
        self.skids = isinstance(robot.drive, SkidSteerDrive) and robot.base == "wheels"
        rolls = [wheel.rollers is not None for wheel in robot.wheels]
        wheels = [
            wheel for wheel, roll in zip(robot.wheels, rolls, strict=True) if robot.base == "wheels"
            and wheel.driven and (self.skids or roll)
        ]  # fmt: skip
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

    def apply(self, model: Any, data: Any, loads: Floats) -> None:
        """Set the friction between the two halves of an engine step, and compute the constraints with it.

        Args:
            model, data: model and data of the engine.
            loads: normal forces ``[W]`` [N] of the wheels in the step before.
        """
        mj, contact = engine(), data.contact
        changed = 0
        if self.skids:
            force, point = np.empty((len(self), 3)), np.empty((len(self), 3))
            changed = _slide(
                contact.geom, contact.pos, contact.frame, contact.friction, self.wheel_of, self.body, self.root,
                data.cvel, data.subtree_com, loads, force, point,
            )  # fmt: skip
            data.xfrc_applied[self.body, :3] = force
            data.xfrc_applied[self.body, 3:] = np.cross(point - data.xipos[self.body], force)
        else:
            changed = _roll(
                contact.geom, contact.frame, contact.friction, self.wheel_of, self.rollers, self.joint, data.xaxis
            )
        if changed:
            mj.mj_makeConstraint(model, data)
            mj.mj_projectConstraint(model, data)
            mj.mj_referenceConstraint(model, data)

    def loads(self, data: Any) -> Floats:
        """Return the normal forces ``[W]`` [N] of the wheels in the last step."""
        found = np.zeros(len(self))
        _weigh(data.contact.geom, data.contact.efc_address, data.efc_force, self.wheel_of, found)
        return found

    def smooth_loads(self, before: Floats, data: Any, step: float) -> Floats:
        """Return the loads ``[W]`` [N] of the wheels, smoothed over :data:`SETTLE`.

        Four wheels on a rigid frame are statically overdetermined: between two engine steps, their loads may jump from
        one diagonal to the other, and with them the friction of sliding tyres.

        Args:
            before: loads ``[W]`` [N] after the step before; all 0 at the start.
            data: data of the engine.
            step: time step of the engine [s].
        """
        found = self.loads(data)
        if not self.skids or not before.any():
            return found
        return np.asarray(before - math.expm1(-step / SETTLE) * (found - before))
