"""SimulatedRobot: takes the place of a real robot at a bridge, so that a trial can be rehearsed without hardware."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Sequence
from typing import Any

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.core import InputError
from crowdbot.recording import StepMessage

PERIOD = 0.02
"""Time [s] between two odometry messages."""
SILENCE = 0.5
"""Age of the latest command [s] at which it stands, as the controllers of ROS do."""
ODOMETRY, TWIST = "nav_msgs/msg/Odometry", "geometry_msgs/msg/Twist"


class SimulatedRobot:
    """A base that follows guarded velocities in real time and sends its odometry, in a thread of its own.

    It stands in for one real robot; the origin of its odometry is its start.

    >>> SimulatedRobot().name
    'simulated'
    """

    name = "simulated"

    def __init__(self) -> None:
        self.pose = (0.0, 0.0, 0.0)
        """Pose in the frame of its odometry [m], [rad]."""
        self._inbox: Inbox | None = None
        self._command = self._odometry = ""
        self._twist, self._heard = (0.0, 0.0, 0.0), -math.inf
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    @classmethod
    def of(cls, address: str) -> SimulatedRobot:
        """Return the robot; it has no address.

        Raises:
            InputError: an address is given.
        """
        if address:
            raise InputError(f"bridge 'simulated' has no address, not {address[:40]!r}")
        return cls()

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Begin to drive, or take the topics of another trial.

        Raises:
            InputError: no real robot is expected: the trial has no robot that one takes the place of.
        """
        inputs = [one.name for one in interface.inputs if ODOMETRY in one.kinds]
        outputs = [one.name for one in interface.outputs if one.kind == TWIST]
        if not inputs or not outputs:
            raise InputError("bridge 'simulated' takes the place of a real robot: use crowdbot join, or \"real-robot\"")
        self._inbox, self._odometry, self._command = inbox, inputs[0], outputs[0]
        if self._thread is None:
            self._thread = threading.Thread(target=self._drive, name="crowdbot-simulated-robot", daemon=True)
            self._thread.start()

    def _drive(self) -> None:
        last = time.monotonic()
        while not self._ended.wait(PERIOD):
            now = time.monotonic()
            self.pose = self._moved(now - last, now)
            last = now
            if self._inbox is not None:
                self._inbox.receive(self._odometry, odometry_fields(*self.pose), self.name)

    def _moved(self, dt: float, now: float) -> tuple[float, float, float]:
        forward, left, turn = self._twist if now - self._heard < SILENCE else (0.0, 0.0, 0.0)
        x, y, heading = self.pose
        middle = heading + 0.5 * dt * turn
        cos, sin = math.cos(middle), math.sin(middle)
        return x + dt * (cos * forward - sin * left), y + dt * (sin * forward + cos * left), heading + dt * turn

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Follow the latest velocity."""
        for one in messages:
            if one.topic == self._command:
                linear, angular = one.message.linear, one.message.angular
                self._twist, self._heard = (linear.x, linear.y, angular.z), time.monotonic()

    def poll(self) -> None:
        """Do nothing: its thread gives the odometry."""

    def report(self, level: str, text: str) -> None:
        """Do nothing: it has no screen."""

    def wants(self, topic: str) -> bool:
        """Return whether a topic is the velocity for it."""
        return topic == self._command

    def stop(self) -> None:
        """End the thread."""
        self._ended.set()
        if self._thread is not None:
            self._thread.join(2.0)


def odometry_fields(x: float, y: float, heading: float) -> dict[str, Any]:
    """Return the fields of ``nav_msgs/Odometry`` that hold a pose."""
    turn = {"x": 0.0, "y": 0.0, "z": math.sin(heading / 2.0), "w": math.cos(heading / 2.0)}
    return {"pose": {"pose": {"position": {"x": x, "y": y, "z": 0.0}, "orientation": turn}}}
