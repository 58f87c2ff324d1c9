"""Controls that a user holds: a robot that is driven, an avatar that is walked. They become an order in every step."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.metrics import wall_clearance
from crowdbot.simulation import AvatarOrder, Order, Simulation, VelocityOrder

__all__ = ["SOURCE", "HeldAvatar", "HeldVelocity"]

SOURCE = "app"
"""Source of the orders of the page."""
REPEAT = 0.2
"""Simulated time [s] after which a velocity is ordered again."""
LET_GO = 1.0
"""Real time [s] after which a control counts as let go if the page does not repeat it."""
WALK, RUN = 1.4, 3.0
"""Speed [m/s] of an avatar, and its highest speed."""


@dataclass
class HeldVelocity:
    """The velocity at which a user drives a robot.

    Fields:
        robot: name of the robot.
        forward, turn, left: [m/s], [rad/s], [m/s].
    """

    robot: str
    forward: float = 0.0
    turn: float = 0.0
    left: float = 0.0

    def __post_init__(self) -> None:
        self._held = time.monotonic()
        self._sent: tuple[float, float, float] | None = None
        self._tick = 0

    def hold(self, forward: float, turn: float, left: float) -> None:
        """Set the velocity."""
        self.forward, self.turn, self.left = forward, turn, left
        self._held = time.monotonic()

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the order for this step: if the velocity has changed, and often enough for the timeout."""
        if time.monotonic() - self._held > LET_GO:
            self.forward = self.turn = self.left = 0.0
        now, step = (self.forward, self.turn, self.left), simulation.world.clock.dt
        if now == self._sent and (simulation.tick - self._tick) * step < REPEAT:
            return []
        self._sent, self._tick = now, simulation.tick
        return [VelocityOrder(robot=self.robot, forward=now[0], turn=now[1], left=now[2], source=SOURCE)]


@dataclass
class HeldAvatar:
    """The velocity at which a user walks an avatar, and its pose.

    Fields:
        avatar: name of the avatar.
        x, y, heading: pose [m], [rad].
        forward, left, turn: velocity in the frame of the avatar [m/s], [m/s], [rad/s].
    """

    avatar: str
    x: float
    y: float
    heading: float
    radius: float = 0.25
    forward: float = 0.0
    left: float = 0.0
    turn: float = 0.0

    def __post_init__(self) -> None:
        self._held = time.monotonic()

    def hold(self, forward: float, left: float, turn: float) -> None:
        """Set the velocity; its length is limited."""
        speed = math.hypot(forward, left)
        share = min(1.0, RUN / speed) if speed > 0.0 else 1.0
        self.forward, self.left, self.turn = forward * share, left * share, turn
        self._held = time.monotonic()

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the pose at the end of the next step; walls are not passed."""
        if time.monotonic() - self._held > LET_GO:
            self.forward = self.left = self.turn = 0.0
        step = simulation.world.clock.dt
        self.heading += self.turn * step
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        x = self.x + (self.forward * cos - self.left * sin) * step
        y = self.y + (self.forward * sin + self.left * cos) * step
        for place in ((x, y), (x, self.y), (self.x, y)):
            if self._is_free(place, simulation.world.environment_scene(0)):
                self.x, self.y = place
                break
        now = float(simulation.world.times[0]) + step
        values: dict[str, Any] = {"x": self.x, "y": self.y, "heading": self.heading}
        return [AvatarOrder(avatar=self.avatar, time=round(now, 9), source=SOURCE, **values)]

    def _is_free(self, place: tuple[float, float], scene: Any) -> bool:
        path = np.array([(self.x, self.y), place])
        before, after = wall_clearance(path, self.radius, scene.walls.segments())
        return bool(after >= 0.0 or after > before)
