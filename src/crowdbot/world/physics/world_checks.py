"""Checks of the arguments of a physics world."""

from __future__ import annotations

import math
from collections.abc import Mapping

from crowdbot.core import InputError, Scene
from crowdbot.world.robots.robot import Robot

__all__ = ["check_arguments"]


def check_arguments(scene: Scene, robots: Mapping[int, Robot], dt: float, physics_dt: float, slots: int | None) -> None:
    """Raise :class:`InputError` if the arguments of a physics world are not allowed."""
    if scene.shape[0] != 1:
        raise InputError(f"a physics world has one environment, the scene has {scene.shape[0]}; use PlanarWorld")
    if not 1e-4 <= physics_dt <= 0.02:
        raise InputError(f"physics_dt = {physics_dt} s must be from 0.0001 to 0.02 s; a typical value is 0.005 s")
    if not math.isfinite(dt) or dt < physics_dt or abs(dt / physics_dt - round(dt / physics_dt)) > 1e-6:
        raise InputError(f"dt = {dt} s must be a multiple of physics_dt = {physics_dt} s")
    if slots is not None and (isinstance(slots, bool) or not isinstance(slots, int) or not 0 <= slots <= 1000):
        raise InputError(f"slots = {slots!r} must be a whole number from 0 to 1000")
    for agent, robot in robots.items():
        if not isinstance(robot, Robot):
            raise InputError(
                f"robots[{agent}] is a {type(robot).__name__}; give a Robot such as Robot.load('turtlebot2')"
            )
        if 0 <= agent < scene.shape[1] and not scene.active[0, agent]:
            raise InputError(f"robot {robot.name} of agent {agent} is absent (active=False); robots must be active")
