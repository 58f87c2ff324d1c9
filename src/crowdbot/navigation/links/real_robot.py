"""The navigator of a robot whose place a real robot takes, or a simulated one that rehearses it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from crowdbot.core import InputError, check_number
from crowdbot.navigation.external import ExternalNavigator

REHEARSAL = "simulated"
"""Bridge to a robot of this program, which needs no area."""


@dataclass(frozen=True)
class RealRobotNavigator(ExternalNavigator):
    """Lets a real robot in an empty hall take the place of the robot of the trial, in real time.

    Its odometry moves the robot of the trial, so people see it where it is; virtual sensors go to it. Wanted velocities
    come from ``driver``, a navigator of this program, or on ``/NAME/cmd_vel`` from software at a bridge; they leave for
    the robot on ``command`` within limits, and not after an emergency stop. With ``bridge="simulated"``, a simulated
    base takes its place: the same trial can be rehearsed without hardware. The episode contains the poses, so its
    replay needs no robot.

    Fields:
        bridge: connections as for ``--bridge``, by blanks, such as ``rosbridge-client:ws://192.168.0.2:9090``;
            ``simulated``: no hardware.
        driver: built-in navigator that drives the robot, such as ``follower``; empty: software at a bridge.
        parameters: parameters of the driver, ``name=value`` by blanks.
        area: rectangle ``x0,y0,x1,y1`` [m] in the trial that the robot may not leave; needed for a real robot.
        odometry: topic of the odometry of the robot; empty: the robot tells its velocity on ``/NAME/cmd_vel``, as over
            ``naoqi``, and its own software drives it.
        command: topic of the guarded velocities.
        max_speed, max_turn: largest velocities that leave [m/s], [rad/s].
        max_acceleration, max_turn_acceleration: largest changes of what leaves [m/s2], [rad/s2].
        link_timeout: age of the latest pose at which the robot is stopped [s].
        start: longest real time until the first pose comes [s].
        timeout: age of the latest wanted velocity at which the robot stops [s].

    Raises:
        InputError: a value is not allowed, or a real robot has no area.

    >>> RealRobotNavigator(driver="follower").mirrors
    True
    """

    source: ClassVar[str] = "crowdbot.bridges:open_real_robot"
    always_returns = True

    bridge: str = REHEARSAL
    driver: str = ""
    parameters: str = ""
    area: str = ""
    odometry: str = "/odom"
    command: str = "/cmd_vel"
    max_speed: float = 0.5
    max_turn: float = 1.0
    max_acceleration: float = 0.5
    max_turn_acceleration: float = 2.0
    link_timeout: float = 0.5
    start: float = 10.0

    def __post_init__(self) -> None:
        super().__post_init__()
        units = {"max_speed": "m/s", "max_turn": "rad/s", "max_acceleration": "m/s2", "max_turn_acceleration": "rad/s2"}
        for name, unit in (units | {"link_timeout": "s", "start": "s"}).items():
            check_number("RealRobotNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        if not self.bridge.split():
            raise InputError("RealRobotNavigator: bridge must name a connection, such as ros2, or simulated")
        if not self.area and self.odometry and REHEARSAL not in self.bridge.split():
            raise InputError("RealRobotNavigator: a real robot needs an area that it may not leave, x0,y0,x1,y1 [m]")
        if self.parameters and not self.driver:
            raise InputError("RealRobotNavigator: parameters belong to a driver; name one, such as driver=follower")
        if any("=" not in word for word in self.parameters.split()):
            raise InputError(f"RealRobotNavigator: parameters = {self.parameters!r} must be name=value, by blanks")
        if self.driver and not self.odometry:
            raise InputError("RealRobotNavigator: without odometry the robot drives itself; leave out the driver")

    @property
    def mirrors(self) -> bool:
        return bool(self.odometry)
