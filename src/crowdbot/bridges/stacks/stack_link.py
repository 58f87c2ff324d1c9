"""StackLink: the connection between a run and the robot software that drives its robots, step by step."""

from __future__ import annotations

import atexit
import math
import os
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from crowdbot.bridges.instant_repeat import InstantRepeat
from crowdbot.bridges.ros2.domain_lock import lock_domain
from crowdbot.bridges.transport import Transport
from crowdbot.bridges.transports import open_transport
from crowdbot.core import InputError
from crowdbot.navigation import Ros2Navigator, RosbridgeNavigator
from crowdbot.simulation import Order, RobotControl, Simulation, VelocityOrder

from .stack_port import StackPort
from .stack_program import StackProgram

StackNavigator = RosbridgeNavigator | Ros2Navigator
LOOK = 0.02
"""Longest real time [s] between two looks at the program."""
ENDING = 1.0
"""Real time [s] in which a program that has disconnected may end; then its exit status is told."""


class StackLink:
    """Brings the commands of a robot software into a run, as an :class:`crowdbot.simulation.OrderSource`.

    At each step it sends the messages of a bridge. At each control period of a robot it waits for a velocity command
    that comes after them; commands in between are dropped, so that the result does not depend on when they come.

    Args:
        navigator: the navigator of the robots.
        robots: names of the robots.
        simulation: a simulation of one environment.

    Attributes:
        seconds: compute time of each decision [s], from the messages of an instant to the command.
    """

    def __init__(self, navigator: StackNavigator, robots: Sequence[str], simulation: Simulation) -> None:
        self.navigator, self.robots = navigator, tuple(robots)
        self.seconds: list[float] = []
        self._release: Callable[[], None] = _do_nothing
        self._program: StackProgram | None = None
        self._transport, places, environment = self._open_transport()
        self._port = StackPort(simulation.trial, [self._transport], robots, navigator.truth)
        self._begun = self._closed = False
        self._held = ""
        try:
            self._port.start()
            if isinstance(navigator, RosbridgeNavigator):
                places["port"] = getattr(self._transport, "port", 0)
            if navigator.command:
                self._program = StackProgram(navigator.command, places, environment)
        except BaseException:
            self.disconnect()
            raise

    def begin(self, simulation: Simulation) -> None:
        """Prepare another run over the same connection."""
        self._port.change_trial(simulation.trial)
        self._begun, self.seconds = False, []

    def _open_transport(self) -> tuple[Transport, dict[str, object], dict[str, str]]:
        """Return the connection, the values for the command, and the variables of the environment."""
        navigator = self.navigator
        if isinstance(navigator, RosbridgeNavigator):
            port = navigator.port if navigator.port or navigator.command else 9090
            return open_transport(f"rosbridge:{port}"), {}, {}
        domain = navigator.domain
        if domain < 0 and navigator.command:
            domain, self._release = lock_domain()
        if domain < 0:
            return open_transport("ros2"), {"domain": os.environ.get("ROS_DOMAIN_ID", "0")}, {}
        return open_transport(f"ros2:{domain}"), {"domain": domain}, {"ROS_DOMAIN_ID": str(domain)}

    def orders(self, simulation: Simulation) -> list[Order]:
        """Send the current instant, and return the commands that answer it.

        Raises:
            InputError: the program has ended, is not connected any more, or does not answer.
        """
        ended = bool(simulation.may_end()[0])
        controls = [one for one in simulation.robots if one.robot.name in self.robots]
        due = [one for one in controls if not ended and not one.arrived[0] and _is_due(one, simulation)]
        kept = [one for one in self._port.take_orders(simulation) if not hasattr(one, "forward")]
        if not self._begun:
            self._begun = True
            self._port.begin(simulation)
            self._wait_for_start(simulation, {one.robot.name for one in due})
        else:
            self._port.publish(simulation)
            self._wait(simulation, due)
        found = [*kept, *self._port.take_orders(simulation)]
        found = [one for one in found if not self._is_dropped(one, due, simulation)]
        if not self._held:
            return found
        stops = [VelocityOrder(robot=one.robot.name, source=self._transport.name) for one in controls]
        return [*(one for one in found if not isinstance(one, VelocityOrder)), *stops]

    def hold(self, stop: bool, reason: str) -> str:
        """Replace the velocities of the program by 0, or use them again; it goes on deciding meanwhile."""
        self._held = reason if stop else ""
        return ""

    def problems(self) -> list[str]:
        """Return nothing: the run fails with the program."""
        return []

    def _is_dropped(self, order: Order, due: Sequence[RobotControl], simulation: Simulation) -> bool:
        """Return whether a velocity command comes between two decisions, or after the deadline."""
        if not hasattr(order, "forward"):
            return False
        control = next((one for one in due if one.robot.name == getattr(order, "robot", "")), None)
        return control is None or int(control.timer.missed[0]) == int(simulation.ticks[0])

    def _wait_for_start(self, simulation: Simulation, names: set[str]) -> None:
        """Wait for the first commands; programs that connect later get the first instant again."""
        inbox, begin, repeat = self._port.inbox, time.perf_counter(), InstantRepeat()
        repeat.begin(self._port.is_heard, inbox.count.velocities, len(names), unasked=True)
        while names - inbox.commanded or not repeat.is_settled(inbox.count.velocities):
            self._check(began=False)
            if names - inbox.commanded:
                if time.perf_counter() - begin > self.navigator.start:
                    raise InputError(self._failure(f"did not send a command within {self.navigator.start:g} s"))
                if repeat.must_send(self._port.is_heard):
                    self._port.publish(simulation)
            self._port.serve(simulation)
            inbox.wait(LOOK)
        self.seconds.append(math.nan)  # it connects and loads its parts

    def _wait(self, simulation: Simulation, due: Sequence[RobotControl]) -> None:
        """Wait for a command for each robot, and note those that come after its deadline."""
        inbox, begin = self._port.inbox, time.perf_counter()
        missing = {one.robot.name: one for one in due}
        while missing:
            for name in [name for name in missing if name in inbox.commanded]:
                control, spent = missing.pop(name), time.perf_counter() - begin
                self.seconds.append(spent)
                control.timer.spent[0] += (spent,)
                if control.robot.deadline is not None and spent > control.robot.deadline:
                    control.timer.missed[0] = simulation.ticks[0]
            if not missing:
                return
            self._check(began=True)
            if time.perf_counter() - begin > self.navigator.answer:
                raise InputError(self._failure(f"did not answer within {self.navigator.answer:g} s"))
            self._port.serve(simulation)
            inbox.wait(LOOK)

    def _check(self, began: bool) -> None:
        """Raise :class:`InputError` if nobody can answer any more."""
        if self._program is not None and not self._program.is_alive:
            raise InputError(self._failure("has ended"))
        topics = [f"/{name}/" for name in self.robots]
        if began and not any(self._transport.wants(topic) for topic in topics):
            if self._program is not None and self._program.wait(ENDING) is not None:
                raise InputError(self._failure("has ended"))
            raise InputError(self._failure("has disconnected"))

    def _failure(self, what: str) -> str:
        program = self._program
        return f"{self.navigator.title()}: its program {what} {program.ending if program else ''}".strip()

    def close(self) -> None:
        """End the run: end the program that was started for it; a program that connects by itself stays connected."""
        if self.navigator.command:
            self.disconnect()

    def disconnect(self) -> None:
        """End the program and the connection."""
        if self._closed:
            return
        self._closed = True
        if self._program is not None:
            self._program.close()
        self._port.stop()
        self._release()

    @property
    def summary(self) -> tuple[int, float, float]:
        """Number of measured decisions, and median and 99th percentile of their compute times [s]."""
        known = [one for one in self.seconds if not math.isnan(one)]
        if not known:
            return 0, math.nan, math.nan
        return len(known), float(np.median(known)), float(np.percentile(known, 99))


