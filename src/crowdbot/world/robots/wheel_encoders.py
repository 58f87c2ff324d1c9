"""Wheels of robots in a world, as encoders see them, and the positions of all joints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import Twist
from crowdbot.sensors import WheelGeometry, WheelRotation
from crowdbot.world.robots.drives.drive import Omnidirectional

if TYPE_CHECKING:
    from crowdbot.world.physics.robots.robot_body import RobotBody
    from crowdbot.world.world import World

    from .robot import Robot

TWISTS = (Twist(1.0, 0.0), Twist(0.0, 1.0), Twist(0.0, 0.0, 1.0))


def wheel_geometry(robot: Robot) -> WheelGeometry | None:
    """Return the driven wheels of a robot; None for a robot without.

    >>> from crowdbot.world import Robot
    >>> geometry = wheel_geometry(Robot.load("turtlebot2"))
    >>> geometry.joints, geometry.track, geometry.radius.tolist()
    (('wheel_left_joint', 'wheel_right_joint'), 0.23, [0.035, 0.035])
    """
    wheels = [wheel for wheel in robot.wheels if wheel.driven]
    if not wheels:
        return None
    poses = robot.model.poses(robot.posture)
    places = [poses[robot.model.joints[wheel.joint].child][:2, 3] for wheel in wheels]
    speeds = [robot.wheel_speeds(twist) for twist in TWISTS]
    rolling = np.array([[speed[wheel.joint] for speed in speeds] for wheel in wheels])
    position = np.array([[round(float(value), 12) for value in place] for place in places])
    radius = np.array([wheel.radius for wheel in wheels])
    steered = np.array([bool(wheel.steering) for wheel in wheels])
    if steered.any():  # a steered wheel turns towards the motion; its own row is that of straight ahead
        ahead = np.where(rolling[steered, 0] < 0.0, -1.0, 1.0) / radius[steered]
        rolling[steered] = np.stack([ahead, -position[steered, 1] * ahead, np.zeros_like(ahead)], axis=1)
    fixed = [x for (x, _), wheel in zip(position.tolist(), wheels, strict=True) if not wheel.steering]
    center = sum(fixed) / len(fixed) if fixed else 0.0
    sideways = isinstance(robot.drive, Omnidirectional) or bool(np.linalg.matrix_rank(rolling, tol=1e-6) == 3)
    joints, steering = tuple(wheel.joint for wheel in wheels), tuple(wheel.steering for wheel in wheels)
    return WheelGeometry(joints, steering, position, radius, rolling, round(center, 12), sideways)


def simulated_body(world: World, robot: int, environment: int) -> RobotBody | None:
    """Return the rigid body of a robot in one environment of a physics world; None in the plane, or if it is absent."""
    if not world.walls_fixed:
        return None
    body: RobotBody | None = world.part(environment)[0].robot_bodies.get(robot)
    return body


def wheel_rotation(
    world: World, robot: int, geometry: WheelGeometry | None, environment: int | None = None
) -> WheelRotation | None:
    """Return the wheels of a robot: their simulated angles in the physics world, elsewhere only what they are.

    The wheels of a base that is pulled touch nothing; it moves as if they rolled without slip.

    Args:
        world: the world.
        robot: index of the robot.
        geometry: its wheels; None: it has none.
        environment: index of the environment; None: the angles of all.
    """
    if geometry is None:
        return None
    chosen = range(len(world.slots)) if environment is None else [environment]
    bodies = [simulated_body(world, robot, e) for e in chosen]
    if not all(body is not None and body.robot.base == "wheels" for body in bodies):
        return WheelRotation(geometry)
    places = [body.joints() for body in bodies if body is not None]
    if not all(name in place for place in places for name in geometry.joints):
        return WheelRotation(geometry)
    angle = np.array([[place[name][0] for name in geometry.joints] for place in places])
    steering = None
    if any(geometry.steering):
        steering = np.array([_steering(body, geometry) for body in bodies if body is not None])
    return WheelRotation(geometry, angle, steering)


def _steering(body: RobotBody, geometry: WheelGeometry) -> list[float]:
    """Return the angle of each wheel to the left [rad], 0 without steering."""
    model, places = body.robot.model, body.joints()
    poses = model.poses(body.robot.posture)
    steering = []
    for name in geometry.steering:
        upwards = not name or (poses[model.joints[name].child][:3, :3] @ model.joints[name].axis)[2] > 0.0
        steering.append((1.0 if upwards else -1.0) * places[name][0] if name else 0.0)
    return steering


def joint_states(
    world: World | None, agent: int, robot: Robot, environment: int = 0, targets: Mapping[str, float] | None = None
) -> dict[str, tuple[float, float]]:
    """Return position [rad or m] and velocity of each joint with one coordinate.

    In the physics world they are simulated. In the plane, joints rest in the posture of the robot or at their targets,
    and wheels have the speed of rolling; their angles are not part of a planar world and are 0.

    Args:
        world: the world; None: the posture of the robot.
        agent: index of the robot.
        robot: the robot.
        environment: index of the environment.
        targets: joint positions in the plane that differ from the posture.

    >>> from crowdbot.world import Robot
    >>> joint_states(None, 0, Robot.load("pepper"))["LShoulderPitch"]
    (1.5, 0.0)
    """
    body = None if world is None else simulated_body(world, agent, environment)
    if body is not None:
        return body.joints()
    places = robot.model.positions({**robot.posture, **(targets or {})})
    single = [joint.name for joint in robot.model.joints.values() if joint.size == 1]
    speeds: Mapping[str, float] = {}
    if world is not None and agent in world.twists and any(wheel.driven for wheel in robot.wheels):
        speeds = robot.wheel_speeds(world.twists[agent].at(environment))
    return {name: (float(places[name][0]), float(speeds.get(name, 0.0))) for name in single}
