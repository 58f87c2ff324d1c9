"""EmulatedGlances: the pose of the head of an emulated person, who looks ahead and at a robot in turn."""

from __future__ import annotations

import math

from crowdbot.core import stream

EYE_HEIGHT = 1.58
"""Height of the eyes [m]."""
FORWARD = 0.1
"""Distance from the axis of the body to the eyes [m]."""
FARTHEST_TURN = math.radians(60.0)
"""Largest turn of the head against the trunk [rad]."""
TURN_RATE = math.radians(150.0)
"""Speed of a turn of the head [rad/s]."""
CHEST = 1.0
"""Height at which the person looks [m]."""


class EmulatedGlances:
    """Turns the head to a robot and back, for times from exponential distributions.

    The numbers are assumptions for rehearsals, not measurements.

    Args:
        step: time step [s].
        seed: seed.
        name: name of the trial; each has its own glances.
        at_robot, ahead: mean times of looking at the robot and ahead [s].

    >>> head = EmulatedGlances(0.1, 1, "walk").pose((0.0, 0.0), 0.0, (3.0, 0.0))
    >>> [round(value, 2) for value in head[:3]]
    [0.1, 0.0, 1.58]
    """

    def __init__(self, step: float, seed: int, name: str, at_robot: float = 1.0, ahead: float = 1.0) -> None:
        self._rng, self._step = stream(seed, "glances", name), step
        self._means = {True: at_robot, False: ahead}
        self._at_robot = bool(self._rng.random() < at_robot / (at_robot + ahead))
        self._left = float(self._rng.exponential(self._means[self._at_robot]))
        self._yaw = 0.0

    def pose(
        self, place: tuple[float, float], heading: float, robot: tuple[float, float]
    ) -> tuple[float, float, float, float, float, float, float]:
        """Advance one step and return x, y, z [m] and the quaternion w, x, y, z of the head.

        Args:
            place, heading: of the trunk [m], [rad].
            robot: place of the robot [m].
        """
        self._left -= self._step
        if self._left <= 0.0:
            self._at_robot = not self._at_robot
            self._left = float(self._rng.exponential(self._means[self._at_robot]))
        away = robot[0] - place[0], robot[1] - place[1]
        bearing = math.remainder(math.atan2(away[1], away[0]) - heading, 2.0 * math.pi)
        wish = max(-FARTHEST_TURN, min(FARTHEST_TURN, bearing)) if self._at_robot else 0.0
        most = TURN_RATE * self._step
        self._yaw += max(-most, min(most, wish - self._yaw))
        down = math.atan2(EYE_HEIGHT - CHEST, max(math.hypot(*away), 0.5)) if self._at_robot else 0.0
        yaw = heading + self._yaw
        cos_yaw, sin_yaw = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
        cos_down, sin_down = math.cos(0.5 * down), math.sin(0.5 * down)
        x, y = place[0] + FORWARD * math.cos(heading), place[1] + FORWARD * math.sin(heading)
        turn = (cos_yaw * cos_down, -sin_yaw * sin_down, cos_yaw * sin_down, sin_yaw * cos_down)
        return (x, y, EYE_HEIGHT, *turn)
