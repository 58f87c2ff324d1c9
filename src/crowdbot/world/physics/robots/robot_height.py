"""Height of robots on uneven ground."""

from __future__ import annotations

from typing import Any

from crowdbot.core import Scene
from crowdbot.world.ground.ground import Ground
from crowdbot.world.robots.robot import Robot


def base_height(ground: Ground | None, scene: Scene, agent: int, robot: Robot) -> float:
    """Return the height [m] of the root of a robot at its place in a scene, on the highest ground under it."""
    if ground is None:
        return robot.lift
    return robot.lift + float(ground.support(scene.position[0, agent], robot.radius))


def is_level(ground: Ground | None, start: Any) -> bool:
    """Return whether the ground under a robot is level where it starts; if not, it keeps the pose in which it rests."""
    return ground is None or ground.is_level(start.x, start.y, start.robot.radius)


def stand_robot(body: Any, ground: Ground, x: float, y: float) -> None:
    """Raise or lower a robot with wheels to the ground at x, y [m]; one with a pulled base keeps its height."""
    if body.robot.base == "wheels":
        joint = body._model.joint(f"{body.prefix}base")
        body._data.qpos[int(joint.qposadr[0]) + 2] = body.robot.lift + float(ground.support([x, y], body.robot.radius))
