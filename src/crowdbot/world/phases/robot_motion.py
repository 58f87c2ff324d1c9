"""Robot motion, the second phase of a step: drives follow the commands, from the scene at its start."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, Scene, Twist
from crowdbot.world.robots.drives.drive import Drive, Twists, put_robot

__all__ = ["check_commands", "initial_twist", "move_robots"]

STILL = Twist()


def initial_twist(scene: Scene, robot: int) -> Twists:
    """Return the twist of a robot with its heading and velocity in a scene."""
    heading, velocity = scene.heading[:, robot], scene.velocity[:, robot]
    cos, sin = np.cos(heading), np.sin(heading)
    forward = cos * velocity[:, 0] + sin * velocity[:, 1]
    left = cos * velocity[:, 1] - sin * velocity[:, 0]
    return Twists(forward, np.zeros_like(forward), left)


def check_commands(
    commands: Mapping[int, Twist | Twists], robots: Iterable[int], active: NDArray[np.bool_]
) -> dict[int, Twists]:
    """Return the command of each robot in all environments; absent robots need none.

    Args:
        commands: commands by agent index.
        robots: agent indices of all robots.
        active: ``[E, A]`` present agents.

    Raises:
        InputError: a robot has no command, or an agent that is not a robot has one.
    """
    known = list(robots)
    for robot in commands:
        if robot not in known:
            raise InputError(f"agent {robot} has a command but is not a robot; robots are {sorted(known) or 'none'}")
    for robot in known:
        if robot not in commands and active[:, robot].any():
            raise InputError(f"robot {robot} has no command; give one in every step, Twist() to stop")
    return {robot: Twists.of(commands.get(robot, STILL), len(active)) for robot in known}


def move_robots(
    before: Scene,
    after: Scene,
    drives: Mapping[int, Drive],
    twists: Mapping[int, Twists],
    commands: Mapping[int, Twists],
    dt: float,
) -> tuple[Scene, dict[int, Twists]]:
    """Return the scene with moved robots, and their twists.

    Args:
        before: scene at the start of the step.
        after: scene with moved people.
        drives, twists, commands: drive, current twist and command of each robot by agent index.
        dt: time step [s].
    """
    position, velocity, heading = after.position.copy(), after.velocity.copy(), after.heading.copy()
    new = dict(twists)
    for robot, command in commands.items():
        old = Pose(before.position[:, robot].copy(), before.heading[:, robot].copy())
        pose, new[robot] = drives[robot].step(old, twists[robot], command, dt)
        put_robot(
            robot, before.active, before.position, before.heading, pose.position, pose.heading,
            new[robot].forward, new[robot].left, position, velocity, heading,
        )  # fmt: skip
    return after.replace(position=position, velocity=velocity, heading=heading), new
