"""Contract check for custom robots, and what a robot reaches at full speed in both worlds."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import InputError, MissingExtra, Pose, Scene, Twist
from crowdbot.models import ORCA

from .planar import PlanarWorld
from .robots.robot import Robot

DT = 0.1
SECONDS = 2.0
"""Duration of a drive test [s]."""
FINE = 0.02
"""Time step [s] of a drive test."""
UPRIGHT = 0.5
"""Tilt [rad] from which a robot has fallen over."""
SLANT = 0.1
"""Largest share of the way straight ahead by which a robot may be beside it."""


class DriveTest(NamedTuple):
    """What a robot reaches that is commanded straight ahead at its maximum speed, alone on a flat floor.

    Fields:
        world: ``planar`` or ``physics``.
        speed: forward speed [m/s] at the end, the mean of the last 0.2 s.
        wanted: maximum speed [m/s].
        forward, left: way [m] from the start.
        tilt: largest angle from the vertical [rad]; 0 in the plane.
        problem: what is wrong, a part of a sentence; empty if nothing is.
    """

    world: str
    speed: float
    wanted: float
    forward: float
    left: float
    tilt: float = 0.0
    problem: str = ""


def drive_tests(robot: Robot) -> tuple[DriveTest, ...]:
    """Drive a robot straight ahead for two seconds in the plane and, if MuJoCo is installed, in the physics world.

    >>> [(test.world, round(test.speed, 2), test.problem) for test in drive_tests(Robot.load("turtlebot2"))]
    [('planar', 0.65, ''), ('physics', 0.65, '')]
    """
    from .physics.world import PhysicsWorld

    scene, drivers = _alone(robot), {0: robot.drive}
    planar = PlanarWorld(scene, ORCA(), drivers, FINE, latency={0: robot.latency})
    speed, steps = _max_speed(robot), round(SECONDS / FINE)
    found = [_judged(robot, "planar", *_ahead(planar, speed, steps))]
    try:
        physics = PhysicsWorld(scene, ORCA(), {0: robot}, FINE)
        found.append(_judged(robot, "physics", *_ahead(physics, speed, steps)))
    except MissingExtra:
        return tuple(found)
    except InputError as error:
        found.append(DriveTest("physics", 0.0, _max_speed(robot), 0.0, 0.0, problem=f"it cannot be tested: {error}"))
    return tuple(found)


def _alone(robot: Robot) -> Scene:
    return Scene.of([[0.0, 0.0]], external=[True], heading=[0.0], radius=robot.radius)


def _max_speed(robot: Robot) -> float:
    return float(getattr(robot.drive, "max_speed", 1.0))


def _ahead(world: Any, speed: float, steps: int) -> tuple[list[tuple[float, float]], float]:
    """Return the places ``(x, y)`` [m] after each step, and the largest tilt [rad]."""
    places, tilt = [], 0.0
    for _ in range(steps):
        scene = world.step({0: Twist(speed)})
        places.append((float(scene.position[0, 0, 0]), float(scene.position[0, 0, 1])))
        if world.walls_fixed:  # in the physics world, a robot has a body that may fall
            tilt = max(tilt, float(world.robot_body(0).tilt))
    return places, tilt


def _judged(robot: Robot, world: str, places: list[tuple[float, float]], tilt: float) -> DriveTest:
    last = round(0.2 / FINE)
    (x, y), wanted = places[-1], _max_speed(robot)
    speed = (x - places[-1 - last][0]) / (last * FINE)
    problem = ""
    if not math.isfinite(x + y):
        problem = "its place is not finite"
    elif tilt > UPRIGHT:
        problem = "it falls over"
    elif x < -0.01:
        problem = f"it moves backwards, {-x:.2f} m in {SECONDS:g} s"
    elif abs(y) > max(0.02, SLANT * x):
        problem = f"it moves sideways, {abs(y):.2f} m to the {'left' if y > 0.0 else 'right'} in {SECONDS:g} s"
    elif speed < 0.5 * wanted:
        most = float(getattr(robot.drive, "max_acceleration", math.inf))
        slow = f"; its acceleration of {most:g} m/s2 allows no more" if most * SECONDS < 0.5 * wanted else ""
        problem = f"it reaches less than half of its maximum speed of {wanted:g} m/s{slow}"
    return DriveTest(world, round(speed, 4), wanted, round(x, 4), round(y, 4), round(tilt, 4), problem)


def check_robot(robot: Robot) -> None:
    """Check that a robot drives forward in the plane, and that its sensors are on its body.

    Raises:
        InputError: the first violated rule.

    >>> check_robot(Robot.load("turtlebot2"))
    """
    speed = 0.5 * _max_speed(robot)
    world = PlanarWorld(_alone(robot), ORCA(), {0: robot.drive}, DT, latency={0: robot.latency})
    x, y = _ahead(world, speed, 50)[0][-1]
    if not 0.0 < x <= 50 * DT * speed + 1e-6 or abs(y) > SLANT * x:
        raise InputError(
            f"{robot.name}: after 5 s forward at {speed:g} m/s, the position is x = {x:.3f}, y = {y:.3f} m"
        )
    still = Pose.of((0.0, 0.0), 0.0)
    for mount in robot.mounts:
        place = robot.sensor_pose(mount.name, still).position[0]
        if np.hypot(place[0], place[1]) > 2.0 * robot.radius + 0.5 or place[2] < -0.01:
            spot = ", ".join(f"{value:.2f}" for value in place)
            raise InputError(f"{robot.name}: the sensor {mount.name!r} is not on the robot: x, y, z = {spot} m")
