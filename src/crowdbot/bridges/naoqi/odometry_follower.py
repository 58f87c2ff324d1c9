"""OdometryFollower: the velocity with which a virtual robot follows the odometry of a real one."""

from __future__ import annotations

import math
import threading
from collections.abc import Sequence

from crowdbot.bridges.join.robot_input import StartAlignment
from crowdbot.core import wrap_angle

GAIN = 2.0
"""Velocity that corrects an error of the pose [1/s]."""
LARGEST = 2.0
"""Error of the position [m] above which a robot was moved by hand, and the poses are aligned anew."""

Pose = tuple[float, float, float]


class OdometryFollower:
    """Makes velocity commands that keep a virtual robot at the odometry of a real one.

    A command is the velocity of the real robot, plus a correction of the distance between both. Velocities alone would
    part them: each one counts until the next arrives, and the virtual robot accelerates in its own way. The origin of
    odometry is anywhere, so the first pose after :meth:`align` is that of the virtual robot at this moment.

    Args:
        x, y: position of the virtual robot at the start [m].
        heading: its heading [rad].

    >>> follower = OdometryFollower(1.0, 2.0, math.pi / 2)
    >>> follower.command((0.5, 0.0, 0.0), (7.0, 7.0, 0.0))
    (0.5, 0.0, 0.0)
    >>> [round(one, 3) for one in follower.command((0.0, 0.0, 0.0), (7.1, 7.0, 0.0))]  # the virtual robot is behind
    [0.2, 0.0, 0.0]
    """

    def __init__(self, x: float, y: float, heading: float) -> None:
        self._virtual: Pose = (x, y, heading)
        self._frame: StartAlignment | None = None
        self._lock = threading.Lock()

    def align(self) -> None:
        """Take the next pose of the real robot as that of the virtual one, after a new connection."""
        with self._lock:
            self._frame = None

    def note_virtual(self, x: float, y: float, heading: float) -> None:
        """Note the pose of the virtual robot."""
        with self._lock:
            self._virtual = x, y, heading

    def command(self, velocity: Sequence[float], pose: Sequence[float]) -> tuple[float, float, float]:
        """Return the command for the virtual robot: forward, left [m/s], turn [rad/s].

        Args:
            velocity: the same of the real robot.
            pose: x, y [m], heading [rad] of its odometry.
        """
        with self._lock:
            dx, dy, turn = self._error(pose)
            if math.hypot(dx, dy) > LARGEST:
                self._frame = None
                dx, dy, turn = self._error(pose)
            cos, sin = math.cos(self._virtual[2]), math.sin(self._virtual[2])
        ahead, aside = math.cos(turn), math.sin(turn)
        forward = ahead * velocity[0] - aside * velocity[1] + GAIN * (cos * dx + sin * dy)
        left = aside * velocity[0] + ahead * velocity[1] + GAIN * (cos * dy - sin * dx)
        return forward, left, velocity[2] + GAIN * turn

    def _error(self, pose: Sequence[float]) -> Pose:
        """Return how far the real robot is from the virtual one: x, y [m] in the trial, heading [rad]."""
        if self._frame is None:
            self._frame = StartAlignment(*self._virtual)
        x, y, heading = self._frame.pose(pose[0], pose[1], pose[2])
        return x - self._virtual[0], y - self._virtual[1], wrap_angle(heading - self._virtual[2])
