"""JoinRun: a trial in real time in which a real robot drives among simulated people; its port and inputs."""

from __future__ import annotations

import dataclasses
import math
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crowdbot.bridges.bridge_run import BridgeRun
from crowdbot.bridges.interface import (
    COMMAND,
    SENSOR,
    InputTopic,
    OutputTopic,
    Request,
    RobotInterface,
    read_heading,
    read_point,
)
from crowdbot.bridges.port import BridgePort
from crowdbot.bridges.run_control import BridgeClock
from crowdbot.bridges.transport import Transport
from crowdbot.core import InputError, Twist, did_you_mean, wrap_angle
from crowdbot.messages import Messages
from crowdbot.navigation import ExternalNavigator
from crowdbot.recording import StepMessage
from crowdbot.simulation import Order, OrderSource, RobotPoseOrder, RunSummary, Simulation, VelocityOrder
from crowdbot.trials import RobotPose, RobotSpec, Trial

from .command_guard import CommandGuard


@dataclass(frozen=True)
class OdometryInput(InputTopic):
    """A topic with ``nav_msgs/Odometry``; its poses go to ``take``, in the thread of the transport."""

    take: Callable[[float, float, float], None] = lambda x, y, heading: None

    def requests(self, fields: Mapping[str, Any], sender: str = "") -> list[Request]:
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

    def requests(self, fields: Mapping[str, Any], sender: str = "") -> list[Request]:
        # give the value to take; it gives no order. What is not plainly false stops
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
        whole, name = RobotInterface.of(trial), self.robot.name
        stop = StopInput(f"/{name}/stop", ("std_msgs/msg/Bool",), name, COMMAND, "emergency stop", self._take_stop)
        inputs = [*whole.inputs, stop]
        if self.odometry:
            kinds = ("nav_msgs/msg/Odometry",)
            inputs.append(OdometryInput(self.odometry, kinds, name, SENSOR, "odometry", self._take_pose))
        guarded = OutputTopic(self.command, TWIST, "", 1.0 / PERIOD, COMMAND, name, "guarded velocity")
        taken = {input_topic.name for input_topic in inputs} | {guarded.name}
        if self.command in {input_topic.name for input_topic in inputs}:
            raise InputError(f"{self.command} is an input; take another topic for the commands to the robot")
        outputs = tuple(output for output in whole.outputs if output.name not in taken)
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
        # send the first instant, then ask motion capture again: the poses of before are as old as this has taken
        super().begin(simulation)
        for capture in self.captures:
            capture.orders(simulation)

    def serve(self, simulation: Simulation) -> None:
        super().serve(simulation)
        wanted: list[VelocityOrder] = []
        for order in self.inbox.take_orders():
            if isinstance(order, VelocityOrder) and order.robot == self.robot.name:
                wanted.append(order)
            else:
                self.inbox.add(order)
        now = self.monotonic()
        with self._lock:
            for item in wanted:
                self.guard.note_command(Twist(item.forward, item.turn, item.left), now)
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
        problem = f"is stopped: {self.guard.reason}" if self.guard.reason else ""
        if self.guard.waits:
            problem = f"stands: no pose has come on {self.odometry or 'its motion capture'} yet"
        if problem != self._told:
            self._told = problem
            text = f"robot {self.robot.name!r} {problem}" if problem else "the robot may drive"
            self.report("warning", text)
            self.note(text)

    def take_orders(self, simulation: Simulation) -> list[Order]:
        orders = super().take_orders(simulation)
        with self._lock:
            latest, self._latest = self._latest, None
        if latest is None or not self.odometry:
            return orders
        age = self.monotonic() - latest[0]
        self._ages.append(age)
        now = float(simulation.world.times[0])
        (x, y, heading), when = latest[1], round(max(0.0, now - age), 6)
        return [*orders, RobotPoseOrder(robot=self.robot.name, time=when, x=x, y=y, heading=heading, source="join")]

    def stop(self) -> None:
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


