"""The simplest navigator: straight to the goal, whoever is in the way."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core import Twist, check_number

from .navigator import Navigator
from .observation import Observation

__all__ = ["Straight"]


@dataclass(frozen=True)
class Straight(Navigator):
    """Goes straight to the goal, blind to people and walls: the lower end of every comparison.

    It turns on the spot while the goal lies aside or behind, and slows near the goal.

    Fields:
        speed: [m/s], cut to what the drive can do.

    Raises:
        InputError: the speed is not finite or not above 0.

    >>> from crowdbot.navigation import Limits
    >>> behind = Observation(pose=(0.0, 0.0, 0.0), goal=(-4.0, 0.1), radius=0.3, limits=Limits(1.0, 2.0), dt=0.1)
    >>> Straight().act(behind)
    Twist(forward=0.0, turn=2.0, left=0.0)
    """

    speed: float = 1.0

    def __post_init__(self) -> None:
        check_number("Straight", "speed", self.speed, "m/s", exclusive_min=0.0)

    def act(self, observation: Observation) -> Twist:
        """Return the twist towards the goal."""
        return observation.towards_goal(self.speed)
