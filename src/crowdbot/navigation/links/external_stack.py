"""Navigators that are robot software in processes of their own: their commands come over a robot interface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from crowdbot.core import InputError, check_number
from crowdbot.navigation.external import ExternalNavigator

SOURCE = "crowdbot.bridges:open_stack"
LAST_PORT, LAST_DOMAIN = 65535, 232
"""Largest TCP port, and the largest ROS domain whose ports exist on all systems."""


@dataclass(frozen=True)
class RosbridgeNavigator(ExternalNavigator):
    """Lets a program that speaks rosbridge drive the robot, step by step.

    The simulation is a rosbridge server. It sends the readings, the odometry, the transforms, the map, the clock and
    the goal of the robot, and at each control period it waits for a velocity command on ``/NAME/cmd_vel``. So the run
    does not depend on the speed of the program, except by the ``deadline`` of the robot: a later command is missed. A
    program that ends, disconnects or does not answer fails the run. The episode contains the commands, so its replay
    does not need the program.

    Fields:
        command: program to start for each run; ``{port}`` is replaced. Empty: a program connects by itself, and stays
            connected from run to run.
        port: TCP port on the loopback interface; 0: any free one for a command, otherwise 9090.
        answer: longest real time until a command comes [s].
        start: longest real time until the first command of a run comes [s].
        truth: whether the program also gets what no real robot knows: true people, the true pose and contacts.
        timeout: age of the latest command at which the robot stops [s], in simulated time.

    Raises:
        InputError: a value is not allowed.

    >>> RosbridgeNavigator(command="python navigate_rosbridge.py --port {port}").answer
    10.0
    """

    source: ClassVar[str] = SOURCE
    always_returns = True

    command: str = ""
    port: int = 0
    answer: float = 10.0
    start: float = 60.0
    truth: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_times(self)
        if not 0 <= self.port <= LAST_PORT:
            raise InputError(f"RosbridgeNavigator: port = {self.port} must be from 0 to {LAST_PORT}")


@dataclass(frozen=True)
class Ros2Navigator(ExternalNavigator):
    """Lets a program of ROS 2 drive the robot, step by step, as :class:`RosbridgeNavigator` does over rosbridge.

    The simulation is a node of rclpy. Set ``use_sim_time`` in the program.

    Fields:
        command: program to start for each run; ``{domain}`` is replaced, and ``ROS_DOMAIN_ID`` is set. Empty: a program
            runs already.
        domain: ROS domain; -1: for a command, one that no other run on this computer uses, otherwise that of
            ``ROS_DOMAIN_ID``.
        answer: longest real time until a command comes [s].
        start: longest real time until the first command of a run comes [s].
        truth: whether the program also gets what no real robot knows: true people, the true pose and contacts.
        timeout: age of the latest command at which the robot stops [s], in simulated time.

    Raises:
        InputError: a value is not allowed.

    >>> Ros2Navigator(domain=7).source
    'crowdbot.bridges:open_stack'
    """

    source: ClassVar[str] = SOURCE
    always_returns = True

    command: str = ""
    domain: int = -1
    answer: float = 10.0
    start: float = 60.0
    truth: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_times(self)
        if not -1 <= self.domain <= LAST_DOMAIN:
            raise InputError(f"Ros2Navigator: domain = {self.domain} must be from 0 to {LAST_DOMAIN}, or -1 for any")


def _check_times(navigator: RosbridgeNavigator | Ros2Navigator) -> None:
    for name in ("answer", "start"):
        check_number(type(navigator).__name__, name, getattr(navigator, name), "s", exclusive_min=0.0)
