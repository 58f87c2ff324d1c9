"""Contract check for custom robots."""

from __future__ import annotations

import numpy as np

from crowdbot.core import InputError, Pose, Scene, Twist
from crowdbot.models import ORCA

from .planar import PlanarWorld
from .robots.robot import Robot

__all__ = ["check_robot"]

DT = 0.1


def check_robot(robot: Robot) -> None:
    """Check that a robot drives forward in the plane, and that its sensors are on its body.

    Raises:
        InputError: the first violated rule.

    >>> check_robot(Robot.load("turtlebot2"))
    """
    speed = 0.5 * float(getattr(robot.drive, "max_speed", 1.0))
    scene = Scene.of([[0.0, 0.0]], external=[True], heading=[0.0], radius=robot.radius)
    world = PlanarWorld(scene, ORCA(), {0: robot.drive}, DT, latency={0: robot.latency})
    for _ in range(50):
        scene = world.step({0: Twist(speed)})
    x, y = scene.position[0, 0]
    if not 0.0 < x <= 50 * DT * speed + 1e-6 or abs(y) > 0.1 * x:
        raise InputError(
            f"{robot.name}: after 5 s forward at {speed:g} m/s, the position is x = {x:.3f}, y = {y:.3f} m"
        )
    still = Pose.of((0.0, 0.0), 0.0)
    for mount in robot.mounts:
        place = robot.sensor_pose(mount.name, still).position[0]
        if np.hypot(place[0], place[1]) > 2.0 * robot.radius + 0.5 or place[2] < -0.01:
            spot = ", ".join(f"{value:.2f}" for value in place)
            raise InputError(f"{robot.name}: the sensor {mount.name!r} is not on the robot: x, y, z = {spot} m")
