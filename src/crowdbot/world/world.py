"""The contract of worlds: people and robots together, one step of time at a time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import NamedTuple

from crowdbot.core import Scene, Twist

from .robots.drive import Twists

__all__ = ["Contact", "World"]


class Contact(NamedTuple):
    """A robot and another agent that touched during a step.

    ``clearance`` [m] is the smallest during the step, negative: how deep they overlapped.
    """

    environment: int
    robot: int
    other: int
    clearance: float


class World(ABC):
    """What turns commands into the next scene.

    Attributes:
        scene: the scene now; who lets people in (a spawner) may put a changed one in its place between two steps.
    """

    scene: Scene

    @abstractmethod
    def step(self, commands: Mapping[int, Twist | Twists]) -> Scene:
        """Go one time step on and return the new scene.

        Args:
            commands: for each robot (its agent index) the twist it is asked for, one for all environments or each.

        Raises:
            InputError: a robot has no command, a command is for no robot, or is not finite.
        """
