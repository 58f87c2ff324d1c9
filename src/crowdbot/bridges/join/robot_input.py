"""Inputs from a real robot: its odometry, and the emergency stop."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from crowdbot.bridges.commands import read_heading, read_point
from crowdbot.bridges.interface import InputTopic
from crowdbot.core import InputError, wrap_angle
from crowdbot.simulation import Order


@dataclass(frozen=True)
class OdometryInput(InputTopic):
    """A topic with ``nav_msgs/Odometry``; its poses go to ``take``, in the thread of the transport."""

    take: Callable[[float, float, float], None] = lambda x, y, heading: None

    def orders(self, fields: Mapping[str, Any], sender: str = "") -> list[Order]:
        """Give the pose of a message to ``take``; it gives no order.

        Raises:
            InputError: the message has no finite pose.
        """
        if not isinstance(fields, Mapping) or not isinstance(fields.get("pose"), Mapping):
            raise InputError(f"a message on {self.name} needs pose, as in nav_msgs/Odometry")
        x, y = read_point(fields, "pose", "pose", "position")
        self.take(x, y, read_heading(fields, "pose", "pose", "orientation"))
        return []


@dataclass(frozen=True)
class StopInput(InputTopic):
    """A topic with ``std_msgs/Bool``: true stops the robot, false releases it."""

    take: Callable[[bool], None] = lambda stop: None

    def orders(self, fields: Mapping[str, Any], sender: str = "") -> list[Order]:
        """Give the value to ``take``; it gives no order. What is not plainly false stops."""
        self.take(not (isinstance(fields, Mapping) and fields.get("data") is False))
        return []


class StartAlignment:
    """Moves odometry, whose origin is anywhere, so that its first pose is the start of the robot in the trial.

    >>> frame = StartAlignment(1.0, 2.0, math.pi / 2)
    >>> frame.pose(5.0, 5.0, 0.0), tuple(round(one, 3) for one in frame.pose(6.0, 5.0, 0.1))
    ((1.0, 2.0, 1.5707963267948966), (1.0, 3.0, 1.671))
    """

    def __init__(self, x: float, y: float, heading: float) -> None:
        self.start = (x, y, heading)
        self._first: tuple[float, float, float] | None = None

    def pose(self, x: float, y: float, heading: float) -> tuple[float, float, float]:
        """Return a pose in the frame of the trial."""
        if self._first is None:
            self._first = (x, y, heading)
        turn = self.start[2] - self._first[2]
        dx, dy = x - self._first[0], y - self._first[1]
        cos, sin = math.cos(turn), math.sin(turn)
        place = (self.start[0] + cos * dx - sin * dy, self.start[1] + sin * dx + cos * dy)
        return (*place, wrap_angle(heading + turn))
