"""GoalOrder: another goal of a robot while it runs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError
from crowdbot.simulation.simulation import NONE, SUCCESS
from crowdbot.trials import robot_place_problem
from crowdbot.world import check_place, redirect_person

from .order import Order


@dataclass(frozen=True, kw_only=True)
class GoalOrder(Order):
    """Give a robot another goal in one environment; a robot that has arrived drives again.

    The goal applies to the observation, the path planner, the arrival and the navigation metrics: these describe the
    run up to the arrival at the goal in force, and measure ``goal_progress`` to the latest goal.

    Fields:
        robot: name of the robot.
        x, y: goal [m].
        tolerance: distance [m] to the goal below which the robot has arrived; None keeps the previous one.

    Raises:
        InputError: a value is not finite, or the tolerance is not above 0.

    >>> GoalOrder(robot="pepper", x=2, y=1).tolerance is None
    True
    """

    robot: str
    x: float
    y: float
    tolerance: float | None = None

    def __post_init__(self) -> None:
        check_place(self.x, self.y)
        if self.tolerance is not None and not 0.0 < self.tolerance < math.inf:
            raise InputError(f"GoalOrder: tolerance = {self.tolerance!r} must be finite and above 0")

    def check(self, simulation: Any) -> None:
        super().check(simulation)
        control, place = simulation.control_of(self.robot), (float(self.x), float(self.y))
        start = f"GoalOrder: robot {self.robot!r}"
        reach = float(control.tolerance[self.environment]) if self.tolerance is None else float(self.tolerance)
        if problem := robot_place_problem(simulation.trial.stage, control.robot, place, reach):
            raise InputError(f"{start} would have its goal {problem}")
        if control.planner is not None:
            here = simulation.world.scene.position[self.environment, control.agent]
            try:
                control.planner.waypoints(here, place)
            except InputError as error:
                reason = str(error).removeprefix("PathPlanner: ").removeprefix("no path: ").removeprefix("Router: ")
                raise InputError(f"{start} has no path to {place[0]:g},{place[1]:g}: {reason}") from None

    def apply(self, simulation: Any) -> None:
        control, e, place = simulation.control_of(self.robot), self.environment, (float(self.x), float(self.y))
        redirect_person(simulation.world, int(simulation.world.ids[e, control.agent]), *place, e)
        control.change_goal(e, place, None if self.tolerance is None else float(self.tolerance))
        if simulation.event[e] == SUCCESS:
            simulation.event[e] = NONE