def _do_nothing() -> None:
    return


def _is_due(control: RobotControl, simulation: Simulation) -> bool:
    schedule = simulation.world.clock.schedule(control.robot.control_period)
    return bool(schedule.is_due(simulation.ticks)[0])


_OPEN: dict[tuple[int, StackNavigator, tuple[str, ...]], StackLink] = {}


def open_stack(navigator: Any, robots: Sequence[str], simulation: Simulation) -> StackLink:
    """Return the link of a run to the software of its robots; a program without a command keeps its connection.

    Args:
        navigator: ``RosbridgeNavigator`` or ``Ros2Navigator``.
        robots: names of the robots that it drives.
        simulation: a simulation of one environment.

    Raises:
        InputError: the connection cannot be opened, or the program cannot be started.

    >>> from crowdbot.navigation import RosbridgeNavigator
    >>> from crowdbot.trials import load_trial
    >>> simulation = Simulation(load_trial("frontal"), 0)
    >>> link = open_stack(RosbridgeNavigator(command="sleep 60"), ["robot"], simulation)
    >>> link.close()
    """
    if navigator.command:
        return StackLink(navigator, robots, simulation)
    key = (os.getpid(), navigator, tuple(robots))
    if key not in _OPEN:
        _OPEN[key] = StackLink(navigator, robots, simulation)
    else:
        _OPEN[key].begin(simulation)
    return _OPEN[key]


def close_stacks() -> None:
    """Close the connections of this process that wait for another run."""
    for key in [key for key in _OPEN if key[0] == os.getpid()]:
        _OPEN.pop(key).disconnect()


atexit.register(close_stacks)
