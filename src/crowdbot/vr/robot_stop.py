"""RobotStop: holds all robots of a trial at velocity 0."""

from __future__ import annotations

from crowdbot.navigation import ExternalNavigator
from crowdbot.simulation import Order, ParameterOrder, Simulation, VelocityOrder
from crowdbot.trials import Trial
from crowdbot.web import navigator_orders

__all__ = ["RobotStop", "movable_robots"]

SOURCE = "vr"
REPEAT = 0.2
"""Simulated time [s] after which the velocity is ordered again."""


class RobotStop:
    """Stops all robots of a trial while it is set, and gives them back to their navigators afterwards.

    It is a source of orders: whatever happens is in the episode. A robot with ``<pose>`` is where its source says, so
    it cannot be stopped from here.

    >>> from crowdbot.trials import load_trial
    >>> stop = RobotStop()
    >>> stop.set = True
    >>> [type(order).__name__ for order in stop.orders(Simulation(load_trial("frontal")))]
    ['ParameterOrder', 'VelocityOrder']
    """

    def __init__(self) -> None:
        self.set = False
        """Whether the robots are to stand."""
        self._held: dict[str, list[Order]] = {}
        self._returns: list[Order] = []
        self._due = 0

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the orders for this step."""
        if not self.set:
            self._returns += [order for orders in self._held.values() for order in orders]
            self._held.clear()
            return [self._returns.pop(0)] if self._returns else []  # one a step: each needs the one before
        found: list[Order] = []
        names = movable_robots(simulation.trial)
        for robot in simulation.trial.robots:
            if robot.name in names and robot.name not in self._held:
                own = isinstance(robot.navigator, ExternalNavigator)
                self._held[robot.name] = [] if own else navigator_orders(robot.name, robot.navigator)
                path = f"robot[{robot.name}]/navigator/type"
                found += [] if own else [ParameterOrder(path=path, value="external", source=SOURCE)]
                self._due = simulation.tick
        if simulation.tick >= self._due:
            self._due = simulation.tick + round(REPEAT / simulation.world.clock.dt)
            found += [VelocityOrder(robot=name, source=SOURCE) for name in names]
        return found


def movable_robots(trial: Trial) -> list[str]:
    """Return the names of the robots that orders can stop."""
    return [robot.name for robot in trial.robots if robot.pose is None]
