"""Friction of wheels on the floor with a direction: sliding tyres of skid-steer bases, and wheels with rollers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.typing import Floats, Ints
from crowdbot.world.physics.engine import engine
from crowdbot.world.physics.robots.wheel_servo import lag
from crowdbot.world.robots.drives.skid_slide import GRAVITY
from crowdbot.world.robots.drives.skid_steer import SkidSteerDrive
from crowdbot.world.robots.robot import Robot
from crowdbot.world.robots.wheel import fastest

SOFT = 0.005
"""Slip [m/s] below which the friction of a sliding tyre is proportional to its slip."""
ROUNDS = 25
"""Largest number of Newton steps, and of halvings of one."""
CLOSE = 1e-9
"""Change of velocities [m/s], [rad/s] at which the steps end."""
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
def _slips(
    geom: NDArray[np.int32], place: Floats, frame: Floats, friction: Floats, wheel_of: Ints, body: Ints, root: Ints,
    axle: Floats, anchor: Floats, speed: Floats, center: Floats, gain: Floats, loads: Floats, slips: Floats,
) -> int:  # fmt: skip
    """Write the contacts of sliding tyres into ``slips`` ``[C, 12]``; return their number.

    A row has slip ``[3]`` [m/s] of the tyre with the speed of its motor after the step, normal ``[3]``, place ``[3]``
    from the centre of mass [m], largest friction [N], wheel, and contact.
    """
    found, count = 0, np.zeros(len(body))
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
        ax, ay, az = gain[w] * axle[w, 0], gain[w] * axle[w, 1], gain[w] * axle[w, 2]
        dx, dy, dz = place[c, 0] - anchor[w, 0], place[c, 1] - anchor[w, 1], place[c, 2] - anchor[w, 2]
        tx, ty, tz = tx + ay * dz - az * dy, ty + az * dx - ax * dz, tz + ax * dy - ay * dx
        along = tx * nx + ty * ny + tz * nz
        row = slips[found]
        row[0], row[1], row[2] = tx - along * nx, ty - along * ny, tz - along * nz
        up = 1.0 if nz > 0.0 else -1.0
        row[3], row[4], row[5], row[6], row[7], row[8] = up * nx, up * ny, up * nz, px, py, pz
        row[9], row[10], row[11] = friction[c, 0] * loads[w] / count[w], w, c
        found += 1
    return found


@kernel
def _rows(slips: Floats, rows: Floats) -> None:
    """Write for each contact ``[C, 3, 3]`` the slip by a motion of the base along two axes of the floor, and a turn."""
    nx, ny, nz = slips[:, 3].mean(), slips[:, 4].mean(), slips[:, 5].mean()
    size = math.sqrt(nx * nx + ny * ny + nz * nz)
    nx, ny, nz = nx / size, ny / size, nz / size
    size = math.sqrt(nz * nz + nx * nx)
    ex, ez = nz / size, -nx / size
    for c in range(len(slips)):
        px, py, pz = slips[c, 6], slips[c, 7], slips[c, 8]
        rows[c, 0, 0], rows[c, 1, 0], rows[c, 2, 0] = ex, 0.0, ez
        rows[c, 0, 1], rows[c, 1, 1], rows[c, 2, 1] = ny * ez, nz * ex - nx * ez, -ny * ex
        rows[c, 0, 2], rows[c, 1, 2], rows[c, 2, 2] = ny * pz - nz * py, nz * px - nx * pz, nx * py - ny * px
        for k in range(3):
            along = rows[c, 0, k] * slips[c, 3] + rows[c, 1, k] * slips[c, 4] + rows[c, 2, k] * slips[c, 5]
            for i in range(3):
                rows[c, i, k] -= along * slips[c, 3 + i]


@kernel
def _cost(slips: Floats, rows: Floats, heft: Floats, pull: Floats, change: Floats) -> float:
    """Return the function whose minimum is the change of the velocity of the base in a step."""
    total = 0.0
    for k in range(3):
        total += change[k] * (0.5 * heft[k] * change[k] - pull[k])
    for c in range(len(slips)):
        size = SOFT * SOFT
        for i in range(3):
            q = slips[c, i]
            for k in range(3):
                q += rows[c, i, k] * change[k]
            size += q * q
        total += slips[c, 9] * math.sqrt(size)
    return total


@kernel
def _settle(slips: Floats, rows: Floats, heft: Floats, pull: Floats, force: Floats) -> None:
    """Write the friction ``[C, 3]`` [N] of tyres at the end of a step, by Newton's method.

    Args:
        slips: see :func:`_slips`.
        rows: see :func:`_rows`.
        heft: mass, mass [kg] and moment of inertia [kg m2] of the robot by the time step [s].
        pull: other forces ``[2]`` [N] and torque [N m] on it.
        force: the result.
    """
    change, trial = np.zeros(3), np.zeros(3)
    gradient, matrix = np.empty(3), np.empty((3, 3))
    cost = _cost(slips, rows, heft, pull, change)
    for _ in range(ROUNDS):
        matrix[:] = 0.0
        for k in range(3):
            gradient[k], matrix[k, k] = heft[k] * change[k] - pull[k], heft[k]
        for c in range(len(slips)):
            q = slips[c, :3] + rows[c] @ change
            size = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + SOFT * SOFT)
            for k in range(3):
                along = (rows[c, 0, k] * q[0] + rows[c, 1, k] * q[1] + rows[c, 2, k] * q[2]) / size
                gradient[k] += slips[c, 9] * along
                for m in range(3):
                    other = (rows[c, 0, m] * q[0] + rows[c, 1, m] * q[1] + rows[c, 2, m] * q[2]) / size
                    dot = rows[c, 0, k] * rows[c, 0, m] + rows[c, 1, k] * rows[c, 1, m] + rows[c, 2, k] * rows[c, 2, m]
                    matrix[k, m] += slips[c, 9] * (dot - along * other) / size
        step = np.linalg.solve(matrix, gradient)
        part = 1.0
        slope = step[0] * gradient[0] + step[1] * gradient[1] + step[2] * gradient[2]
        for _ in range(ROUNDS):
            trial[:] = change - part * step
            found = _cost(slips, rows, heft, pull, trial)
            if found <= cost - 0.1 * part * slope:
                break
            part *= 0.5
        change[:], cost = trial, found
        if abs(part * step[0]) + abs(part * step[1]) + abs(part * step[2]) < CLOSE:
            break
    for c in range(len(slips)):
        q = slips[c, :3] + rows[c] @ change
        size = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + SOFT * SOFT)
        force[c] = -slips[c, 9] * q / size


@kernel
def _push(slips: Floats, place: Floats, friction: Floats, found: Floats, force: Floats, point: Floats) -> None:
    """Write force and point of application ``[W, 3]`` of the tyres, and take friction out of the engine."""
    count = np.zeros(len(force))
    force[:], point[:] = 0.0, 0.0
    for c in range(len(slips)):
        w, contact = int(slips[c, 10]), int(slips[c, 11])
        count[w] += 1.0
        for k in range(3):
            force[w, k] += found[c, k]
            point[w, k] += (place[contact, k] - point[w, k]) / count[w]
        friction[contact, 0], friction[contact, 1] = LEAST * friction[contact, 0], LEAST * friction[contact, 1]


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
      direction by all forces of a step, so that a light driven wheel is held sideways and hardly along. Tyres instead
      get the force of Coulomb's law: friction coefficient times the load of the step before, against the slip;
      proportional to slips below :data:`SOFT`. The slip is that at the end of the step (implicit Euler): forces that
      turn with the slip of its beginning make robots with a small moment of inertia vibrate. It is found for the robot
      as one rigid body with the commanded speeds of its motors; contacts with others are not part of it.
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
        names = [prefix + wheel.joint for wheel in wheels]
        self.dof = np.asarray(model.jnt_dofadr[self.joint], dtype=np.int64)
        self.motor = np.array([model.actuator(name).id for name in names], dtype=np.int64)
        joints = robot.model.joints
        self._fastest = np.array(
            [fastest(joints[wheel.joint], joints[wheel.joint].motor.effort or math.inf) for wheel in wheels]
        )
        whole, step = robot.model.inertial(robot.posture), float(model.opt.timestep)
        self._mass, self._share = whole.mass, step / lag(step)
        self._heft = np.array([whole.mass, whole.mass, float(whole.tensor[2, 2])]) / step
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
            changed = self._skid(data, loads)
        else:
            changed = _roll(
                contact.geom, contact.frame, contact.friction, self.wheel_of, self.rollers, self.joint, data.xaxis
            )
        if changed:
            mj.mj_makeConstraint(model, data)
            mj.mj_projectConstraint(model, data)
            mj.mj_referenceConstraint(model, data)

    def _skid(self, data: Any, loads: Floats) -> int:
        """Apply the friction of sliding tyres; return the number of their contacts."""
        contact = data.contact
        slips, force = np.empty((len(contact.geom), 12)), np.zeros((len(self), 3))
        reached = np.clip(data.ctrl[self.motor], -self._fastest, self._fastest)
        gain = self._share * (reached - data.qvel[self.dof])
        count = _slips(
            contact.geom, contact.pos, contact.frame, contact.friction, self.wheel_of, self.body, self.root,
            data.xaxis[self.joint], data.xanchor[self.joint], data.cvel, data.subtree_com, gain, loads, slips,
        )  # fmt: skip
        slips, point = slips[:count], np.zeros((len(self), 3))
        if count:
            rows, found = np.empty((count, 3, 3)), np.empty((count, 3))
            _rows(slips, rows)
            down = rows[0, 2] * (1.0, 1.0, 0.0)
            _settle(slips, rows, self._heft, -GRAVITY * self._mass * down, found)
            _push(slips, contact.pos, contact.friction, found, force, point)
        data.xfrc_applied[self.body, :3] = force
        data.xfrc_applied[self.body, 3:] = np.cross(point - data.xipos[self.body], force)
        return count

    def loads(self, data: Any) -> Floats:
        """Return the normal forces ``[W]`` [N] of the wheels in the last step."""
        result = np.zeros(len(self))
        _weigh(data.contact.geom, data.contact.efc_address, data.efc_force, self.wheel_of, result)
        return result

    def smooth_loads(self, before: Floats, data: Any, step: float) -> Floats:
        """Return the loads ``[W]`` [N] of the wheels, smoothed over :data:`SETTLE`.

        Four wheels on a rigid frame are statically overdetermined: between two engine steps, their loads may jump from
        one diagonal to the other, and with them the friction of sliding tyres.

        Args:
            before: loads ``[W]`` [N] after the step before; all 0 at the start.
            data: data of the engine.
            step: time step of the engine [s].
        """
        loads = self.loads(data)
        if not self.skids or not before.any():
            return loads
        return np.asarray(before - math.expm1(-step / SETTLE) * (loads - before))
