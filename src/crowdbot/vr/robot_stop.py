"""RobotStop: holds all robots of a trial at velocity 0."""

from __future__ import annotations

from collections.abc import Sequence

from crowdbot.navigation import ExternalNavigator
from crowdbot.simulation import Order, OwnSource, ParameterOrder, Simulation, VelocityOrder
from crowdbot.trials import RobotSpec, Trial
from crowdbot.web import navigator_orders

SOURCE = "vr"
OPERATOR = "the stop button"
"""Reason for robots with a connection."""
REPEAT = 0.2
"""Simulated time [s] after which the velocity is ordered again."""


class RobotStop:
    """Stops all robots of a trial while it is set, and gives them back to their navigators afterwards.

    It is a source of orders: whatever happens is in the episode. Robots with a connection of their navigator are
    stopped there (:func:`hold_sources`). A robot with ``<pose>`` is where its source says: it is stopped at itself.

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
    return [robot.name for robot in trial.robots if robot.mirror is None and not _has_source(robot)]


def linked_robots(trial: Trial) -> list[str]:
    """Return the names of the robots that are stopped at the connection of their navigator."""
    return [robot.name for robot in trial.robots if _has_source(robot)]


def hold_sources(sources: Sequence[object], stop: bool) -> list[str]:
    """Stop or release the robots of connections; return why some of them are not released."""
    found = [one.hold(stop, OPERATOR) for one in sources if isinstance(one, OwnSource)]
    return [one for one in found if one]


def source_problems(sources: Sequence[object]) -> list[str]:
    """Return why robots of connections stand."""
    return [line for one in sources if isinstance(one, OwnSource) for line in one.problems()]


def _has_source(robot: RobotSpec) -> bool:
    return isinstance(robot.navigator, ExternalNavigator) and bool(robot.navigator.source)
