"""StackLink: robot software in processes of its own that drives the robots of a trial, step by step."""

from __future__ import annotations

import atexit
import contextlib
import dataclasses
import math
import os
import shlex
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np

from crowdbot.bridges.interface import LATCHED, OutputTopic, RobotInterface
from crowdbot.bridges.port import BridgePort
from crowdbot.bridges.run_control import InstantRepeat
from crowdbot.bridges.transport import Transport, is_among, open_transport
from crowdbot.core import InputError, check_programs, lock_file, refuse_system
from crowdbot.messages import MAP, Messages
from crowdbot.navigation import Ros2Navigator, RosbridgeNavigator
from crowdbot.recording import StepMessage
from crowdbot.simulation import Order, RobotControl, Simulation, VelocityOrder
from crowdbot.trials import Trial

DRIVEN = ("cmd_vel", "joint_command", "joint_trajectory")
"""Inputs of a robot that its software may use."""


GOAL = "geometry_msgs/msg/PoseStamped"


def _goal_topic(robot: str) -> OutputTopic:
    return OutputTopic(f"/{robot}/goal", GOAL, MAP, 0.0, LATCHED, robot, "goal")


class StackPort(BridgePort):
    """A port for the software of some robots of a trial.

    It offers the topics of these robots and of the scene that a real robot has, too
    (:attr:`~crowdbot.bridges.OutputTopic.truth`), and the goals. It takes velocities and joint targets only: no goals,
    no other orders, no services.

    Args:
        trial: the trial.
        transports: connections to the software.
        robots: names of its robots.
        truth: whether the topics with the truth are sent, too, and readings say which agent each beam met.

    >>> from crowdbot.trials import load_trial
    >>> port = StackPort(load_trial("frontal"), [], ["robot"])
    >>> [one.name for one in port.interface.inputs], port.interface.services
    (['/robot/cmd_vel'], ())
    """

    def __init__(
        self, trial: Trial, transports: Sequence[Transport], robots: Sequence[str], truth: bool = False
    ) -> None:
        self.robots, self.truth = tuple(robots), truth
        self.labelled = truth
        self._goals: dict[str, tuple[float, float]] = {}
        self._make = Messages()
        super().__init__(trial, transports)

    def describe(self, trial: Trial) -> RobotInterface:
        whole = RobotInterface.of(trial)
        inputs = tuple(
            input_topic
            for input_topic in whole.inputs
            if input_topic.robot in self.robots and input_topic.name.rpartition("/")[2] in DRIVEN
        )
        outputs = [*filter(self._offers, whole.outputs), *(_goal_topic(name) for name in self.robots)]
        actions = tuple(action for action in whole.actions if action.robot in self.robots)
        return dataclasses.replace(whole, outputs=tuple(outputs), inputs=inputs, services=(), actions=actions)

    def begin(self, simulation: Simulation) -> None:
        self._goals.clear()
        super().begin(simulation)

    def publish(self, simulation: Simulation) -> None:
        self._send(list(self._new_goals(simulation)))
        super().publish(simulation)

    def _new_goals(self, simulation: Simulation) -> Iterator[StepMessage]:
        make, now = self._make, simulation.world.clock.nanoseconds
        for control in simulation.robots:
            name, goal = control.robot.name, (float(control.goal[0, 0]), float(control.goal[0, 1]))
            if name in self.robots and self._goals.get(name) != goal:
                self._goals[name] = goal
                pose = make.make(GOAL, header=make.header(now), pose=make.pose(*goal, 0.0))
                yield StepMessage(f"/{name}/goal", GOAL, now, make, pose)

    def _offers(self, output_topic: OutputTopic) -> bool:
        """Return whether the software may see a topic: the one rule, for all transports."""
        return (self.truth or not output_topic.truth) and (not output_topic.robot or output_topic.robot in self.robots)

    def _send(self, messages: list[StepMessage]) -> None:
        """Send what the software may see; of the transforms those of its robots."""
        offered = {output.name for output in self.interface.outputs}
        super()._send([self._own(message) for message in messages if message.topic in offered])

    def _own(self, step_message: StepMessage) -> StepMessage:
        if step_message.topic != "/tf" or self.truth:
            return step_message
        rows = [row for row in step_message.message.transforms if row.child_frame_id.partition("/")[0] in self.robots]
        return dataclasses.replace(step_message, content=type(step_message.message)(transforms=rows))

    def _is_wanted(self, topic: str) -> bool:
        """Return whether the software subscribes a topic that it may have."""
        return is_among(topic, [output.name for output in self.interface.outputs]) and super()._is_wanted(topic)


PATIENCE = 3.0
"""Real time [s] between the request to end and the end by force."""
LAST_CHARACTERS = 500
"""Characters of the error output in a message."""


def _check_process_groups(what: str) -> None:
    """Raise InputError on Windows, where a program would end without the programs that it has started."""
    if sys.platform == "win32":
        refuse_system(f"the start of {what} by a run", "Linux or macOS", "start it yourself, and leave out command")


