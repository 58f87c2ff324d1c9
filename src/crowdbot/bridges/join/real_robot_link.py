"""RealRobotLink: connects a run to a real robot that takes the place of its robot, or to a simulated one."""

from __future__ import annotations

import contextlib
import math
import threading
import time
from collections.abc import Sequence
from typing import Any

from crowdbot import navigation
from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.bridges.run_control import Pace
from crowdbot.bridges.transport import Transport, open_transport
from crowdbot.core import InputError, Twist, find_class, from_attributes
from crowdbot.navigation import ExternalNavigator, Navigator, RealRobotNavigator
from crowdbot.recording import StepMessage
from crowdbot.simulation import JointOrder, Order, OrderSource, RobotPoseOrder, Simulation, VelocityOrder

from .command_guard import CommandGuard, DrivingArea, GuardLimits
from .join_run import PERIOD, JoinPort

EVERYWHERE = DrivingArea(-1e6, -1e6, 1e6, 1e6)
"""Area of a simulated robot without one."""
LOOK = 0.02
"""Real time [s] between two looks for the first pose."""


class RealRobotLink:
    """Brings the poses of a real robot into a run, as an :class:`crowdbot.simulation.OwnSource`.

    Steps wait for real time. A thread lets guarded commands leave, at least 20 times a second, also while the run is
    paused: without steps the latest wanted velocity becomes too old, and the robot stands.

    Args:
        navigator: the navigator of the robot.
        robot: name of the robot.
        simulation: a simulation of one environment.
        transports: connections (default: those of the navigator).

    Raises:
        InputError: a connection cannot be opened, or the driver does not exist.
    """

    def __init__(
        self,
        navigator: RealRobotNavigator,
        robot: str,
        simulation: Simulation,
        transports: Sequence[Transport] | None = None,
    ) -> None:
        self.navigator, self.robot = navigator, robot
        self.remarks: list[str] = []
        """What the guard has said, such as why the robot was stopped."""
        self._driver = _driver(navigator)
        self._memory: tuple[Any, ...] = ()
        self._lock, self._ended = threading.RLock(), threading.Event()
        self._pace = Pace(simulation.trial.step, 1.0)
        self._latest = -math.inf
        self._begun = False
        self._capture: OrderSource | None = None
        self._simulation: Simulation | None = None
        spec = next(item for item in simulation.trial.robots if item.name == robot)
        limits = GuardLimits(
            navigator.max_speed, navigator.max_turn, navigator.max_acceleration, navigator.max_turn_acceleration,
            navigator.link_timeout, navigator.timeout,
        )  # fmt: skip
        area = DrivingArea.of(navigator.area) if navigator.area else EVERYWHERE
        opened = [open_transport(item) for item in navigator.bridge.split()] if transports is None else transports
        self.port = JoinPort(
            simulation.trial, opened, spec, CommandGuard(area, limits), navigator.odometry, navigator.command,
            self.remarks.append,
        )  # fmt: skip
        self._thread = threading.Thread(target=self._keep_alive, name=f"crowdbot-{robot}", daemon=True)
        try:
            self.port.start()
        except BaseException:
            self.close()
            raise
        self._thread.start()

    def orders(self, simulation: Simulation) -> list[Order]:
        """Send the current instant, let a command leave, and return the pose of the robot.

        Raises:
            InputError: no pose comes.
        """
        self._simulation = simulation
        if not self._begun:
            self._begin(simulation)
        else:
            while (wait := self._pace.wait_time()) > 0.0:
                time.sleep(min(wait, LOOK))
            self._pace.note_step()
        with self._lock:
            now = time.monotonic()
            if now - self._latest > self.navigator.timeout:
                self.port.inbox.take_orders()  # wanted before a pause
            self._latest = now
            self._track()
            self.port.publish(simulation)
            if not self.navigator.odometry:
                return self._velocities(simulation)
            self._decide(simulation)
            self.port.serve(simulation)
            found = self.port.take_orders(simulation)
        kinds = (RobotPoseOrder, JointOrder)
        return [one for one in found if isinstance(one, kinds) and one.robot == self.robot]

    def _begin(self, simulation: Simulation) -> None:
        with self._lock:
            self.port.begin(simulation)
        end = time.monotonic() + self.navigator.start
        while self.navigator.odometry and not self.port.has_pose:
            if time.monotonic() > end:
                raise InputError(
                    f"robot {self.robot!r}: no pose came on {self.navigator.odometry} within {self.navigator.start:g} s"
                )
            time.sleep(LOOK)
            with self._lock:
                self._track()
        self._begun, self._latest = True, time.monotonic()
        self._pace.restart()

    def _velocities(self, simulation: Simulation) -> list[Order]:
        """Return the velocity that the robot tells; 0 while it is stopped here."""
        for transport in self.port.transports:
            transport.poll()
        found = [order for order in self.port.inbox.take_orders() if isinstance(order, VelocityOrder)]
        return [one for one in found if one.robot == self.robot]

    def _decide(self, simulation: Simulation) -> None:
        """Let the driver decide at its control period."""
        control = next((robot for robot in simulation.robots if robot.robot.name == self.robot), None)
        if self._driver is None or control is None:
            return
        due = simulation.world.clock.schedule(control.robot.control_period).is_due(simulation.ticks)
        if not bool(due[0]) or bool(simulation.may_end()[0]):
            return
        seen = simulation.observation(self.robot)
        if not self._memory:
            self._memory = (self._driver.begin(seen),)
        action, memory = self._driver.decide(seen, *self._memory)
        self._memory = (memory,)
        forward, turn, left = action.twist
        self.port.want(Twist(float(forward), float(turn), float(left)))

    def _keep_alive(self) -> None:
        """Let commands leave while no steps are taken, and hear the robot."""
        while not self._ended.wait(PERIOD):
            with self._lock, contextlib.suppress(InputError):
                for transport in self.port.transports:
                    transport.poll()
                if self.navigator.odometry and not self._ended.is_set():
                    self._track()
                    self.port.send_command(0)

    def use_capture(self, capture: OrderSource) -> None:
        """Take the poses of the robot from motion capture, and ignore its odometry, from now on."""
        with self._lock:
            self._capture, self.port.tracked = capture, True

    def _track(self) -> None:
        """Take the newest pose of motion capture, also while the run is paused."""
        if self._capture is None or self._simulation is None:
            return
        for order in self._capture.orders(self._simulation):
            if isinstance(order, RobotPoseOrder) and order.robot == self.robot:
                self.port.note_pose(order.x, order.y, order.heading)

    def hold(self, stop: bool, reason: str) -> str:
        """Stop the robot at once, or release it; return why it is not released."""
        if not self.navigator.odometry:
            return f"robot {self.robot!r} drives itself: stop it at itself" if stop else ""
        problem = self.port.request_stop(stop, reason)
        if stop:
            with self._lock:
                self.port.send_command(0)
        return problem

    def problems(self) -> list[str]:
        """Return why the robot is stopped."""
        reason = self.port.guard.reason
        return [f"robot {self.robot!r} is stopped: {reason}"] if reason else []

    def close(self) -> None:
        """Let the robot stand and close the connections; without effect the second time."""
        if self._ended.is_set():
            return
        self._ended.set()
        with self._lock:
            if self._thread.ident is not None:
                self.port.stop()
                return
            for transport in self.port.transports:  # one of them could not be opened
                transport.stop()