def joined_trial(trial: Trial, robot: str = "") -> Trial:
    """Return the trial with a robot that a real one moves.

    Args:
        trial: the trial.
        robot: name of the robot; empty: the only one.

    Raises:
        InputError: there is no such robot, or several and none is named.

    >>> from crowdbot.trials import load_trial
    >>> joined_trial(load_trial("frontal")).robots[0].pose.source
    'external'
    """
    names = [robot.name for robot in trial.robots]
    if not robot and len(names) != 1:
        raise InputError(f"trial {trial.name!r} has {len(names)} robots; name one of {', '.join(names) or 'none'}")
    chosen = robot or names[0]
    if chosen not in names:
        raise InputError(f"trial {trial.name!r} has no robot {chosen!r}{did_you_mean(chosen, names)}")
    pose = RobotPose(source="external")
    changes: dict[str, Any] = {"navigator": ExternalNavigator(), "pose": pose, "safety": None, "deadline": None}
    robots = tuple(dataclasses.replace(robot, **changes) if robot.name == chosen else robot for robot in trial.robots)
    return dataclasses.replace(trial, robots=robots)


class _Watch:
    """Passes on the orders of a source, and notes the poses of the robot in them."""

    def __init__(self, source: OrderSource, port: JoinPort) -> None:
        self.source, self.port = source, port

    def orders(self, simulation: Any) -> list[Order]:
        """Return the orders of the source."""
        result = list(self.source.orders(simulation))
        for item in result:
            if isinstance(item, RobotPoseOrder) and item.robot == self.port.robot.name:
                self.port.note_pose(item.x, item.y, item.heading)
        return result


class JoinRun:
    """Runs a trial in real time with a real robot, see :class:`JoinPort`.

    Args:
        trial: the trial, see :func:`joined_trial`.
        transports: connections to the robot and its software.
        guard: emergency stop and limits.
        robot: name of the robot; empty: the only one.
        odometry, command: topics of the real robot.
        seed, out, force, note: as in :func:`crowdbot.bridges.run_bridge`.
        sources: motion capture that moves the robot, instead of its odometry, or people.

    Raises:
        InputError: the robot does not exist.
    """

    def __init__(
        self,
        trial: Trial,
        transports: Sequence[Transport],
        guard: CommandGuard,
        robot: str = "",
        odometry: str = "/odom",
        command: str = "/cmd_vel",
        seed: int | None = None,
        out: Path | str | None = None,
        force: bool = False,
        note: Callable[[str], None] | None = None,
        sources: Sequence[OrderSource] = (),
    ) -> None:
        trial = joined_trial(trial, robot)
        spec = next(item for item in trial.robots if item.name == (robot or trial.robots[0].name))
        port = JoinPort(trial, transports, spec, guard, odometry, command, note or (lambda text: None))
        port.captures = [_Watch(source, port) for source in sources]
        self.port = port
        self._bridge = BridgeRun(trial, transports, seed, out, BridgeClock(), force, note, port.captures, port)

    def run(self) -> RunSummary:
        """Run until the trial ends, or Ctrl-C."""
        return self._bridge.run()

    def remarks(self) -> list[str]:
        """Return lines for people: latencies and stops."""
        known, guard = self.port.latency, self.port.guard
        found = [
            f"{known.poses} poses of the robot, age median {1e3 * known.pose_age[0]:.1f} ms, p99"
            f" {1e3 * known.pose_age[1]:.1f} ms" if known.poses else "no odometry of the robot",
            f"{known.commands} commands passed on after {1e3 * known.command_delay[0]:.2f} ms (median),"
            f" {1e3 * known.command_delay[1]:.2f} ms (99 %)" if known.commands else "no commands",
        ]  # fmt: skip
        return found + [f"stopped: {stop}" for stop in guard.stops if stop != "the run has ended"]
