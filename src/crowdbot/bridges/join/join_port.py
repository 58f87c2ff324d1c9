"""JoinPort: the port of a trial in which a real robot drives."""

from __future__ import annotations

import dataclasses
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from crowdbot.bridges.interface import OutputTopic, RobotInterface
from crowdbot.bridges.port import BridgePort
from crowdbot.bridges.quality import COMMAND, SENSOR
from crowdbot.bridges.transport import Transport
from crowdbot.core import InputError, Twist
from crowdbot.messages import Messages
from crowdbot.recording import StepMessage
from crowdbot.simulation import Order, OrderSource, RobotPoseOrder, Simulation, VelocityOrder
from crowdbot.trials import RobotSpec, Trial

from .command_guard import CommandGuard
from .robot_input import OdometryInput, StartAlignment, StopInput

TWIST = "geometry_msgs/msg/Twist"
PERIOD = 0.05
"""Longest real time [s] between two commands that leave: the robot hears that its guard is alive."""
MOST = 100_000


class JoinLatency(NamedTuple):
    """Real times of a run with a real robot.

    Fields:
        poses: number of poses of the robot.
        pose_age: median and 99th percentile of their age when a step uses them [s].
        commands: number of wanted commands.
        command_delay: median and 99th percentile of the time from a wanted command to what leaves [s].
    """

    poses: int
    pose_age: tuple[float, float]
    commands: int
    command_delay: tuple[float, float]


