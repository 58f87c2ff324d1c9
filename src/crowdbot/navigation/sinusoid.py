"""A navigator that moves forward and backward as a sinusoid, as the leader of a coordination experiment."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from crowdbot.core import InputError, Twist, check_number, wrap_angle

from .action import Action
from .navigator import Navigator
from .observation import Observation

POSITION_GAIN = 2.0
"""Gain of the correction of the position along the line [1/s]."""
HEADING_GAIN = 2.0
"""Gain of the correction of the heading [1/s]."""


class LineStart(NamedTuple):
    """Pose x, y [m], heading [rad] and time [s] of the first decision."""

    x: float
    y: float
    heading: float
    time: float


@dataclass(frozen=True)
class SinusoidNavigator(Navigator):
    """Moves forward and backward along its first heading, and ignores people, walls and the goal.

    The displacement is ``amplitude (1 - cos(2 pi t / period))``: the robot starts at rest at the rear end. It leads in
    experiments on the coordination of people with robots.

    Fields:
        amplitude: half of the distance between the two ends [m].
        period: time to and fro [s].
        cycles: number of periods, after which the robot stands.
        wait: time before the first motion [s].

    Source: Ducourant, Vieilledent, Kerlirzin, Berthoz (2005), doi:10.1016/j.neulet.2005.06.052.

    Raises:
        InputError: a number is not above 0; at the first decision, if the drive is too slow for the motion.

    >>> from crowdbot.navigation import DriveLimits
    >>> leader = SinusoidNavigator(amplitude=0.4, period=8.0)
    >>> rest = Observation(pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1)
    >>> action, start = leader.decide(rest, leader.begin(rest))
    >>> round(action.twist.forward, 4)
    0.0123
    """

    always_returns = True

    amplitude: float = 0.5
    period: float = 8.0
    cycles: int = 6
    wait: float = 0.0

    def __post_init__(self) -> None:
        check_number("SinusoidNavigator", "amplitude", self.amplitude, "m", exclusive_min=0.0)
        check_number("SinusoidNavigator", "period", self.period, "s", exclusive_min=0.0)
        check_number("SinusoidNavigator", "cycles", self.cycles, "", min=1)
        check_number("SinusoidNavigator", "wait", self.wait, "s", min=0.0)

    @property
    def top_speed(self) -> float:
        """Largest speed of the motion [m/s]."""
        return 2.0 * math.pi * self.amplitude / self.period

    def begin(self, observation: Observation) -> LineStart:
        if self.top_speed > observation.limits.max_speed:
            raise InputError(
                f"an amplitude of {self.amplitude} m and a period of {self.period} s need {self.top_speed:.3g} "
                f"m/s, but the drive reaches {observation.limits.max_speed:g} m/s; use a longer period"
            )
        return LineStart(*observation.pose, observation.time)

    def act(self, observation: Observation, memory: LineStart) -> tuple[Action, LineStart]:
        x, y, heading = observation.pose
        along = (x - memory.x) * math.cos(memory.heading) + (y - memory.y) * math.sin(memory.heading)
        now = observation.time - memory.time
        ahead = (self.displacement(now + observation.dt) - self.displacement(now)) / observation.dt
        forward = ahead + POSITION_GAIN * (self.displacement(now) - along)
        turn = HEADING_GAIN * wrap_angle(memory.heading - heading)
        top, most = observation.limits.max_speed, observation.limits.max_turn_rate
        return Action(Twist(max(-top, min(top, forward)), max(-most, min(most, turn)))), memory

    def displacement(self, time: float) -> float:
        """Return the displacement [m] at a time after the start [s]."""
        moving = min(max(time - self.wait, 0.0), self.cycles * self.period)
        return self.amplitude * (1.0 - math.cos(2.0 * math.pi * moving / self.period))
