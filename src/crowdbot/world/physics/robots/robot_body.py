"""Body of a robot in the engine: motor commands, pose and twist."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import InputError, Pose, SpatialPose, Storage, Twist, did_you_mean
from crowdbot.typing import Floats
from crowdbot.world.physics.engine import engine
from crowdbot.world.physics.wheels.friction import WheelFriction
from crowdbot.world.robots.drives.ackermann import AckermannDrive, SteeredTwists, TricycleDrive
from crowdbot.world.robots.drives.drive import Twists
from crowdbot.world.robots.drives.servo import CommandDelay, Pending
from crowdbot.world.robots.drives.skid_slide import GRAVITY, rims_of
from crowdbot.world.robots.drives.skid_steer import SkidSteerDrive
from crowdbot.world.robots.robot import Robot, spatial

from .base_servo import BASE_MOTORS, BaseForces
from .wheel_servo import lag

RATE = 3.0
"""Rate [1/s] of the estimate of the slip."""
RETURN = 0.025
"""Time [s] in which an error of the twist is corrected where the tyres slide."""
GAIN = 2.0
"""Largest correction of the wheels by an error of the twist."""
LEAST = 0.06
"""Slip [m/s] that the wheels may have beyond ``MOST`` times that of a steady turn."""
QUIET = 0.1
"""Turn rate [rad/s] below which slip is hardly estimated."""
MOST = 2.5
"""Maximum of the estimated factor, and of its inverse."""

SlipState = tuple[float, float, float, float]
"""Factor of the difference of the sides, offset [m] of the centre of turning, and forward speed [m/s] and turn rate
[rad/s] expected by now."""


@dataclass(frozen=True)
class SlipControl:
    """Wheel speeds of a skid-steer base from its own velocity, as a controller with a gyro and odometry sets them.

    The sides of the base turn about their instantaneous centres of rotation, which depend on friction and loads. The
    control estimates them while the base turns: the slip factor ``k`` (effective track divided by track) and the offset
    ``c`` of their middle, both relative to the balance of forces of :meth:`SkidSteerDrive.slide`. For a command
    ``(v, w)``, the sides get the speeds of that balance with ``k`` times their difference, and ``c w`` added to both.
    Both are corrected by the error of the twist, by a least-mean-squares step with the rate ``RATE``. The factor begins
    with 1 and stays within ``1 / MOST`` and ``MOST``. The velocity is that of the engine, without noise.

    Source: A. Mandow et al., Experimental kinematics for wheeled skid-steer mobile robots, IROS 2007; J. Pentzer et
    al., Model-based prediction of skid-steer robot kinematics using online estimation of track instantaneous centers of
    rotation, Journal of Field Robotics 31(3), 2014.

    Fields:
        drive: the drive.
        tires: ``[W, 5]`` places and levers of the driven wheels, see :func:`rims_of`.
        gyration: squared radius of gyration about the vertical [m2].
        weight: weight of the robot [N].
    """

    drive: SkidSteerDrive
    tires: Floats
    gyration: float
    weight: float

    @classmethod
    def of(cls, robot: Robot) -> SlipControl | None:
        """Return the control of a robot, None for one that does not skid."""
        drive = robot.drive
        if robot.base != "wheels" or not isinstance(drive, SkidSteerDrive):
            return None
        whole, poses = robot.model.inertial(robot.posture), robot.model.poses(robot.posture)
        joints = [robot.model.joints[wheel.joint] for wheel in robot.wheels if wheel.driven]
        places = np.array([(poses[joint.parent] @ joint.origin)[:2, 3] for joint in joints])
        middle, count = np.array([drive.wheels_x, 0.0]), len(places)
        tires = np.concatenate([places - middle, np.full((count, 1), 1.0 / count), places - whole.center[:2]], axis=1)
        return cls(drive, tires, float(whole.tensor[2, 2]) / whole.mass, GRAVITY * whole.mass)

    @property
    def first(self) -> SlipState:
        """State before the first step."""
        return (1.0, 0.0, 0.0, 0.0)

    def step(self, state: SlipState, wanted: Twist, found: Twist, dt: float) -> SlipState:
        """Return the new state.

        Args:
            state: state before the step.
            wanted: twist that the base is to have.
            found: its twist.
            dt: time step [s].
        """
        factor, offset, forward, turn = state
        gain = -math.expm1(-dt / lag(dt))
        forward, turn = forward + gain * (wanted.forward - forward), turn + gain * (wanted.turn - turn)
        share = RATE * dt * turn / (turn * turn + QUIET * QUIET)
        factor += factor * share * (turn - found.turn)
        offset += share * (forward - found.forward)
        factor, most = min(max(factor, 1.0 / MOST), MOST), self.drive.track
        offset = min(max(offset, -most), most)
        return (factor, offset, forward, turn)

    def wheels(self, state: SlipState, old: Twist, new: Twist, found: Twist, loads: Floats, dt: float) -> Twist:
        """Return the twist for which the wheels turn without slip, so that the base has another one with it.

        Args:
            state: the estimate.
            old, new: twists that the base is to have before and after the step.
            found: its twist.
            loads: normal forces ``[W]`` [N] of the driven wheels; all 0 before the first step.
            dt: time step [s].
        """
        factor, offset, forward, turn = state
        drive, tires = self.drive, self.tires
        if loads.any():
            tires = tires.copy()
            tires[:, 2] = loads / self.weight
        grip = drive.friction * GRAVITY
        half = 0.5 * drive.track * drive.slip_factor * new.turn
        most = MOST * (abs(half) + LEAST)
        out = np.array([new.forward - half, new.forward + half])
        now = np.array([new.forward, new.turn, found.left + found.turn * drive.wheels_x])
        change = np.array([(new.forward - old.forward) / dt, (new.turn - old.turn) / dt])
        rims_of(now, change, tires, grip, self.gyration, most, out)
        slip = abs(half - 0.5 * drive.track * new.turn) + 0.5 * drive.wheelbase * abs(new.turn)
        gain = min(slip / (grip * RETURN), GAIN)
        middle = 0.5 * (out[0] + out[1]) + offset * new.turn + gain * (forward - found.forward)
        push = gain * drive.slip_factor * (turn - found.turn)
        return Twist(float(middle), float(factor * (out[1] - out[0]) / drive.track + push))


STILL = Twist()


class RobotBody:
    """A robot in the engine.

    Args:
        model, data: model and data of the engine.
        robot: description of the robot.
        prefix: prefix of its names in the engine.
        step: time step of the engine [s].

    Attributes:
        robot: description of the robot.
        body: index of the root link in the engine.
        friction: wheels whose friction has a direction.
        loads: normal forces [N] of these wheels in the last engine step.
    """

    storage = Storage(
        constants=(
            "robot", "prefix", "step", "_model", "_data", "_mj", "body", "_sites", "_servo", "_wheels", "_steers",
            "_step_robots", "_rolling", "_delay", "_slip", "friction", "_forces", "_lag", "_base", "_rows",
        ),
    )  # fmt: skip

    def __init__(self, model: Any, data: Any, robot: Robot, prefix: str, step: float) -> None:
        self.robot, self.prefix, self.step = robot, prefix, step
        self._mj = engine()
        self.bind(model, data)
        units = [robot.wheel_speeds(Twist(*row)) for row in np.eye(3).tolist()]
        self._step_robots = [joint for joint in units[0] if joint in self._wheels]
        self._rolling = np.array([[unit[joint] for unit in units] for joint in self._step_robots]).reshape(-1, 3)
        self._steers = any(wheel.steering for wheel in robot.wheels)
        self.loads = np.zeros(len(self.friction))
        self._slip = SlipControl.of(robot)
        self._slip_state: SlipState | None = self._slip.first if self._slip else None
        self._delay = CommandDelay(robot.latency)
        self._pending: tuple[Pending, ...] = ()
        self._current: Twist | Twists = STILL
        self._asked: Twist | Twists = STILL
        self._forced: Twist | Twists | None = None
        self._aim = Twists.of(STILL, 1)
        self._held: dict[str, float] = {}
        self._forces = BaseForces(robot, step)
        self._quick: tuple[float, float, float] | tuple[()] = ()
        self._lag = lag(step)

    def bind(self, model: Any, data: Any) -> None:
        """Continue in another model and state of the engine."""
        robot, prefix = self.robot, self.prefix
        self._model, self._data = model, data
        self.body = int(model.body(prefix + robot.model.root).id)
        self._sites = [int(model.site(prefix + link).id) for link in robot.model.links]
        self._servo = [model.actuator(prefix + name).id for name in BASE_MOTORS] if robot.base == "planar" else []
        joints = [model.joint(f"{prefix}base_{name}") for name in ("x", "y", "yaw")] if self._servo else []
        self._base = [int(joint.qposadr[0]) for joint in joints], [int(joint.dofadr[0]) for joint in joints]
        free = None if self._servo else model.joint(f"{prefix}base")
        self._free = (0, 0) if free is None else (int(free.qposadr[0]), int(free.dofadr[0]))
        named = [wheel.joint for wheel in robot.wheels if wheel.driven]
        named += [wheel.steering for wheel in robot.wheels if wheel.steering]
        self._wheels = {} if self._servo else {joint: self._motor(joint) for joint in named}
        self._rows: dict[str, tuple[int, int]] = {}
        for joint in robot.model.joints.values():
            index = self._mj.mj_name2id(model, self._mj.mjtObj.mjOBJ_JOINT, prefix + joint.name)
            if joint.size == 1 and index >= 0:
                self._rows[joint.name] = int(model.jnt_qposadr[index]), int(model.jnt_dofadr[index])
        self.friction = WheelFriction(model, robot, prefix)

    def prepare(self) -> None:
        """Set posture and weight of the robot in a new model."""
        if self._servo:  # the engine takes the mean over three directions; a planar base lacks one
            self._model.body_invweight0[self.body, 0] = 1.0 / self.robot.model.mass
        self._posed()

    @property
    def mass(self) -> float:
        """Mass of the whole robot [kg]."""
        return self.robot.model.mass

    @property
    def pose(self) -> Pose:
        """Current pose, E = 1."""
        place, turn = self._data.xpos[self.body], self._data.xmat[self.body]
        return Pose(place[None, :2].copy(), np.array([math.atan2(turn[3], turn[0])]))

    @property
    def tilt(self) -> float:
        """Angle between the upward axis of the robot and the vertical [rad]; above about 1, the robot has fallen
        over.
        """
        return math.acos(min(1.0, max(-1.0, float(self._data.xmat[self.body][8]))))

    @property
    def twist(self) -> Twists:
        """Current twist in the frame of the robot."""
        speed = np.zeros(6)
        self._mj.mj_objectVelocity(self._model, self._data, self._mj.mjtObj.mjOBJ_XBODY, self.body, speed, 1)
        return Twists(speed[3:4].copy(), speed[2:3].copy(), speed[4:5].copy())

    def _moved(self) -> Twist:
        """Return the twist of a free base from its coordinates, which are those of the end of the last step.

        The velocities of the bodies are those of its beginning, except after the last step of the world.
        """
        place, speed = self._free
        w, x, y, z = self._data.qpos[place + 3 : place + 7].tolist()
        vx, vy, vz, _, _, turn = self._data.qvel[speed : speed + 6].tolist()
        ahead = (1.0 - 2.0 * (y * y + z * z)) * vx + 2.0 * (x * y + w * z) * vy + 2.0 * (x * z - w * y) * vz
        aside = 2.0 * (x * y - w * z) * vx + (1.0 - 2.0 * (x * x + z * z)) * vy + 2.0 * (y * z + w * x) * vz
        return Twist(ahead, turn, left=aside)

    @property
    def height(self) -> float | None:
        """Height of the root of a robot on wheels [m]; None for a pulled base, which keeps its height."""
        return None if self._servo else float(self._data.qpos[self._free[0] + 2])

    @property
    def held(self) -> Mapping[str, float]:
        """Targets [rad or m] of the joints without a position motor, by name in the engine; see :meth:`hold`."""
        return self._held

    def put(
        self,
        x: float,
        y: float,
        heading: float,
        velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
        height: float | None = None,
    ) -> None:
        """Place the robot upright; joint positions are unchanged.

        Args:
            x, y, heading: place [m] and heading [rad].
            velocity: velocity of the base in the world: x, y [m/s], turn rate [rad/s].
            height: height of the root of a robot on wheels [m]; None: unchanged.
        """
        place, speed = self._data.qpos, self._data.qvel
        if self._servo:
            rows, dofs = self._base
            place[rows], speed[dofs] = (x, y, heading), velocity
            return
        row, dof = self._free
        place[row : row + 2] = x, y
        if height is not None:
            place[row + 2] = height
        place[row + 3 : row + 7] = math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2)
        speed[dof : dof + 6] = velocity[0], velocity[1], 0.0, 0.0, 0.0, velocity[2]

    def turn_joints(self, speeds: Mapping[str, float]) -> None:
        """Set the speeds [rad/s or m/s] of joints, as far as the engine has them."""
        for joint, speed in speeds.items():
            if joint in self._rows:
                self._data.qvel[self._rows[joint][1]] = speed

    def ask(self, command: Twist | Twists) -> None:
        """Set the command for the next step of the world."""
        self._asked = command
        self._forced = None

    def drive(self) -> None:
        """Send the command for the next engine step to the motors, after delay, limits and ramps."""
        for name, position in self._held.items():
            joint = self._model.joint(name)
            self._data.qpos[joint.qposadr[0]], self._data.qvel[joint.dofadr[0]] = position, 0.0
        now = self._asked
        if self.robot.latency > 0.0:
            self._pending, now = self._delay.step(self._pending, self._current, self._asked, self.step)
            self._current = now
        if now is self._forced and self._slip_state is None and not self._steers:  # the command is reached
            return
        old = self._aim
        _, self._aim = self.robot.drive.step(NOWHERE, old, now, self.step)
        if self._servo:
            self._pull(old)
            return
        if _same(old, self._aim):
            self._forced = now
        if self._steers:
            self._steered(old, self._aim)
            return
        speeds = self._wheel_rates(old, self._aim)
        before = speeds if self._slip is not None else self._wheel_rates(old, old)
        if self._slip is not None and self._slip_state is not None:
            self._slip_state = self._slip.step(self._slip_state, self._aim.at(0), self._moved(), self.step)
        lead = self._lag / self.step  # the servos lag behind; they get the speed of the wheels ahead of time
        self._data.ctrl[[self._wheels[joint] for joint in self._step_robots]] = before + lead * (speeds - before)

    def _wheel_rates(self, old: Twists, twist: Twists) -> Floats:
        """Return the speeds of the driven wheels [rad/s] on the way to a twist, with the slip of a skid-steer base."""
        if self._slip is not None and self._slip_state is not None:
            wheels = self._slip.wheels(self._slip_state, old.at(0), twist.at(0), self._moved(), self.loads, self.step)
            return np.asarray(self._rolling @ (wheels.forward, wheels.turn, 0.0))
        return np.asarray(self._rolling @ _row(twist))

    def _pull(self, old: Twists) -> None:
        """Set the forces on a planar base for the way from the old commanded twist to the new one."""
        place, speed = self._base
        heading = float(self._data.qpos[place[2]])
        if not self._quick:
            self._quick = self._forces.weigh(self._model, self._data, speed, heading)
        velocity = self._data.qvel[speed]
        self._data.ctrl[self._servo] = self._forces.forces(old, self._aim, velocity, heading, self._quick)

    def _steered(self, old: Twists, aim: Twists) -> None:
        """Steer the wheels of a car or tricycle; at rest they keep their angle.

        Servos lag behind, so they get their speeds ahead of time. A servo that steers also corrects its angle, with the
        same time constant.
        """
        (angles, speeds), (now, after) = self._wheel_motion(old), self._wheel_motion(aim)
        lead = self._lag / self.step
        for joint, value in now.items():
            row, dof = self._rows[joint]
            angle, rate = float(self._data.qpos[row]), float(self._data.qvel[dof])
            goal = (value - angles[joint]) / self.step + (angles[joint] - angle) / self._lag
            self._data.ctrl[self._wheels[joint]] = rate + lead * (goal - rate)
        for joint, value in after.items():
            self._data.ctrl[self._wheels[joint]] = speeds[joint] + lead * (value - speeds[joint])

    def _wheel_motion(self, twist: Twists) -> tuple[dict[str, float], dict[str, float]]:
        """Return steering angles [rad] and wheel speeds [rad/s] of a car or tricycle, by joint."""
        drive = self.robot.drive
        assert isinstance(drive, AckermannDrive | TricycleDrive)
        steering = twist.steering if isinstance(twist, SteeredTwists) else np.zeros(1)
        angle, speed = float(steering[0]), float(drive.rolling(twist, steering)[0])
        angles, rates = _wheel_rates_at(self.robot, angle, math.copysign(1.0, angle))
        return angles, {joint: rate * speed for joint, rate in rates.items()}

    def command(self, joints: Mapping[str, float]) -> None:
        """Set the commands of joint motors: position, velocity or effort, depending on the motor.

        Raises:
            InputError: a joint has no motor or is a wheel of the base, or a value is not finite.
        """
        for name, value in joints.items():
            if name in self._wheels:
                raise InputError(f"the joint {name!r} of {self.robot.name} is a wheel; use a Twist command")
            if not math.isfinite(value):
                raise InputError(f"the command {value} for joint {name!r} of {self.robot.name} is not finite")
            self._data.ctrl[self._motor(name)] = value

    def hold(self, joint: str, position: float) -> None:
        """Move a joint to a position [rad or m] by its position motor; a joint without one is held there."""
        motor = self._mj.mj_name2id(self._model, self._mj.mjtObj.mjOBJ_ACTUATOR, self.prefix + joint)
        if motor >= 0 and self._model.actuator_biasprm[motor, 1] != 0.0:
            self._data.ctrl[motor] = position
        else:
            self._held[self.prefix + joint] = position

    def joints(self) -> dict[str, tuple[float, float]]:
        """Return position and velocity of each joint with one coordinate."""
        place, speed = self._data.qpos, self._data.qvel
        return {joint: (float(place[row]), float(speed[dof])) for joint, (row, dof) in self._rows.items()}

    def frame(self, link: str) -> Floats:
        """Return the frame ``[4, 4]`` of a link in the world.

        Raises:
            InputError: the link is unknown.
        """
        if link not in self.robot.model.links:
            raise InputError(f"{self.robot.name} has no link {link!r}{did_you_mean(link, self.robot.model.links)}")
        site = self._data.site(self.prefix + link)
        result = np.eye(4)
        result[:3, :3], result[:3, 3] = site.xmat.reshape(3, 3), site.xpos
        return result

    def frames(self) -> dict[str, Floats]:
        """Return the frames ``[4, 4]`` of all links in the world."""
        found = np.zeros((len(self._sites), 4, 4))
        found[:, :3, :3] = self._data.site_xmat[self._sites].reshape(-1, 3, 3)
        found[:, :3, 3], found[:, 3, 3] = self._data.site_xpos[self._sites], 1.0
        return dict(zip(self.robot.model.links, found, strict=True))

    def sensor_pose(self, sensor: str) -> SpatialPose:
        """Return the current pose of a sensor, including joint positions and tilt, E = 1.

        Raises:
            InputError: the sensor is unknown.
        """
        mount = self.robot.mount(sensor)
        return spatial(self.frame(mount.link) @ mount.origin)

    def _motor(self, joint: str) -> int:
        index = self._mj.mj_name2id(self._model, self._mj.mjtObj.mjOBJ_ACTUATOR, self.prefix + joint)
        if index < 0:
            named = [self._model.actuator(k).name for k in range(self._model.nu)]
            own = [name.removeprefix(self.prefix) for name in named if name.startswith(self.prefix)]
            raise InputError(f"{self.robot.name} has no motor on joint {joint!r}{did_you_mean(joint, own)}")
        return int(index)

    def _posed(self) -> None:
        """Set the joints to the posture of the robot, held by their motors."""
        for name, value in self.robot.model.positions(self.robot.posture).items():
            if name in self._rows:
                self._data.qpos[self._rows[name][0]] = value[0]
        for name, position in self.robot.posture.items():
            index = self._mj.mj_name2id(self._model, self._mj.mjtObj.mjOBJ_ACTUATOR, self.prefix + name)
            if index >= 0:
                self._data.ctrl[index] = float(np.atleast_1d(position)[0])


@functools.lru_cache(maxsize=256)
def _wheel_rates_at(robot: Robot, angle: float, sign: float) -> tuple[dict[str, float], dict[str, float]]:
    """Return steering angles [rad] and wheel rates [rad/s per m/s] of a car or tricycle at a steering angle [rad].

    ``sign`` is that of the angle, since 0 and -0 are equal keys. Each angle is asked for twice: a robot goes from the
    angle of the last step to the next one.
    """
    drive = robot.drive
    assert isinstance(drive, AckermannDrive | TricycleDrive)
    way = drive.motion(angle)
    return robot.steering(way), robot.wheel_speeds(way)


def _row(twist: Twists) -> Floats:
    return np.array([twist.forward[0], twist.turn[0], twist.left[0]])


def _same(twists: Twists, other: Twists) -> bool:
    names = [part.name for part in dataclasses.fields(twists) if part.init]
    return type(twists) is type(other) and all(getattr(twists, name)[0] == getattr(other, name)[0] for name in names)


NOWHERE = Pose(np.zeros((1, 2)), np.zeros(1))
"""Pose used where drives only limit the twist."""