def _driver(navigator: RealRobotNavigator) -> Navigator | None:
    if not navigator.driver:
        return None
    kind = find_class(navigator.driver, navigation, Navigator, trust=False)
    if issubclass(kind, ExternalNavigator):
        raise InputError(f"RealRobotNavigator: driver {navigator.driver!r} decides nothing; name another navigator")
    values = dict(word.split("=", 1) for word in navigator.parameters.split())
    attributes: Navigator = from_attributes(kind, values, "RealRobotNavigator: parameters")
    return attributes


def open_real_robot(navigator: Any, robots: Sequence[str], simulation: Simulation) -> RealRobotLink:
    """Return the link of a run to a real robot.

    Args:
        navigator: ``RealRobotNavigator``.
        robots: the name of the robot.
        simulation: a simulation of one environment.

    Raises:
        InputError: several robots share the navigator, or the connection cannot be opened.

    >>> import dataclasses
    >>> from crowdbot.trials import load_trial
    >>> trial = load_trial("frontal")
    >>> robot = dataclasses.replace(trial.robots[0], navigator=RealRobotNavigator(driver="straight"))
    >>> simulation = Simulation(dataclasses.replace(trial, robots=(robot,)), 0)
    >>> link = open_real_robot(robot.navigator, ["robot"], simulation)
    >>> link.hold(True, "the operator"), link.problems()
    ('', ["robot 'robot' is stopped: the operator"])
    >>> link.close()
    """
    if len(robots) != 1:
        names = ", ".join(map(repr, robots))
        raise InputError(f"robots {names} have the same bridge {navigator.bridge!r}; each real robot needs one")
    return RealRobotLink(navigator, robots[0], simulation)


TRANSPORT_PERIOD = 0.02
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
        inputs = [input_topic.name for input_topic in interface.inputs if ODOMETRY in input_topic.kinds]
        outputs = [output.name for output in interface.outputs if output.kind == TWIST]
        if not inputs or not outputs:
            raise InputError("bridge 'simulated' takes the place of a real robot: use crowdbot join, or \"real-robot\"")
        self._inbox, self._odometry, self._command = inbox, inputs[0], outputs[0]
        if self._thread is None:
            self._thread = threading.Thread(target=self._drive, name="crowdbot-simulated-robot", daemon=True)
            self._thread.start()

    def _drive(self) -> None:
        last = time.monotonic()
        while not self._ended.wait(TRANSPORT_PERIOD):
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
        for message in messages:
            if message.topic == self._command:
                linear, angular = message.message.linear, message.message.angular
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
