"""A world in the plane: a crowd model moves the people, drives move the robots."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import FreeClock, InputError, Pose, Scene, Twist, stream
from crowdbot.metrics import swept_distance
from crowdbot.models import CrowdModel

from .drive import Drive, Twists
from .world import Contact, World

__all__ = ["PlanarWorld"]


@dataclass
class PlanarWorld(World):
    """People and robots as discs in the plane, E environments at once.

    In a step the crowd and the robots move from the same old scene: people see where robots are, not where they will
    be, and the reverse. People see robots as agents that are moved from outside. There are no forces between bodies:
    overlaps are reported in :attr:`contacts`, never resolved, and a robot that is driven into a wall passes through it.
    The crowd draws from its own stream of randomness, so that sensors and navigators do not change it.

    Args:
        scene: at the beginning; robots are agents with ``external=True``.
        model: how people walk.
        drives: the drive of each robot by its agent index.
        dt: time step [s].
        seed: of the crowd's randomness.
        leave_radius: people nearer to their goal than this [m] leave (``active=False``); None: they stay. Robots
            never leave.
        berth: how much wider people take a robot to be [m]. Discs of a crowd model pass one another at zero clearance;
            without a berth ORCA people touch even a robot that stands still.

    Attributes:
        clock: who counts the time.
        twists: how each robot moves now.
        contacts: robot and other pairs whose clearance fell below 0 during the last step, on straight ways between
            the two scenes.

    Raises:
        InputError: a drive belongs to no agent, or to one that is not external; dt, leave_radius or
            berth has a value that is not allowed.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.world import DifferentialDrive
    >>> start = Scene.of([[0.0, 0.0], [5.0, 1.0]], goal=[[0.0, 0.0], [-5.0, 1.0]], external=[True, False])
    >>> world = PlanarWorld(start, ORCA(), {0: DifferentialDrive()}, dt=0.1)
    >>> scene = world.step({0: Twist(1.0, 0.0)})
    >>> scene.time, scene.position[0].round(2).tolist()
    (0.1, [[0.01, 0.0], [4.87, 1.0]])
    """

    scene: Scene
    model: CrowdModel
    drives: Mapping[int, Drive]
    dt: float
    seed: int = 0
    leave_radius: float | None = None
    berth: float = 0.1
    clock: FreeClock = field(init=False)
    twists: dict[int, Twists] = field(init=False)
    contacts: tuple[Contact, ...] = field(init=False, default=())

    def __post_init__(self) -> None:
        agents = self.scene.shape[1]
        for robot in self.drives:
            if not 0 <= robot < agents:
                raise InputError(f"a drive is given for agent {robot}, but the scene has agents 0 to {agents - 1}")
            if not np.all(self.scene.external[:, robot]):
                raise InputError(f"agent {robot} has a drive but is not external: set external=True for robots")
        if not 0.0 <= self.berth < math.inf:
            raise InputError(f"berth {self.berth} m must be finite and at least 0")
        if self.leave_radius is not None and not 0.0 < self.leave_radius < math.inf:
            raise InputError(f"leave_radius {self.leave_radius} m must be finite and above 0, or None")
        self.clock = FreeClock(self.dt)
        self.twists = {robot: self._initial_twist(robot) for robot in sorted(self.drives)}
        self._begin = self.scene.time
        self._rng = stream(self.seed, "crowd")

    def step(self, commands: Mapping[int, Twist | Twists]) -> Scene:
        """Go one time step on and return the new scene; see :class:`World`."""
        asked = self._checked(commands)
        before = self.scene
        crowd = self.model.step(before.replace(radius=self._felt(before)), self.dt, self._rng)
        after = self._driven(before, crowd.replace(radius=before.radius), asked)
        self.clock.advance()
        after = after.replace(time=self._begin + self.clock.time)
        after.check()
        self.contacts = self._touching(before, after)
        self.scene = after if self.leave_radius is None else _left(after, self.leave_radius)
        return self.scene

    def pose(self, robot: int) -> Pose:
        """Return where a robot is in every environment."""
        return Pose(self.scene.position[:, robot].copy(), self.scene.heading[:, robot].copy())

    def _felt(self, scene: Scene) -> NDArray[np.float64]:
        """Return the radii as people take them: robots wider by the berth."""
        radius = scene.radius.copy()
        radius[:, list(self.twists)] += self.berth
        return radius

    def _initial_twist(self, robot: int) -> Twists:
        heading, velocity = self.scene.heading[:, robot], self.scene.velocity[:, robot]
        cos, sin = np.cos(heading), np.sin(heading)
        forward = cos * velocity[:, 0] + sin * velocity[:, 1]
        left = cos * velocity[:, 1] - sin * velocity[:, 0]
        return Twists(forward, np.zeros_like(forward), left)

    def _checked(self, commands: Mapping[int, Twist | Twists]) -> dict[int, Twists]:
        for robot in commands:
            if robot not in self.drives:
                raise InputError(f"a command is given for agent {robot}; robots are {sorted(self.drives) or 'none'}")
        missing = [robot for robot in self.twists if robot not in commands]
        if missing:
            raise InputError(f"robot {missing[0]} has no command; give one in every step, Twist() to stand")
        return {robot: Twists.of(commands[robot], self.scene.shape[0]) for robot in self.twists}

    def _driven(self, before: Scene, after: Scene, asked: Mapping[int, Twists]) -> Scene:
        position, velocity, heading = after.position.copy(), after.velocity.copy(), after.heading.copy()
        for robot, command in asked.items():
            here = before.active[:, robot]
            old = Pose(before.position[:, robot].copy(), before.heading[:, robot].copy())
            pose, twist = self.drives[robot].step(old, self.twists[robot], command, self.dt)
            self.twists[robot] = twist
            position[:, robot] = np.where(here[:, None], pose.position, old.position)
            heading[:, robot] = np.where(here, pose.heading, old.heading)
            velocity[:, robot] = np.where(here[:, None], twist.velocity(heading[:, robot]), 0.0)
        return after.replace(position=position, velocity=velocity, heading=heading)

    def _touching(self, before: Scene, after: Scene) -> tuple[Contact, ...]:
        found: list[Contact] = []
        for number, robot in enumerate(self.twists):
            start = before.position - before.position[:, robot : robot + 1]
            end = after.position - after.position[:, robot : robot + 1]
            gap = swept_distance(start, end) - after.radius - after.radius[:, robot : robot + 1]
            others = after.active & after.active[:, robot : robot + 1]
            others[:, list(self.twists)[: number + 1]] = False
            for e, other in np.argwhere(others & (gap < 0.0)):
                found.append(Contact(int(e), robot, int(other), float(gap[e, other])))
        return tuple(sorted(found))


def _left(scene: Scene, radius: float) -> Scene:
    away = scene.goal - scene.position
    arrived = away[..., 0] ** 2 + away[..., 1] ** 2 < radius * radius
    return scene.replace(active=scene.active & ~(arrived & ~scene.external))