class JoinPort(BridgePort):
    """Takes the odometry of a real robot, and sends it guarded commands, besides the topics of a bridge.

    Args:
        trial: a trial whose robot has ``<pose source="external"/>``.
        transports: connections to the robot and its software.
        robot: the robot.
        guard: emergency stop and limits.
        odometry: topic of ``nav_msgs/Odometry``; empty: orders of another source move the robot.
        command: topic on which the guarded velocity leaves.
        note: receives remarks for people, such as why the robot is stopped.
        monotonic: source of real time [s].
    """

    def __init__(
        self,
        trial: Trial,
        transports: Sequence[Transport],
        robot: RobotSpec,
        guard: CommandGuard,
        odometry: str,
        command: str,
        note: Callable[[str], None],
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        self.robot, self.guard, self.odometry, self.command = robot, guard, odometry, command
        self.note, self.monotonic = note, monotonic
        self.captures: Sequence[OrderSource] = ()
        """Motion capture that gives poses to :meth:`note_pose` when it is asked for its orders."""
        self.tracked = False
        """Whether motion capture gives the pose, and odometry is ignored."""
        self._frame = StartAlignment(robot.x, robot.y, robot.heading)
        self._lock = threading.Lock()
        self._latest: tuple[float, tuple[float, float, float]] | None = None
        self._next = 0.0
        self._ages: deque[float] = deque(maxlen=MOST)
        self._delays: deque[float] = deque(maxlen=MOST)
        self._told = ""
        self._make = Messages()
        super().__init__(trial, transports)

    def describe(self, trial: Trial) -> RobotInterface:
        """Return the topics of a bridge, with those of the real robot."""
        whole, name = RobotInterface.of(trial), self.robot.name
        stop = StopInput(f"/{name}/stop", ("std_msgs/msg/Bool",), name, COMMAND, "emergency stop", self._take_stop)
        inputs = [*whole.inputs, stop]
        if self.odometry:
            kinds = ("nav_msgs/msg/Odometry",)
            inputs.append(OdometryInput(self.odometry, kinds, name, SENSOR, "odometry", self._take_pose))
        guarded = OutputTopic(self.command, TWIST, "", 1.0 / PERIOD, COMMAND, name, "guarded velocity")
        taken = {one.name for one in inputs} | {guarded.name}
        if self.command in {one.name for one in inputs}:
            raise InputError(f"{self.command} is an input; take another topic for the commands to the robot")
        outputs = tuple(one for one in whole.outputs if one.name not in taken)
        return dataclasses.replace(whole, outputs=(*outputs, guarded), inputs=tuple(inputs), services=())

    def _take_pose(self, x: float, y: float, heading: float) -> None:
        """Keep a pose of the odometry; runs in the thread of a transport."""
        if self.tracked:
            return
        with self._lock:
            self.note_pose(*self._frame.pose(x, y, heading))

    def note_pose(self, x: float, y: float, heading: float) -> None:
        """Keep a pose in the frame of the trial."""
        now = self.monotonic()
        self._latest = (now, (x, y, heading))
        self.guard.note_pose(x, y, heading, now)

    @property
    def has_pose(self) -> bool:
        """Whether a pose of the robot has come."""
        return self.guard.has_pose

    def want(self, twist: Twist) -> None:
        """Take a wanted velocity from this program."""
        with self._lock:
            self.guard.note_command(twist, self.monotonic())
        self._next = 0.0

    def _take_stop(self, stop: bool) -> None:
        """Stop or release; runs in the thread of a transport."""
        self.request_stop(stop, "a stop message")

    def request_stop(self, stop: bool, reason: str) -> str:
        """Stop the robot, or release it, from any thread; return why it is not released."""
        with self._lock:
            if not stop:
                return self.guard.release(self.monotonic())
            self.guard.stop(reason)
            self._next = 0.0
        self.inbox.wake()
        return ""

    def begin(self, simulation: Simulation) -> None:
        """Send the first instant, then ask motion capture again: the poses of before are as old as this has taken."""
        super().begin(simulation)
        for one in self.captures:
            one.orders(simulation)

    def serve(self, simulation: Simulation) -> None:
        """Let commands leave, in every round of the loop."""
        super().serve(simulation)
        wanted: list[VelocityOrder] = []
        for one in self.inbox.take_orders():
            if isinstance(one, VelocityOrder) and one.robot == self.robot.name:
                wanted.append(one)
            else:
                self.inbox.add(one)
        now = self.monotonic()
        with self._lock:
            for one in wanted:
                self.guard.note_command(Twist(one.forward, one.turn, one.left), now)
        if wanted or now >= self._next:
            self.send_command(simulation.world.clock.nanoseconds)
            self._delays.extend([self.monotonic() - now] * len(wanted))

    def send_command(self, nanoseconds: int) -> None:
        """Send what may leave now."""
        now = self.monotonic()
        with self._lock:
            twist = self.guard.next_command(now)
        self._next = now + PERIOD
        fields = (("x", twist.forward), ("y", twist.left), ("z", 0.0))
        linear = self._make.make("geometry_msgs/msg/Vector3", **dict(fields))
        angular = self._make.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=twist.turn)
        message = self._make.make(TWIST, linear=linear, angular=angular)
        self._send([StepMessage(self.command, TWIST, nanoseconds, self._make, message)])
        if self.guard.reason != self._told:
            self._told = self.guard.reason
            text = f"robot {self.robot.name!r} is stopped: {self._told}" if self._told else "the robot may drive"
            self.report("warning", text)
            self.note(text)

    def take_orders(self, simulation: Simulation) -> list[Order]:
        """Return the orders for the current instant, with the pose of the robot."""
        found = super().take_orders(simulation)
        with self._lock:
            latest, self._latest = self._latest, None
        if latest is None or not self.odometry:
            return found
        age = self.monotonic() - latest[0]
        self._ages.append(age)
        now = float(simulation.world.times[0])
        (x, y, heading), when = latest[1], round(max(0.0, now - age), 6)
        return [*found, RobotPoseOrder(robot=self.robot.name, time=when, x=x, y=y, heading=heading, source="join")]

    def stop(self) -> None:
        """Let the robot stand, and close all transports."""
        with self._lock:
            self.guard.stop("the run has ended")
        self.send_command(0)
        super().stop()

    @property
    def latency(self) -> JoinLatency:
        """Real times until now."""
        return JoinLatency(len(self._ages), _quantiles(self._ages), len(self._delays), _quantiles(self._delays))


def _quantiles(found: Sequence[float]) -> tuple[float, float]:
    if not found:
        return float("nan"), float("nan")
    return float(np.median(found)), float(np.percentile(found, 99))