class StackProgram:
    """A program with its children, in a process group of its own.

    Args:
        command: program and arguments, as in a shell without its special characters.
        places: values of ``{port}`` and ``{domain}`` in the command.
        environment: variables in addition to those of this process.

    Raises:
        InputError: the program cannot be started, or the system is Windows, which has no process groups to end.

    >>> program = StackProgram("sh -c 'echo no map >&2; exit 3'", {}, {})
    >>> _ = program.wait(10.0)
    >>> program.ending
    '(exit status 3): no map'
    >>> program.close()
    """

    def __init__(self, command: str, places: Mapping[str, object], environment: Mapping[str, str]) -> None:
        check_programs(f"{command[:80]!r}")
        _check_process_groups(f"{command[:80]!r}")
        words = shlex.split(command)
        for name, value in places.items():
            words = [word.replace(f"{{{name}}}", str(value)) for word in words]
        self.name = words[0] if words else ""
        self._log: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 (closed by close())
        try:
            self._process = subprocess.Popen(  # noqa: S603 (the trial names the program)
                words,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=self._log,
                env=os.environ | dict(environment),
                start_new_session=True,
            )
        except (OSError, IndexError, ValueError) as error:
            self._log.close()
            reason = error.strerror if isinstance(error, OSError) else str(error)
            raise InputError(f"the program {command[:80]!r} cannot be started: {reason}") from None

    @property
    def is_alive(self) -> bool:
        """Whether the program runs."""
        return self._process.poll() is None

    def wait(self, seconds: float) -> int | None:
        """Wait for the end and return the exit status, None if it still runs."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            return self._process.wait(seconds)
        return None

    @property
    def ending(self) -> str:
        """Exit status and last line of the error output, for messages."""
        code = self._process.poll()
        end = self._log.seek(0, os.SEEK_END)
        self._log.seek(max(0, end - LAST_CHARACTERS))
        lines = [line.strip() for line in self._log.read().decode("utf-8", "replace").splitlines() if line.strip()]
        status = "" if code is None else (f"killed by signal {-code}" if code < 0 else f"exit status {code}")
        return f"({status})" * bool(status) + (f": {lines[-1]}" if lines else "")

    def close(self) -> None:
        """End the program and its children."""
        if self._log.closed:
            return
        self._end_group()
        if self.wait(PATIENCE) is None:
            self._end_group(by_force=True)
            self._process.wait()
        self._end_group(by_force=True)  # children that have ignored the request
        self._log.close()

    def _end_group(self, by_force: bool = False) -> None:
        if sys.platform != "win32":
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL if by_force else signal.SIGTERM)


FIRST_DOMAIN, LAST_DOMAIN = 101, 200
"""Domains that are given to runs; those below are left to people."""


def lock_domain() -> tuple[int, Callable[[], None]]:
    """Return a ROS domain that no other run on this computer has, and a function that releases it.

    Raises:
        InputError: all domains are in use.

    >>> first, release = lock_domain()
    >>> second, also = lock_domain()
    >>> first != second
    True
    >>> release(), also()
    (None, None)
    """
    for number in range(FIRST_DOMAIN, LAST_DOMAIN + 1):
        stream = os.fdopen(os.open(_lock_path(number), os.O_CREAT | os.O_RDWR, 0o600), "r+b")
        try:
            lock_file(stream)
        except OSError:
            stream.close()
            continue
        return number, stream.close
    raise InputError(f"the ROS domains from {FIRST_DOMAIN} to {LAST_DOMAIN} are all in use")


def _lock_path(number: int) -> Path:
    folder = Path(tempfile.gettempdir())
    if sys.platform == "win32":  # the folder belongs to one user
        return folder / f"crowdbot-domain-{number}.lock"
    else:
        return folder / f"crowdbot-domain-{os.getuid()}-{number}.lock"


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
        self._port.inbox.in_step = True
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
        controls = [robot for robot in simulation.robots if robot.robot.name in self.robots]
        due = [control for control in controls if not ended and not control.arrived[0] and _is_due(control, simulation)]
        kept = [order for order in self._port.take_orders(simulation) if not hasattr(order, "forward")]
        if not self._begun:
            self._begun = True
            self._port.begin(simulation)
            self._wait_for_start(simulation, {item.robot.name for item in due})
        else:
            self._port.publish(simulation)
            self._wait(simulation, due)
        result = [*kept, *self._port.take_orders(simulation)]
        result = [one for one in result if not self._is_dropped(one, due, simulation)]
        if not self._held:
            return result
        stops = [VelocityOrder(robot=control.robot.name, source=self._transport.name) for control in controls]
        return [*(one for one in result if not isinstance(one, VelocityOrder)), *stops]

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
        control = next((item for item in due if item.robot.name == getattr(order, "robot", "")), None)
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
        missing = {item.robot.name: item for item in due}
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
        program, stale = self._program, self._port.inbox.count.stale
        what += f"; {stale} commands had stamps of earlier instants" if stale else ""
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
        known = [second for second in self.seconds if not math.isnan(second)]
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
